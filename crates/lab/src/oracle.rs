//! The oracle: reflectance by the book, in plain `f64`, without a line of the kernel but for the losses of `energy`.
//!
//! It shares no arrangement with the kernel: half vectors are normalised, D and Λ are in their tan²θ forms (Walter et al.
//! 2007; Heitz 2014; PBR book, section 9.6), conductors use complex arithmetic, dielectrics Snell's angles. So an error that the
//! kernel makes consistently, in value and density alike (two axes swapped everywhere, a π missing twice, a wrong sign of k),
//! meets a second opinion here. Clarity before precision: it loses some digits where the kernel does not.

use crate::probe::{Dir, Worth};
use gonio_kernel::energy;
use std::f64::consts::PI;

/// Lambert: ρ/π.
pub(crate) fn lambert(p: &[f64], _wo: Dir, wi: Dir) -> Worth {
    Worth { f_cos: [p[0], p[1], p[2]].map(|albedo| albedo / PI * wi.z), pdf: wi.z / PI }
}

/// What is purely discrete has no density over directions.
pub(crate) fn discrete(_p: &[f64], _wo: Dir, _wi: Dir) -> Worth {
    Worth { f_cos: [0.0; 3], pdf: 0.0 }
}

/// Phong's diffuse and glossy part, n/(α + 1) given: three k_d, α; k_s = 1 − k_d.
fn phong(p: &[f64], wo: Dir, wi: Dir, excess: f64) -> Worth {
    let exponent = p[3];
    // The angle between two points of the sphere, from the chord between wo and the mirrored wi.
    let chord = ((wo.x + wi.x).powi(2) + (wo.y + wi.y).powi(2) + (wo.z - wi.z).powi(2)).sqrt();
    let cos = (2.0 * (0.5 * chord).min(1.0).asin()).cos();
    let glossy = if cos > 0.0 { (exponent + 1.0) / (2.0 * PI) * cos.powf(exponent) } else { 0.0 };
    let luminance = |c: [f64; 3]| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    let choose = luminance([p[0], p[1], p[2]]);
    let f = [0, 1, 2].map(|c| p[c] / PI + (1.0 - p[c]) * glossy * excess);
    Worth { f_cos: f.map(|f| f * wi.z), pdf: choose * wi.z / PI + (1.0 - choose) * glossy }
}

/// Phong as in the lecture: three k_d, α; k_s = 1 − k_d.
pub(crate) fn phong_lecture(p: &[f64], wo: Dir, wi: Dir) -> Worth {
    phong(p, wo, wi, 1.0)
}

/// Phong as by Lafortune and Willems.
pub(crate) fn phong_lafortune(p: &[f64], wo: Dir, wi: Dir) -> Worth {
    phong(p, wo, wi, (p[3] + 2.0) / (p[3] + 1.0))
}

/// A conductor: alpha_x, alpha_y, three η, three k.
pub(crate) fn metal(p: &[f64], wo: Dir, wi: Dir) -> Worth {
    microfacet(p[0], p[1], wo, wi, |cos| [0, 1, 2].map(|c| conductor(cos, p[2 + c], p[5 + c])))
}

/// Schlick's Fresnel: alpha_x, alpha_y, three f0.
pub(crate) fn schlick(p: &[f64], wo: Dir, wi: Dir) -> Worth {
    microfacet(p[0], p[1], wo, wi, |cos| [0, 1, 2].map(|c| schlick_curve(p[2 + c], cos)))
}

fn schlick_curve(f0: f64, cos: f64) -> f64 {
    f0 + (1.0 - f0) * (1.0 - cos).powi(5)
}

/// F82: alpha_x, alpha_y, three f0, three tints. Schlick's curve less a cosθ (1 − cosθ)⁶, with a such that the curve is
/// tint times Schlick's at cosθ = 1/7.
pub(crate) fn f82(p: &[f64], wo: Dir, wi: Dir) -> Worth {
    microfacet(p[0], p[1], wo, wi, |cos| {
        [0, 1, 2].map(|c| {
            let schlick = |cos: f64| p[2 + c] + (1.0 - p[2 + c]) * (1.0 - cos).powi(5);
            let bell = |cos: f64| cos * (1.0 - cos).powi(6);
            let at = 1.0 / 7.0;
            (schlick(cos) - (1.0 - p[5 + c]) * schlick(at) * bell(cos) / bell(at)).max(0.0)
        })
    })
}

