//! The oracle: reflectance by the book, in plain `f64`, without a line of the kernel but for the losses of `energy`.
//!
//! It shares no arrangement with the kernel: half vectors are normalised, D and Λ are in their tan²θ forms (Walter et al.
//! 2007; Heitz 2014; PBR book, section 9.6), conductors use complex arithmetic, dielectrics Snell's angles. So an error that the
//! kernel makes consistently, in value and density alike (two axes swapped everywhere, a π missing twice, a wrong sign of k),
//! meets a second opinion here. Clarity before precision: it loses some digits where the kernel does not.
//!
//! A model that is not in [`value`] has no second opinion, and no row in the instrument `reference`.

mod eon;
mod facets;
mod fresnel;

pub(crate) use facets::beckmann_lambda;
pub(crate) use fresnel::{conductor, dielectric};

use crate::probe::{BsdfValue, Dir};
use fresnel::reflectance;
use gonio_kernel::energy::{self, Compensation};
use gonio_kernel::lobe::{AnyLobe, Conductor, Lambert, Phong, PhongNormalization, RoughDielectric};
use gonio_kernel::microfacet::{Distribution, Masking, Microfacets};
use gonio_kernel::{Lobe, Rgb};
use std::f64::consts::PI;

const BLACK: BsdfValue = BsdfValue { f_cos: [0.0; 3], pdf: 0.0 };

/// The textbook's value of a lobe, as importance; none if the book has none.
pub(crate) fn value(lobe: &AnyLobe<f64>, wo: Dir, wi: Dir) -> Option<BsdfValue> {
    match lobe {
        // What is all delta has no density over directions.
        lobe if lobe.properties().all_delta => Some(BLACK),
        AnyLobe::Lambert(l) => Some(lambert(l, wi)),
        AnyLobe::Phong(l) => phong(l, wo, wi),
        AnyLobe::Eon(l) => eon::value(l, wo, wi),
        AnyLobe::Conductor(l) => conductor_value(l, wo, wi),
        AnyLobe::RoughDielectric(l) => rough_dielectric(l, wo, wi),
        _ => None,
    }
}

/// Lambert: ρ/π.
fn lambert(l: &Lambert<f64>, wi: Dir) -> BsdfValue {
    BsdfValue { f_cos: <[f64; 3]>::from(l.albedo).map(|albedo| albedo / PI * wi.z), pdf: wi.z / PI }
}

fn luminance(c: Rgb<f64>) -> f64 {
    0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b
}

/// Phong's diffuse and glossy part.
fn phong(l: &Phong<f64>, wo: Dir, wi: Dir) -> Option<BsdfValue> {
    let exponent = l.exponent;
    let n = match l.normalization {
        PhongNormalization::Modified => exponent + 1.0,
        PhongNormalization::LafortuneWillems => exponent + 2.0,
        _ => return None,
    };
    // The angle between two points of the sphere, from the chord between wo and the mirrored wi.
    let chord = ((wo.x + wi.x).powi(2) + (wo.y + wi.y).powi(2) + (wo.z - wi.z).powi(2)).sqrt();
    let cos = (2.0 * (0.5 * chord).min(1.0).asin()).cos();
    let power = if cos > 0.0 { cos.powf(exponent) / (2.0 * PI) } else { 0.0 };
    let (d, s) = (luminance(l.diffuse), luminance(l.glossy));
    let choose = if d + s > 0.0 { d / (d + s) } else { 1.0 };
    let f = l.diffuse.map(|k| k / PI) + l.glossy.map(|k| k * n * power);
    let pdf = choose * wi.z / PI + (1.0 - choose) * (exponent + 1.0) * power;
    Some(BsdfValue { f_cos: f.map(|f| f * wi.z).into(), pdf })
}

/// A rough reflector: single scattering, and what is added for the rest.
fn conductor_value(l: &Conductor<f64>, wo: Dir, wi: Dir) -> Option<BsdfValue> {
    let [alpha_x, alpha_y] = l.microfacets.alphas();
    let part = |cos: f64| Some((reflectance(&l.fresnel, cos)?, 1.0));
    let mut single = reflection(&l.microfacets, l.masking, wo, wi, &part)?;
    if l.microfacets.distribution == Distribution::Ggx {
        // Reflectors sample normals above a bound (Eto & Tokuyoshi 2023, equations 5 and 6): D/(2(k cosθ + t)) where all
        // normals would give D/(2(cosθ + t)).
        let t = (wo.z * wo.z + (alpha_x * wo.x).powi(2) + (alpha_y * wo.y).powi(2)).sqrt();
        let a = alpha_x.min(alpha_y);
        let s = 1.0 + (1.0 - wo.z * wo.z).max(0.0).sqrt();
        let k = (1.0 - a * a) * s * s / (s * s + a * a * wo.z * wo.z);
        single.pdf *= (wo.z + t) / (k * wo.z + t);
    }
    match l.compensation {
        Compensation::None => Some(single),
        Compensation::Turquin => {
            let lost = energy::Missing::of((alpha_x * alpha_y).sqrt()).at(wo.z);
            let f0 = reflectance(&l.fresnel, 1.0)?;
            let factor = |c: usize| 1.0 + f0[c] * (1.0 / (1.0 - lost) - 1.0);
            Some(BsdfValue { f_cos: [0, 1, 2].map(|c| single.f_cos[c] * factor(c)), ..single })
        }
        Compensation::KullaConty => with_multiple(l, wo, wi, single),
        _ => None,
    }
}

