//! `Surface`: a list of lobes whose number is known at run time only, mixed and layered.
//!
//! The lobes stand from the top down. Their light adds, each times its colour; a lobe that was put on as a coat
//! ([`Surface::coat`]) attenuates all that come after it ([`crate::lobe::Layer`] says how). A lobe is chosen with a probability
//! proportional to the luminance of what it returns, so an absent or black lobe has probability exactly 0. The continuous density is
//! Σ pᵢ·pdfᵢ, not renormalised by the probability of delta events.
//!
//! A surface of one lobe without a coat costs what the lobe costs. One of several prepares its lobes anew in each call: arrays of
//! prepared data would have to be filled and moved, which costs more (measured: twelve slots, two lobes, eight lanes: 187 → 80 ns).

mod parameters;

pub use crate::roughness::{Alpha, Roughness};

use crate::energy::AlbedoCurve;
use crate::lobe::{
    AnyLobe, Coat, Event, Layering, Lobe, Properties, Sample, Transport, Value, Weighted, either_scale, rest_of,
};
use crate::model::Parameters;
use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::vec3::Vec3;
use core::fmt;

/// A lobe does not fit: the surface would not be what was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SurfaceError {
    /// All places for lobes are taken.
    Full,
    /// All places for coats are taken.
    TooManyCoats,
    /// Nothing shines through the lobe: it cannot be a coat.
    NoCoat,
}

impl fmt::Display for SurfaceError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Full => "the surface has no room for a further lobe",
            Self::TooManyCoats => "the surface has no room for a further coat",
            Self::NoCoat => "nothing shines through this lobe: it cannot be a coat",
        })
    }
}
impl core::error::Error for SurfaceError {}

/// At most N lobes of type L, from the top down, of which at most C are coats. Without lobes it absorbs everything.
///
/// ```
/// use gonio_kernel::{Closure, Rgb, Surface, Vec3, lobe::{Lambert, Mirror}};
///
/// let chalk = Lambert::new(Rgb::splat(0.8_f32));
/// let half: Surface<f32> = Surface::black().with(0.5, chalk)?.with(0.5, Mirror::new(Rgb::splat(1.0)))?;
/// let closure = Closure::new(&half, Vec3::unit_z());
/// assert!(closure.sample([0.9, 0.5, 0.5]).event.is_delta);
/// # Ok::<(), gonio_kernel::surface::SurfaceError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Surface<R, L = AnyLobe<'static, R>, const N: usize = 4, const C: usize = 1> {
    lobes: [Option<Weighted<R, L>>; N],
    coats: [Option<Placed<R>>; C],
}

/// A coat, and which lobe it is.
#[derive(Clone, Copy, Debug)]
struct Placed<R> {
    top: usize,
    coat: Coat<R>,
}

impl<R: Real> Surface<R> {
    /// A surface of the kernel's lobes that absorbs everything.
    pub const fn black() -> Self {
        Self::empty()
    }
    /// A surface of one of the kernel's lobes.
    pub fn of(lobe: impl Into<AnyLobe<'static, R>>) -> Self {
        let mut surface = Self::black();
        if let Some(slot) = surface.lobes.first_mut() {
            *slot = Some(Weighted { weight: Rgb::splat(R::ONE), lobe: lobe.into() });
        }
        surface
    }
}

impl<R: Real, L, const N: usize, const C: usize> Surface<R, L, N, C>
where
    L: Copy,
{
    /// A surface that absorbs everything, for any type of lobes and number of places.
    pub const fn empty() -> Self {
        Self { lobes: [None; N], coats: [None; C] }
    }

    /// This surface and one lobe more below the others, times a factor or colour in \[0, 1\].
    ///
    /// # Errors
    /// There is no room for it.
    pub fn with(mut self, weight: impl Into<Rgb<R>>, lobe: impl Into<L>) -> Result<Self, SurfaceError> {
        let slot = self.lobes.iter_mut().find(|slot| slot.is_none()).ok_or(SurfaceError::Full)?;
        *slot = Some(Weighted { weight: weight.into(), lobe: lobe.into() });
        Ok(self)
    }

    /// The lobes in order.
    #[inline(always)]
    pub fn lobes(&self) -> impl Iterator<Item = &Weighted<R, L>> {
        self.lobes.iter().map_while(Option::as_ref)
    }

    /// The lobe, if there is one alone, without a coat. Where it is asked once for many calls, `Closure::new(only, wo)` costs them
    /// nothing.
    #[inline(always)]
    pub fn only(&self) -> Option<&Weighted<R, L>> {
        match (self.lobes.as_slice(), self.coats.first()) {
            ([Some(only)] | [Some(only), None, ..], None | Some(None)) => Some(only),
            _ => None,
        }
    }
}

