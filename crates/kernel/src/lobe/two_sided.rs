//! Two-sided: a lobe that looks the same from behind, as a sheet of paper does.
//!
//! Seen from below, wo and wi are mirrored in the surface, and so is what is sampled. Reciprocity and energy are the lobe's.

use super::{Lobe, Properties, Sample, Transport, Value};
use crate::frame::turned;
use crate::model::{Entry, Parameter, Parameters, Source};
use crate::real::Real;
use crate::rgb::Rgb;
use crate::vec3::Vec3;

/// A lobe on both sides of the surface. Meant for lobes that only reflect; a [`crate::Surface`] can be one too.
#[derive(Clone, Copy, Debug)]
pub struct TwoSided<L>(pub L);

impl<R: Real, L: Lobe<R>> Lobe<R> for TwoSided<L> {
    type Prepared = L::Prepared;
    const LOBES: u32 = L::LOBES;

    #[inline(always)]
    fn prepare(&self, wo: Vec3<R>, transport: Transport) -> Self::Prepared {
        self.0.prepare(turned(wo, wo), transport)
    }

    #[inline(always)]
    fn eval(&self, wo: Vec3<R>, prepared: &Self::Prepared, wi: Vec3<R>) -> Value<R> {
        self.0.eval(turned(wo, wo), prepared, turned(wo, wi))
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, prepared: &Self::Prepared, u: [R; 3]) -> Sample<R> {
        let sample = self.0.sample(turned(wo, wo), prepared, u);
        Sample { wi: turned(wo, sample.wi), ..sample }
    }

    #[inline(always)]
    fn delta(&self, wo: Vec3<R>, prepared: &Self::Prepared, sample: &Sample<R>) -> Value<R> {
        let sample = Sample { wi: turned(wo, sample.wi), ..*sample };
        self.0.delta(turned(wo, wo), prepared, &sample)
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
        self.0.albedo_estimate(turned(wo, wo))
    }

    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.0.domain()
    }

    #[inline(always)]
    fn radiance_scale(&self, wo: Vec3<R>) -> R {
        self.0.radiance_scale(turned(wo, wo))
    }

    #[inline(always)]
    fn largest_weight(&self, wo: Vec3<R>) -> R {
        self.0.largest_weight(turned(wo, wo))
    }

    #[inline(always)]
    fn properties(&self) -> Properties<R> {
        self.0.properties()
    }
}

impl<L: Parameters> Parameters for TwoSided<L> {
    type Real = L::Real;
    type Of<S: Real> = TwoSided<L::Of<S>>;
    const ENTRIES: &'static [Entry] = L::ENTRIES;

    #[inline(always)]
    fn map<S: Real>(&self, f: &mut impl FnMut(&'static Parameter, usize, L::Real) -> S) -> Self::Of<S> {
        TwoSided(self.0.map(f))
    }
    #[cfg(feature = "wide")]
    #[inline(always)]
    fn gather(lanes: [&Self::Of<f32>; 8]) -> Self::Of<crate::F32x8> {
        TwoSided(L::gather(crate::each_lane(|i| &lanes[i & 7].0)))
    }
    #[inline(always)]
    fn same_code(&self, other: &Self) -> bool {
        self.0.same_code(&other.0)
    }
    fn each_choice(&self, visit: &mut dyn FnMut(&'static str)) {
        self.0.each_choice(visit);
    }
    #[inline(always)]
    fn in_domain(&self) -> <L::Real as Real>::Mask {
        self.0.in_domain()
    }
    fn read<S: Source<L::Real>>(source: &mut S) -> Result<Self, S::Error> {
        L::read(source).map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lobe::{Lambert, Mirror};
    use crate::testing::{Bare, Random};

    #[test]
    fn from_behind_paper_looks_as_from_the_front() {
        let mut random = Random(20);
        let paper = TwoSided(Lambert::new(Rgb::new(0.8_f32, 0.5, 0.2)));
        for _ in 0..1000 {
            let (wo, wi) = (random.direction(), random.direction());
            let (front, back) = (paper.value(wo, wi), paper.value(-wo, -wi));
            assert_eq!((front.f_cos, front.pdf), (back.f_cos, back.pdf));
            let sample = paper.draw(wo, [random.unit(), random.unit(), random.unit()]);
            assert!(sample.event.failed || sample.wi.z * wo.z > 0.0, "{wo:?} {sample:?}");
        }
    }

    #[test]
    fn a_two_sided_mirror_reflects_from_below() {
        let mirror = TwoSided(Mirror::new(Rgb::splat(0.5_f32)));
        let wo = Vec3::new(0.6, 0.0, -0.8);
        let sample = mirror.draw(wo, [0.5; 3]);
        assert_eq!(sample.wi, Vec3::new(-0.6, 0.0, -0.8));
        assert_eq!(mirror.delta_of(wo, &sample).f_cos.r, 0.5);
    }
}
