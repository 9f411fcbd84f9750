//! A colour of three linear Rec. 709 channels: a reflectance, a radiance, a weight.

use crate::operators::{by_component, by_number};
use crate::real::Real;
use core::iter::Sum;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Sub, SubAssign};

/// Red, green and blue, linear, Rec. 709 primaries.
///
/// Colours are added, subtracted, multiplied and divided channel by channel, and multiplied and divided by numbers.
///
/// ```
/// use gonio_kernel::Rgb;
/// let (white, brass) = (Rgb::splat(1.0_f32), Rgb::new(0.5, 0.25, 0.125));
/// assert_eq!(white - brass, Rgb::new(0.5, 0.75, 0.875));
/// assert_eq!(brass / brass, white);
/// assert_eq!(2.0 * brass, brass / 0.5);
/// assert_eq!([brass, brass].iter().sum::<Rgb<f32>>(), brass * 2.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "bytemuck", derive(bytemuck::AnyBitPattern))]
#[repr(C)]
pub struct Rgb<R> {
    /// Red.
    pub r: R,
    /// Green.
    pub g: R,
    /// Blue.
    pub b: R,
}

impl<R> Rgb<R> {
    /// (r, g, b)
    #[inline(always)]
    pub const fn new(r: R, g: R, b: R) -> Self {
        Self { r, g, b }
    }
    /// `f` of each channel.
    #[inline(always)]
    pub fn map<S>(self, mut f: impl FnMut(R) -> S) -> Rgb<S> {
        Rgb::new(f(self.r), f(self.g), f(self.b))
    }
}

impl<R: Real> Rgb<R> {
    /// The same value in each channel.
    #[inline(always)]
    pub fn splat(x: R) -> Self {
        Self::new(x, x, x)
    }
    /// Black.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::splat(R::ZERO)
    }
    /// Y of CIE 1931 for Rec. 709 primaries: 0.2126 r + 0.7152 g + 0.0722 b.
    #[inline(always)]
    pub fn luminance(self) -> R {
        R::lit(0.2126).mul_add(self.r, R::lit(0.7152).mul_add(self.g, R::lit(0.0722) * self.b))
    }
    /// The largest channel.
    #[inline(always)]
    pub fn largest(self) -> R {
        self.r.max(self.g).max(self.b)
    }
    /// The smaller of each pair of channels, chosen as by [`Real::min`].
    ///
    /// ```
    /// use gonio_kernel::Rgb;
    /// let (a, b) = (Rgb::new(0.1_f32, 0.5, 0.9), Rgb::splat(0.5));
    /// assert_eq!((a.min(b), a.max(b)), (Rgb::new(0.1, 0.5, 0.5), Rgb::new(0.5, 0.5, 0.9)));
    /// ```
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        Self::new(self.r.min(other.r), self.g.min(other.g), self.b.min(other.b))
    }
    /// The larger of each pair of channels, chosen as by [`Real::max`].
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Self::new(self.r.max(other.r), self.g.max(other.g), self.b.max(other.b))
    }
    /// (1 − t) self + t other: exactly self at t = 0 and other at t = 1, if both are finite.
    ///
    /// ```
    /// use gonio_kernel::Rgb;
    /// let half = Rgb::splat(0.0_f32).lerp(Rgb::new(1.0, 2.0, 4.0), 0.5);
    /// assert_eq!(half, Rgb::new(0.5, 1.0, 2.0));
    /// ```
    #[inline(always)]
    pub fn lerp(self, other: Self, t: R) -> Self {
        let mix = |a: R, b: R| t.mul_add(b, (R::ONE - t) * a);
        Self::new(mix(self.r, other.r), mix(self.g, other.g), mix(self.b, other.b))
    }
    /// self where `mask`, black elsewhere.
    #[inline(always)]
    pub fn or_zero(self, mask: R::Mask) -> Self {
        self.map(|x| x.or_zero(mask))
    }
    /// `yes` where `mask`, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self::new(R::select(mask, yes.r, no.r), R::select(mask, yes.g, no.g), R::select(mask, yes.b, no.b))
    }
    /// Whether every channel lies in [lo, hi]; NaN does not.
    #[inline(always)]
    pub fn within(self, lo: f64, hi: f64) -> R::Mask {
        let inside = |x: R| x.ge(R::lit(lo)) & x.le(R::lit(hi));
        inside(self.r) & inside(self.g) & inside(self.b)
    }
}

