//! `Closure`: a lobe seen from one direction wo, and the only guard.
//!
//! Outside the domain (a direction that is not finite or not unit to 1e-3 in |w|², a parameter out of range) every value is exactly
//! zero and every sample fails with a finite unit `wi` and weight 0. [`Unguarded`] is the same lobe without that guard, for
//! instruments that must see what the formulas do by themselves.
//!
//! A closure owns its lobe or borrows it (`Closure<R, &L>`), so it can be returned from a function:
//!
//! ```
//! use gonio_kernel::{Closure, Real, Rgb, Vec3, lobe::Lambert};
//!
//! fn chalk<R: Real>(wo: Vec3<R>) -> Closure<R, Lambert<R>> {
//!     Closure::new(Lambert::new(Rgb::splat(R::lit(0.8))), wo)
//! }
//! let sample = chalk(Vec3::new(0.6_f64, 0.0, 0.8)).sample([0.5; 3]);
//! assert!((sample.weight.r - 0.8).abs() < 1e-12);
//! ```

use crate::lobe::{Event, Lobe, Sample, Transport, Value};
use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::vec3::Vec3;

/// A sampled direction with its value.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample<R: Real> {
    /// The direction, local, unit.
    pub wi: Vec3<R>,
    /// How it came about.
    pub event: Event<R>,
    /// f·|cos_i| \[1/sr\]; for a delta event its weight times its probability.
    pub f_cos: Rgb<R>,
    /// Density per solid angle \[1/sr\]; for a delta event its probability; 0 if the sample failed.
    pub pdf: R,
    /// f_cos/pdf, what the path's throughput is multiplied by; 0 if the sample failed, never NaN.
    pub weight: Rgb<R>,
}

/// A lobe prepared at wo, total over all bit patterns.
#[derive(Clone, Copy, Debug)]
pub struct Closure<R: Real, L: Lobe<R>> {
    lobe: Unguarded<R, L>,
    valid: R::Mask,
}

impl<R: Real, L: Lobe<R>> Closure<R, L> {
    /// The lobe seen from the local unit direction wo, for radiance.
    #[inline(always)]
    pub fn new(lobe: L, wo: Vec3<R>) -> Self {
        Self::with_transport(lobe, wo, Transport::Radiance)
    }

    /// The lobe seen from the local unit direction wo.
    #[inline(always)]
    pub fn with_transport(lobe: L, wo: Vec3<R>, transport: Transport) -> Self {
        let valid = wo.is_direction() & lobe.domain();
        Self { lobe: Unguarded::new(lobe, wo, transport), valid }
    }

    /// f·|cos_i| \[1/sr\] and density \[1/sr\] of the continuous lobes at wi.
    #[inline(always)]
    pub fn eval(&self, wi: Vec3<R>) -> Value<R> {
        let value = self.lobe.eval(wi);
        value.or_zero(self.valid & wi.is_direction() & value.is_sound())
    }

    /// A direction wi for the uniform numbers u in [0, 1), with its value: that of [`Closure::eval`], or of a delta event.
    #[inline(always)]
    pub fn sample(&self, u: [R; 3]) -> BsdfSample<R> {
        let sample = self.lobe.sample(u);
        let Sample { wi, event } = sample;
        let mut value = self.lobe.eval(wi);
        if event.is_delta.any() {
            value = Value::select(event.is_delta, self.lobe.delta(&sample), value);
        }
        // The least normal `f32`: the inverse of less may be infinite.
        let possible = !event.failed & value.pdf.ge(R::lit(f64::from(f32::MIN_POSITIVE)));
        let ok = self.valid & wi.is_direction() & value.is_sound() & possible;
        let Value { f_cos, pdf } = value.or_zero(ok);
        let weight = (f_cos * value.pdf.recip()).or_zero(ok);
        BsdfSample {
            wi: Vec3::select(ok, wi, Vec3::unit_z()),
            event: Event { failed: !ok, ..event },
            f_cos,
            pdf,
            weight,
        }
    }

    /// Whether wo and the parameters lie in the domain.
    #[inline(always)]
    pub fn valid(&self) -> R::Mask {
        self.valid
    }
}

/// A lobe prepared at wo: finite and non-negative inside the domain, anything at all outside.
#[derive(Clone, Copy, Debug)]
pub struct Unguarded<R: Real, L: Lobe<R>> {
    lobe: L,
    wo: Vec3<R>,
    prepared: L::Prepared,
}

