//! The parameters of a surface are those of its lobes, with their colours.

use super::Surface;
use crate::lobe::Weighted;
use crate::model::{Choice, Entry, Parameter, Parameters, Source};
use crate::real::{Mask, Real};

impl<R: Real, L: Parameters<Real = R>, const N: usize, const C: usize> Parameters for Surface<R, L, N, C> {
    type Real = R;
    type Of<S: Real> = Surface<S, L::Of<S>, N, C>;
    const ENTRIES: &'static [Entry] = <Weighted<R, L> as Parameters>::ENTRIES;

    fn map<S: Real>(&self, f: &mut impl FnMut(&'static Parameter, usize, R) -> S) -> Self::Of<S> {
        Surface::like(self.lobes.map(|lobe| lobe.map(|lobe| lobe.map(f))), self.layerings())
    }
    #[cfg(feature = "wide")]
    fn gather(lanes: [&Self::Of<f32>; 8]) -> Self::Of<crate::F32x8> {
        let lobes = core::array::from_fn(|i| {
            let of = |lane: &Self::Of<f32>| lane.lobes.get(i).copied().flatten();
            let first = of(lanes[0])?;
            let all = lanes.map(|lane| of(lane).unwrap_or(first));
            Some(Weighted::<R, L>::gather(crate::each_lane(|i| &all[i & 7])))
        });
        Surface::like(lobes, lanes[0].layerings())
    }
    fn same_code(&self, other: &Self) -> bool {
        let mut both = self.lobes().zip(other.lobes());
        self.lobes().count() == other.lobes().count()
            && self.layerings() == other.layerings()
            && both.all(|(a, b)| a.same_code(b))
    }
    fn each_choice(&self, visit: &mut dyn FnMut(&'static str)) {
        self.layerings().iter().flatten().for_each(|(_, layering)| visit(layering.word()));
        self.lobes().for_each(|lobe| lobe.each_choice(visit));
    }
    fn in_domain(&self) -> R::Mask {
        self.lobes().fold(R::Mask::splat(true), |ok, lobe| ok & lobe.in_domain())
    }
    fn read<S: Source<R>>(source: &mut S) -> Result<Self, S::Error> {
        let mut lobes = [None; N];
        if let Some(slot) = lobes.first_mut() {
            *slot = Some(Weighted::read(source)?);
        }
        Ok(Self { lobes, coats: [None; C] })
    }
}
