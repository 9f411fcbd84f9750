//! The perfect mirror: all light from one direction leaves in one other, ω_o = 2n(n·ω_i) − ω_i, times a reflectance R.
//!
//! f = R δ(ω_i − mirrored ω_o)/|cosθ_i|; with the cosine of the scattering equation the weight is R. The lecture's mirror
//! omits the 1/|cosθ|. Reciprocal; conserves energy for R ≤ 1. Purely discrete: `eval` is 0, 0.

use super::{Event, Lobe, Sample, Value};
use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::vec3::Vec3;

/// A mirror of specular reflectance R, each channel in [0, 1]. Reflects on the side of the normal only.
#[derive(Clone, Copy, Debug)]
pub struct Mirror<R> {
    /// The reflected part of the light.
    pub reflectance: Rgb<R>,
}

impl<R> Mirror<R> {
    /// A mirror of specular reflectance R in [0, 1].
    pub const fn new(reflectance: Rgb<R>) -> Self {
        Self { reflectance }
    }
}

impl<R: Real> Lobe<R> for Mirror<R> {
    #[inline(always)]
    fn eval(&self, _wo: Vec3<R>, _wi: Vec3<R>) -> Value<R> {
        Value::zero()
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, _u: [R; 3]) -> Sample<R> {
        // 2n(n·wo) − wo with n = (0, 0, 1).
        let wi = Vec3::new(-wo.x, -wo.y, wo.z);
        let event = Event { discrete: R::Mask::splat(true), ..Event::reflected(!wo.z.gt(R::ZERO)) };
        Sample { wi, event }
    }

    #[inline(always)]
    fn discrete(&self, wo: Vec3<R>, event: &Event<R>) -> Value<R> {
        Value { f_cos: self.reflectance, pdf: R::ONE }.or_zero(event.discrete & !event.failed & wo.z.gt(R::ZERO))
    }

    #[inline(always)]
    fn albedo_estimate(&self, _wo: Vec3<R>) -> Rgb<R> {
        self.reflectance
    }

    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.reflectance.within(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    #[test]
    fn light_leaves_a_mirror_along_2n_times_n_dot_w_minus_w() {
        let mut random = Random(1);
        let (mirror, n) = (Mirror::new(Rgb::new(0.9_f32, 0.5, 0.1)), Vec3::unit_z());
        for _ in 0..100 {
            let w = random.above();
            let sample = mirror.sample(w, [0.0; 3]);
            assert_eq!(sample.wi, n * (2.0 * n.dot(w)) - w);
            let worth = mirror.discrete(w, &sample.event);
            assert_eq!((worth.f_cos, worth.pdf), (mirror.reflectance, 1.0));
            assert_eq!(mirror.eval(w, sample.wi).pdf, 0.0);
        }
    }

    #[test]
    fn from_below_a_mirror_is_black() {
        let mirror = Mirror::new(Rgb::splat(1.0_f32));
        let below = Vec3::new(0.6, 0.0, -0.8);
        let sample = mirror.sample(below, [0.0; 3]);
        assert!(sample.event.failed);
        assert_eq!(mirror.discrete(below, &sample.event).pdf, 0.0);
    }
}