/// Beckmann's distribution with Schlick's Fresnel: alpha_x, alpha_y, three f0. D in slopes (Walter et al. 2007, equation 25),
/// Λ with the error function (Heitz 2014, equation 77); all visible normals as density.
pub(crate) fn beckmann(p: &[f64], wo: Dir, wi: Dir) -> Worth {
    let schlick = |cos: f64| ([0, 1, 2].map(|c| schlick_curve(p[2 + c], cos)), 1.0);
    reflection(&|m| beckmann_d(p[0], p[1], m), &|w| beckmann_lambda(p[0], p[1], w), wo, wi, &schlick)
}

/// Λ of a Beckmann surface: Heitz 2014, equation 77.
pub(crate) fn beckmann_lambda(alpha_x: f64, alpha_y: f64, w: Dir) -> f64 {
    let a = w.z / ((alpha_x * w.x).powi(2) + (alpha_y * w.y).powi(2)).sqrt();
    if a.is_infinite() { 0.0 } else { 0.5 * ((-a * a).exp() / (a * PI.sqrt()) - statrs::function::erf::erfc(a)) }
}

fn beckmann_d(alpha_x: f64, alpha_y: f64, m: [f64; 3]) -> f64 {
    let slopes = [m[0] / m[2] / alpha_x, m[1] / m[2] / alpha_y];
    (-slopes[0] * slopes[0] - slopes[1] * slopes[1]).exp() / (PI * alpha_x * alpha_y * m[2].powi(4))
}

/// Schlick's Fresnel with Turquin's factor: alpha_x, alpha_y, three f0.
pub(crate) fn turquin(p: &[f64], wo: Dir, wi: Dir) -> Worth {
    let single = schlick(p, wo, wi);
    let lost = energy::Missing::of((p[0] * p[1]).sqrt()).at(wo.z);
    let factor = |c: usize| 1.0 + p[2 + c] * (1.0 / (1.0 - lost) - 1.0);
    Worth { f_cos: [0, 1, 2].map(|c| single.f_cos[c] * factor(c)), ..single }
}

/// Schlick's Fresnel with separable masking.
pub(crate) fn separable(p: &[f64], wo: Dir, wi: Dir) -> Worth {
    let worth = schlick(p, wo, wi);
    let ratio = ggx_g1(p[0], p[1], wo) * ggx_g1(p[0], p[1], wi) / ggx_g2(p[0], p[1], wo, wi);
    Worth { f_cos: worth.f_cos.map(|f| f * ratio), ..worth }
}

/// Schlick's Fresnel with Kulla & Conty's lobe: alpha_x, alpha_y, three f0. The losses are the kernel's (the instrument `walk`
/// and the tables' own tests hold them to quadrature), and so are the fitted constants; the arrangement is not.
pub(crate) fn kulla_conty(p: &[f64], wo: Dir, wi: Dir) -> Worth {
    let fresnel = |c: usize, cos: f64| schlick_curve(p[2 + c], cos);
    with_multiple(p, wo, wi, schlick(p, wo, wi), &fresnel)
}

/// The same of a metal: alpha_x, alpha_y, three η, three k.
pub(crate) fn metal_kulla_conty(p: &[f64], wo: Dir, wi: Dir) -> Worth {
    let fresnel = |c: usize, cos: f64| conductor(cos, p[2 + c], p[5 + c]);
    with_multiple(p, wo, wi, metal(p, wo, wi), &fresnel)
}

