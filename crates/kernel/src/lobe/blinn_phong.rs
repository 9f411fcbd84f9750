//! Blinn–Phong, normalised: a diffuse part and a glossy part, a power of the cosine between normal and half vector. What games and
//! MTL files mean by a specular exponent.
//!
//! Blinn 1977, "Models of light reflection for computer synthesized pictures", on Phong's. With $h$ the half vector and
//! $c_h = n\cdot h$:
//!
//! $$f = \frac{k_d}{\pi} + k_s\\,N\\,c_h^{\\,n}, \quad N = \frac{(n + 2)(n + 4)}{8\pi\\,(2^{-n/2} + n)}.$$
//!
//! N makes $k_s$ the glossy albedo along the normal, exactly and for every n: $\int c_h^n \cos\theta_i\\,d\omega_i = 1/N$ there (Giesen
//! 2009, "Derivation of Phong and Blinn-Phong BRDF normalization factors"). The popular $(n + 8)/8\pi$ is up to 7.5 % larger, at
//! n = 8, and gains energy.
//!
//! | parameter | range | meaning | a feeling for values |
//! |---|---|---|---|
//! | `diffuse` | \[0, 1\] | $k_d$, albedo of the diffuse part | |
//! | `glossy` | \[0, 1\], $k_d + k_s \le 1$ | $k_s$, albedo of the glossy part at normal incidence | 0.04 is plastic |
//! | `exponent` | \[0, 1e7\] | n | 40 is dull plastic, 4000 polished wood: four times Phong's |
//!
//! **Laws.** Reciprocal. Conserves energy: by quadrature, no angle has a larger glossy albedo than the normal, at any exponent.
//! Narrow highlights darken as $\cos^2\theta_o$ down to exactly $k_s/(2^{-n/2} + n)$ at grazing; n = 0 is Lambert's law.
//!
//! **Sampler.** One part is chosen by the luminances of $k_d$ and $k_s$ with probabilities $p_d$, $p_s$. The glossy one samples h
//! with the density $p(h) = (n + 1)\\,c_h^{\\,n}/2\pi$, and $\omega_i$ is $\omega_o$ mirrored in h: density $p(h)/(4k)$,
//! $k = \omega_o\cdot h$. Directions below the horizon fail. The largest weight is the larger of $k_d/p_d$ and
//! $k_s W/p_s$, since the glossy part weighs $k_s W \cos\theta_i\\,k$ with $W = 8\pi N/(n + 1)$: 8 for n = 0, 1.5 for n = 10, 1.05 for
//! n = 100.
//!
//! **Precision.** As in [`AshikhminShirley`](super::AshikhminShirley), whose half vectors these are: $c_h$ comes from
//! $\tan^2\theta_h$, so that nothing cancels at n = 1e7, and k counts as at least 1e-30.
//!
//! ```toml
//! type = "blinn-phong"
//! diffuse = [0.5, 0.1, 0.1]
//! glossy = 0.04
//! exponent = 200
//! ```
//!
//! Cost of `eval`: 2 divisions, 2 square roots, one logarithm, one exponential; the probabilities and W, which depend on the parameters
//! alone, are prepared.

use super::ashikhmin_shirley::{HalfVector, sample_half_vector};
use super::{Event, Lobe, Properties, Sample, Transport, Value, share};
use crate::frame::both_above;
use crate::math::exp_negative;
use crate::microfacet::reflect;
use crate::model::{EXPONENT, Parameters, REFLECTANCE};
use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::vec3::Vec3;
use crate::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere};
use core::f64::consts::{FRAC_1_PI, LN_2};