impl<R: Real, L: Parameters<Real = R>, const N: usize, const C: usize> Surface<R, L, N, C> {
    /// This surface and one lobe more below the others, as a coat: it attenuates all that are added after it. Through a dielectric
    /// whose index is not in \[1, 3\] nothing is known to shine: what lies below is black.
    ///
    /// # Errors
    /// There is no room for it, or nothing shines through it.
    ///
    /// ```
    /// use gonio_kernel::{Rgb, Surface, fresnel::Fresnel, microfacet::Ggx};
    /// use gonio_kernel::lobe::{Conductor, Lambert, Layering};
    ///
    /// let coat = Conductor::new(Ggx::isotropic(0.04_f32), Fresnel::Dielectric { eta: 1.5 });
    /// let base = Lambert::new(Rgb::new(0.7, 0.1, 0.1));
    /// let plastic: Surface<f32> = Surface::black().coat(1.0, coat, Layering::Reciprocal)?.with(1.0, base)?;
    /// # Ok::<(), gonio_kernel::surface::SurfaceError>(())
    /// ```
    pub fn coat(
        mut self,
        weight: impl Into<Rgb<R>>,
        lobe: impl Into<L>,
        layering: Layering,
    ) -> Result<Self, SurfaceError> {
        let top = self.lobes.iter().position(Option::is_none).ok_or(SurfaceError::Full)?;
        let lobe = Weighted { weight: weight.into(), lobe: lobe.into() };
        let albedo = lobe.albedo_curve().ok_or(SurfaceError::NoCoat)?;
        let slot = self.coats.iter_mut().find(|slot| slot.is_none()).ok_or(SurfaceError::TooManyCoats)?;
        *slot = Some(Placed { top, coat: Coat::new(albedo, layering) });
        self.with(lobe.weight, lobe.lobe)
    }

    /// From other lobes, with the coats of a surface of the same kind.
    #[inline]
    fn like(lobes: [Option<Weighted<R, L>>; N], layerings: [Option<(usize, Layering)>; C]) -> Self {
        let coats = layerings.map(|placed| {
            let (top, layering) = placed?;
            let albedo = lobes.get(top)?.as_ref()?.albedo_curve();
            let albedo = albedo.unwrap_or(AlbedoCurve::constant(Rgb::splat(R::ONE)));
            Some(Placed { top, coat: Coat::new(albedo, layering) })
        });
        Self { lobes, coats }
    }

    #[inline(always)]
    fn layerings(&self) -> [Option<(usize, Layering)>; C] {
        self.coats.map(|placed| placed.map(|p| (p.top, p.coat.layering())))
    }
}

/// What a [`Surface`] prepares.
#[derive(Clone, Copy, Debug)]
pub struct Prepared<R, P, const N: usize, const C: usize> {
    /// The probability of each lobe.
    p: [R; N],
    /// T(wo) of each coat.
    transmitted: [Rgb<R>; C],
    /// What the only lobe prepares.
    only: Option<P>,
    transport: Transport,
}

#[inline(never)]
fn eval_anew<R: Real, L: Lobe<R>>(lobe: &L, wo: Vec3<R>, transport: Transport, wi: Vec3<R>) -> Value<R> {
    lobe.eval(wo, &lobe.prepare(wo, transport), wi)
}
#[inline(never)]
fn sample_anew<R: Real, L: Lobe<R>>(lobe: &L, wo: Vec3<R>, transport: Transport, u: [R; 3]) -> Sample<R> {
    lobe.sample(wo, &lobe.prepare(wo, transport), u)
}

impl<R: Real, L: Lobe<R> + Copy, const N: usize, const C: usize> Surface<R, L, N, C> {
    /// What the coats above lobe `index` leave of it, given what `of` says of each.
    #[inline(always)]
    fn below_coats(
        &self,
        index: usize,
        lambertian: bool,
        of: impl Fn(&Coat<R>, usize, bool) -> Rgb<R>,
    ) -> Option<Rgb<R>> {
        let above = self.coats.iter().flatten().take_while(|placed| placed.top < index).count();
        let each = self.coats.iter().flatten().take(above).enumerate();
        // Only the coat next to a Lambertian lobe may divide by T_avg: those above see what that coat lets through.
        each.fold(None, |all, (i, placed)| {
            let one = of(&placed.coat, i, lambertian && i + 1 == above);
            Some(all.map_or(one, |all: Rgb<R>| all * one))
        })
    }

