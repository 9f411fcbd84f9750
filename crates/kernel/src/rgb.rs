//! A colour of three linear Rec. 709 channels: a reflectance, a radiance, a weight.

use crate::real::Real;
use core::ops::{Add, AddAssign, Mul};

/// Red, green and blue, linear, Rec. 709 primaries.
#[derive(Clone, Copy, Debug, PartialEq)]
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

impl<R: Real> Add for Rgb<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.r + other.r, self.g + other.g, self.b + other.b)
    }
}
impl<R: Real> AddAssign for Rgb<R> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl<R: Real> Mul for Rgb<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::new(self.r * other.r, self.g * other.g, self.b * other.b)
    }
}
impl<R: Real> Mul<R> for Rgb<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, k: R) -> Self {
        self.map(|x| x * k)
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
    fn a_channel_that_is_nan_lies_within_no_range() {
        assert!(Rgb::new(0.0_f32, 0.5, 1.0).within(0.0, 1.0));
        assert!(!Rgb::new(0.0, f32::NAN, 1.0).within(0.0, 1.0));
        assert_eq!(Rgb::new(f32::NAN, 1.0, -1.0).or_zero(false), Rgb::zero());
    }
}