crate::model! {
    /// The normalised Blinn–Phong model: a diffuse part and a glossy part about the half vector. Reflects on the side of the normal
    /// only.
    pub struct BlinnPhong<R> = "blinn-phong" {
        /// k_d. Both parts together reflect at most all light.
        diffuse: Rgb<R> = 0.5 in REFLECTANCE.white(0.0),
        /// k_s, the glossy albedo at normal incidence.
        glossy: Rgb<R> = 0.5 in REFLECTANCE,
        /// n: 40 is dull plastic, 4000 polished wood.
        exponent: R = 100.0 in EXPONENT,
    }
    // As in Phong: roundings to f32, of both and of their sum, are half of what is allowed.
    rule |it| (it.diffuse + it.glossy).within(0.0, 1.0 + 2.0 * f64::from(f32::EPSILON))
        => "\"diffuse\" and \"glossy\" together reflect more than all light";
}

/// What depends on the parameters alone.
#[derive(Clone, Copy, Debug)]
pub struct Prepared<R> {
    p_diffuse: R,
    p_glossy: R,
    /// W.
    weight: R,
}

impl<R: Real> BlinnPhong<R> {
    /// The probabilities of the diffuse and of the glossy part: exactly 0 and 1 where one is absent, and each to its own precision,
    /// which 1 less the other would not have.
    #[inline(always)]
    fn probabilities(&self) -> [R; 2] {
        [share(self.diffuse, self.glossy), share(self.glossy, self.diffuse)]
    }

    /// W = 8πN/(n + 1): in [1, 8].
    #[inline(always)]
    fn weight(&self) -> R {
        let n = self.exponent;
        let lost = exp_negative(n * R::lit(-0.5 * LN_2));
        (n + R::lit(2.0)) * (n + R::lit(4.0)) / ((n + R::ONE) * (lost + n))
    }
}

impl<R: Real> Lobe<R> for BlinnPhong<R> {
    type Prepared = Prepared<R>;

    #[inline(always)]
    fn prepare(&self, _wo: Vec3<R>, _transport: Transport) -> Prepared<R> {
        let [p_diffuse, p_glossy] = self.probabilities();
        Prepared { p_diffuse, p_glossy, weight: self.weight() }
    }

    #[inline]
    fn eval(&self, wo: Vec3<R>, prepared: &Prepared<R>, wi: Vec3<R>) -> Value<R> {
        let Prepared { p_diffuse, p_glossy, weight } = *prepared;
        let half = HalfVector::of(wo, wi);
        let density = half.pdf_reflected(self.exponent, (self.exponent + R::ONE) * R::lit(0.5 * FRAC_1_PI));
        // N cosⁿ: the pole of the density cancels k exactly, for k's floor is in both.
        let glossy = density * half.cos_m * weight * wi.z;
        let cosine = pdf_cosine_hemisphere(wi);
        let f_cos = self.diffuse * cosine + self.glossy * glossy;
        Value { f_cos, pdf: p_diffuse.mul_add(cosine, p_glossy * density) }.or_zero(both_above(wo, wi))
    }

    #[inline]
    fn sample(&self, wo: Vec3<R>, prepared: &Prepared<R>, u: [R; 3]) -> Sample<R> {
        let glossy = reflect(wo, sample_half_vector(self.exponent, self.exponent, [u[1], u[2]]));
        let diffuse = sample_cosine_hemisphere([u[1], u[2]]);
        let wi = Vec3::select(u[0].lt(prepared.p_diffuse), diffuse, glossy);
        Sample { wi, event: Event::reflected(!both_above(wo, wi)) }
    }

    #[inline(always)]
    fn delta(&self, _wo: Vec3<R>, _prepared: &Prepared<R>, _sample: &Sample<R>) -> Value<R> {
        Value::zero()
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
        // Towards grazing as cos², from 1 down to 1/(2^(−n/2) + n), which for n = 0 is 1 too.
        let cos = wo.z.max(R::ZERO).min(R::ONE);
        let n = self.exponent;
        let left = (exp_negative(n * R::lit(-0.5 * LN_2)) + n).recip();
        self.diffuse + self.glossy * (cos * cos).mul_add(R::ONE - left, left)
    }

    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.in_domain()
    }

    #[inline(always)]
    fn properties(&self) -> Properties<R> {
        let is_black = |k: Rgb<R>| k.largest().same(R::ZERO).all();
        Properties { one_to_one: is_black(self.diffuse) || is_black(self.glossy), ..Properties::LAWFUL }
    }

    #[inline(always)]
    fn largest_weight(&self, _wo: Vec3<R>) -> R {
        let [p_diffuse, p_glossy] = self.probabilities();
        let part = |k: Rgb<R>, p: R| (k.largest() / p).or_zero(p.gt(R::ZERO));
        part(self.diffuse, p_diffuse).max(part(self.glossy, p_glossy) * self.weight())
    }
}

