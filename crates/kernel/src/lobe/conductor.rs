//! A rough reflector: mirrors of GGX- or Beckmann-distributed normals. A metal, or the reflecting part of a dielectric.
//!
//! $$ f = \frac{F(\omega_o \cdot m)\\,D(m)\\,G_2(\omega_o, \omega_i)}{4\\,c_o\\,c_i} $$
//!
//! with m the half vector (Cook & Torrance 1982; Walter et al. 2007), masking height-correlated unless told otherwise.
//! Reciprocal; conserves energy, but loses the light that would be scattered more than once: up to 69 % of it at α = 1.
//! Visible normals are sampled, GGX within the bound of Eto & Tokuyoshi 2023, so weights never exceed F; samples that leave
//! below the horizon fail.
//!
//! **Compensation** ([`crate::energy`]; GGX with height-correlated masking only). Kulla & Conty's lobe is sampled apart, with
//! the probability 1 − E(wo), along its own shape: reciprocal, a white surface returns all light to 1e-4, no sample weighs
//! more than 4. Turquin's factor changes no sample: not reciprocal, weights up to 1/E(wo) ≤ 3.3. Both conserve energy if
//! isotropic; for α_x ≠ α_y a white surface may return up to 4 % too much ([`effective_alpha`]).
//!
//! Cost of a value: two divisions and two roots, and for a conductor's Fresnel one division and six roots more; its density
//! takes no further one. Kulla & Conty's lobe: Fresnel's reflectance at two more cosines, about ten divisions and 300
//! multiplications. What depends on wo alone (s(wo), the reach of visible normals, 1 − E(wo)) or on the material alone
//! (1 − E_avg) is prepared once per closure.

use super::{Event, Lobe, Properties, Sample, Transport, Value};
use crate::energy::{
    Compensation, Missing, effective_alpha, kulla_conty, missing_avg, multiple_fresnel, pdf_multiple, sample_multiple,
    scattered_again, turquin,
};
use crate::frame::both_above;
use crate::fresnel::Fresnel;
use crate::microfacet::{Distribution, Masking, Microfacets, Reach, pdf_visible_reflected, reflect, vis_cos_i};
use crate::model::Parameters;
use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::vec3::Vec3;

crate::model! {
    /// A rough metal, or the reflecting part of a rough dielectric. Reflects on the side of the normal only.
    pub struct Conductor<R> = "conductor" {
        /// The distribution of microfacet normals.
        microfacets: Microfacets<R>,
        /// How masking and shadowing go together.
        masking: Masking = HeightCorrelated,
        /// What the microfacets are made of.
        fresnel: Fresnel<R>,
        /// What becomes of light that meets more than one facet; anything but "none" needs "ggx" with "correlated".
        compensation: Compensation = None,
    }
    rule |it| R::Mask::splat(it.compensation == Compensation::None || it.is_ggx_correlated())
        => "\"compensation\" needs the distribution \"ggx\" and the masking \"correlated\"";
    coat |it| if it.is_ggx_correlated() && it.compensation == Compensation::None {
        // For anisotropic facets no more than a bound is known: that of the narrower alpha, raised.
        let [x, y] = it.microfacets.alphas();
        it.fresnel.albedo_curve(x.min(y)).map(|curve| curve.raised(!it.microfacets.is_isotropic()))
    } else {
        None
    };
}

/// What depends on wo alone.
#[derive(Clone, Copy, Debug)]
pub struct Prepared<R> {
    /// s(wo).
    s_o: R,
    /// The visible normals that are sampled.
    reach: Reach<R>,
    /// 1 − E(wo), where it is asked for.
    missing_o: R,
    /// 1 − E_avg, where it is asked for.
    mean: R,
}

impl<R> Conductor<R> {
    /// A rough reflector with height-correlated masking.
    pub fn new(microfacets: impl Into<Microfacets<R>>, fresnel: Fresnel<R>) -> Self {
        Self {
            microfacets: microfacets.into(),
            masking: Masking::HeightCorrelated,
            fresnel,
            compensation: Compensation::None,
        }
    }

    /// The same with light that meets more than one facet given back.
    pub fn with_compensation(self, compensation: Compensation) -> Self {
        Self { compensation, ..self }
    }

    /// The same with another masking.
    pub fn with_masking(self, masking: Masking) -> Self {
        Self { masking, ..self }
    }
}

impl<R: Real> Conductor<R> {
    /// The alpha whose losses count.
    #[inline(always)]
    fn alpha(&self) -> R {
        let [alpha_x, alpha_y] = self.microfacets.alphas();
        effective_alpha(alpha_x, alpha_y)
    }

    #[inline(always)]
    fn is_ggx_correlated(&self) -> bool {
        self.microfacets.distribution == Distribution::Ggx && self.masking == Masking::HeightCorrelated
    }

    /// Kulla & Conty's lobe beside the single scattering, with 1 − E(wo) and 1 − E_avg given; cosines in (0, 1].
    #[inline(always)]
    fn with_multiple(&self, single: Value<R>, [missing_o, mean]: [R; 2], cos_o: R, cos_i: R) -> Value<R> {
        let alpha = self.alpha();
        let missing_i = Missing::of(alpha).at(cos_i);
        let again = scattered_again(alpha, missing_o, missing_i, mean);
        let multiple = self
            .fresnel
            .of_facets(alpha, cos_o, cos_i)
            .map(|f| kulla_conty(missing_o, missing_i, mean, multiple_fresnel(f, again)));
        Value {
            f_cos: single.f_cos + multiple * cos_i,
            pdf: (R::ONE - missing_o).mul_add(single.pdf, missing_o * pdf_multiple(alpha, cos_i)),
        }
    }
}

