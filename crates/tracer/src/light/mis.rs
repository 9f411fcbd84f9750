//! Multiple importance sampling: light that two techniques can find is weighted by the power heuristic.

use gonio_kernel::{F32x8, Mask8, Real};

/// Which techniques of finding light take part. All give the same picture but for noise, which is what this is for: a wrong
/// density makes them differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Techniques {
    /// Both, weighted by the power heuristic.
    #[default]
    Both,
    /// Lights are sampled; scattering finds light only behind delta events and the camera.
    Lights,
    /// Scattering; lights are sampled only where scattering cannot find them: point, spot and distant lights.
    Scattering,
}

impl Techniques {
    /// The weight of a light sample of density `own` that scattering finds with density `scattering`; 1 if it cannot.
    #[inline(always)]
    pub(crate) fn weight_of_light_sample(self, own: F32x8, scattering: F32x8, is_delta: Mask8) -> F32x8 {
        F32x8::select(is_delta, F32x8::ONE, self.weight(Self::Lights, own, scattering))
    }

    /// The weight of light that scattering found with density `own` and that a light sample finds with density `light`; 1
    /// after the camera or a delta event, where `own` is 0 and no light was sampled.
    #[inline(always)]
    pub(crate) fn weight_of_scattering(self, own: F32x8, light: F32x8) -> F32x8 {
        F32x8::select(own.gt(F32x8::ZERO), self.weight(Self::Scattering, own, light), F32x8::ONE)
    }

    /// `alone` is the technique that finds the light with density `own` when it is the only one.
    #[inline(always)]
    fn weight(self, alone: Self, own: F32x8, other: F32x8) -> F32x8 {
        match self {
            Self::Both => power_heuristic(own, other),
            only => F32x8::splat(if only == alone { 1.0 } else { 0.0 }),
        }
    }
}

/// The power heuristic with exponent 2 (Veach & Guibas 1995): the weight of a sample of density `a` that could also have
/// been drawn with density `b`. Written as a ratio, so that huge densities do not overflow; 1 where b is 0.
#[inline(always)]
fn power_heuristic(a: F32x8, b: F32x8) -> F32x8 {
    let r = b / a;
    r.mul_add(r, F32x8::ONE).recip()
}