#[cfg(test)]
mod tests {
    use super::super::ashikhmin_shirley::tests::{assert_normalised, double, pair, units, view};
    use super::*;
    use crate::testing::{Bare, Random, close};
    use core::f64::consts::{PI, TAU};

    fn grey<R: Real>(diffuse: f64, glossy: f64, exponent: f64) -> BlinnPhong<R> {
        BlinnPhong {
            diffuse: Rgb::splat(R::lit(diffuse)),
            glossy: Rgb::splat(R::lit(glossy)),
            exponent: R::lit(exponent),
        }
    }

    fn any_exponent(random: &mut Random) -> f64 {
        match random.bits() % 8 {
            0 => 0.0,
            1 => 1e7,
            _ => 10.0_f64.powf(9.0 * f64::from(random.unit()) - 2.0),
        }
    }

    /// The glossy albedo for k_s = 1: midpoints over the random numbers of h.
    fn albedo(exponent: f64, wo: Vec3<f64>, steps: i32) -> f64 {
        let lobe = grey::<f64>(0.0, 1.0, exponent);
        let mut sum = 0.0;
        for i in 0..steps {
            for j in 0..steps {
                let u = [i, j].map(|i| (f64::from(i) + 0.5) / f64::from(steps));
                let sample = lobe.draw(wo, [0.5, u[0], u[1]]);
                let value = lobe.value(wo, sample.wi);
                sum += if sample.event.failed { 0.0 } else { value.f_cos.g / value.pdf };
            }
        }
        sum / f64::from(steps * steps)
    }

    #[test]
    fn it_is_a_power_of_the_half_vectors_cosine() {
        let mut random = Random(91);
        for _ in 0..20_000 {
            let n = 1000.0 * f64::from(random.unit()).powi(3);
            let k_d = f64::from(random.unit());
            let [wo, wi] = [double(random.above()).normalize(), double(random.above()).normalize()];
            let h = (wo + wi).normalize();
            let norm = (n + 2.0) * (n + 4.0) / (8.0 * PI * (0.5_f64.powf(n / 2.0) + n));
            let exact = (k_d / PI + (1.0 - k_d) * norm * h.z.powf(n)) * wi.z;
            let value = grey::<f64>(k_d, 1.0 - k_d, n).value(wo, wi);
            assert!(close(value.f_cos.g, exact, 1e-9 * exact.max(1e-290)), "{wo:?} {wi:?}: {value:?}, not {exact}");
            let density = (n + 1.0) / (2.0 * PI) * h.z.powf(n) / (4.0 * wo.dot(h));
            let shiny = grey::<f64>(0.0, 0.5, n).value(wo, wi).pdf;
            assert!(close(shiny, density, 1e-9 * density.max(1e-290)), "{wo:?} {wi:?}: {shiny}, not {density}");
        }
    }

