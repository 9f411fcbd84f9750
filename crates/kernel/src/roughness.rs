//! Roughness as users give it, and alpha, its square, which distributions of microfacet normals take.

use crate::real::Real;

/// The user's roughness in [0, 1]: perceptually about linear, never the alpha of a distribution.
///
/// ```
/// use gonio_kernel::{Alpha, Roughness, microfacet::Ggx};
/// assert_eq!(Alpha::from(Roughness(0.5_f32)), Alpha(0.25));
/// assert_eq!(Ggx::isotropic(Roughness(0.5_f32)), Ggx::isotropic(0.25));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness<R>(pub R);

/// The alpha of a distribution of microfacet normals, in [1e-8, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alpha<R>(pub R);

impl<R: Real> From<Roughness<R>> for Alpha<R> {
    /// alpha = roughness²: the rule of Disney 2012 and OpenPBR.
    #[inline(always)]
    fn from(roughness: Roughness<R>) -> Self {
        Self(roughness.0 * roughness.0)
    }
}
impl<R: Real> From<R> for Alpha<R> {
    #[inline(always)]
    fn from(alpha: R) -> Self {
        Self(alpha)
    }
}
