//! A rough dielectric: ground glass, a rippled lake. Microfacets that reflect and refract.
//!
//! Walter, Marschner, Li & Torrance 2007, "Microfacet Models for Refraction through Rough Surfaces". With η = η_t/η_i seen
//! from wo, h = wo + wi for reflection and h = wo + η wi for refraction, m along ±h on the side of the normal:
//!
//! $$ f_r = \frac{F\\,D\\,G_2}{4\\,c_o c_i} \qquad
//!    f_t = \frac{(1 - F)\\,D\\,G_1 G_1\\,|\omega_o\\!\cdot\\!h|\\,|\omega_i\\!\cdot\\!h|\\,\eta^2}{c_o c_i\\,|h|^4}
//!    \cdot \frac{1}{\eta^2} $$
//!
//! where the last factor is that of radiance. Reflection is masked height-correlated unless told otherwise; for refraction,
//! where wo and wi see opposite sides of the heights, masking is separable as in the paper. Conserves energy (as
//! importance), but loses what would be scattered more than once. Visible normals are sampled, and reflection in proportion
//! to F, so weights never exceed 1; samples that leave on the wrong side fail.
//!
//! **Nearly equal indices.** As η → 1 refraction narrows to a line straight on, whatever the roughness. Within 10⁻³ of 1
//! it is that line: all light passes as one delta event. (It would turn by at most 0.06°, and reflect 2.5·10⁻⁷.)
//!
//! Cost of a value with GGX: ten divisions and three roots.

use super::dielectric::relative_index;
use super::{Event, Lobe, Properties, Sample, Transport, Value};
use crate::frame::turned;
use crate::fresnel::{interface, refracted_cosine};
use crate::microfacet::{Masking, Microfacets, Reach, pdf_visible_reflected, reflect, vis_cos_i};
use crate::model::{INDEX, Parameters};
use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::vec3::Vec3;

crate::model! {
    /// A rough interface: ground glass, a rippled lake. The normal points away from the inside.
    pub struct RoughDielectric<R> = "dielectric" with ("roughness" | "alpha" | "alpha_x" | "alpha_y") {
        /// The distribution of microfacet normals.
        microfacets: Microfacets<R>,
        /// How masking and shadowing of reflection go together.
        masking: Masking = HeightCorrelated,
        /// Index of the inside over that of the outside.
        eta("ior"): R = 1.5 in INDEX,
    }
}

/// What depends on wo alone.
#[derive(Clone, Copy, Debug)]
pub struct Prepared<R> {
    /// s(wo).
    s_o: R,
    /// All visible normals.
    reach: Reach<R>,
    /// η seen from wo.
    eta: R,
    transport: Transport,
}

/// How near to 1 an index must be for the interface to count as none.
const NO_INTERFACE: f64 = 1e-3;

impl<R: Real> RoughDielectric<R> {
    /// A rough interface of relative index eta, with height-correlated masking.
    pub fn new(microfacets: impl Into<Microfacets<R>>, eta: R) -> Self {
        Self { microfacets: microfacets.into(), masking: Masking::HeightCorrelated, eta }
    }

    /// The same with another masking of reflection.
    pub fn with_masking(self, masking: Masking) -> Self {
        Self { masking, ..self }
    }

    /// Whether a facet is seen well enough from wo to tell which of its sides is: the half vector of refraction is a difference of
    /// length |η − 1| at least, whose direction rounding moves by (1 + η)ε/|η − 1|.
    ///
    /// What is seen less refracts nothing, in values and samples alike. In `f32` that loses up to 3e-5 of the light on such a
    /// facet at η = 1.5, but 0.5 % at 1.01 and 16 % at 1.001, where a wo of cosine 1e-3 sees hardly any others.
    #[inline(always)]
    fn is_seen(&self, cos_m: R, eta: R, room: f64) -> R::Mask {
        (cos_m * (eta - R::ONE).abs()).gt((R::ONE + eta) * R::EPSILON * R::lit(room))
    }

    #[inline(always)]
    fn is_nothing(&self) -> R::Mask {
        (self.eta - R::ONE).abs().lt(R::lit(NO_INTERFACE))
    }
}

impl<R: Real> Lobe<R> for RoughDielectric<R> {
    type Prepared = Prepared<R>;