    #[test]
    fn along_the_normal_the_glossy_albedo_is_k_s_for_every_exponent() {
        for exponent in [0.0, 0.01, 0.5, 1.0, 10.0, 100.0, 1e4, 1e7] {
            // There h lies at half of wi's angle: one integral, over t = cos(θ_h)^(n + 2), until wi reaches the horizon.
            let (lobe, steps) = (grey::<f64>(0.0, 1.0, exponent), 100_000);
            let (lowest, mut sum) = (0.5_f64.powf(0.5 * exponent + 1.0), 0.0);
            for step in 0..steps {
                let t = lowest + (1.0 - lowest) * (f64::from(step) + 0.5) / f64::from(steps);
                let log = t.ln() / (exponent + 2.0);
                let (cos, sin2) = (log.exp(), -(2.0 * log).exp_m1());
                let wi = Vec3::new(2.0 * cos * sin2.sqrt(), 0.0, 1.0 - 2.0 * sin2);
                // dω_i = 4 cosθ_h dω_h, dω_h = 2π dcosθ_h, dcos = cos dt/((n + 2) t).
                let density = lobe.value(Vec3::unit_z(), wi).f_cos.g;
                sum += density * 4.0 * cos * TAU * cos / ((exponent + 2.0) * t);
            }
            let sum = sum * (1.0 - lowest) / f64::from(steps);
            assert!(close(sum, 1.0, 1e-6), "{exponent}: {sum}");
        }
    }

    #[test]
    fn no_angle_and_no_exponent_returns_more_than_the_normal_does() {
        for exponent in [0.0, 0.003, 0.03, 0.1, 0.3, 1.0, 2.0, 3.0, 5.0, 10.0, 30.0, 100.0, 1e3, 1e4, 1e7] {
            let normal = albedo(exponent, Vec3::unit_z(), 256);
            for cos in [1e-4, 0.01, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 0.999] {
                let sum = albedo(exponent, view(cos, 0.09), 256);
                assert!(sum <= 1.0 + 1e-3 && sum <= normal + 2e-4, "{exponent} {cos}: {sum} {normal}");
            }
            let left = 1.0 / (0.5_f64.powf(0.5 * exponent) + exponent);
            let grazing = albedo(exponent, view(1e-9, 0.09), 256);
            assert!(close(grazing, left, 2e-3 * left), "{exponent}: {grazing} instead of {left}");
        }
    }

    #[test]
    fn single_precision_is_within_eight_units() {
        let (mut random, mut worst) = (Random(92), 0.0_f64);
        for _ in 0..200_000 {
            // Parts as unequal as can be: a small probability must not be what another one lacks of 1.
            let [k_d, k_s] = [(); 2].map(|()| 0.5 * f64::from(random.unit()).powi(5));
            let lobe = grey::<f32>(k_d, k_s, any_exponent(&mut random));
            let [wo, wi] = pair(&mut random);
            worst = worst.max(units(&lobe, wo, wi));
        }

        assert!(worst <= 8.0, "{worst}");
    }

    #[test]
    fn densities_integrate_to_1_less_what_fails() {
        for exponent in [0.0, 1.0, 20.0, 60.0] {
            for (k_d, k_s) in [(0.0, 0.5), (0.5, 0.5)] {
                for cos in [1.0, 0.7, 0.2] {
                    assert_normalised(
                        &std::format!("{exponent} {k_d} {k_s} {cos}"),
                        &grey(k_d, k_s, exponent),
                        view(cos, 0.09),
                    );
                }
            }
        }
    }

    #[test]
    fn no_sample_weighs_more_than_promised() {
        let (mut random, mut closest) = (Random(93), 0.0_f32);
        for round in 0..400_000 {
            let k_d = random.unit();
            let mut lobe = grey::<f32>(k_d.into(), (1.0 - k_d).into(), any_exponent(&mut random));
            if round % 2 == 0 {
                lobe.diffuse.r *= random.unit();
                lobe.glossy.b *= random.unit();
            }
            let wo = if round % 3 == 0 { Vec3::unit_z() } else { pair(&mut random)[0] };
            let sample = lobe.draw(wo, [random.unit(), random.unit(), random.unit()]);
            let value = lobe.value(wo, sample.wi);
            if !sample.event.failed {
                closest = closest.max(value.f_cos.largest() / value.pdf / lobe.largest_weight(wo));
            }
        }
        assert!(closest <= 1.0 + 1e-5, "{closest}");
    }