/// Kulla & Conty's lobe beside the single scattering. The losses are the kernel's (the instrument `walk` and the tables' own tests hold
/// them to quadrature), and so are the fitted constants; the arrangement is not.
fn with_multiple(l: &Conductor<f64>, wo: Dir, wi: Dir, single: BsdfValue) -> Option<BsdfValue> {
    let [alpha_x, alpha_y] = l.microfacets.alphas();
    let alpha = (alpha_x * alpha_y).sqrt();
    let missing = energy::Missing::of(alpha);
    let (lost_o, lost_i, lost) = (missing.at(wo.z), missing.at(wi.z), energy::missing_avg(alpha));
    let wide = lost_o * lost_i / (PI * lost);
    let again = (0.68 * lost_o * lost_i / lost).min(0.545 * alpha);
    let cos = ((0.77 * wo.z + 0.56 * alpha) * (0.77 * wi.z + 0.56 * alpha)).sqrt().min(1.0);
    let (steep, flat) = (reflectance(&l.fresnel, cos)?, reflectance(&l.fresnel, 0.43 * cos)?);
    let f_cos = [0, 1, 2].map(|c| {
        let f = 0.5 * (steep[c] + flat[c]);
        single.f_cos[c] + f * f * (1.0 - again) / (1.0 - f * again) * wide * wi.z
    });
    let multiple = 1.0 / (2.0 * PI * (wi.z + 4.0 * alpha) * (1.0 + 0.25 / alpha).ln());
    Some(BsdfValue { f_cos, pdf: (1.0 - lost_o) * single.pdf + lost_o * multiple })
}

/// A rough interface. Walter et al. 2007, equations 16, 20 and 21, read with i for wo and o for wi, and all visible normals as
/// density.
fn rough_dielectric(l: &RoughDielectric<f64>, wo: Dir, wi: Dir) -> Option<BsdfValue> {
    let (mut wo, mut wi, mut eta) = (wo, wi, l.eta);
    if wo.z < 0.0 {
        (wo.z, wi.z, eta) = (-wo.z, -wi.z, 1.0 / eta);
    }
    let dot = |a: Dir, m: [f64; 3]| a.x * m[0] + a.y * m[1] + a.z * m[2];
    if wi.z > 0.0 {
        // Reflection is chosen in proportion to F.
        let part = |cos| Some(([dielectric(cos, eta); 3], dielectric(cos, eta)));
        return reflection(&l.microfacets, l.masking, wo, wi, &part);
    }
    let lambda_o = facets::lambda(&l.microfacets, wo)?;
    let lambda_i = facets::lambda(&l.microfacets, Dir::new(wi.x, wi.y, -wi.z))?;
    let g1_o = 1.0 / (1.0 + lambda_o);
    // The normal of refraction, on wo's side.
    let h = [wo.x + eta * wi.x, wo.y + eta * wi.y, wo.z + eta * wi.z];
    let length = (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]).sqrt();
    let sign = if h[2] < 0.0 { -1.0 } else { 1.0 };
    let m = h.map(|x| x * sign / length);
    let (cos_om, cos_im) = (dot(wo, m), dot(wi, m));
    if cos_om <= 0.0 || cos_im >= 0.0 {
        return Some(BLACK);
    }
    // Fresnel's amplitudes of the transmitted wave, with both angles from the geometry.
    let cos_t = -cos_im;
    let across = 2.0 * cos_om / (cos_om + eta * cos_t);
    let along = 2.0 * cos_om / (eta * cos_om + cos_t);
    let transmitted = eta * cos_t / cos_om * 0.5 * (across * across + along * along);
    let d = facets::d(&l.microfacets, m)?;
    let g = g1_o / (1.0 + lambda_i);
    let jacobian = eta * eta * cos_im.abs() / (cos_om + eta * cos_im).powi(2);
    let f = transmitted * d * g * cos_om * jacobian / (wo.z * wi.z.abs());
    let pdf = transmitted * g1_o * d * cos_om / wo.z * jacobian;
    Some(BsdfValue { f_cos: [f * wi.z.abs(); 3], pdf })
}

/// F at a cosine, and the probability with which a facet reflects.
type Part<'a> = &'a dyn Fn(f64) -> Option<([f64; 3], f64)>;

/// Cook–Torrance: f = F D G₂ / (4 cosθ_o cosθ_i), all visible normals as density.
fn reflection(microfacets: &Microfacets<f64>, masking: Masking, wo: Dir, wi: Dir, part: Part) -> Option<BsdfValue> {
    let sum = [wo.x + wi.x, wo.y + wi.y, wo.z + wi.z];
    let length = (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]).sqrt();
    let m = sum.map(|x| x / length);
    let cos_om = wo.x * m[0] + wo.y * m[1] + wo.z * m[2];
    let (lambda_o, lambda_i) = (facets::lambda(microfacets, wo)?, facets::lambda(microfacets, wi)?);
    let g1 = 1.0 / (1.0 + lambda_o);
    let g2 = match masking {
        Masking::HeightCorrelated => 1.0 / (1.0 + lambda_o + lambda_i),
        Masking::Separable => g1 / (1.0 + lambda_i),
        _ => return None,
    };
    // D_visible(m) = G₁ D (wo·m)/cosθ_o, and dω_m/dω_i = 1/(4 wo·m).
    let (fresnel, reflects) = part(cos_om)?;
    let d = facets::d(microfacets, m)?;
    let pdf = reflects * g1 * d * cos_om / wo.z / (4.0 * cos_om);
    Some(BsdfValue { f_cos: fresnel.map(|f| f * d * g2 / (4.0 * wo.z * wi.z) * wi.z), pdf })
}
