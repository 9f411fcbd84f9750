//! `Surface`: what a point is made of, as resolved numbers. Textures have been looked up; nothing depends on a direction yet.
//!
//! A surface is a list of at most [`MAX_LOBES`] lobes whose contributions add, each times its weight.

use crate::lobe::{AnyLobe, Lobe, Properties};
use crate::real::Real;

/// How many lobes a surface can hold. Base, coat, sheen and transmission are the most that a layered model needs at once.
pub const MAX_LOBES: usize = 4;

/// The user's roughness in [0, 1]: perceptually about linear, never a width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness<R>(pub R);

/// The width of a microfacet distribution: α = roughness².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alpha<R>(pub R);

impl<R: Real> From<Roughness<R>> for Alpha<R> {
    fn from(roughness: Roughness<R>) -> Self {
        Alpha(roughness.0 * roughness.0)
    }
}

/// A lobe and the factor of its contribution.
#[derive(Clone, Copy, Debug)]
pub struct Weighted<R> {
    /// Factor in [0, 1].
    pub weight: R,
    /// The scattering model.
    pub lobe: AnyLobe<R>,
}

/// At most [`MAX_LOBES`] weighted lobes. A surface without lobes absorbs everything.
#[derive(Clone, Copy, Debug)]
pub struct Surface<R> {
    lobes: [Option<Weighted<R>>; MAX_LOBES],
}

impl<R: Real> Surface<R> {
    /// A surface that absorbs everything.
    pub const fn black() -> Self {
        Self { lobes: [None; MAX_LOBES] }
    }

    /// A surface of one lobe.
    pub fn of(lobe: impl Into<AnyLobe<R>>) -> Self {
        Self::black().with(R::ONE, lobe)
    }

    /// This surface and one lobe more. A lobe beyond [`MAX_LOBES`] is left out: check [`Surface::is_full`] first.
    pub fn with(mut self, weight: R, lobe: impl Into<AnyLobe<R>>) -> Self {
        if let Some(slot) = self.lobes.iter_mut().find(|slot| slot.is_none()) {
            *slot = Some(Weighted { weight, lobe: lobe.into() });
        }
        self
    }

    /// Whether no further lobe fits.
    pub fn is_full(&self) -> bool {
        self.lobes.iter().all(Option::is_some)
    }

    /// The lobes in order.
    #[inline(always)]
    pub fn lobes(&self) -> impl Iterator<Item = &Weighted<R>> {
        self.lobes.iter().map_while(Option::as_ref)
    }

    /// Whether every weight and parameter lies in its domain.
    #[inline(always)]
    pub fn domain(&self) -> R::Mask {
        use crate::real::Mask;
        self.lobes()
            .fold(R::Mask::splat(true), |ok, l| ok & l.weight.ge(R::ZERO) & l.weight.le(R::ONE) & l.lobe.domain())
    }

    /// The laws that all lobes claim together; energy as long as the weights add up to 1 at most.
    pub fn properties(&self) -> Properties {
        self.lobes().fold(Properties::LAWFUL, |all, l| {
            let one = l.lobe.properties();
            Properties {
                reciprocal: all.reciprocal && one.reciprocal,
                conserving: all.conserving && one.conserving,
                excess: all.excess.max(one.excess),
                units: all.units.max(one.units),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lobe::Mirror;
    use crate::rgb::Rgb;

    #[test]
    fn roughness_one_half_is_a_width_of_one_quarter() {
        assert_eq!(Alpha::from(Roughness(0.5_f32)), Alpha(0.25));
    }

    #[test]
    fn a_surface_holds_four_lobes_and_leaves_out_the_fifth() {
        let mirror = Mirror::new(Rgb::splat(0.1_f32));
        let mut surface = Surface::black();
        for count in 0..=MAX_LOBES {
            assert_eq!(surface.lobes().count(), count);
            assert_eq!(surface.is_full(), count == MAX_LOBES);
            surface = surface.with(0.5, mirror);
        }
        assert_eq!(surface.lobes().count(), MAX_LOBES);
    }

    #[test]
    fn a_parameter_out_of_range_or_nan_leaves_the_domain() {
        for (weight, reflectance) in [(1.1_f32, 0.5), (-0.1, 0.5), (f32::NAN, 0.5), (1.0, 1.1), (1.0, f32::NAN)] {
            let surface = Surface::black().with(weight, Mirror::new(Rgb::splat(reflectance)));
            assert!(!surface.domain(), "weight {weight}, reflectance {reflectance}");
        }
        assert!(Surface::<f32>::black().domain());
    }
}