    #[test]
    fn the_largest_weight_of_a_glossy_surface_falls_from_8_to_1() {
        let mut before = 8.0 + 1e-12;
        for step in 0..=900 {
            let exponent = if step == 0 { 0.0 } else { 10.0_f64.powf(f64::from(step) / 100.0 - 2.0) };
            let weight = grey::<f64>(0.0, 1.0, exponent).largest_weight(Vec3::unit_z());
            assert!(weight <= before && weight >= 1.0, "{exponent}: {weight} after {before}");
            before = weight;
        }
    }

    #[test]
    fn light_takes_the_same_way_back() {
        let mut random = Random(94);
        for _ in 0..10_000 {
            let lobe = grey::<f32>(0.3, 0.7, any_exponent(&mut random));
            let [a, b] = pair(&mut random);
            let (there, back) = (lobe.value(a, b).f_cos.g / b.z, lobe.value(b, a).f_cos.g / a.z);
            assert!((there - back).abs() <= 1e-6 * there, "{a:?} {b:?}: {there} and {back}");
        }
    }

    #[cfg(feature = "wide")]
    #[test]
    fn eight_lanes_have_the_bits_of_one() {
        let mut random = Random(96);
        for _ in 0..10_000 {
            let lobe = grey::<f32>(0.3, 0.7, any_exponent(&mut random));
            super::super::ashikhmin_shirley::tests::assert_lanes(&lobe, &mut random);
        }
    }

    #[test]
    fn an_exponent_of_0_is_lambert_and_two_parts_may_not_return_more_than_they_get() {
        let (wo, wi) = (view(0.3, 0.1), view(0.8, 0.6));
        assert!(close(grey::<f64>(0.0, 0.5, 0.0).value(wo, wi).f_cos.g, 0.5 * 0.8 / PI, 1e-12));
        let domain = |d, s, n| grey::<f32>(d, s, n).domain();
        assert!(domain(0.3, 0.7, 5.0) && domain(1.0, 0.0, 0.0) && domain(0.1, 0.9, 1e7));
        assert!(!domain(0.301, 0.7, 5.0) && !domain(-0.1, 0.5, 5.0) && !domain(f64::NAN, 0.0, 5.0));
        assert!(!domain(0.5, 0.5, 1.1e7) && !domain(0.5, 0.5, -1.0));
    }

    #[test]
    fn grazing_and_opposite_directions_stay_finite_and_the_horizon_is_black() {
        let turn = |cos: f32, x: f32, y: f32| Vec3::new(x, y, cos);
        for exponent in [0.0, 0.3, 10.0, 1e4, 1e7] {
            for glossy in [0.0, 0.5, 1.0] {
                let lobe = grey::<f32>(1.0 - glossy, glossy, exponent);
                for cos_o in [1e-45, 1e-38, 1e-30, 1e-20, 1e-10, 1e-4] {
                    for cos_i in [1e-45, 1e-38, 1e-30, 1e-20, 1e-10, 1e-4] {
                        for length in [0.9996, 1.0, 1.0004] {
                            let wo = turn(cos_o, length, 0.0);
                            for wi in [turn(cos_i, -length, 0.0), turn(cos_i, -1.0, 1e-20), turn(cos_i, 0.6, 0.8)] {
                                let value = lobe.value(wo, wi);
                                assert!(value.is_sound(), "{lobe:?} {wo:?} {wi:?}: {value:?}");
                            }
                        }
                    }
                    let (wo, below) = (turn(cos_o, 1.0, 0.0), turn(-0.6, 0.8, 0.0));
                    assert_eq!((lobe.value(wo, below).pdf, lobe.value(wo, below).f_cos), (0.0, Rgb::zero()));
                    assert_eq!((lobe.value(below, wo).pdf, lobe.value(wo, turn(0.0, 1.0, 0.0)).pdf), (0.0, 0.0));
                    let sample = lobe.draw(wo, [0.99, 0.5, 0.3]);
                    assert!(sample.wi.is_direction(), "{lobe:?} {wo:?}: {sample:?}");
                }
            }
        }
    }
}