    #[inline(always)]
    fn prepare(&self, wo: Vec3<R>, transport: Transport) -> Prepared<R> {
        let s_o = self.microfacets.smith_length(wo);
        let reach = Reach::whole(turned(wo, wo), s_o);
        Prepared { s_o, reach, eta: relative_index(self.eta, wo), transport }
    }

    #[inline(always)]
    fn eval(&self, wo: Vec3<R>, prepared: &Prepared<R>, wi: Vec3<R>) -> Value<R> {
        let Prepared { s_o, reach, eta, transport } = *prepared;
        let (wi, wo) = (turned(wo, wi), turned(wo, wo));
        let through = wi.z.lt(R::ZERO);
        let (c_o, c_i) = (wo.z, wi.z.abs());

        let turn = R::select(through, eta, R::ONE);
        let h = wo + wi * turn;
        // The side that wo sees, which for reflection is above, whatever rounding makes of wo·h at grazing. A normal sampled in the
        // surface itself may come back a rounding below it.
        let h = Vec3::select(through & wo.dot(h).lt(R::ZERO), -h, h);
        let upwards = h.z.ge(turn.mul_add(c_i, c_o) * R::lit(-4.0) * R::EPSILON);
        let h2 = h.length2();
        let (wo_h, wi_h) = (wo.dot(h), wi.dot(h));
        // wo·m: |h|/2 for reflection, where the dot product would cancel at grazing. For refraction both cosines are known,
        // and Snell's law, which loses digits near the critical angle, is not needed.
        let h_length = h2.sqrt();
        let limit = |x: R| x.max(R::ZERO).min(R::ONE);
        let cos_m = limit(R::select(through, wo_h / h_length, h_length * R::lit(0.5)));
        let cos_t = R::select(through, limit(-wi_h / h_length), refracted_cosine(cos_m, eta));
        let at = interface(cos_m, cos_t, eta);
        let d = self.microfacets.d(h, h2);
        let s_i = self.microfacets.smith_length(wi);

        let reflected = Value {
            f_cos: Rgb::splat(at.reflected * d * vis_cos_i(self.masking, c_o, s_o, c_i, s_i)),
            pdf: at.reflected * pdf_visible_reflected(d, reach),
        };
        // dω_m/dω_i · |wo·m| = |wo·h| |wi·h| η²/|h|⁴; both cosines of h first over |h|², so that nothing under- or overflows.
        let turning = (wo_h / h2) * (wi_h.abs() / h2) * at.transmitted * d * R::lit(4.0);
        let refracted = Value {
            f_cos: Rgb::splat(turning * vis_cos_i(Masking::Separable, c_o, s_o, c_i, s_i)),
            pdf: turning * (eta * eta) * pdf_visible_reflected(R::ONE, reach),
        };
        // Both must see the front of the microfacet: wo from above, a refracted wi from below.
        let faces = upwards & wi_h.lt(R::ZERO) & self.is_seen(wo_h / h_length, eta, 4.0);
        let ok = c_o.gt(R::ZERO) & c_i.gt(R::ZERO) & !self.is_nothing();
        let f_cos = Rgb::select(through, refracted.f_cos, reflected.f_cos);
        let pdf = R::select(through, refracted.pdf, reflected.pdf);
        let value = Value { f_cos, pdf }.or_zero(ok & (faces | !through));
        match transport {
            Transport::Radiance => value,
            Transport::Importance => Value { f_cos: value.f_cos * R::select(through, eta * eta, R::ONE), ..value },
        }
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, prepared: &Prepared<R>, u: [R; 3]) -> Sample<R> {
        let Prepared { s_o, reach, eta, .. } = *prepared;
        let up = turned(wo, wo);
        let m = self.microfacets.sample_visible(up, s_o, reach, [u[1], u[2]]).normalize_or(Vec3::unit_z());
        let cos_m = up.dot(m).max(R::ZERO).min(R::ONE);
        let cos_t = refracted_cosine(cos_m, eta);
        let at = interface(cos_m, cos_t, eta);
        let reflects = u[0].lt(at.reflected);
        let thin = eta.recip();
        let refracted = (m * cos_m.mul_add(thin, -cos_t) - up * thin).normalize_or(-Vec3::unit_z());
        let wi = turned(wo, Vec3::select(reflects, reflect(up, m), refracted));
        let side = wo.z * wi.z;
        // With twice the room that values have, so that rounding takes none of them away.
        let refracts = !reflects & self.is_seen(cos_m, eta, 8.0) & at.transmitted.gt(R::ZERO);
        let right_side = (side.gt(R::ZERO) & reflects) | (side.lt(R::ZERO) & refracts);

        let nothing = self.is_nothing();
        let no_side = wo.z.same(R::ZERO);
        Sample {
            wi: Vec3::select(nothing, -wo, wi),
            event: Event {
                lobe: R::int(0),
                transmitted: nothing | !reflects,
                is_delta: nothing,
                failed: no_side | (!nothing & !right_side),
            },
        }
    }