/// The cosine of a direction above the surface, in (0, 1].
#[inline(always)]
fn cosine<R: Real>(w: Vec3<R>) -> R {
    w.z.max(R::lit(1e-38)).min(R::ONE)
}

impl<R: Real> Lobe<R> for Conductor<R> {
    type Prepared = Prepared<R>;

    #[inline(always)]
    fn prepare(&self, wo: Vec3<R>, _transport: Transport) -> Prepared<R> {
        let missing_o = match self.compensation {
            Compensation::None => R::ZERO,
            _ => Missing::of(self.alpha()).at(cosine(wo)),
        };
        let mean = match self.compensation {
            Compensation::KullaConty => missing_avg(self.alpha()),
            _ => R::ZERO,
        };
        let s_o = self.microfacets.smith_length(wo);
        Prepared { s_o, reach: self.microfacets.reach(wo, s_o), missing_o, mean }
    }

    #[inline(always)]
    fn eval(&self, wo: Vec3<R>, prepared: &Prepared<R>, wi: Vec3<R>) -> Value<R> {
        let Prepared { s_o, reach, missing_o, mean } = *prepared;
        let h = wo + wi;
        let h2 = h.length2();
        let s_i = self.microfacets.smith_length(wi);
        let d = self.microfacets.d(h, h2);
        // wo·m = |h|/2 for unit directions: no cancellation at grazing, and never above 1 but by rounding.
        let cos2_m = (h2 * R::lit(0.25)).min(R::ONE);
        let f = self.fresnel.reflectance_of_squared(cos2_m.sqrt(), cos2_m);
        let f_cos = f * (d * vis_cos_i(self.masking, wo.z, s_o, wi.z, s_i));
        let pdf = pdf_visible_reflected(d, reach);
        let single = Value { f_cos, pdf };
        let value = match self.compensation {
            Compensation::None => single,
            Compensation::KullaConty => self.with_multiple(single, [missing_o, mean], cosine(wo), cosine(wi)),
            Compensation::Turquin => {
                let f0 = self.fresnel.reflectance(R::ONE);
                Value { f_cos: f_cos * f0.map(|f0| turquin(f0, missing_o)), pdf }
            }
        };
        value.or_zero(both_above(wo, wi))
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, prepared: &Prepared<R>, u: [R; 3]) -> Sample<R> {
        let Prepared { s_o, reach, missing_o, .. } = *prepared;
        let mut wi = reflect(wo, self.microfacets.sample_visible(wo, s_o, reach, [u[1], u[2]]));
        if self.compensation == Compensation::KullaConty {
            wi = Vec3::select(u[0].lt(missing_o), sample_multiple(self.alpha(), [u[1], u[2]]), wi);
        }
        Sample { wi, event: Event::reflected(!both_above(wo, wi)) }
    }

    #[inline(always)]
    fn delta(&self, _wo: Vec3<R>, _prepared: &Self::Prepared, _sample: &Sample<R>) -> Value<R> {
        Value::zero()
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
        self.fresnel.reflectance(wo.z.max(R::ZERO).min(R::ONE))
    }

    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.in_domain()
    }

    /// What is compensated exceeds all light by 1e-4 at most if isotropic, else by 4 %. Kulla & Conty's lobe is a product of two
    /// losses, each right to 6 units of the last place: where both directions are as steep their errors are the same, and add.
    #[inline(always)]
    fn properties(&self) -> Properties<R> {
        let isotropic = self.microfacets.is_isotropic().all();
        let excess = match self.compensation {
            Compensation::None => 0.0,
            _ if isotropic => 1e-4,
            _ => 0.04,
        };
        let units = if self.compensation == Compensation::KullaConty { 12.0 } else { 8.0 };
        let white = match self.fresnel {
            Fresnel::Schlick { f0 } => (f0.r.same(R::ONE) & f0.g.same(R::ONE) & f0.b.same(R::ONE)).all(),
            _ => false,
        };
        let all_returned = white && isotropic && self.compensation == Compensation::KullaConty;
        let reciprocal = self.compensation != Compensation::Turquin;
        Properties {
            reciprocal,
            symmetric: reciprocal,
            anisotropic: !isotropic,
            excess,
            units,
            // Beckmann's steep slopes are reached from two places, and Kulla & Conty's lobe has a sampler of its own.
            one_to_one: self.microfacets.distribution == Distribution::Ggx
                && self.compensation != Compensation::KullaConty,
            albedo: all_returned.then_some(Rgb::splat(R::ONE)),
            ..Properties::LAWFUL
        }
    }

    #[inline(always)]
    fn largest_weight(&self, _wo: Vec3<R>) -> R {
        R::lit(match self.compensation {
            Compensation::None => 1.0,
            Compensation::KullaConty => 4.0,
            Compensation::Turquin => 3.3,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::microfacet::Ggx;
    use crate::testing::{Bare, Random};

    #[test]
    fn no_sample_of_a_rough_conductor_weighs_more_than_its_fresnel_reflectance() {
        let mut random = Random(3);
        for alpha in [1e-3_f32, 0.1, 1.0] {
            let ggx = Ggx { alpha_x: alpha, alpha_y: 0.5 * alpha };
            let white = Conductor::new(ggx, Fresnel::Schlick { f0: Rgb::splat(1.0) });
            for _ in 0..1000 {
                let wo = random.above();
                let sample = white.draw(wo, [random.unit(), random.unit(), random.unit()]);
                let value = white.value(wo, sample.wi);
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
            let (there, back) = (conductor.value(a, b).f_cos.g * a.z, conductor.value(b, a).f_cos.g * b.z);
            assert!((there - back).abs() <= 1e-6 * there, "{a:?} {b:?}: {there} and {back}");
        }
    }
}
