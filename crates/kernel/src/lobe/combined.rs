//! What [`super::Lobe::times`] and [`super::Lobe::plus`] return, as data; `weighted` and `mix` make lobes of them.

use crate::rgb::Rgb;

/// A lobe times a colour in \[0, 1\].
///
/// ```
/// use gonio_kernel::{Lobe, Rgb, lobe::Lambert};
/// let half_red = Lambert::new(Rgb::splat(0.8_f32)).times(Rgb::new(0.5, 0.0, 0.0));
/// assert!(half_red.domain());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weighted<R, L> {
    /// The factor.
    pub weight: Rgb<R>,
    /// The lobe.
    pub lobe: L,
}

/// Two lobes side by side.
///
/// ```
/// use gonio_kernel::{Closure, Lobe, Rgb, Vec3, lobe::{Lambert, Mirror}};
/// let chalk = Lambert::new(Rgb::splat(0.5_f32)).plus(Mirror::new(Rgb::splat(0.5)));
/// let sample = Closure::new(chalk, Vec3::unit_z()).sample([0.9, 0.5, 0.5]);
/// assert!(sample.event.is_delta && sample.weight.g == 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mix<A, B>(pub A, pub B);