    #[inline]
    fn delta(&self, _wo: Vec3<R>, _prepared: &Prepared<R>, sample: &Sample<R>) -> Value<R> {
        // No interface: radiance is not scaled either.
        Value { f_cos: Rgb::splat(R::ONE), pdf: R::ONE }.or_zero(sample.event.is_delta & !sample.event.failed)
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
        Properties {
            transmits: true,
            has_delta: self.is_nothing().any(),
            all_delta: self.is_nothing().all(),
            anisotropic: !self.microfacets.is_isotropic().all(),
            ..Properties::LAWFUL
        }
    }

    #[inline(always)]
    fn largest_weight(&self, _wo: Vec3<R>) -> R {
        R::ONE
    }

    #[inline(always)]
    fn radiance_scale(&self, wo: Vec3<R>) -> R {
        R::select(self.is_nothing(), R::ONE, relative_index(self.eta, wo).sqr())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::microfacet::Ggx;
    use crate::testing::{Bare, Random};

    fn glass(alpha: f32, eta: f32) -> RoughDielectric<f32> {
        RoughDielectric::new(Ggx { alpha_x: alpha, alpha_y: 0.5 * alpha }, eta)
    }

    #[test]
    fn refraction_is_reciprocal_up_to_the_squares_of_the_indices() {
        let mut random = Random(23);
        let glass = RoughDielectric::new(Ggx { alpha_x: 0.4_f64, alpha_y: 0.2 }, 1.5);
        let mut compared = 0;
        let mut direction = || Vec3::from(<[f32; 3]>::from(random.direction()).map(f64::from)).normalize();
        for _ in 0..10_000 {
            let (a, b) = (direction(), direction());
            // f(wo, wi) η_i² = f(wi, wo) η_o²
            let (there, back) = (glass.value(a, b).f_cos.g / b.z.abs(), glass.value(b, a).f_cos.g / a.z.abs());
            let square = |w: Vec3<f64>| if w.z > 0.0 { 1.0 } else { 2.25 };
            let (there, back) = (there * square(b), back * square(a));
            assert!((there - back).abs() <= 1e-10 * there.max(1e-6), "{a:?} {b:?}: {there} and {back}");
            compared += u32::from(a.z * b.z < 0.0 && there > 0.0);
        }
        assert!(compared > 1000, "{compared}");
    }

    #[test]
    fn no_sample_of_ground_glass_weighs_more_than_one() {
        let mut random = Random(24);
        for (alpha, eta) in [(1e-3, 1.5), (0.3, 0.7), (1.0, 2.4)] {
            let glass = glass(alpha, eta);
            for _ in 0..2000 {
                let wo = random.direction();
                let sample = glass.draw(wo, [random.unit(), random.unit(), random.unit()]);
                if sample.event.failed {
                    continue;
                }
                let value = glass.value(wo, sample.wi);
                let energy = value.f_cos.r * if sample.event.transmitted { glass.radiance_scale(wo) } else { 1.0 };
                assert!(value.pdf > 0.0 && energy <= value.pdf * (1.0 + 1e-5), "{wo:?} {sample:?} {value:?}");
            }
        }
    }

    #[test]
    fn an_interface_between_equal_indices_is_none() {
        let nothing = glass(0.5, 1.000_000_1);
        let wo = Vec3::new(0.6, 0.0, -0.8);
        let sample = nothing.draw(wo, [0.3, 0.5, 0.5]);
        assert!(sample.event.is_delta && sample.event.transmitted && sample.wi == -wo);
        assert_eq!(nothing.delta_of(wo, &sample).f_cos.b, 1.0);
        assert_eq!(nothing.value(wo, sample.wi).pdf, 0.0);
    }
}
