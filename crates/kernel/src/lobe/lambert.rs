//! Lambert's perfectly diffuse reflector: f = ρ/π, so that exitance = ρ · irradiance (Lambert 1760, "Photometria").
//!
//! Reciprocal; conserves energy for ρ ≤ 1, with equality in a white furnace. Reflects on the side of the normal only.
//! Sampled by cosine, which makes every weight exactly ρ up to rounding.

use super::{Event, Lobe, Properties, Sample, Transport, Value};
use crate::frame::both_above;
use crate::model::{Parameters, REFLECTANCE};
use crate::real::Real;
use crate::rgb::Rgb;
use crate::vec3::Vec3;
use crate::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere};

crate::model! {
    /// Lambert's perfectly diffuse reflector.
    pub struct Lambert<R> = "diffuse" {
        /// The reflected part of the light, ρ.
        albedo("base_color"): Rgb<R> = 0.8 in REFLECTANCE,
    }
}

impl<R> Lambert<R> {
    /// A diffuse reflector of albedo ρ in [0, 1].
    pub const fn new(albedo: Rgb<R>) -> Self {
        Self { albedo }
    }
}

impl<R: Real> Lobe<R> for Lambert<R> {
    type Prepared = ();

    #[inline(always)]
    fn prepare(&self, _wo: Vec3<R>, _transport: Transport) {}

    #[inline(always)]
    fn eval(&self, wo: Vec3<R>, _prepared: &(), wi: Vec3<R>) -> Value<R> {
        let pdf = pdf_cosine_hemisphere(wi);
        Value { f_cos: self.albedo * pdf, pdf }.or_zero(both_above(wo, wi))
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, _prepared: &(), u: [R; 3]) -> Sample<R> {
        let wi = sample_cosine_hemisphere([u[1], u[2]]);
        Sample { wi, event: Event::reflected(!both_above(wo, wi)) }
    }

    #[inline(always)]
    fn delta(&self, _wo: Vec3<R>, _prepared: &Self::Prepared, _sample: &Sample<R>) -> Value<R> {
        Value::zero()
    }

    #[inline(always)]
    fn albedo_estimate(&self, _wo: Vec3<R>) -> Rgb<R> {
        self.albedo
    }

    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.in_domain()
    }

    #[inline(always)]
    fn properties(&self) -> Properties<R> {
        Properties { one_to_one: true, symmetric: true, albedo: Some(self.albedo), ..Properties::LAWFUL }
    }

    #[inline(always)]
    fn largest_weight(&self, _wo: Vec3<R>) -> R {
        self.albedo.largest()
    }

    #[inline(always)]
    fn is_lambertian(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Bare, Random, close};

    #[test]
    fn every_sample_of_a_diffuse_surface_weighs_its_albedo() {
        let mut random = Random(2);
        let lambert = Lambert::new(Rgb::new(0.8_f32, 0.5, 0.0));
        for _ in 0..100 {
            let wo = random.above();
            let wi = lambert.draw(wo, [random.unit(), random.unit(), random.unit()]).wi;
            let value = lambert.value(wo, wi);
            assert!(close((value.f_cos.r / value.pdf).into(), 0.8, 1e-6) && value.f_cos.b == 0.0);
        }
    }
}
