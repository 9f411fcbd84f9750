//! A smooth conductor: polished metal, or the reflection of a smooth coat of lacquer.
//!
//! All light leaves in the mirrored direction, times Fresnel's reflectance at its angle (Born & Wolf, section 14.2): the limit of
//! [`super::Conductor`] for alpha → 0, and a [`super::Mirror`] whose reflectance follows the angle. Reciprocal; conserves energy. All
//! delta: `eval` is 0, 0, every sample weighs F.
//!
//! With the reflectance of a dielectric or Schlick's curve it can lie on top of other lobes as a smooth coat ([`super::Layer`]).
//!
//! ```toml
//! type = "smooth-conductor"
//! metal = "gold"
//! ```
//!
//! Cost of a sample: that of the reflectance.

use super::mirror::{is_mirrored, mirrored};
use super::{Lobe, Properties, Sample, Transport, Value};
use crate::fresnel::Fresnel;
use crate::model::Parameters;
use crate::real::Real;
use crate::rgb::Rgb;
use crate::vec3::Vec3;

crate::model! {
    /// A smooth metal, or the reflection of a smooth dielectric.
    pub struct SmoothConductor<R> = "smooth-conductor" {
        /// What it is made of.
        fresnel: Fresnel<R>,
    }
    coat |it| it.fresnel.albedo_curve(R::ZERO);
}

impl<R> SmoothConductor<R> {
    /// A smooth reflector of this material.
    pub const fn new(fresnel: Fresnel<R>) -> Self {
        Self { fresnel }
    }
}

impl<R: Real> SmoothConductor<R> {
    #[inline(always)]
    fn reflectance(&self, wo: Vec3<R>) -> Rgb<R> {
        self.fresnel.reflectance(wo.z.max(R::ZERO).min(R::ONE))
    }
}

impl<R: Real> Lobe<R> for SmoothConductor<R> {
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
        Value { f_cos: self.reflectance(wo), pdf: R::ONE }.or_zero(is_mirrored(wo, sample))
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
        self.reflectance(wo)
    }

    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.in_domain()
    }

    #[inline(always)]
    fn properties(&self) -> Properties<R> {
        Properties { has_delta: true, all_delta: true, symmetric: true, ..Properties::LAWFUL }
    }

    #[inline(always)]
    fn largest_weight(&self, _wo: Vec3<R>) -> R {
        R::ONE
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metal::Metal;
    use crate::testing::{Bare, Random};

    #[test]
    fn polished_gold_reflects_what_fresnel_says_in_the_mirrored_direction() {
        let mut random = Random(61);
        let gold = SmoothConductor::new(Fresnel::<f32>::from(Metal::Gold));
        for _ in 0..100 {
            let wo = random.above();
            let sample = gold.draw(wo, [0.5; 3]);
            assert_eq!(sample.wi, Vec3::new(-wo.x, -wo.y, wo.z));
            assert_eq!(gold.delta(wo, &(), &sample).f_cos, gold.fresnel.reflectance(wo.z));
            assert_eq!(gold.value(wo, sample.wi).pdf, 0.0);
        }
    }
}