    #[inline(always)]
    fn transmitted(&self, wo: Vec3<R>) -> [Rgb<R>; C] {
        self.coats.map(|placed| placed.map_or(Rgb::splat(R::ONE), |p| p.coat.transmitted(wo)))
    }

    /// What each lobe returns of the light from wo, about.
    #[inline(always)]
    fn returned(&self, wo: Vec3<R>, transmitted: &[Rgb<R>; C]) -> impl Iterator<Item = Rgb<R>> {
        self.lobes().enumerate().map(move |(index, lobe)| {
            let own = lobe.albedo_estimate(wo);
            let through = self.below_coats(index, false, |_, i, _| transmitted.get(i).copied().unwrap_or(Rgb::zero()));
            through.map_or(own, |through| own * through)
        })
    }

    #[inline]
    fn probabilities(&self, wo: Vec3<R>, transmitted: &[Rgb<R>; C]) -> [R; N] {
        let mut p = [R::ZERO; N];
        let mut sum = R::ZERO;
        for (p, returned) in p.iter_mut().zip(self.returned(wo, transmitted)) {
            *p = returned.luminance();
            sum += *p;
        }
        let scale = sum.recip().or_zero(sum.gt(R::ZERO));
        for p in &mut p {
            *p *= scale;
        }
        p
    }

    /// A lobe's light as the coats above it leave it.
    #[inline(always)]
    fn attenuated(
        &self,
        (index, lobe): (usize, &Weighted<R, L>),
        transmitted: &[Rgb<R>; C],
        (wo, wi): (Vec3<R>, Vec3<R>),
        f_cos: Rgb<R>,
    ) -> Rgb<R> {
        let left = self.below_coats(index, lobe.is_lambertian(), |coat, i, lambertian| {
            coat.attenuation(transmitted.get(i).copied().unwrap_or(Rgb::zero()), wo, wi, lambertian)
        });
        left.map_or(f_cos, |left| f_cos * left)
    }

    #[inline(never)]
    fn eval_sum(&self, wo: Vec3<R>, prepared: &Prepared<R, L::Prepared, N, C>, wi: Vec3<R>) -> Value<R> {
        let mut sum = Value::zero();
        for ((index, lobe), &p) in self.lobes().enumerate().zip(&prepared.p) {
            let value = eval_anew(lobe, wo, prepared.transport, wi);
            sum.f_cos += self.attenuated((index, lobe), &prepared.transmitted, (wo, wi), value.f_cos);
            sum.pdf += p * value.pdf;
        }
        sum
    }

    #[inline(never)]
    fn sample_one(&self, wo: Vec3<R>, prepared: &Prepared<R, L::Prepared, N, C>, u: [R; 3]) -> Sample<R> {
        let mut chosen = Sample::nothing();
        let mut below = R::ZERO;
        for ((lobe, &p), index) in self.lobes().zip(&prepared.p).zip(0_u32..) {
            let above = below + p;
            let mine = u[0].ge(below) & u[0].lt(above);
            if mine.any() {
                let sample = sample_anew(lobe, wo, prepared.transport, [rest_of(u[0], below, p), u[1], u[2]]);
                chosen = Sample::select(mine, sample.renumbered(index.wrapping_mul(L::LOBES)), chosen);
            }
            below = above;
        }
        chosen
    }

    #[inline(never)]
    fn delta_one(&self, wo: Vec3<R>, prepared: &Prepared<R, L::Prepared, N, C>, sample: &Sample<R>) -> Value<R> {
        let mut sum = Value::zero();
        let event = sample.event;
        let (mut lobe_left, mut left) = (event.lobe, event.is_delta & !event.failed);
        for ((index, lobe), &p) in self.lobes().enumerate().zip(&prepared.p) {
            // Numbers that wrapped compare differently in lanes: an event that was counted is left alone.
            let mine = R::int_lt(lobe_left, R::int(L::LOBES)) & left;
            if mine.any() {
                let sample = Sample { event: Event { lobe: lobe_left, ..event }, ..*sample };
                let value = lobe.delta(wo, &lobe.prepare(wo, prepared.transport), &sample);
                // Masked last, so that a lane with a p that is not finite leaves its neighbours alone.
                let f_cos = self.attenuated((index, lobe), &prepared.transmitted, (wo, sample.wi), value.f_cos);
                sum.f_cos += f_cos.or_zero(mine);
                sum.pdf += (p * value.pdf).or_zero(mine);
            }
            left = left & !mine;
            lobe_left = R::int_add(lobe_left, R::int(L::LOBES.wrapping_neg()));
        }
        sum
    }
}