/// Kulla & Conty's lobe beside the single scattering; `fresnel` of a channel and a cosine.
fn with_multiple(p: &[f64], wo: Dir, wi: Dir, single: Worth, fresnel: &dyn Fn(usize, f64) -> f64) -> Worth {
    let alpha = (p[0] * p[1]).sqrt();
    let missing = energy::Missing::of(alpha);
    let (lost_o, lost_i, lost) = (missing.at(wo.z), missing.at(wi.z), energy::missing_avg(alpha));
    let wide = lost_o * lost_i / (PI * lost);
    let again = (0.68 * lost_o * lost_i / lost).min(0.545 * alpha);
    let cos = ((0.77 * wo.z + 0.56 * alpha) * (0.77 * wi.z + 0.56 * alpha)).sqrt().min(1.0);
    let f_cos = [0, 1, 2].map(|c| {
        let f = 0.5 * (fresnel(c, cos) + fresnel(c, 0.43 * cos));
        single.f_cos[c] + f * f * (1.0 - again) / (1.0 - f * again) * wide * wi.z
    });
    let multiple = 1.0 / (2.0 * PI * (wi.z + 4.0 * alpha) * (1.0 + 0.25 / alpha).ln());
    Worth { f_cos, pdf: (1.0 - lost_o) * single.pdf + lost_o * multiple }
}

/// The reflection of a dielectric: alpha_x, alpha_y, index.
pub(crate) fn coat(p: &[f64], wo: Dir, wi: Dir) -> Worth {
    microfacet(p[0], p[1], wo, wi, |cos| [dielectric(cos, p[2]); 3])
}

/// A rough interface: alpha_x, alpha_y, index; as importance. Walter et al. 2007, equations 16, 20 and 21, read with i for
/// wo and o for wi, and all visible normals as density.
pub(crate) fn ground(p: &[f64], wo: Dir, wi: Dir) -> Worth {
    let (d, lambda) = (|m| ggx_d(p[0], p[1], m), |w| ggx_lambda(p[0], p[1], w));
    ground_of(p[2], &d, &lambda, wo, wi)
}

/// The same with Beckmann's distribution.
pub(crate) fn ground_beckmann(p: &[f64], wo: Dir, wi: Dir) -> Worth {
    let (d, lambda) = (|m| beckmann_d(p[0], p[1], m), |w| beckmann_lambda(p[0], p[1], w));
    ground_of(p[2], &d, &lambda, wo, wi)
}

fn ground_of(eta: f64, distribution: Distribution, lambda: Lambda, wo: Dir, wi: Dir) -> Worth {
    let black = Worth { f_cos: [0.0; 3], pdf: 0.0 };
    let (mut wo, mut wi, mut eta) = (wo, wi, eta);
    if (eta - 1.0).abs() < 1e-3 {
        return black; // a discrete event
    }
    if wo.z < 0.0 {
        (wo.z, wi.z, eta) = (-wo.z, -wi.z, 1.0 / eta);
    }
    let dot = |a: Dir, m: [f64; 3]| a.x * m[0] + a.y * m[1] + a.z * m[2];
    if wi.z > 0.0 {
        // Reflection is chosen in proportion to F.
        let part = |cos| ([dielectric(cos, eta); 3], dielectric(cos, eta));
        return reflection(distribution, lambda, wo, wi, &part);
    }
    let (lambda_o, lambda_i) = (lambda(wo), lambda(Dir::new(wi.x, wi.y, -wi.z)));
    let g1_o = 1.0 / (1.0 + lambda_o);
    // The normal of refraction, on wo's side.
    let h = [wo.x + eta * wi.x, wo.y + eta * wi.y, wo.z + eta * wi.z];
    let length = (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]).sqrt();
    let sign = if h[2] < 0.0 { -1.0 } else { 1.0 };
    let m = h.map(|x| x * sign / length);
    let (cos_om, cos_im) = (dot(wo, m), dot(wi, m));
    if cos_om <= 0.0 || cos_im >= 0.0 {
        return black;
    }
    // Fresnel's amplitudes of the transmitted wave, with both angles from the geometry.
    let cos_t = -cos_im;
    let across = 2.0 * cos_om / (cos_om + eta * cos_t);
    let along = 2.0 * cos_om / (eta * cos_om + cos_t);
    let transmitted = eta * cos_t / cos_om * 0.5 * (across * across + along * along);
    let d = distribution(m);
    let g = g1_o / (1.0 + lambda_i);
    let jacobian = eta * eta * cos_im.abs() / (cos_om + eta * cos_im).powi(2);
    let f = transmitted * d * g * cos_om * jacobian / (wo.z * wi.z.abs());
    let pdf = transmitted * g1_o * d * cos_om / wo.z * jacobian;
    Worth { f_cos: [f * wi.z.abs(); 3], pdf }
}

