//! `Closure`: a surface seen from one direction wo. The only place that mixes lobes, and the only guard.
//!
//! **Mixture.** f_cos = Σ wᵢ fᵢ. A lobe is chosen with probability pᵢ proportional to the luminance of its weighted albedo
//! estimate, so an absent or black lobe has probability exactly 0. The continuous density is Σ pᵢ·pdfᵢ over the continuous
//! lobes, not renormalised by the discrete probability; a discrete event has probability pᵢ times its own.
//!
//! **Guard.** Outside the domain (a direction that is not finite or not unit to 1e-3 in |w|², a parameter out of range)
//! every value is exactly zero and every sample fails with a finite unit `wi`. [`Unguarded`] is the same mixture without
//! that guard, for instruments that must see what the formulas do by themselves.

use crate::lobe::{Event, Lobe, Prepared, Sample, Value};
use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::surface::{MAX_LOBES, Surface, Weighted};
use crate::vec3::Vec3;

/// What a path carries from wi to wo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Radiance, as seen by a camera: compressed by 1/η² where it crosses into another medium.
    Radiance,
    /// Importance, or particles of light: energy as it is.
    Importance,
}

/// A surface prepared at wo, total over all bit patterns.
#[derive(Clone, Copy, Debug)]
pub struct Closure<'a, R: Real> {
    mixture: Unguarded<'a, R>,
    valid: R::Mask,
}

impl<'a, R: Real> Closure<'a, R> {
    /// The surface seen from the local unit direction wo.
    #[inline(always)]
    pub fn new(surface: &'a Surface<R>, wo: Vec3<R>) -> Self {
        Self { mixture: Unguarded::new(surface, wo), valid: wo.is_direction() & surface.domain() }
    }

    /// The same, carrying something else than radiance.
    #[inline(always)]
    pub fn carrying(self, transport: Transport) -> Self {
        Self { mixture: self.mixture.carrying(transport), ..self }
    }

    /// f·|cos_i| \[1/sr\] and density \[1/sr\] of the continuous lobes at wi.
    #[inline(always)]
    pub fn eval(&self, wi: Vec3<R>) -> Value<R> {
        let value = self.mixture.eval(wi);
        value.or_zero(self.valid & wi.is_direction() & value.is_sound())
    }

    /// A direction wi for the uniform numbers u in [0, 1).
    #[inline(always)]
    pub fn sample(&self, u: [R; 3]) -> Sample<R> {
        let Sample { wi, event } = self.mixture.sample(u);
        let ok = self.valid & wi.is_direction();
        Sample { wi: Vec3::select(ok, wi, Vec3::unit_z()), event: Event { failed: event.failed | !ok, ..event } }
    }

    /// Weight times probability, and probability, of a discrete event that [`Closure::sample`] returned.
    #[inline(always)]
    pub fn discrete(&self, event: &Event<R>) -> Value<R> {
        let value = self.mixture.discrete(event);
        value.or_zero(self.valid & value.is_sound())
    }

    /// Whether wo and the parameters lie in the domain.
    #[inline(always)]
    pub fn valid(&self) -> R::Mask {
        self.valid
    }
}

/// The mixture itself: finite and non-negative inside the domain, anything at all outside.
#[derive(Clone, Copy, Debug)]
pub struct Unguarded<'a, R: Real> {
    surface: &'a Surface<R>,
    wo: Vec3<R>,
    p: [R; MAX_LOBES],
    prepared: [Prepared<R>; MAX_LOBES],
    transport: Transport,
}

impl<'a, R: Real> Unguarded<'a, R> {
    /// The surface seen from the local unit direction wo.
    #[inline(always)]
    pub fn new(surface: &'a Surface<R>, wo: Vec3<R>) -> Self {
        let mut p = [R::ZERO; MAX_LOBES];
        let mut lobes = surface.lobes();
        if let (Some(only), None) = (lobes.next(), lobes.next()) {
            // One lobe needs no estimate, unless it is absent where its weight is 0.
            p[0] = R::ONE.or_zero(only.weight.gt(R::ZERO));
        } else {
            let mut sum = R::ZERO;
            for (p, l) in p.iter_mut().zip(surface.lobes()) {
                *p = l.weight * l.lobe.albedo_estimate(wo).luminance();
                sum += *p;
            }
            let scale = sum.recip().or_zero(sum.gt(R::ZERO));
            for p in &mut p {
                *p *= scale;
            }
        }
        let mut prepared = [Prepared([R::ZERO; 5]); MAX_LOBES];
        for (prepared, l) in prepared.iter_mut().zip(surface.lobes()) {
            *prepared = l.lobe.prepare(wo);
        }
        Self { surface, wo, p, prepared, transport: Transport::Radiance }
    }