impl<R: Real, L: Lobe<R> + Copy, const N: usize, const C: usize> Lobe<R> for Surface<R, L, N, C> {
    type Prepared = Prepared<R, L::Prepared, N, C>;
    const LOBES: u32 = L::LOBES * N as u32;

    #[inline]
    fn prepare(&self, wo: Vec3<R>, transport: Transport) -> Self::Prepared {
        let nothing = Prepared { p: [R::ZERO; N], transmitted: [Rgb::zero(); C], only: None, transport };
        match self.only() {
            Some(only) => Prepared { only: Some(only.prepare(wo, transport)), ..nothing },
            None => {
                let transmitted = self.transmitted(wo);
                Prepared { p: self.probabilities(wo, &transmitted), transmitted, ..nothing }
            }
        }
    }
    #[inline]
    fn eval(&self, wo: Vec3<R>, prepared: &Self::Prepared, wi: Vec3<R>) -> Value<R> {
        match (&prepared.only, self.only()) {
            (Some(prepared), Some(only)) => only.eval(wo, prepared, wi),
            _ => self.eval_sum(wo, prepared, wi),
        }
    }
    #[inline]
    fn sample(&self, wo: Vec3<R>, prepared: &Self::Prepared, u: [R; 3]) -> Sample<R> {
        match (&prepared.only, self.only()) {
            (Some(prepared), Some(only)) => only.sample(wo, prepared, u),
            _ => self.sample_one(wo, prepared, u),
        }
    }
    #[inline]
    fn delta(&self, wo: Vec3<R>, prepared: &Self::Prepared, sample: &Sample<R>) -> Value<R> {
        match (&prepared.only, self.only()) {
            (Some(prepared), Some(only)) => only.delta(wo, prepared, sample),
            _ => self.delta_one(wo, prepared, sample),
        }
    }
    #[inline]
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
        let transmitted = self.transmitted(wo);
        self.returned(wo, &transmitted).fold(Rgb::zero(), |sum, one| sum + one)
    }
    #[inline]
    fn domain(&self) -> R::Mask {
        self.lobes().fold(R::Mask::splat(true), |ok, lobe| ok & lobe.domain())
    }
    /// Of lobes side by side energy is conserved as long as their weights add up to 1 at most.
    fn properties(&self) -> Properties<R> {
        let mut each = self.lobes().map(Lobe::properties);
        let Some(first) = each.next() else { return Properties { albedo: Some(Rgb::zero()), ..Properties::LAWFUL } };
        let all = each.fold(first, Properties::and);
        self.coats.iter().flatten().fold(all, |all, placed| placed.coat.properties(all))
    }
    fn largest_weight(&self, wo: Vec3<R>) -> R {
        if let Some(only) = self.only() {
            return only.largest_weight(wo);
        }
        let transmitted = self.transmitted(wo);
        let p = self.probabilities(wo, &transmitted);
        self.lobes().enumerate().zip(p).fold(R::ZERO, |largest, ((index, lobe), p)| {
            let left = self.below_coats(index, lobe.is_lambertian(), |coat, i, lambertian| {
                coat.largest_attenuation(transmitted.get(i).copied().unwrap_or(Rgb::zero()), lambertian)
            });
            let left = left.map_or(R::ONE, Rgb::largest);
            (lobe.largest_weight(wo) * left / p).or_zero(p.gt(R::ZERO)).max(largest)
        })
    }
    fn radiance_scale(&self, wo: Vec3<R>) -> R {
        self.lobes().fold(R::ONE, |scale, lobe| either_scale(scale, lobe.radiance_scale(wo)))
    }
    #[inline]
    fn is_lambertian(&self) -> bool {
        self.coats.iter().all(Option::is_none) && self.lobes().all(Lobe::is_lambertian)
    }
}

#[cfg(test)]
mod tests;