/// EON with the exact directional albedo: three ρ, r.
pub(crate) fn eon_exact(p: &[f64], wo: Dir, wi: Dir) -> Worth {
    eon(p, wo, wi, |mu| {
        let s = (1.0 - mu * mu).max(0.0).sqrt();
        (s * (mu.acos() - s * mu) + 2.0 / 3.0 * ((s / mu) * (1.0 - s * s * s) - s)) / PI
    })
}

/// EON with the fitted directional albedo.
pub(crate) fn eon_fitted(p: &[f64], wo: Dir, wi: Dir) -> Worth {
    eon(p, wo, wi, |mu| {
        let m = 1.0 - mu;
        0.0571085289 * m + 0.491881867 * m.powi(2) - 0.332181442 * m.powi(3) + 0.0714429953 * m.powi(4)
    })
}

/// Portsmouth, Kutz & Hill 2025, listings 1 to 3, with r^⅛ instead of r^0.1; g is G/π.
fn eon(p: &[f64], wo: Dir, wi: Dir, g: impl Fn(f64) -> f64) -> Worth {
    let r = p[3];
    let (c1, c2) = (0.5 - 2.0 / (3.0 * PI), 2.0 / 3.0 - 28.0 / (15.0 * PI));
    let a = 1.0 / (1.0 + c1 * r);
    let s = wo.dot(wi) - wo.z * wi.z;
    let s_over_t = if s > 0.0 { s / wo.z.max(wi.z) } else { s };
    // The fitted albedo exceeds 1 at grazing, where the paper clamps as well.
    let lost = |mu: f64| (1.0 - a * (1.0 + r * g(mu))).max(0.0);
    let mean = a * (1.0 + c2 * r);
    let f_cos = [p[0], p[1], p[2]].map(|rho| {
        let multiple = rho * rho * mean / (1.0 - rho * (1.0 - mean));
        let compensation = if r > 0.0 { multiple / PI * lost(wo.z) * lost(wi.z) / (1.0 - mean) } else { 0.0 };
        (rho / PI * a * (1.0 + r * s_over_t) + compensation) * wi.z
    });
    let mu = wo.z;
    let share = r.powf(0.125) * (0.162925 + mu * (-0.372058 + (0.538233 - 0.290822 * mu) * mu));
    Worth { f_cos, pdf: share / (2.0 * PI) + (1.0 - share) * cltc(wo, wi, r) }
}

/// Density of the clipped linearly transformed cosine: cosine over the kept part of the hemisphere, times the Jacobian
/// |M⁻¹| / |M⁻¹ω|³ of ω ∝ Mw.
fn cltc(wo: Dir, wi: Dir, r: f64) -> f64 {
    let mu = wo.z;
    let a = 1.0 + r * (0.303392 + (-0.518982 + 0.111709 * mu) * mu + (-0.276266 + 0.335918 * mu) * r);
    let b = r * (-1.16407 + 1.15859 * mu + (0.150815 - 0.150105 * mu) * r) / (mu * mu * mu - 1.43545);
    let c = 1.0 + (0.20013 + (-0.506373 + 0.261777 * mu) * mu) * r;
    let d = r * (0.540852 + (-1.01625 + 0.475392 * mu) * mu) / (-1.0743 + mu * (0.0725628 + mu));
    // wi in the frame whose x is wo's azimuth; any frame will do at the normal.
    let azimuth = if wo.x == 0.0 && wo.y == 0.0 { 0.0 } else { wo.y.atan2(wo.x) };
    let (x, y) = (wi.x * azimuth.cos() + wi.y * azimuth.sin(), wi.y * azimuth.cos() - wi.x * azimuth.sin());
    // M = [[a, 0, b], [0, c, 0], [d, 0, 1]]: y decouples, x and z by Cramer's rule.
    let det_xz = a - b * d;
    let w = [(x - b * wi.z) / det_xz, y / c, (a * wi.z - d * x) / det_xz];
    let length = (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]).sqrt();
    let kept = 0.5 * (1.0 + 1.0 / (1.0 + d * d).sqrt());
    (w[2] / length).max(0.0) / (PI * kept) / (c * det_xz) / (length * length * length)
}

