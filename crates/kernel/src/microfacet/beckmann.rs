//! The Beckmann distribution of microfacet normals, a surface of Gaussian slopes, with Smith's masking.
//!
//! Beckmann & Spizzichino 1963; Cook & Torrance 1982; Walter et al. 2007, "Microfacet Models for Refraction through Rough
//! Surfaces"; anisotropic and height-correlated as in Heitz 2014, "Understanding the Masking-Shadowing Function in
//! Microfacet-Based BRDFs". With α_x along the tangent and α_y along the bitangent, both in [1e-8, 1]:
//!
//! - D(m) = exp(−(m_x²/α_x² + m_y²/α_y²)/m_z²) / (π α_x α_y m_z⁴)
//! - Λ(w) = (erf a − 1)/2 + exp(−a²)/(2a√π), a = |w_z|/t, t = √(α_x²w_x² + α_y²w_y²)
//!
//! Λ is exact, not Walter's rational fit, and comes as s(w) = |w_z|(1 + 2Λ) = |w_z| erf a + t exp(−a²)/√π, which needs no
//! division by w_z.
//!
//! **Visible normals.** For α = 1 and a view in the xz-plane with cotangent a, the slope y is Gaussian and the slope x has
//! the density (a − x)₊ exp(−x²) (Heitz & d'Eon 2014, "Importance Sampling Microfacet-Based BSDFs using the Distribution
//! of Visible Normals"), so x is G⁻¹(G(a)Φ(z)) with G its integral and z Gaussian as well. z and y come from the unit square
//! by polar coordinates (Box & Muller 1958), x from a closed guess within 0.07 and Halley's method. Unlike in Jakob 2014,
//! "An Improved Visible Normal Sampling Routine for the Beckmann Distribution", the number of steps is fixed, two in `f32`
//! and twelve in `f64`, and neither an inverse error function nor its logarithms are needed. What remains is an error of
//! G(x)/G(a) of the size of its rounding. One to one from the unit square, at every angle.
//!
//! **Cost.** `d`: one division, one exponential. `smith_length`: one division, one root, one exponential. `sample_visible`
//! in `f32`: five divisions, five roots, five exponentials, one logarithm, one sine and cosine.

use super::{lengthened, widths_in_domain};
use crate::math::{erf_and_exp, exp, flushed_square, ln, scaled_erfc, sin_cos_turns};
use crate::real::{Precision, Real};
use crate::vec3::Vec3;
use core::f64::consts::{FRAC_1_PI, FRAC_2_SQRT_PI};

/// A Beckmann surface of widths alpha_x and alpha_y, each in [1e-8, 1]; √2 times the standard deviations of its slopes.
#[derive(Clone, Copy, Debug)]
pub struct Beckmann<R> {
    /// Width along the tangent, α_u.
    pub alpha_x: R,
    /// Width along the bitangent, α_v.
    pub alpha_y: R,
}

impl<R: Real> Beckmann<R> {
    /// D of the half vector h = wo + wi with h.z ≥ 0, not normalised, with |h|² given \[1/sr\].
    #[inline]
    pub fn d(&self, h: Vec3<R>, h_length2: R) -> R {
        let (h, h_length2) = lengthened(h, h_length2);
        // Where h lies that close to the horizon, D is 0 by 1e20 in the exponent; and all quotients stay finite.
        let z = h.z.max(R::lit(1e-16));
        let a = self.alpha_x * self.alpha_y;
        let inverse = (a * z).recip();
        let x = h.x * self.alpha_y * inverse;
        let y = h.y * self.alpha_x * inverse;
        let secant2 = h_length2 * (a * inverse).sqr();
        // The root first, because secant⁴ may overflow where the exponential is 0.
        let root = exp(R::lit(-0.5) * x.mul_add(x, y * y)) * secant2;
        flushed_square(root, inverse * z * R::lit(FRAC_1_PI))
    }

    /// s(w) = |w_z|(1 + 2Λ(w)): |w_z| seen from above, t/√π in the horizon.
    #[inline]
    pub fn smith_length(&self, w: Vec3<R>) -> R {
        let x = self.alpha_x * w.x;
        let y = self.alpha_y * w.y;
        let t = x.mul_add(x, y * y).sqrt();
        let z = w.z.abs();
        let (erf, e) = erf_and_exp(z / t);
        z.mul_add(erf, t * e * R::lit(0.5 * FRAC_2_SQRT_PI))
    }

