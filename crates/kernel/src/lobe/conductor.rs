//! A rough reflector: mirrors of GGX- or Beckmann-distributed normals. A metal, or the reflecting part of a dielectric.
//!
//! $$ f = \frac{F(\omega_o \cdot m)\,D(m)\,G_2(\omega_o, \omega_i)}{4\,c_o\,c_i} $$
//!
//! with m the half vector (Cook & Torrance 1982; Walter et al. 2007), masking height-correlated unless told otherwise.
//! Reciprocal; conserves energy, but loses the light that would be scattered more than once: up to about half of it at
//! α = 1. Visible normals are sampled, GGX within the bound of Eto & Tokuyoshi 2023, so weights never exceed F; samples
//! that leave below the horizon fail.
//!
//! Cost of a value: two divisions and two roots, and for a conductor's Fresnel one division and six roots more; its density
//! one division. What depends on wo alone (s(wo), the bound and that division) is prepared once per closure.

use super::{Event, Lobe, Prepared, Sample, Value};
use crate::frame::both_above;
use crate::fresnel::Fresnel;
use crate::microfacet::{Masking, Microfacets, pdf_visible_reflected, reflect, vis_cos_i};
use crate::real::Real;
use crate::rgb::Rgb;
use crate::vec3::Vec3;

/// A rough reflector of widths α in [1e-8, 1] and the given Fresnel reflectance. Reflects on the side of the normal only.
#[derive(Clone, Copy, Debug)]
pub struct Conductor<R> {
    /// The distribution of microfacet normals.
    pub microfacets: Microfacets<R>,
    /// How masking and shadowing go together.
    pub masking: Masking,
    /// What the microfacets are made of.
    pub fresnel: Fresnel<R>,
}

impl<R> Conductor<R> {
    /// A rough reflector with height-correlated masking.
    pub fn new(microfacets: impl Into<Microfacets<R>>, fresnel: Fresnel<R>) -> Self {
        Self { microfacets: microfacets.into(), masking: Masking::HeightCorrelated, fresnel }
    }

    /// The same with another masking.
    pub fn with_masking(self, masking: Masking) -> Self {
        Self { masking, ..self }
    }
}

impl<R: Real> Lobe<R> for Conductor<R> {
    /// s(wo) and the bound of visible normals.
    #[inline(always)]
    fn prepare(&self, wo: Vec3<R>) -> Prepared<R> {
        Prepared([self.microfacets.smith_length(wo), self.microfacets.bound(wo), R::ZERO, R::ZERO])
    }

    #[inline(always)]
    fn eval_prepared(&self, wo: Vec3<R>, prepared: &Prepared<R>, wi: Vec3<R>) -> Value<R> {
        let Prepared([s_o, bound, ..]) = *prepared;
        let h = wo + wi;
        let h2 = h.length2();
        let s_i = self.microfacets.smith_length(wi);
        let d = self.microfacets.d(h, h2);
        // wo·m = |h|/2 for unit directions: no cancellation at grazing, and never above 1 but by rounding.
        let cos_m = (h2.sqrt() * R::lit(0.5)).min(R::ONE);
        let f = self.fresnel.reflectance(cos_m);
        let f_cos = f * (d * vis_cos_i(self.masking, wo.z, s_o, wi.z, s_i));
        let pdf = pdf_visible_reflected(d, bound, wo.z, s_o);
        Value { f_cos, pdf }.or_zero(both_above(wo, wi))
    }

    #[inline(always)]
    fn sample_prepared(&self, wo: Vec3<R>, prepared: &Prepared<R>, u: [R; 3]) -> Sample<R> {
        let Prepared([s_o, bound, ..]) = *prepared;
        let wi = reflect(wo, self.microfacets.sample_visible(wo, s_o, bound, [u[1], u[2]]));
        Sample { wi, event: Event::reflected(!both_above(wo, wi)) }
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
        self.fresnel.reflectance(wo.z.max(R::ZERO).min(R::ONE))
    }

    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.microfacets.domain() & self.fresnel.domain()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::microfacet::Ggx;
    use crate::testing::Random;

    #[test]
    fn no_sample_of_a_rough_conductor_weighs_more_than_its_fresnel_reflectance() {
        let mut random = Random(3);
        for alpha in [1e-3_f32, 0.1, 1.0] {
            let ggx = Ggx { alpha_x: alpha, alpha_y: 0.5 * alpha };
            let white = Conductor::new(ggx, Fresnel::Schlick { f0: Rgb::splat(1.0) });
            for _ in 0..1000 {
                let wo = random.above();
                let sample = white.sample(wo, [random.unit(), random.unit(), random.unit()]);
                let value = white.eval(wo, sample.wi);
                assert!(sample.event.failed || value.f_cos.r <= value.pdf * (1.0 + 1e-5), "{alpha}: {wo:?} {value:?}");
            }
        }
    }

    #[test]
    fn light_takes_the_same_way_back() {
        let mut random = Random(4);
        let ggx = Ggx { alpha_x: 0.4_f32, alpha_y: 0.1 };
        let copper = Fresnel::Conductor { eta: Rgb::new(0.22, 0.96, 1.17), k: Rgb::new(3.68, 2.59, 2.46) };
        let conductor = Conductor::new(ggx, copper);
        for _ in 0..1000 {
            let (a, b) = (random.above(), random.above());
            let (there, back) = (conductor.eval(a, b).f_cos.g * a.z, conductor.eval(b, a).f_cos.g * b.z);
            assert!((there - back).abs() <= 1e-6 * there, "{a:?} {b:?}: {there} and {back}");
        }
    }
}