    /// The same, carrying something else.
    #[inline(always)]
    pub fn carrying(self, transport: Transport) -> Self {
        Self { transport, ..self }
    }

    /// A lobe's value in the transport at hand, `through` where it is transmitted.
    #[inline(always)]
    fn carried(&self, l: &Weighted<R>, f_cos: Rgb<R>, through: R::Mask) -> Rgb<R> {
        match self.transport {
            Transport::Radiance => f_cos,
            Transport::Importance => f_cos * R::select(through, l.lobe.compression(self.wo), R::ONE),
        }
    }

    /// See [`Closure::eval`].
    #[inline(always)]
    pub fn eval(&self, wi: Vec3<R>) -> Value<R> {
        let mut sum = Value::zero();
        for ((l, &p), prepared) in self.surface.lobes().zip(&self.p).zip(&self.prepared) {
            let value = l.lobe.eval_prepared(self.wo, prepared, wi);
            let through = (self.wo.z * wi.z).lt(R::ZERO);
            sum.f_cos += self.carried(l, value.f_cos, through) * l.weight;
            sum.pdf += p * value.pdf;
        }
        sum
    }

    /// See [`Closure::sample`].
    #[inline(always)]
    pub fn sample(&self, u: [R; 3]) -> Sample<R> {
        let mut chosen = Sample { wi: Vec3::unit_z(), event: Event::reflected(R::Mask::splat(true)) };
        let mut below = R::ZERO;
        for (((l, &p), prepared), index) in self.surface.lobes().zip(&self.p).zip(&self.prepared).zip(0..) {
            let above = below + p;
            let mine = u[0].ge(below) & u[0].lt(above);
            if mine.any() {
                // What is left of u₀ inside this lobe's share is uniform again; below 1 even after rounding.
                let rest = ((u[0] - below) / p).max(R::ZERO).min(R::lit(0.999_999_94));
                let s = l.lobe.sample_prepared(self.wo, prepared, [rest, u[1], u[2]]);
                chosen.wi = Vec3::select(mine, s.wi, chosen.wi);
                chosen.event = Event::select(mine, Event { lobe: R::int(index), ..s.event }, chosen.event);
            }
            below = above;
        }
        chosen
    }