    /// A microfacet normal, unit, distributed as those visible from wo (above the surface).
    #[inline]
    pub fn sample_visible(&self, wo: Vec3<R>, u: [R; 2]) -> Vec3<R> {
        let (x, y) = (self.alpha_x * wo.x, self.alpha_y * wo.y);
        let length = x.mul_add(x, y * y).sqrt();
        // Along the normal there is no azimuth, and none is needed.
        let tilted = length.gt(R::lit(1e-18));
        let l = R::select(tilted, length, R::ONE);
        let inverse = (l * (l + wo.z)).recip();
        let (over_l, over_sum) = ((l + wo.z) * inverse, l * inverse);
        let view = View {
            cos: wo.z * over_sum,
            sin: (l * over_sum).or_zero(tilted),
            cot: R::select(tilted, wo.z * over_l, R::lit(1e18)),
        };
        let (cos_phi, sin_phi) = (R::select(tilted, x * over_l, R::ONE), (y * over_l).or_zero(tilted));

        let radius = (-ln(R::ONE - u[0])).max(R::ZERO).sqrt();
        let (sin, cos) = sin_cos_turns(u[1]);
        let (along, across) = (view.slope(radius * cos), radius * sin);
        let slope_x = along * cos_phi - across * sin_phi;
        let slope_y = along * sin_phi + across * cos_phi;
        Vec3::new(-self.alpha_x * slope_x, -self.alpha_y * slope_y, R::ONE).normalize()
    }

    /// Whether both widths lie in [1e-8, 1].
    #[inline(always)]
    pub fn domain(&self) -> R::Mask {
        widths_in_domain(self.alpha_x, self.alpha_y)
    }
}

/// A view of the surface of α = 1: cosine and sine of its angle to the normal up to a common factor, cot = cos/sin.
/// The factor makes cos + sin = 1 where it matters.
#[derive(Clone, Copy)]
struct View<R> {
    cos: R,
    sin: R,
    cot: R,
}

impl<R: Real> View<R> {
    /// The visible slope x ≤ cot whose share G(x)/G(cot) is that of Gaussian slopes below z.
    #[inline(always)]
    fn slope(&self, z: R) -> R {
        let (end, steps, least) = match R::PRECISION {
            Precision::Single => (4.5, 2, 1e-6),
            Precision::Double => (6.5, 12, 1e-12),
        };
        // Beyond ±end nothing is left of the Gaussian.
        let cot = self.cot.min(R::lit(end));
        let tail = scaled_erfc(z.abs()) * exp(-(z * z)) * R::lit(0.5 * FRAC_2_SQRT_PI);
        let share = R::select(z.gt(R::ZERO), R::ONE - tail, tail);
        let target = share * self.gathered(cot, exp(-(cot * cot)));
        // Towards cot, G levels off like a parabola. Halley's method comes nearer to its vertex by thirds, but hardly leaves it.
        let mut x = self.guess(z).min(cot - R::lit(0.004));
        for _ in 0..steps {
            x = x.max(R::lit(-end)).min(cot);
            let e = exp(-(x * x));
            let excess = self.gathered(x, e) - target;
            // G′ = k exp(−x²), G″/G′ = −sin/k − 2x; both sides times k² exp(−x²), so that one division does.
            let k = (self.cos - self.sin * x).max(R::lit(least));
            let curved = (R::lit(2.0) * x).mul_add(k, self.sin);
            let slope = k * k * e;
            // Not below a quarter but by the rounding of G near its end.
            let step = excess * k / (R::lit(0.5) * excess).mul_add(curved, slope).max(R::lit(0.25) * slope);
            x = x - step.clamp(-0.5, 0.5);
        }
        x.min(cot)
    }

    /// G(x) = ∫ (cos − sin t) exp(−t²) dt up to x, with exp(−x²) given. No cancellation below 0.
    #[inline(always)]
    fn gathered(&self, x: R, e: R) -> R {
        let part = self.cos * scaled_erfc(x.abs()) * e;
        let all = self.cos * R::lit(2.0 / FRAC_2_SQRT_PI);
        (R::lit(0.5) * self.sin).mul_add(e, R::select(x.gt(R::ZERO), all - part, part))
    }