/// Cook–Torrance with GGX.
fn microfacet(alpha_x: f64, alpha_y: f64, wo: Dir, wi: Dir, fresnel: impl Fn(f64) -> [f64; 3]) -> Worth {
    let part = |cos| (fresnel(cos), 1.0);
    let worth = reflection(&|m| ggx_d(alpha_x, alpha_y, m), &|w| ggx_lambda(alpha_x, alpha_y, w), wo, wi, &part);
    // Reflectors sample normals above a bound (Eto & Tokuyoshi 2023, equations 5 and 6): D/(2(k cosθ + t)) where all
    // normals would give D/(2(cosθ + t)).
    let t = (wo.z * wo.z + (alpha_x * wo.x).powi(2) + (alpha_y * wo.y).powi(2)).sqrt();
    let a = alpha_x.min(alpha_y);
    let s = 1.0 + (1.0 - wo.z * wo.z).max(0.0).sqrt();
    let k = (1.0 - a * a) * s * s / (s * s + a * a * wo.z * wo.z);
    Worth { pdf: worth.pdf * (wo.z + t) / (k * wo.z + t), ..worth }
}

/// A density of normals.
type Distribution<'a> = &'a dyn Fn([f64; 3]) -> f64;
/// Smith's Λ.
type Lambda<'a> = &'a dyn Fn(Dir) -> f64;

/// Cook–Torrance: f = F D G₂ / (4 cosθ_o cosθ_i), all visible normals as density. `part` is F, and the probability with which
/// a facet reflects.
fn reflection(d: Distribution, lambda: Lambda, wo: Dir, wi: Dir, part: &dyn Fn(f64) -> ([f64; 3], f64)) -> Worth {
    let sum = [wo.x + wi.x, wo.y + wi.y, wo.z + wi.z];
    let length = (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]).sqrt();
    let m = sum.map(|x| x / length);
    let cos_om = wo.x * m[0] + wo.y * m[1] + wo.z * m[2];
    let (lambda_o, lambda_i) = (lambda(wo), lambda(wi));
    let (g1, g2) = (1.0 / (1.0 + lambda_o), 1.0 / (1.0 + lambda_o + lambda_i));
    // D_visible(m) = G₁ D (wo·m)/cosθ_o, and dω_m/dω_i = 1/(4 wo·m).
    let (fresnel, reflects) = part(cos_om);
    let d = d(m);
    let pdf = reflects * g1 * d * cos_om / wo.z / (4.0 * cos_om);
    Worth { f_cos: fresnel.map(|f| f * d * g2 / (4.0 * wo.z * wi.z) * wi.z), pdf }
}

/// D(m) = 1 / (π α_x α_y cos⁴θ (1 + tan²θ (cos²φ/α_x² + sin²φ/α_y²))²).
fn ggx_d(alpha_x: f64, alpha_y: f64, m: [f64; 3]) -> f64 {
    let cos2 = m[2] * m[2];
    let sin2 = m[0] * m[0] + m[1] * m[1];
    if sin2 == 0.0 {
        return 1.0 / (PI * alpha_x * alpha_y);
    }
    let (cos2_phi, sin2_phi) = (m[0] * m[0] / sin2, m[1] * m[1] / sin2);
    let e = sin2 / cos2 * (cos2_phi / (alpha_x * alpha_x) + sin2_phi / (alpha_y * alpha_y));
    1.0 / (PI * alpha_x * alpha_y * cos2 * cos2 * (1.0 + e) * (1.0 + e))
}