    /// See [`Closure::discrete`].
    #[inline(always)]
    pub fn discrete(&self, event: &Event<R>) -> Value<R> {
        let mut sum = Value::zero();
        for ((l, &p), index) in self.surface.lobes().zip(&self.p).zip(0..) {
            let mine = R::int_same(event.lobe, R::int(index)) & event.discrete & !event.failed;
            if mine.any() {
                let value = l.lobe.discrete(self.wo, event);
                // The strength is wR whatever p is: divided by the probability it weighs wR/p. Masked last, so that a lane
                // with a p that is not finite leaves its neighbours alone.
                let f_cos = self.carried(l, value.f_cos, event.transmitted);
                sum.f_cos += (f_cos * l.weight).or_zero(mine);
                sum.pdf += (p * value.pdf).or_zero(mine);
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fresnel::Fresnel;
    use crate::lobe::{Conductor, Lambert, Mirror};
    use crate::microfacet::Ggx;
    use crate::testing::{Random, close, special_values};

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
    fn values_add_and_densities_average_by_the_probability_of_their_lobe() {
        let mut random = Random(11);
        let surface = Surface::black().with(0.5, matte()).with(0.25, mirror()).with(0.75, metal());
        for _ in 0..1000 {
            let (wo, wi) = (random.above(), random.above());
            let value = Closure::new(&surface, wo).eval(wi);
            let (a, b) = (matte().eval(wo, wi), metal().eval(wo, wi));
            let luminance = |lobe: &dyn Lobe<f32>| lobe.albedo_estimate(wo).luminance();
            let shares = [0.5 * luminance(&matte()), 0.25 * luminance(&mirror()), 0.75 * luminance(&metal())];
            let sum: f32 = shares.iter().sum();
            let pdf = (shares[0] * a.pdf + shares[2] * b.pdf) / sum;
            assert!(close((value.pdf / pdf).into(), 1.0, 1e-5), "{value:?} and {pdf}");
            assert!(close((value.f_cos.g / (0.5 * a.f_cos.g + 0.75 * b.f_cos.g)).into(), 1.0, 1e-5));
        }
    }

    #[test]
    fn the_mirror_of_a_mixture_is_chosen_and_weighed_as_a_discrete_event() {
        let wo = Vec3::new(0.6_f32, 0.0, 0.8);
        let surface = Surface::black().with(0.5, Lambert::new(Rgb::splat(0.5))).with(0.5, mirror());
        let closure = Closure::new(&surface, wo);
        let (first, second) = (closure.sample([0.25, 0.5, 0.5]), closure.sample([0.75, 0.5, 0.5]));
        assert!(!first.event.discrete && first.event.lobe == 0 && closure.discrete(&first.event).pdf == 0.0);
        assert!(second.event.discrete && second.event.lobe == 1);
        assert_eq!(second.wi, Vec3::new(-0.6, 0.0, 0.8));
        // Half of 0.5 is reflected like this, and half of the samples carry it: each is worth 0.25/0.5.
        let worth = closure.discrete(&second.event);
        assert!(close(worth.pdf.into(), 0.5, 1e-6) && close(worth.f_cos.r.into(), 0.25, 1e-6));
    }

    #[test]
    fn a_lobe_that_is_absent_or_black_is_never_chosen() {
        let mut random = Random(12);
        let absent = Surface::black().with(0.0, mirror()).with(1.0, matte());
        let black = Surface::black().with(1.0, Mirror::new(Rgb::zero())).with(1.0, matte());
        for surface in [absent, black] {
            for _ in 0..1000 {
                let sample = Closure::new(&surface, random.above()).sample([random.unit(), 0.5, 0.5]);
                assert!(sample.event.failed || sample.event.lobe == 1);
            }
        }
        assert!(Closure::new(&Surface::black(), Vec3::<f32>::unit_z()).sample([0.5; 3]).event.failed);
    }

    fn assert_black(surface: &Surface<f32>, wo: Vec3<f32>, wi: Vec3<f32>, u: [f32; 3]) {
        let closure = Closure::new(surface, wo);
        let (value, sample) = (closure.eval(wi), closure.sample(u));
        let worth = closure.discrete(&sample.event);
        for x in [value.f_cos.r, value.f_cos.g, value.f_cos.b, value.pdf, worth.f_cos.r, worth.pdf] {
            assert_eq!(x.to_bits(), 0, "{wo:?} {wi:?}: {value:?} {worth:?}");
        }
        assert!(sample.event.failed && sample.wi.is_direction(), "{wo:?}: {sample:?}");
    }

    #[test]
    fn outside_the_domain_everything_is_exactly_zero() {
        let up = Vec3::unit_z();
        let surface = Surface::black().with(0.5, matte()).with(0.25, mirror()).with(0.25, metal());
        for x in special_values() {
            let bad = Vec3::new(x, 0.3, 0.9); // never a unit vector
            assert_black(&surface, bad, up, [0.5; 3]);
            let value = Closure::new(&surface, up).eval(bad);
            assert_eq!((value.pdf.to_bits(), value.f_cos.g.to_bits()), (0, 0), "{bad:?}");
            if !(0.0..=1.0).contains(&x) {
                assert_black(&Surface::of(Lambert::new(Rgb::new(0.5, x, 0.5))), up, up, [0.5; 3]);
                assert_black(&Surface::black().with(x, mirror()), up, up, [0.5; 3]);
            }
        }
    }
}