impl<R: Real, L: Lobe<R>> Unguarded<R, L> {
    /// The lobe seen from the local unit direction wo.
    #[inline(always)]
    pub fn new(lobe: L, wo: Vec3<R>, transport: Transport) -> Self {
        let prepared = lobe.prepare(wo, transport);
        Self { lobe, wo, prepared }
    }
    /// See [`Lobe::eval`].
    #[inline(always)]
    pub fn eval(&self, wi: Vec3<R>) -> Value<R> {
        self.lobe.eval(self.wo, &self.prepared, wi)
    }
    /// See [`Lobe::sample`].
    #[inline(always)]
    pub fn sample(&self, u: [R; 3]) -> Sample<R> {
        self.lobe.sample(self.wo, &self.prepared, u)
    }
    /// See [`Lobe::delta`].
    #[inline(always)]
    pub fn delta(&self, sample: &Sample<R>) -> Value<R> {
        self.lobe.delta(self.wo, &self.prepared, sample)
    }
    /// The lobe.
    #[inline(always)]
    pub fn lobe(&self) -> &L {
        &self.lobe
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fresnel::Fresnel;
    use crate::lobe::{Conductor, Lambert, Mirror};
    use crate::microfacet::Ggx;
    use crate::surface::{Surface, SurfaceError};
    use crate::testing::{Bare, Random, close, special_values};

    // Out of line, so that each surface's code is made once.
    #[inline(never)]
    fn eval<L: Lobe<f32>>(lobe: &L, wo: Vec3<f32>, wi: Vec3<f32>) -> Value<f32> {
        Closure::new(lobe, wo).eval(wi)
    }
    #[inline(never)]
    fn sample<L: Lobe<f32>>(lobe: &L, wo: Vec3<f32>, u: [f32; 3]) -> BsdfSample<f32> {
        Closure::new(lobe, wo).sample(u)
    }
    fn matte() -> Lambert<f32> {
        Lambert::new(Rgb::new(0.4, 0.2, 0.1))
    }
    fn metal() -> Conductor<f32> {
        let ggx = Ggx { alpha_x: 0.2, alpha_y: 0.4 };
        Conductor::new(ggx, Fresnel::Schlick { f0: Rgb::new(0.9, 0.7, 0.3) })
    }
    fn mirror() -> Mirror<f32> {
        Mirror::new(Rgb::splat(0.5))
    }

    #[test]
    fn values_add_and_densities_average_by_the_probability_of_their_lobe() -> Result<(), SurfaceError> {
        let mut random = Random(11);
        let surface = Surface::black().with(0.5, matte())?.with(0.25, mirror())?.with(0.75, metal())?;
        for _ in 0..1000 {
            let (wo, wi) = (random.above(), random.above());
            let value = eval(&surface, wo, wi);
            let (a, b) = (matte().value(wo, wi), metal().value(wo, wi));
            let shares = [
                0.5 * matte().albedo_estimate(wo).luminance(),
                0.25 * mirror().albedo_estimate(wo).luminance(),
                0.75 * metal().albedo_estimate(wo).luminance(),
            ];
            let sum: f32 = shares.iter().sum();
            let pdf = (shares[0] * a.pdf + shares[2] * b.pdf) / sum;
            assert!(close((value.pdf / pdf).into(), 1.0, 1e-5), "{value:?} and {pdf}");
            assert!(close((value.f_cos.g / (0.5 * a.f_cos.g + 0.75 * b.f_cos.g)).into(), 1.0, 1e-5));
        }
        Ok(())
    }

    #[test]
    fn a_surface_its_typed_mix_and_a_nested_surface_are_one_bsdf() -> Result<(), SurfaceError> {
        let mut random = Random(13);
        let half = Rgb::splat(0.5);
        let typed = matte().times(half).plus(mirror().times(half).plus(metal().times(half)));
        let flat = Surface::black().with(0.5, matte())?.with(0.5, mirror())?.with(0.5, metal())?;
        let nested = Surface::<f32, Surface<f32>, 2, 0>::empty().with(1.0, Surface::of(matte()))?;
        let rest = Surface::black().with(1.0, mirror())?.with(1.0, metal())?;
        let nested = nested.with(1.0, rest)?.times(half);
        for _ in 0..1000 {
            let (wo, wi) = (random.above(), random.above());
            let u = [random.unit(), random.unit(), random.unit()];
            let values = [eval(&typed, wo, wi), eval(&flat, wo, wi), eval(&nested, wo, wi)];
            let samples = [sample(&typed, wo, u), sample(&flat, wo, u), sample(&nested, wo, u)];
            for i in 1..3 {
                assert!(close((values[i].pdf / values[0].pdf).into(), 1.0, 1e-5), "{values:?}");
                assert!(close((values[i].f_cos.r / values[0].f_cos.r).into(), 1.0, 1e-5), "{values:?}");
                // At the border between two lobes one may choose the other.
                if samples[i].event.is_delta == samples[0].event.is_delta && !samples[0].event.failed {
                    assert!(close(samples[i].weight.r.into(), samples[0].weight.r.into(), 1e-3), "{samples:?}");
                }
            }
        }
        Ok(())
    }

    #[test]
    fn the_mirror_of_a_mixture_is_chosen_and_weighed_as_a_delta_event() -> Result<(), SurfaceError> {
        let wo = Vec3::new(0.6_f32, 0.0, 0.8);
        let surface = Surface::black().with(0.5, Lambert::new(Rgb::splat(0.5)))?.with(0.5, mirror())?;
        let (first, second) = (sample(&surface, wo, [0.25, 0.5, 0.5]), sample(&surface, wo, [0.75, 0.5, 0.5]));
        assert!(!first.event.is_delta && first.event.lobe == 0);
        assert!(second.event.is_delta && second.event.lobe == 1);
        assert_eq!(second.wi, Vec3::new(-0.6, 0.0, 0.8));
        // Half of 0.5 is reflected like this, and half of the samples carry it: each weighs 0.25/0.5.
        assert!(close(second.pdf.into(), 0.5, 1e-6) && close(second.f_cos.r.into(), 0.25, 1e-6));
        assert!(close(second.weight.r.into(), 0.5, 1e-6));
        Ok(())
    }

    #[test]
    fn a_lobe_that_is_absent_or_black_is_never_chosen() -> Result<(), SurfaceError> {
        let mut random = Random(12);
        let absent = Surface::black().with(0.0, mirror())?.with(1.0, matte())?;
        let black = Surface::black().with(1.0, Mirror::new(Rgb::zero()))?.with(1.0, matte())?;
        for surface in [absent, black] {
            for _ in 0..1000 {
                let sample = sample(&surface, random.above(), [random.unit(), 0.5, 0.5]);
                assert!(sample.event.failed || sample.event.lobe == 1);
            }
        }
        assert!(sample(&Surface::black(), Vec3::<f32>::unit_z(), [0.5; 3]).event.failed);
        Ok(())
    }

    fn assert_black(surface: &Surface<f32>, wo: Vec3<f32>, wi: Vec3<f32>, u: [f32; 3]) {
        let (value, sample) = (eval(surface, wo, wi), sample(surface, wo, u));
        let numbers =
            [value.f_cos.r, value.f_cos.g, value.f_cos.b, value.pdf, sample.f_cos.r, sample.pdf, sample.weight.g];
        for x in numbers {
            assert_eq!(x.to_bits(), 0, "{wo:?} {wi:?}: {value:?} {sample:?}");
        }
        assert!(sample.event.failed && sample.wi.is_direction(), "{wo:?}: {sample:?}");
    }

    #[test]
    fn outside_the_domain_everything_is_exactly_zero() -> Result<(), SurfaceError> {
        let up = Vec3::unit_z();
        let surface = Surface::black().with(0.5, matte())?.with(0.25, mirror())?.with(0.25, metal())?;
        for x in special_values() {
            let bad = Vec3::new(x, 0.3, 0.9); // never a unit vector
            assert_black(&surface, bad, up, [0.5; 3]);
            let value = eval(&surface, up, bad);
            assert_eq!((value.pdf.to_bits(), value.f_cos.g.to_bits()), (0, 0), "{bad:?}");
            if !(0.0..=1.0).contains(&x) {
                assert_black(&Surface::of(Lambert::new(Rgb::new(0.5, x, 0.5))), up, up, [0.5; 3]);
                assert_black(&Surface::black().with(x, mirror())?, up, up, [0.5; 3]);
            }
        }
        Ok(())
    }
}
