//! `Mix`: two lobes side by side, whose light adds.
//!
//! A part is chosen with a probability proportional to the luminance of its albedo estimate, so that a black part has probability
//! exactly 0. The density is p·pdf_a + (1 − p)·pdf_b over the continuous parts, not renormalised by the probability of delta events;
//! a delta event has the probability of its part times its own.

use super::combined::Mix;
use super::{Lobe, Properties, Sample, Transport, Value};
use crate::model::{Entry, Parameter, Parameters, Source};
use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::vec3::Vec3;

/// What a [`Mix`] prepares.
#[derive(Clone, Copy, Debug)]
pub struct Prepared<R, A, B> {
    /// The probability of either part. Both are kept: 1 − p would lose the digits of a part that is nearly absent.
    pub(super) p: [R; 2],
    pub(super) a: A,
    pub(super) b: B,
}

/// The share of the first of two albedos: exactly 0 or 1 where one is black, 0 where both are.
#[inline(always)]
pub(crate) fn share<R: Real>(a: Rgb<R>, b: Rgb<R>) -> R {
    let (a, b) = (a.luminance(), b.luminance());
    (a / (a + b)).or_zero((a + b).gt(R::ZERO))
}

/// The shares of two albedos.
#[inline(always)]
pub(super) fn shares<R: Real>(a: Rgb<R>, b: Rgb<R>) -> [R; 2] {
    [share(a, b), share(b, a)]
}

/// The scale of radiance of two lobes of one interface: that of the one that transmits.
#[inline(always)]
pub(crate) fn either_scale<R: Real>(a: R, b: R) -> R {
    R::select(a.same(R::ONE), b, a)
}

/// What is left of u₀ inside the interval of length p from `below`: uniform again, and below 1 even after rounding.
#[inline(always)]
pub(crate) fn rest_of<R: Real>(u: R, below: R, p: R) -> R {
    ((u - below) / p).max(R::ZERO).min(R::lit(0.999_999_94))
}

/// Two parts, the first chosen with probability p: the one body of [`Mix`] and [`super::Layer`].
impl<R: Real, PA, PB> Prepared<R, PA, PB> {
    #[inline(always)]
    pub(super) fn pdf(&self, a: R, b: R) -> R {
        self.p[0].mul_add(a, self.p[1] * b)
    }

    #[inline(always)]
    pub(super) fn sample<A, B>(&self, (a, b): (&A, &B), wo: Vec3<R>, u: [R; 3]) -> Sample<R>
    where
        A: Lobe<R, Prepared = PA>,
        B: Lobe<R, Prepared = PB>,
    {
        let [p, q] = self.p;
        // Where rounding leaves a gap below 1, it is the first's if the second is absent.
        let first = u[0].lt(p) | q.same(R::ZERO);
        let (below, p) = (R::select(first, R::ZERO, p), R::select(first, p, q));
        let u = [rest_of(u[0], below, p), u[1], u[2]];
        let mut chosen = Sample::nothing();
        if first.any() {
            chosen = Sample::select(first, a.sample(wo, &self.a, u), chosen);
        }
        if (!first).any() {
            chosen = Sample::select(first, chosen, b.sample(wo, &self.b, u).renumbered(A::LOBES));
        }
        chosen
    }

    /// The delta values of both parts, of which one at most is not 0.
    #[inline(always)]
    pub(super) fn delta<A, B>(&self, (a, b): (&A, &B), wo: Vec3<R>, sample: &Sample<R>) -> [Value<R>; 2]
    where
        A: Lobe<R, Prepared = PA>,
        B: Lobe<R, Prepared = PB>,
    {
        let first = R::int_lt(sample.event.lobe, R::int(A::LOBES));
        let second = sample.renumbered(A::LOBES.wrapping_neg());
        [a.delta(wo, &self.a, sample).or_zero(first), b.delta(wo, &self.b, &second).or_zero(!first)]
    }

    /// The largest weight of a sample, from the parts' own.
    #[inline(always)]
    pub(super) fn largest_weight(&self, a: R, b: R) -> R {
        let over = |weight: R, p: R| (weight / p).or_zero(p.gt(R::ZERO));
        over(a, self.p[0]).max(over(b, self.p[1]))
    }
}

