//! A rough conductor: mirrors of GGX-distributed normals, single scattering with Smith's height-correlated masking.
//!
//! f = F(wo·m) D(m) G₂(wo, wi)/(4 cos_o cos_i) with m the half vector (Cook & Torrance 1982; Walter et al. 2007).
//! Reciprocal; conserves energy, but loses the light that would be scattered more than once: up to about half of it at
//! α = 1. Visible normals are sampled, so weights never exceed F; samples that leave below the horizon fail.

use super::{Event, Lobe, Sample, Value};
use crate::frame::both_above;
use crate::fresnel::Fresnel;
use crate::microfacet::Ggx;
use crate::real::Real;
use crate::rgb::Rgb;
use crate::vec3::Vec3;

/// A rough reflector of widths α in [1e-4, 1] and the given Fresnel reflectance. Reflects on the side of the normal only.
#[derive(Clone, Copy, Debug)]
pub struct Conductor<R> {
    /// The distribution of microfacet normals.
    pub ggx: Ggx<R>,
    /// What the microfacets are made of.
    pub fresnel: Fresnel<R>,
}

impl<R> Conductor<R> {
    /// A rough conductor.
    pub const fn new(ggx: Ggx<R>, fresnel: Fresnel<R>) -> Self {
        Self { ggx, fresnel }
    }
}

impl<R: Real> Lobe<R> for Conductor<R> {
    #[inline(always)]
    fn eval(&self, wo: Vec3<R>, wi: Vec3<R>) -> Value<R> {
        let h = wo + wi;
        let h2 = h.length2();
        let (s_o, s_i) = (self.ggx.stretched_length(wo), self.ggx.stretched_length(wi));
        let d = self.ggx.d(h, h2);
        // wo·m = |h|/2 for unit directions: no cancellation at grazing, and never above 1 but by rounding.
        let cos_m = (h2.sqrt() * R::lit(0.5)).min(R::ONE);
        let f = self.fresnel.reflectance(cos_m);
        let f_cos = f * (d * self.ggx.vis_cos_i(wo.z, s_o, wi.z, s_i));
        let pdf = self.ggx.pdf_visible_reflected(d, wo.z, s_o);
        Value { f_cos, pdf }.or_zero(both_above(wo, wi))
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R> {
        let m = self.ggx.sample_visible(wo, [u[1], u[2]]);
        let wi = (m * (R::lit(2.0) * wo.dot(m)) - wo).normalize_or(Vec3::unit_z());
        Sample { wi, event: Event::reflected(!both_above(wo, wi)) }
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
        self.fresnel.reflectance(wo.z.max(R::ZERO).min(R::ONE))
    }

    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.ggx.domain() & self.fresnel.domain()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
