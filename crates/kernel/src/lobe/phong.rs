//! The modified Phong model: a diffuse part and a glossy part about the mirror direction.
//!
//! $$f = \frac{k_d}{\pi} + k_s \frac{n}{2\pi} \max(0, \omega_o\cdot\omega_r)^\alpha$$
//!
//! with ω_r the mirrored wi. Phong 1975, "Illumination for Computer Generated Pictures"; without his division by the cosine
//! Lewis 1993, "Making Shaders More Physically Plausible", and Lafortune & Willems 1994, "Using the Modified Phong
//! Reflectance Model for Physically Based Rendering". [`PhongNormalization`] says what n is. Below the clamp the glossy part is 0,
//! for α = 0 too. k_d, k_s in [0, 1] with k_d + k_s ≤ 1 per channel; α in [0, 1e7].
//!
//! Reciprocal; conserves energy. The albedo along the normal is k_d + k_s (α + 1)/(α + 2) with n = α + 1, k_d + k_s with
//! n = α + 2; towards grazing the glossy part darkens, half of it below the horizon. One part is chosen by the luminances
//! of k_d and k_s with probabilities p_d, p_s. The largest weight is the larger of k_d/p_d and k_s n/(p_s (α + 1)).
//!
//! The cosine is 1 − q with q = |ω_o − ω_r|²/2, and its power exp(α ln(1 − q)), so nothing cancels at α = 1e7; the sampler
//! has 1 − cos from `exp_m1`. Cost of `eval`: two divisions, one logarithm, one exponential.

use super::{Event, Lobe, Properties, Sample, Transport, Value, share};
use crate::frame::{both_above, tangents};
use crate::math::{exp, exp_m1, flushed_square, ln, ln_1p, sin_cos_turns};
use crate::model::{EXPONENT, Parameters, REFLECTANCE};
use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::vec3::Vec3;
use crate::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere};
use core::f64::consts::FRAC_1_PI;

crate::choice! {
    /// What the glossy part is multiplied by, besides k_s/2π.
    pub enum PhongNormalization {
        /// n = α + 1: the part without cosine integrates to k_s about the mirror direction.
        Modified = "modified" | "lecture",
        /// n = α + 2, the most that conserves energy (Lafortune & Willems 1994).
        LafortuneWillems = "lafortune-willems" | "lafortune",
    }
}

crate::model! {
    /// The modified Phong model: a diffuse part and a glossy part about the mirror direction. Reflects on the side of the normal only.
    pub struct Phong<R> = "phong" {
        /// k_d. Both parts together reflect at most all light.
        diffuse: Rgb<R> = 0.5 in REFLECTANCE.white(0.0),
        /// k_s
        glossy: Rgb<R> = 0.5 in REFLECTANCE,
        /// α: 10 is dull plastic, 1000 polished wood.
        exponent: R = 30.0 in EXPONENT,
        /// n: what the glossy part integrates to.
        normalization: PhongNormalization = LafortuneWillems,
    }
    // Both may have been rounded up to f32, by 2⁻²⁵ each, and their sum again by 2⁻²⁴: half of what is allowed.
    rule |it| (it.diffuse + it.glossy).within(0.0, 1.0 + 2.0 * f64::from(f32::EPSILON))
        => "\"diffuse\" and \"glossy\" together reflect more than all light";
}

impl<R: Real> Phong<R> {
    /// The probability of the glossy part: exactly 0 or 1 where a part is absent.
    #[inline(always)]
    fn probability_glossy(&self) -> R {
        share(self.glossy, self.diffuse)
    }

    /// n/(α + 1).
    #[inline(always)]
    fn excess(&self) -> R {
        match self.normalization {
            PhongNormalization::Modified => R::ONE,
            PhongNormalization::LafortuneWillems => (self.exponent + R::lit(2.0)) / (self.exponent + R::ONE),
        }
    }
}

impl<R: Real> Lobe<R> for Phong<R> {
    type Prepared = ();

    #[inline(always)]
    fn prepare(&self, _wo: Vec3<R>, _transport: Transport) {}

