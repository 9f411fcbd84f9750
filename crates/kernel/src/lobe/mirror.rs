//! The perfect mirror: all light from one direction leaves in one other, ω_o = 2n(n·ω_i) − ω_i, times a reflectance R.
//!
//! f = R δ(ω_i − mirrored ω_o)/|cosθ_i|; with the cosine of the scattering equation the weight is R. The lecture's mirror
//! omits the 1/|cosθ|. Reciprocal; conserves energy for R ≤ 1. All delta: `eval` is 0, 0.

use super::{Event, Lobe, Properties, Sample, Transport, Value};
use crate::energy::AlbedoCurve;
use crate::model::{Parameters, REFLECTANCE};
use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::vec3::Vec3;

crate::model! {
    /// A perfect mirror of one reflectance at every angle. Reflects on the side of the normal only.
    pub struct Mirror<R> = "mirror" {
        /// The reflected part of the light, R.
        reflectance: Rgb<R> = 1.0 in REFLECTANCE,
    }
    coat |mirror| Some(AlbedoCurve::constant(mirror.reflectance));
}

impl<R> Mirror<R> {
    /// A mirror of specular reflectance R in [0, 1].
    pub const fn new(reflectance: Rgb<R>) -> Self {
        Self { reflectance }
    }
}

impl<R: Real> Lobe<R> for Mirror<R> {
    type Prepared = ();

    #[inline(always)]
    fn prepare(&self, _wo: Vec3<R>, _transport: Transport) {}

    #[inline(always)]
    fn eval(&self, _wo: Vec3<R>, _prepared: &(), _wi: Vec3<R>) -> Value<R> {
        Value::zero()
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, _prepared: &(), _u: [R; 3]) -> Sample<R> {
        mirrored(wo)
    }

    #[inline(always)]
    fn delta(&self, wo: Vec3<R>, _prepared: &(), sample: &Sample<R>) -> Value<R> {
        Value { f_cos: self.reflectance, pdf: R::ONE }.or_zero(is_mirrored(wo, sample))
    }

    #[inline(always)]
    fn albedo_estimate(&self, _wo: Vec3<R>) -> Rgb<R> {
        self.reflectance
    }

    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.in_domain()
    }

    #[inline(always)]
    fn properties(&self) -> Properties<R> {
        Properties {
            has_delta: true,
            all_delta: true,
            symmetric: true,
            albedo: Some(self.reflectance),
            ..Properties::LAWFUL
        }
    }

    #[inline(always)]
    fn largest_weight(&self, _wo: Vec3<R>) -> R {
        self.reflectance.largest()
    }
}

/// The one event of a smooth reflector: 2n(n·wo) − wo with n = (0, 0, 1).
#[inline(always)]
pub(super) fn mirrored<R: Real>(wo: Vec3<R>) -> Sample<R> {
    let event = Event { is_delta: R::Mask::splat(true), ..Event::reflected(!wo.z.gt(R::ZERO)) };
    Sample { wi: Vec3::new(-wo.x, -wo.y, wo.z), event }
}

/// Whether a sample is that event.
#[inline(always)]
pub(super) fn is_mirrored<R: Real>(wo: Vec3<R>, sample: &Sample<R>) -> R::Mask {
    sample.event.is_delta & !sample.event.failed & wo.z.gt(R::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Bare, Random};

    #[test]
    fn light_leaves_a_mirror_along_2n_times_n_dot_w_minus_w() {
        let mut random = Random(1);
        let (mirror, n) = (Mirror::new(Rgb::new(0.9_f32, 0.5, 0.1)), Vec3::unit_z());
        for _ in 0..100 {
            let w = random.above();
            let sample = mirror.draw(w, [0.0; 3]);
            assert_eq!(sample.wi, n * (2.0 * n.dot(w)) - w);
            let value = mirror.delta_of(w, &sample);
            assert_eq!((value.f_cos, value.pdf), (mirror.reflectance, 1.0));
            assert_eq!(mirror.value(w, sample.wi).pdf, 0.0);
        }
    }

    #[test]
    fn from_below_a_mirror_is_black() {
        let mirror = Mirror::new(Rgb::splat(1.0_f32));
        let below = Vec3::new(0.6, 0.0, -0.8);
        let sample = mirror.draw(below, [0.0; 3]);
        assert!(sample.event.failed);
        assert_eq!(mirror.delta_of(below, &sample).pdf, 0.0);
    }
}
