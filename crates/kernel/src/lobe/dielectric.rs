//! A smooth dielectric: clear glass or water. Light is reflected or refracted, each in one direction.
//!
//! Fresnel's F of it is reflected, 1 − F refracted along Snell's law, η_o sinθ_o = η_i sinθ_i; beyond the critical angle all
//! of it is reflected (Born & Wolf, section 1.5). All delta: `eval` is 0, 0. Energy is conserved exactly (for
//! importance: transmitted radiance carries 1/η²); light takes the same way back. Sampled in proportion, so every weight is 1.
//!
//! Cost: five divisions and one root.

use super::{Event, Lobe, Properties, Sample, Transport, Value};
use crate::fresnel::{Interface, interface, refracted_cosine};
use crate::model::{INDEX, Parameters};
use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::vec3::Vec3;

crate::model! {
    /// A smooth interface: clear glass, water. The normal points away from the inside, which may be thinner than the outside.
    pub struct Dielectric<R> = "dielectric" {
        /// Index of the inside over that of the outside; 1 is no interface at all.
        eta("ior"): R = 1.5 in INDEX,
    }
}

impl<R: Real> Dielectric<R> {
    /// A smooth interface of relative index eta.
    pub const fn new(eta: R) -> Self {
        Self { eta }
    }

    /// η_t/η_i seen from wo, the cosine of what is refracted, and how much that is.
    #[inline(always)]
    fn seen_from(&self, wo: Vec3<R>) -> (R, R, Interface<R>) {
        let eta = relative_index(self.eta, wo);
        let cos_o = wo.z.abs().min(R::ONE);
        let cos_t = refracted_cosine(cos_o, eta);
        (eta, cos_t, interface(cos_o, cos_t, eta))
    }
}

/// η_t/η_i seen from wo, of an interface whose inside is `eta` times as dense as its outside.
#[inline(always)]
pub(super) fn relative_index<R: Real>(eta: R, wo: Vec3<R>) -> R {
    R::select(wo.z.gt(R::ZERO), eta, eta.recip())
}

impl<R: Real> Lobe<R> for Dielectric<R> {
    type Prepared = Transport;

    #[inline(always)]
    fn prepare(&self, _wo: Vec3<R>, transport: Transport) -> Transport {
        transport
    }

    #[inline]
    fn eval(&self, _wo: Vec3<R>, _prepared: &Transport, _wi: Vec3<R>) -> Value<R> {
        Value::zero()
    }

    #[inline]
    fn sample(&self, wo: Vec3<R>, _prepared: &Transport, u: [R; 3]) -> Sample<R> {
        let (eta, cos_t, at) = self.seen_from(wo);
        let reflected = u[0].lt(at.reflected);
        // Snell's law for the tangential part, and the normal part on the other side; unit as wo is.
        let thin = eta.recip();
        let refracted = Vec3::new(-wo.x * thin, -wo.y * thin, cos_t.copysign(-wo.z)).normalize_or(Vec3::unit_z());
        let wi = Vec3::select(reflected, Vec3::new(-wo.x, -wo.y, wo.z), refracted);
        let event = Event {
            is_delta: R::Mask::splat(true),
            transmitted: !reflected,
            // In the surface itself there is no side; and rounding may leave a hair between F and 1 in total reflection.
            ..Event::reflected(wo.z.same(R::ZERO) | (!reflected & at.transmitted.le(R::ZERO)))
        };
        Sample { wi, event }
    }

    #[inline]
    fn delta(&self, wo: Vec3<R>, transport: &Transport, sample: &Sample<R>) -> Value<R> {
        let (eta, _, at) = self.seen_from(wo);
        let event = sample.event;
        let pdf = R::select(event.transmitted, at.transmitted, at.reflected);
        let f_cos = match transport {
            Transport::Radiance => R::select(event.transmitted, pdf / (eta * eta), pdf),
            Transport::Importance => pdf,
        };
        Value { f_cos: Rgb::splat(f_cos), pdf }.or_zero(event.is_delta & !event.failed & !wo.z.same(R::ZERO))
    }

    #[inline(always)]
    fn albedo_estimate(&self, _wo: Vec3<R>) -> Rgb<R> {
        Rgb::splat(R::ONE)
    }

    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.in_domain()
    }

    #[inline(always)]
    fn properties(&self) -> Properties<R> {
        Properties { has_delta: true, all_delta: true, transmits: true, symmetric: true, ..Properties::LAWFUL }
    }

    #[inline(always)]
    fn largest_weight(&self, _wo: Vec3<R>) -> R {
        R::ONE
    }

    #[inline(always)]
    fn radiance_scale(&self, wo: Vec3<R>) -> R {
        relative_index(self.eta, wo).sqr()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Bare, Random, close};

    #[test]
    fn light_bends_by_snells_law_and_finds_its_way_back() {
        let mut random = Random(21);
        for eta in [1.5_f32, 1.0 / 1.5, 1.0001, 2.4] {
            let glass = Dielectric::new(eta);
            for _ in 0..1000 {
                let wo = random.direction();
                let sample = glass.draw(wo, [0.999_999_9, 0.0, 0.0]);
                if !sample.event.transmitted || sample.event.failed {
                    continue;
                }
                let inside = if wo.z > 0.0 { eta } else { 1.0 / eta };
                let (sin_o, sin_i) = (wo.x.hypot(wo.y), sample.wi.x.hypot(sample.wi.y));
                assert!(close((sin_o / sin_i / inside).into(), 1.0, 3e-6) || sin_i < 1e-3, "{eta} {wo:?} {sample:?}");
                assert!(sample.wi.z * wo.z < 0.0);
                let back = glass.draw(sample.wi, [0.999_999_9, 0.0, 0.0]);
                // From the denser side one ulp of sinθ becomes η of them, and is divided by the cosine.
                let slack = 4e-7 * f64::from(eta.max(1.0 / eta)).powi(2) / f64::from(wo.z.abs()).max(1e-3);
                assert!(close((back.wi - wo).length().into(), 0.0, slack), "{eta} {wo:?} {:?}", back.wi);
            }
        }
    }

    #[test]
    fn every_sample_weighs_one_but_for_the_compression_of_radiance() {
        let mut random = Random(22);
        let glass = Dielectric::new(1.5_f32);
        for _ in 0..1000 {
            let wo = random.direction();
            let sample = glass.draw(wo, [random.unit(), 0.0, 0.0]);
            let value = glass.delta_of(wo, &sample);
            let weight = f64::from(value.f_cos.r / value.pdf);
            let right = if sample.event.transmitted { 1.0 / f64::from(glass.radiance_scale(wo)) } else { 1.0 };
            assert!(close(weight / right, 1.0, 1e-6), "{wo:?}: {weight}");
        }
        // Seen from outside, light from within glass is thinned by 1.5²; seen from within, light from outside is denser.
        assert!(close(glass.radiance_scale(Vec3::unit_z()).into(), 2.25, 1e-6));
        assert!(close(glass.radiance_scale(-Vec3::unit_z()).into(), 1.0 / 2.25, 1e-6));
    }

    #[test]
    fn equal_indices_let_all_light_pass_straight() {
        let nothing = Dielectric::new(1.0_f32);
        let wo = Vec3::new(0.6, 0.0, 0.8);
        let sample = nothing.draw(wo, [0.3, 0.0, 0.0]);
        assert!(sample.event.transmitted && (sample.wi + wo).length() < 1e-6, "{sample:?}");
        assert!(close(nothing.delta_of(wo, &sample).f_cos.g.into(), 1.0, 1e-6));
    }
}