    #[inline]
    fn eval(&self, wo: Vec3<R>, _prepared: &(), wi: Vec3<R>) -> Value<R> {
        let apart = Vec3::new(wo.x + wi.x, wo.y + wi.y, wo.z - wi.z);
        let q = apart.length2() * R::lit(0.5);
        let root = exp(self.exponent * ln_1p(-q) * R::lit(0.5)).or_zero(q.lt(R::ONE));
        let density = flushed_square(root, (self.exponent + R::ONE) * R::lit(0.5 * FRAC_1_PI));
        let excess = self.excess();
        let cosine = pdf_cosine_hemisphere(wi);
        let glossy = density * excess * wi.z;
        let p = self.probability_glossy();
        let f_cos = self.diffuse * cosine + self.glossy * glossy;
        Value { f_cos, pdf: (R::ONE - p).mul_add(cosine, p * density) }.or_zero(both_above(wo, wi))
    }

    #[inline]
    fn sample(&self, wo: Vec3<R>, _prepared: &(), u: [R; 3]) -> Sample<R> {
        let diffuse = u[0].lt(R::ONE - self.probability_glossy());
        // cos = (1 − u)^(1/(α + 1)), and 1 − cos without cancellation.
        let fall = -exp_m1(ln(R::ONE - u[1]) / (self.exponent + R::ONE));
        // The rim of exponent 0 stays above the clamp when the cosine is formed again.
        let fall = fall.min(R::ONE - R::lit(8.0) * R::EPSILON);
        let sin = (fall * (R::lit(2.0) - fall)).max(R::ZERO).sqrt();
        let (sin_phi, cos_phi) = sin_cos_turns(u[2]);
        let mirrored = Vec3::new(-wo.x, -wo.y, wo.z);
        let (x, y) = tangents(mirrored);
        let glossy = (mirrored - mirrored * fall).along(sin * cos_phi, x).along(sin * sin_phi, y);
        let glossy = glossy.normalize_or(Vec3::unit_z());
        let wi = Vec3::select(diffuse, sample_cosine_hemisphere([u[1], u[2]]), glossy);
        Sample { wi, event: Event::reflected(!both_above(wo, wi)) }
    }

    #[inline(always)]
    fn delta(&self, _wo: Vec3<R>, _prepared: &Self::Prepared, _sample: &Sample<R>) -> Value<R> {
        Value::zero()
    }