by_component!(
    Rgb(r, g, b):
    Add add AddAssign add_assign +,
    Sub sub SubAssign sub_assign -,
    Mul mul MulAssign mul_assign *,
    Div div DivAssign div_assign /
);
by_number!(Rgb(r, g, b));

/// From black on, in order.
impl<R: Real> Sum for Rgb<R> {
    fn sum<I: Iterator<Item = Self>>(colours: I) -> Self {
        colours.fold(Self::zero(), |sum, c| sum + c)
    }
}
/// From black on, in order.
impl<'a, R: Real> Sum<&'a Self> for Rgb<R> {
    fn sum<I: Iterator<Item = &'a Self>>(colours: I) -> Self {
        colours.copied().sum()
    }
}
impl<R: Real> From<R> for Rgb<R> {
    /// A grey.
    #[inline(always)]
    fn from(x: R) -> Self {
        Self::splat(x)
    }
}
impl<R> From<[R; 3]> for Rgb<R> {
    fn from([r, g, b]: [R; 3]) -> Self {
        Self::new(r, g, b)
    }
}
impl<R> From<Rgb<R>> for [R; 3] {
    fn from(c: Rgb<R>) -> Self {
        [c.r, c.g, c.b]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_has_luminance_one_and_green_weighs_most() {
        assert!((Rgb::splat(1.0_f64).luminance() - 1.0).abs() < 1e-15);
        assert_eq!(Rgb::new(0.0, 1.0, 0.0).luminance(), 0.7152_f64);
        assert_eq!(Rgb::new(0.1_f32, 0.3, 0.2).largest(), 0.3);
    }

    #[test]
    fn operators_work_channel_by_channel_and_assign_the_same() {
        let (a, b) = (Rgb::new(1.0_f32, 2.0, 3.0), Rgb::new(0.5, 4.0, 0.25));
        assert_eq!((a - b, a / b), (Rgb::new(0.5, -2.0, 2.75), Rgb::new(2.0, 0.5, 12.0)));
        assert_eq!((a / 2.0, 2.0 * a), (Rgb::new(0.5, 1.0, 1.5), a + a));
        let assigned = |change: fn(&mut Rgb<f32>, Rgb<f32>)| {
            let mut c = a;
            change(&mut c, b);
            c
        };
        assert_eq!((assigned(|a, b| *a += b), assigned(|a, b| *a -= b)), (a + b, a - b));
        assert_eq!((assigned(|a, b| *a *= b), assigned(|a, b| *a /= b)), (a * b, a / b));
        assert_eq!((assigned(|a, b| *a *= b.r), assigned(|a, b| *a /= b.g)), (a * b.r, a / b.g));
        assert_eq!([a, b].into_iter().sum::<Rgb<f32>>(), a + b);
    }

    #[test]
    fn a_mixture_begins_and_ends_with_its_parts() {
        let (a, b) = (Rgb::new(0.1_f32, 1e-20, 3e7), Rgb::new(0.7, 0.3, 1e-9));
        assert_eq!((a.lerp(b, 0.0), a.lerp(b, 1.0)), (a, b));
    }

    #[test]
    fn a_channel_that_is_nan_lies_within_no_range() {
        assert!(Rgb::new(0.0_f32, 0.5, 1.0).within(0.0, 1.0));
        assert!(!Rgb::new(0.0, f32::NAN, 1.0).within(0.0, 1.0));
        assert_eq!(Rgb::new(f32::NAN, 1.0, -1.0).or_zero(false), Rgb::zero());
    }
}
