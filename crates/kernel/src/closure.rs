//! `Closure`: a surface seen from one direction wo. The only place that mixes lobes, and the only guard.
//!
//! **Mixture.** f_cos = Σ wᵢ fᵢ. A lobe is chosen with probability pᵢ proportional to the luminance of its weighted albedo
//! estimate, so an absent or black lobe has probability exactly 0. The continuous density is Σ pᵢ·pdfᵢ over the continuous
//! lobes, not renormalised by the discrete probability; a discrete event has probability pᵢ times its own.
//!
//! **Guard.** Outside the domain (a direction that is not finite or not unit to 1e-3 in |w|², a parameter out of range)
//! every value is exactly zero and every sample fails with a finite unit `wi`. [`Unguarded`] is the same mixture without
//! that guard, for instruments that must see what the formulas do by themselves.

use crate::lobe::{Event, Lobe, Sample, Value};
use crate::real::{Mask, Real};
use crate::surface::{MAX_LOBES, Surface};
use crate::vec3::Vec3;

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
        Self { surface, wo, p }
    }

    /// See [`Closure::eval`].
    #[inline(always)]
    pub fn eval(&self, wi: Vec3<R>) -> Value<R> {
        let mut sum = Value::zero();
        for (l, &p) in self.surface.lobes().zip(&self.p) {
            let value = l.lobe.eval(self.wo, wi);
            sum.f_cos += value.f_cos * l.weight;
            sum.pdf += p * value.pdf;
        }
        sum
    }

    /// See [`Closure::sample`].
    #[inline(always)]
    pub fn sample(&self, u: [R; 3]) -> Sample<R> {
        let mut chosen = Sample { wi: Vec3::unit_z(), event: Event::reflected(R::Mask::splat(true)) };
        let mut below = R::ZERO;
        for ((l, &p), index) in self.surface.lobes().zip(&self.p).zip(0..) {
            let above = below + p;
            let mine = u[0].ge(below) & u[0].lt(above);
            if mine.any() {
                // What is left of u₀ inside this lobe's share is uniform again; below 1 even after rounding.
                let rest = ((u[0] - below) / p).max(R::ZERO).min(R::lit(0.999_999_94));
                let s = l.lobe.sample(self.wo, [rest, u[1], u[2]]);
                chosen.wi = Vec3::select(mine, s.wi, chosen.wi);
                chosen.event = Event {
                    lobe: R::int_select(mine, R::int(index), chosen.event.lobe),
                    transmitted: (mine & s.event.transmitted) | (!mine & chosen.event.transmitted),
                    discrete: (mine & s.event.discrete) | (!mine & chosen.event.discrete),
                    failed: (mine & s.event.failed) | (!mine & chosen.event.failed),
                };
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
                let value = l.lobe.discrete(self.wo, event).or_zero(mine);
                sum.f_cos += value.f_cos * (l.weight * p);
                sum.pdf += p * value.pdf;
            }
        }
        sum
    }
}