    #[inline(always)]
    fn albedo_estimate(&self, _wo: Vec3<R>) -> Rgb<R> {
        self.diffuse + self.glossy
    }

    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.in_domain()
    }

    #[inline(always)]
    fn properties(&self) -> Properties<R> {
        let is_black = |k: Rgb<R>| k.largest().same(R::ZERO).all();
        let one_to_one = is_black(self.diffuse) || is_black(self.glossy);
        Properties { one_to_one, symmetric: true, ..Properties::LAWFUL }
    }

    #[inline(always)]
    fn largest_weight(&self, _wo: Vec3<R>) -> R {
        let p = self.probability_glossy();
        let part = |k: Rgb<R>, p: R| (k.largest() / p).or_zero(p.gt(R::ZERO));
        part(self.diffuse, R::ONE - p).max(part(self.glossy, p) * self.excess())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Bare, Random, close};

    fn glossy<R: Real>(exponent: f64, norm: PhongNormalization) -> Phong<R> {
        Phong { diffuse: Rgb::zero(), glossy: Rgb::splat(R::ONE), exponent: R::lit(exponent), normalization: norm }
    }

    #[test]
    fn along_the_normal_the_glossy_albedo_is_alpha_plus_1_over_alpha_plus_2() {
        // ∫ f cosθ over t = cos^(α+2), which makes the integrand constant: midpoints are exact but for their rounding.
        for exponent in [0.0, 1.0, 10.0, 100.0, 1e4, 1e7] {
            for (norm, albedo) in [
                (PhongNormalization::Modified, (exponent + 1.0) / (exponent + 2.0)),
                (PhongNormalization::LafortuneWillems, 1.0),
            ] {
                let (phong, up, steps) = (glossy::<f64>(exponent, norm), Vec3::unit_z(), 1000);
                let mut sum = 0.0;
                for step in 0..steps {
                    let t = (f64::from(step) + 0.5) / f64::from(steps);
                    let fall = -(t.ln() / (exponent + 2.0)).exp_m1();
                    let wi = Vec3::new((fall * (2.0 - fall)).sqrt(), 0.0, 1.0 - fall);
                    // dω = 2π dcos, dcos = cos dt/((α + 2) t).
                    sum += phong.value(up, wi).f_cos.g * core::f64::consts::TAU * wi.z / ((exponent + 2.0) * t);
                }
                assert!(close(sum / f64::from(steps), albedo, 1e-6), "{exponent}, {norm:?}: {sum}");
            }
        }
    }

    #[test]
    fn opposite_to_the_mirror_direction_even_exponent_0_is_black() {
        let (wo, back) = (Vec3::new(0.8_f32, 0.0, 0.6), Vec3::new(0.96, 0.0, 0.28));
        assert_eq!(glossy::<f32>(0.0, PhongNormalization::Modified).value(wo, back).f_cos.r, 0.0);
        assert!(glossy::<f32>(0.0, PhongNormalization::Modified).value(wo, Vec3::unit_z()).f_cos.r > 0.0);
    }

    #[test]
    fn an_absent_part_is_never_sampled() {
        let mut random = Random(41);
        let matte = Phong {
            diffuse: Rgb::splat(0.5_f32),
            glossy: Rgb::zero(),
            exponent: 1e7,
            normalization: PhongNormalization::Modified,
        };
        let shiny = Phong { diffuse: Rgb::zero(), glossy: Rgb::splat(0.5_f32), ..matte };
        for _ in 0..1000 {
            let wo = Vec3::new(0.6, 0.0, 0.8);
            let u = [random.unit(), random.unit(), random.unit()];
            assert_eq!(matte.draw(wo, u).wi, sample_cosine_hemisphere([u[1], u[2]]));
            assert!((shiny.draw(wo, u).wi - Vec3::new(-0.6, 0.0, 0.8)).length() < 3e-3);
        }
    }

    #[test]
    fn at_an_exponent_of_ten_million_single_precision_still_knows_its_angle() {
        let mut random = Random(42);
        let (single, double) =
            (glossy::<f32>(1e7, PhongNormalization::Modified), glossy::<f64>(1e7, PhongNormalization::Modified));
        let wide = |w: Vec3<f32>| Vec3::new(f64::from(w.x), f64::from(w.y), f64::from(w.z));
        for _ in 0..10_000 {
            let wo = random.above();
            let wi = single.draw(wo, [0.5, random.unit(), random.unit()]).wi;
            let (f, exact) = (f64::from(single.value(wo, wi).pdf), double.value(wide(wo), wide(wi)).pdf);
            assert!((f - exact).abs() <= 2e-5 * exact, "{wo:?} {wi:?}: {f} instead of {exact}");
        }
    }

    #[test]
    fn light_takes_the_same_way_back() {
        let mut random = Random(43);
        let phong = Phong {
            diffuse: Rgb::splat(0.3),
            glossy: Rgb::splat(0.7),
            ..glossy(30.0, PhongNormalization::LafortuneWillems)
        };
        for _ in 0..1000 {
            let (a, b) = (random.above(), random.above());
            let (there, back) = (phong.value(a, b).f_cos.g * a.z, phong.value(b, a).f_cos.g * b.z);
            assert!((there - back).abs() <= 1e-6 * there, "{a:?} {b:?}: {there} and {back}");
        }
    }

    #[test]
    fn two_parts_may_not_return_more_than_they_get() {
        let phong = |d: f32, s: f32| Phong {
            diffuse: Rgb::splat(d),
            glossy: Rgb::splat(s),
            ..glossy(5.0, PhongNormalization::Modified)
        };
        assert!(phong(0.3, 0.7).domain() && phong(1.0, 0.0).domain() && phong(0.1, 0.9).domain());
        assert!(!phong(0.301, 0.7).domain() && !phong(-0.1, 0.5).domain() && !phong(f32::NAN, 0.0).domain());
        assert!(
            !Phong { exponent: 1.1e7, ..phong(0.5, 0.5) }.domain()
                && !Phong { exponent: -1.0, ..phong(0.5, 0.5) }.domain()
        );
    }
}