impl<R: Real, A: Lobe<R>, B: Lobe<R>> Lobe<R> for Mix<A, B> {
    type Prepared = Prepared<R, A::Prepared, B::Prepared>;
    const LOBES: u32 = A::LOBES + B::LOBES;

    #[inline(always)]
    fn prepare(&self, wo: Vec3<R>, transport: Transport) -> Self::Prepared {
        let p = shares(self.0.albedo_estimate(wo), self.1.albedo_estimate(wo));
        Prepared { p, a: self.0.prepare(wo, transport), b: self.1.prepare(wo, transport) }
    }
    #[inline(always)]
    fn eval(&self, wo: Vec3<R>, prepared: &Self::Prepared, wi: Vec3<R>) -> Value<R> {
        let (a, b) = (self.0.eval(wo, &prepared.a, wi), self.1.eval(wo, &prepared.b, wi));
        Value { f_cos: a.f_cos + b.f_cos, pdf: prepared.pdf(a.pdf, b.pdf) }
    }
    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, prepared: &Self::Prepared, u: [R; 3]) -> Sample<R> {
        prepared.sample((&self.0, &self.1), wo, u)
    }
    #[inline(always)]
    fn delta(&self, wo: Vec3<R>, prepared: &Self::Prepared, sample: &Sample<R>) -> Value<R> {
        let [a, b] = prepared.delta((&self.0, &self.1), wo, sample);
        Value { f_cos: a.f_cos + b.f_cos, pdf: prepared.pdf(a.pdf, b.pdf) }
    }
    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
        self.0.albedo_estimate(wo) + self.1.albedo_estimate(wo)
    }
    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.0.domain() & self.1.domain()
    }
    #[inline(always)]
    fn properties(&self) -> Properties<R> {
        self.0.properties().and(self.1.properties())
    }
    #[inline(always)]
    fn largest_weight(&self, wo: Vec3<R>) -> R {
        let p = shares(self.0.albedo_estimate(wo), self.1.albedo_estimate(wo));
        Prepared { p, a: (), b: () }.largest_weight(self.0.largest_weight(wo), self.1.largest_weight(wo))
    }
    #[inline(always)]
    fn radiance_scale(&self, wo: Vec3<R>) -> R {
        either_scale(self.0.radiance_scale(wo), self.1.radiance_scale(wo))
    }
    #[inline(always)]
    fn is_lambertian(&self) -> bool {
        self.0.is_lambertian() && self.1.is_lambertian()
    }
}

impl<R: Real, A: Parameters<Real = R>, B: Parameters<Real = R>> Parameters for Mix<A, B> {
    type Real = R;
    type Of<S: Real> = Mix<A::Of<S>, B::Of<S>>;
    const ENTRIES: &'static [Entry] = &[Entry::Group(A::ENTRIES), Entry::Group(B::ENTRIES)];

    #[inline(always)]
    fn map<S: Real>(&self, f: &mut impl FnMut(&'static Parameter, usize, R) -> S) -> Self::Of<S> {
        let a = self.0.map(f);
        Mix(a, self.1.map(f))
    }
    #[cfg(feature = "wide")]
    #[inline(always)]
    fn gather(lanes: [&Self::Of<f32>; 8]) -> Self::Of<crate::F32x8> {
        use crate::each_lane;
        Mix(A::gather(each_lane(|i| &lanes[i & 7].0)), B::gather(each_lane(|i| &lanes[i & 7].1)))
    }
    #[inline(always)]
    fn same_code(&self, other: &Self) -> bool {
        self.0.same_code(&other.0) && self.1.same_code(&other.1)
    }
    fn each_choice(&self, visit: &mut dyn FnMut(&'static str)) {
        self.0.each_choice(visit);
        self.1.each_choice(visit);
    }
    #[inline(always)]
    fn in_domain(&self) -> R::Mask {
        self.0.in_domain() & self.1.in_domain()
    }
    fn read<S: Source<R>>(source: &mut S) -> Result<Self, S::Error> {
        Ok(Self(A::read(source)?, B::read(source)?))
    }
}