/// Λ(w) = (√(1 + α² tan²θ) − 1)/2 with α² = cos²φ α_x² + sin²φ α_y².
fn ggx_lambda(alpha_x: f64, alpha_y: f64, w: Dir) -> f64 {
    let sin2 = w.x * w.x + w.y * w.y;
    if sin2 == 0.0 {
        return 0.0;
    }
    let alpha2 = w.x * w.x / sin2 * alpha_x * alpha_x + w.y * w.y / sin2 * alpha_y * alpha_y;
    ((1.0 + alpha2 * sin2 / (w.z * w.z)).sqrt() - 1.0) / 2.0
}

/// Smith's G₁.
fn ggx_g1(alpha_x: f64, alpha_y: f64, w: Dir) -> f64 {
    1.0 / (1.0 + ggx_lambda(alpha_x, alpha_y, w))
}

/// Height-correlated G₂.
fn ggx_g2(alpha_x: f64, alpha_y: f64, wo: Dir, wi: Dir) -> f64 {
    1.0 / (1.0 + ggx_lambda(alpha_x, alpha_y, wo) + ggx_lambda(alpha_x, alpha_y, wi))
}

type Complex = [f64; 2];

fn times(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}
fn norm2(a: Complex) -> f64 {
    a[0] * a[0] + a[1] * a[1]
}
/// The root with non-negative real part, by polar angles.
fn root(a: Complex) -> Complex {
    let (r, phi) = (norm2(a).sqrt().sqrt(), 0.5 * a[1].atan2(a[0]));
    [r * phi.cos(), r * phi.sin()]
}

/// Fresnel's reflectance of an interface of complex index n = η − ik, unpolarised: amplitudes
/// r⊥ = (cosθ − s)/(cosθ + s), r∥ = (n² cosθ − s)/(n² cosθ + s), s = √(n² − sin²θ).
pub(crate) fn conductor(cos: f64, eta: f64, k: f64) -> f64 {
    let n2 = times([eta, -k], [eta, -k]);
    let s = root([n2[0] - (1.0 - cos * cos), n2[1]]);
    let n2_cos = n2.map(|x| x * cos);
    let ratio = |a: Complex| norm2([a[0] - s[0], a[1] - s[1]]) / norm2([a[0] + s[0], a[1] + s[1]]);
    0.5 * (ratio([cos, 0.0]) + ratio(n2_cos))
}

/// Fresnel's reflectance between dielectrics by Snell's angles: r⊥ = −sin(θ − θ′)/sin(θ + θ′), r∥ = tan(θ − θ′)/tan(θ + θ′).
pub(crate) fn dielectric(cos: f64, eta: f64) -> f64 {
    let theta = cos.min(1.0).acos(); // a product of two unit vectors may exceed 1 by rounding
    let sin_t = theta.sin() / eta;
    if sin_t >= 1.0 {
        return 1.0;
    }
    if theta < 1e-6 {
        return ((eta - 1.0) / (eta + 1.0)).powi(2);
    }
    let theta_t = sin_t.asin();
    let (minus, plus) = (theta - theta_t, theta + theta_t);
    0.5 * ((minus.sin() / plus.sin()).powi(2) + (minus.tan() / plus.tan()).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_printed_values() {
        // Glass of 1.5 reflects 4 % straight on and nothing polarised in the plane at Brewster's angle, where the rest is
        // ½(η² − 1)²/(η² + 1)²; a perfect dielectric limit of the conductor is the same curve.
        assert!((dielectric(1.0, 1.5) - 0.04).abs() < 1e-12);
        let brewster = 1.5_f64.atan().cos();
        let rest = 0.5 * (1.25_f64 / 3.25).powi(2);
        assert!((dielectric(brewster, 1.5) - rest).abs() < 1e-12);
        assert!((conductor(brewster, 1.5, 0.0) - rest).abs() < 1e-12);
        // ((η − 1)² + k²)/((η + 1)² + k²) at normal incidence.
        assert!((conductor(1.0, 0.2, 3.0) - (0.64 + 9.0) / (1.44 + 9.0)).abs() < 1e-12);
    }
}