    /// About the slope for z in [−4.2, 4.2], within 0.07: a smooth minimum of z and cot, a hyperbola, corrected by a
    /// polynomial. Exact for sin = 0. Fitted to solutions in 40 digits.
    #[inline(always)]
    fn guess(&self, z: R) -> R {
        let z = z.max(R::lit(-4.2)).min(R::lit(4.2));
        let b = self.sin;
        let quadratic = |c: [f64; 3]| R::lit(c[0]).mul_add(b, R::lit(c[1])).mul_add(b, R::lit(c[2]));
        let end = self.cot.min(R::lit(6.5)) + quadratic([0.922_244_5, 0.990_045_0, 0.164_414_6]);
        let gap = b * quadratic([1.080_047_4, -1.814_517_7, 0.825_733_2]).mul_add(b, R::lit(0.028_411_4));
        let apart = z - end;
        let x = R::lit(0.5) * (z + end - apart.mul_add(apart, R::lit(4.0) * gap).sqrt());
        let correction = quadratic([-0.015_225_5, 0.002_715_6, 0.001_020_6])
            .mul_add(x, quadratic([0.010_063_9, -0.108_066_3, -0.010_709_7]))
            .mul_add(x, quadratic([0.703_138_0, -1.088_224_3, 0.030_292_9]))
            .mul_add(x, quadratic([1.363_112_8, -1.841_754_5, -0.285_047_0]));
        b.mul_add(correction, x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::erf;
    use crate::testing::{Random, close};
    use core::f64::consts::{FRAC_PI_2, PI, TAU};
    use std::vec::Vec;

    /// ∫ f(m) over the upper hemisphere, by midpoints.
    fn over_hemisphere(f: impl Fn(Vec3<f64>) -> f64) -> f64 {
        let (rows, columns) = (1000, 400);
        let mut sum = 0.0;
        for row in 0..rows {
            let (sin, cos) = ((f64::from(row) + 0.5) / f64::from(rows) * FRAC_PI_2).sin_cos();
            for column in 0..columns {
                let (sin_phi, cos_phi) = ((f64::from(column) + 0.5) / f64::from(columns) * TAU).sin_cos();
                sum += f(Vec3::new(sin * cos_phi, sin * sin_phi, cos)) * sin;
            }
        }
        sum * FRAC_PI_2 / f64::from(rows) * TAU / f64::from(columns)
    }

    const WIDTHS: [(f64, f64); 3] = [(1.0, 1.0), (0.5, 0.2), (0.3, 0.9)];

    fn view(cos: f64, phi: f64) -> Vec3<f64> {
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
        Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
    }

    #[test]
    fn along_the_normal_d_is_one_over_pi_alpha_x_alpha_y() {
        for (alpha_x, alpha_y) in [(1.0_f64, 1.0), (0.5, 0.1), (1e-8, 1e-8)] {
            let d = Beckmann { alpha_x, alpha_y }.d(Vec3::unit_z() * 1.7, 1.7 * 1.7);
            assert!(close(d * PI * alpha_x * alpha_y, 1.0, 1e-14));
        }
    }

    #[test]
    fn the_facets_together_project_onto_the_whole_surface() {
        for (alpha_x, alpha_y) in WIDTHS {
            let beckmann = Beckmann { alpha_x, alpha_y };
            let integral = over_hemisphere(|m| beckmann.d(m, 1.0) * m.z);
            assert!(close(integral, 1.0, 1e-5), "{alpha_x}, {alpha_y}: {integral}");
        }
    }

    #[test]
    fn the_visible_facets_together_fill_the_view() {
        // ∫ D max(0, wo·m) dω = cos_o/G₁ = (cos_o + s)/2.
        for (alpha_x, alpha_y) in WIDTHS {
            let beckmann = Beckmann { alpha_x, alpha_y };
            for (cos, phi) in [(1.0, 0.0), (0.7, 0.4), (0.2, 2.0), (0.01, 4.0), (1e-30, 5.0)] {
                let wo = view(cos, phi);
                let integral = over_hemisphere(|m| beckmann.d(m, 1.0) * m.dot(wo).max(0.0));
                let whole = 0.5 * (wo.z + beckmann.smith_length(wo));
                assert!(close(integral, whole, 2e-5 * whole), "{alpha_x}, {alpha_y}, {cos}: {integral} and {whole}");
            }
        }
    }

    /// G(x)/G(a) in `f64`, from erf, for a view of cotangent a.
    fn share(a: f64, x: f64) -> f64 {
        let (c, s) = (a / (1.0 + a), 1.0 / (1.0 + a));
        let g = |x: f64| c * 0.5 * PI.sqrt() * (1.0 + erf(x)) + 0.5 * s * (-x * x).exp();
        g(x) / g(a)
    }

    #[test]
    fn the_slope_has_the_share_that_was_asked_for() {
        let (mut single, mut double) = (0.0_f64, 0.0_f64);
        for i in 0..=200 {
            let a = if i == 0 { 1e-38 } else { (f64::from(i) * 0.05).sinh() * 0.1 };
            for j in -400..=400 {
                let z = f64::from(j) * 0.01;
                let view = |cot: f64| View { cos: cot / (1.0 + cot), sin: 1.0 / (1.0 + cot), cot };
                let x = view(a).slope(z);
                double = double.max((share(a, x) - 0.5 * (1.0 + erf(z))).abs());
                let (a, z) = (a as f32, z as f32);
                let x = View { cos: a / (1.0 + a), sin: 1.0 / (1.0 + a), cot: a }.slope(z);
                assert!(x.is_finite() && x <= a);
                single = single.max((share(a.into(), x.into()) - 0.5 * (1.0 + erf(f64::from(z)))).abs());
            }
        }
        // Four roundings of G in f32, a few more in f64.
        assert!(single <= 4.0 * f64::from(f32::EPSILON) && double <= 8.0 * f64::EPSILON, "{single:e} {double:e}");
    }

    #[test]
    fn the_slope_grows_with_its_share_and_the_tails_are_right() {
        for a in [1e-38, 0.01, 0.3, 1.0, 3.0, 5.0, 100.0] {
            let view = View { cos: a / (1.0 + a), sin: 1.0 / (1.0 + a), cot: a };
            let mut last = -f64::INFINITY;
            for j in -600..=300 {
                let x = view.slope(f64::from(j) * 0.01);
                assert!(x > last, "{a}, {j}: {x} after {last}");
                last = x;
            }
        }
        // At a = 0, x = −√(−ln Φ(z)); Φ(−6) = erfc(6)/2 = 1.0759868e-17.
        let grazing = View { cos: 0.0, sin: 1.0, cot: 0.0 };
        assert!(close(grazing.slope(-6.0_f64), -(1.075_986_8e-17_f64.ln().abs().sqrt()), 1e-7));
    }

    #[test]
    fn the_density_of_a_visible_normal_is_the_inverse_of_the_stretching() {
        // D_visible = D wo·m/((cos_o + s)/2) times |∂m/∂u₀ × ∂m/∂u₁| is 1, by five-point differences.
        let mut random = Random(31);
        let mut worst = 0.0_f64;
        for i in 0..4000 {
            let mut unit = || f64::from(random.unit());
            let alpha = [(1.0, 1.0), (0.3, 0.7), (1e-8, 1e-8), (0.01, 0.9)][i % 4];
            let beckmann = Beckmann { alpha_x: alpha.0, alpha_y: alpha.1 };
            let cos = if i % 3 == 0 { 1e-6_f64.powf(unit()) } else { unit() };
            let wo = view(cos, TAU * unit());
            let u = [0.02 + 0.96 * unit(), 0.02 + 0.96 * unit()];
            let along = |axis: usize| {
                let at = |steps: f64| {
                    let mut moved = u;
                    moved[axis] += 1e-4 * steps;
                    beckmann.sample_visible(wo, moved)
                };
                ((at(1.0) - at(-1.0)) * (8.0 / 12.0) - (at(2.0) - at(-2.0)) * (1.0 / 12.0)) * 1e4
            };
            let m = beckmann.sample_visible(wo, u);
            let d = beckmann.d(m, 1.0) * wo.dot(m) * 2.0 / (wo.z + beckmann.smith_length(wo));
            let error = (d * along(0).cross(along(1)).length() - 1.0).abs();
            worst = worst.max(error);
            assert!(error < 1e-5, "{error:e}: {beckmann:?}, {wo:?}, {u:?}");
        }
    }

    #[test]
    fn the_slopes_of_visible_normals_follow_their_law() {
        // Kolmogorov–Smirnov against G(x)/G(a), x along the view, and against a Gaussian across it: eight tests at 1e-4
        // each, which √n·D exceeds 2.2253 with that probability.
        let mut random = Random(32);
        let count = 100_000;
        for cos in [1.0, 0.6, 0.05, 1e-38] {
            let beckmann = Beckmann { alpha_x: 0.5_f32, alpha_y: 0.5 };
            let wo = Vec3::new((1.0 - cos * cos).sqrt() as f32, 0.0, cos as f32);
            let a = if cos < 1.0 { f64::from(wo.z) / (0.5 * f64::from(wo.x)) } else { 1e9 };
            let law = |x: f64| if cos < 1.0 { share(a, x) } else { 0.5 * (1.0 + erf(x)) };
            let (mut along, mut across) = (Vec::new(), Vec::new());
            for _ in 0..count {
                let m = beckmann.sample_visible(wo, [random.unit(), random.unit()]);
                along.push(law(f64::from(-m.x / m.z) / 0.5));
                across.push(0.5 * (1.0 + erf(f64::from(-m.y / m.z) / 0.5)));
            }
            for mut values in [along, across] {
                values.sort_by(f64::total_cmp);
                let n = f64::from(count);
                let distance = values.iter().enumerate().fold(0.0, |most: f64, (i, &v)| {
                    most.max((v - i as f64 / n).abs()).max((v - (i + 1) as f64 / n).abs())
                });
                assert!(distance * n.sqrt() < 2.2253, "cos {cos}: {}", distance * n.sqrt());
            }
        }
    }

    #[test]
    fn a_visible_normal_faces_the_viewer_in_every_corner() {
        let mut random = Random(33);
        let last = 1.0 - f32::EPSILON / 2.0;
        for alpha_x in [1e-8_f32, 1e-4, 0.1, 1.0] {
            for alpha_y in [1e-8_f32, 0.3, 1.0] {
                let beckmann = Beckmann { alpha_x, alpha_y };
                for i in 0..2000 {
                    let mut wo = random.above();
                    if i % 2 == 0 {
                        let cos = [1.0, 1e-3, 1e-7, 1e-18, 1e-30, 1e-38, 1.0 - 1e-7][i / 2 % 7];
                        let (s, c) = sin_cos_turns(random.unit());
                        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
                        wo = Vec3::new(sin * c, sin * s, cos);
                    }
                    let mut number = || match random.bits() % 8 {
                        0 => 0.0,
                        1 => last,
                        2 => 0.5,
                        _ => random.unit(),
                    };
                    let m = beckmann.sample_visible(wo, [number(), number()]);
                    assert!(close(m.length().into(), 1.0, 1e-6) && m.z > 0.0, "{wo:?} {m:?}");
                    assert!(m.dot(wo) >= -1e-6, "{wo:?} {m:?}");
                    let (d, s) = (beckmann.d(m, 1.0), beckmann.smith_length(wo));
                    assert!(
                        d.is_finite() && d >= 0.0 && s.is_finite() && s >= wo.z * (1.0 - 1e-6) && s > 0.0,
                        "{d} {s}"
                    );
                }
                for x in [1e-38_f32, 1e-20, 1e-8, 1e-3, 1.0] {
                    for z in [1e-45_f32, 1e-38, 1e-30, 1e-16, 1e-6, 1.0] {
                        let h = Vec3::new(x, -0.5 * x, z);
                        let d = beckmann.d(h, h.length2());
                        assert!(d.is_finite() && d >= 0.0 && !d.is_subnormal(), "{h:?}: {d}");
                    }
                }
            }
        }
    }

    #[test]
    fn single_precision_is_as_good_as_its_input() {
        let mut random = Random(34);
        for _ in 0..100_000 {
            let alpha = 1e-8_f32.powf(random.unit());
            let single = Beckmann { alpha_x: alpha, alpha_y: 0.5 * alpha + 0.5e-8 };
            let double = Beckmann { alpha_x: f64::from(single.alpha_x), alpha_y: f64::from(single.alpha_y) };
            let m = single.sample_visible(random.above(), [random.unit(), random.unit()]);
            let wide = Vec3::new(f64::from(m.x), f64::from(m.y), f64::from(m.z));
            let (d, exact) = (f64::from(single.d(m, m.length2())), double.d(wide, wide.length2()));
            // D falls like exp(−e): an ulp of alpha changes it by 2e of themselves.
            let e = (wide.x / double.alpha_x).powi(2) + (wide.y / double.alpha_y).powi(2);
            let unit = f64::from(f32::EPSILON) * exact * (1.0 + 2.0 * e / wide.z / wide.z);
            assert!((d - exact).abs() <= 8.0 * unit, "{m:?}, {alpha}: {d:e} instead of {exact:e}");
            let (s, exact) = (f64::from(single.smith_length(m)), double.smith_length(wide));
            assert!((s - exact).abs() <= 8.0 * f64::from(f32::EPSILON) * exact, "{m:?}, {alpha}: {s} and {exact}");
        }
    }
}
