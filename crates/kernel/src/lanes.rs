//! Eight `f32` side by side: the only file of the kernel that knows the width.
//!
//! A thin coat over `wide`, whose instruction set is chosen at compile time (x86-64-v3: one AVX2 register). Masks hold
//! all ones or all zeros per lane, so that `and`, `or` and blends agree on what true means. `wide`'s own `min` and `max`
//! cost three instructions and hide NaNs; ours are the single instruction, with the rule of [`Real::min`].

mod operators;
mod vectors;

use crate::real::{LARGEST_INT, Mask, Precision, Real, Recordable};
use crate::table::Table;
use wide::{f32x8, i32x8, u32x8};

/// Eight `f32`, in memory like `[f32; 8]` at an address that is a multiple of 32.
///
/// ```
/// use gonio_kernel::{F32x8, Real};
/// let roots = F32x8::from([1.0, 4.0, 9.0, 16.0, 25.0, 36.0, 49.0, 64.0]).sqrt();
/// assert_eq!(<[f32; 8]>::from(roots), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "bytemuck", derive(bytemuck::Pod, bytemuck::Zeroable))]
#[repr(transparent)]
pub struct F32x8(f32x8);

/// Eight truths, each all ones or all zeros.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Mask8(f32x8);

/// Eight `u32`, with wrapping arithmetic; in memory like [`F32x8`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "bytemuck", derive(bytemuck::Pod, bytemuck::Zeroable))]
#[repr(transparent)]
pub struct U32x8(u32x8);

/// `[f(0), f(1), …]`, one per lane. Written out, because a closure per lane must be inlined to become eight loads.
#[inline(always)]
pub fn each_lane<T>(f: impl Fn(usize) -> T) -> [T; F32x8::LANES] {
    [f(0), f(1), f(2), f(3), f(4), f(5), f(6), f(7)]
}

impl F32x8 {
    /// How many lanes there are.
    pub const LANES: usize = 8;

    /// Lane *i* is `lanes[i]`.
    #[inline(always)]
    pub const fn new(lanes: [f32; 8]) -> Self {
        Self(f32x8::new(lanes))
    }
    /// The same as [`F32x8::new`], under the name that goes with [`F32x8::to_array`].
    #[inline(always)]
    pub const fn from_array(lanes: [f32; 8]) -> Self {
        Self::new(lanes)
    }
    /// Lane *i* is `f(i)`.
    #[inline(always)]
    pub fn from_fn(f: impl Fn(usize) -> f32) -> Self {
        Self::new(each_lane(f))
    }
    /// `x` in every lane.
    #[inline(always)]
    pub fn splat(x: f32) -> Self {
        Self(f32x8::splat(x))
    }
    /// Lane `lane` modulo 8.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> f32 {
        self.0.as_array()[lane & 7]
    }
    /// Puts `x` into lane `lane` modulo 8.
    #[inline(always)]
    pub fn set_lane(&mut self, lane: usize, x: f32) {
        self.0.as_mut_array()[lane & 7] = x;
    }
    /// Lane `lane` modulo 8, in every lane.
    #[inline(always)]
    pub fn splat_lane(&self, lane: usize) -> Self {
        Self::splat(self.lane(lane))
    }
    /// The lanes in order.
    #[inline(always)]
    pub fn to_array(self) -> [f32; 8] {
        self.0.to_array()
    }
    /// The type behind it, for our ray casting alone: no part of what versions promise.
    #[doc(hidden)]
    #[inline(always)]
    pub const fn to_wide(self) -> f32x8 {
        self.0
    }
    /// See [`F32x8::to_wide`].
    #[doc(hidden)]
    #[inline(always)]
    pub const fn from_wide(lanes: f32x8) -> Self {
        Self(lanes)
    }
    /// The bit patterns of the lanes.
    #[inline(always)]
    pub fn to_bits(self) -> U32x8 {
        U32x8(bytemuck::cast(self.0))
    }
}

impl Mask8 {
    /// Lane *i* is true if bit *i* is set.
    #[inline(always)]
    pub fn from_bits(bits: u32) -> Self {
        let lane = u32x8::new([1, 2, 4, 8, 16, 32, 64, 128]);
        U32x8(u32x8::splat(bits) & lane).same(U32x8(lane))
    }
    /// Bit *i* is set if lane *i* is true; the higher bits are 0.
    #[inline(always)]
    pub fn to_bits(self) -> u32 {
        self.0.to_bitmask()
    }
    /// The first `count` lanes are true.
    #[inline(always)]
    pub fn first(count: usize) -> Self {
        Self::from_bits(if count >= 8 { 0xff } else { (1_u32 << count) - 1 })
    }
    /// Lane *i* is lane `from[i]` modulo 8 of `self`.
    #[inline(always)]
    pub fn permute(self, from: U32x8) -> Self {
        Self(F32x8(self.0).to_bits().permute(from).as_real().0)
    }
    /// Whether lane `lane` is true.
    #[inline(always)]
    pub fn lane(self, lane: usize) -> bool {
        (self.to_bits() >> (lane & 7)) & 1 != 0
    }
}

impl U32x8 {
    /// Lane *i* is `lanes[i]`.
    #[inline(always)]
    pub const fn new(lanes: [u32; 8]) -> Self {
        Self(u32x8::new(lanes))
    }
    /// The same as [`U32x8::new`], under the name that goes with [`U32x8::to_array`].
    #[inline(always)]
    pub const fn from_array(lanes: [u32; 8]) -> Self {
        Self::new(lanes)
    }
    /// Lane *i* is `f(i)`.
    #[inline(always)]
    pub fn from_fn(f: impl Fn(usize) -> u32) -> Self {
        Self::new(each_lane(f))
    }
    /// `x` in every lane.
    #[inline(always)]
    pub fn splat(x: u32) -> Self {
        Self(u32x8::splat(x))
    }
    /// Lane `lane` modulo 8.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> u32 {
        self.0.as_array()[lane & 7]
    }
    /// Puts `x` into lane `lane` modulo 8.
    #[inline(always)]
    pub fn set_lane(&mut self, lane: usize, x: u32) {
        self.0.as_mut_array()[lane & 7] = x;
    }
    /// The lanes in order.
    #[inline(always)]
    pub fn to_array(self) -> [u32; 8] {
        self.0.to_array()
    }
    /// The reals with these bit patterns.
    #[inline(always)]
    pub fn as_real(self) -> F32x8 {
        F32x8(bytemuck::cast(self.0))
    }
    /// The nearest reals of lanes below 2³¹.
    #[inline(always)]
    pub fn to_real(self) -> F32x8 {
        F32x8(f32x8::from_i32x8(bytemuck::cast::<u32x8, i32x8>(self.0)))
    }
    /// Where lanes are equal.
    #[inline(always)]
    pub fn same(self, other: Self) -> Mask8 {
        Mask8(bytemuck::cast(self.0.simd_eq(other.0)))
    }
    /// Where self < other, both below 2³¹.
    #[inline(always)]
    pub fn lt(self, other: Self) -> Mask8 {
        let (a, b): (i32x8, i32x8) = (bytemuck::cast(self.0), bytemuck::cast(other.0));
        Mask8(bytemuck::cast(a.simd_lt(b)))
    }
    /// Lane *i* is lane `from[i]` modulo 8 of `self`.
    #[inline(always)]
    pub fn permute(self, from: Self) -> Self {
        // The instruction looks at three bits by itself.
        if cfg!(target_feature = "avx2") { Self(self.0.shuffle(from.0)) } else { Self(self.0.shuffle_wrapping(from.0)) }
    }
    /// Lane *i* is shifted down by `bits[i]`, which is below 32.
    #[inline(always)]
    pub fn shr_each(self, bits: Self) -> Self {
        Self(self.0.unbounded_shr(bits.0))
    }
    /// `yes` where `mask`, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        F32x8::select(mask, yes.as_real(), no.as_real()).to_bits()
    }
}

impl Mask for Mask8 {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(U32x8::splat(if value { u32::MAX } else { 0 }).as_real().0)
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0.to_bitmask() != 0
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.0.to_bitmask() == 0xff
    }
}

impl Recordable for F32x8 {}
impl Real for F32x8 {
    type Mask = Mask8;
    type Int = U32x8;
    const PRECISION: Precision = Precision::Single;
    const EPSILON: Self = Self::new([f32::EPSILON; 8]);
    const ZERO: Self = Self(f32x8::ZERO);
    const ONE: Self = Self(f32x8::ONE);

    #[inline(always)]
    fn lit(x: f64) -> Self {
        Self::splat(x as f32)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self(self.0.mul_add(a.0, b.0))
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        Self(self.0.fast_min(b.0))
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        Self(self.0.fast_max(b.0))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        let bit = U32x8::splat(0x8000_0000);
        let rest = U32x8::splat(0x7fff_ffff);
        ((self.to_bits() & rest) | (sign.to_bits() & bit)).as_real()
    }
    #[inline(always)]
    fn negated(self, mask: Mask8) -> Self {
        // Only the sign bit of a mask of ones is left to turn.
        (self.to_bits() ^ (U32x8(bytemuck::cast(mask.0)) & U32x8::splat(0x8000_0000))).as_real()
    }
    #[inline(always)]
    fn lt(self, b: Self) -> Mask8 {
        Mask8(self.0.simd_lt(b.0))
    }
    #[inline(always)]
    fn le(self, b: Self) -> Mask8 {
        Mask8(self.0.simd_le(b.0))
    }
    #[inline(always)]
    fn same(self, b: Self) -> Mask8 {
        Mask8(self.0.simd_eq(b.0))
    }
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(mask.0.select(yes.0, no.0))
    }
    #[inline(always)]
    fn or_zero(self, mask: Mask8) -> Self {
        Self(self.0 & mask.0)
    }
    #[inline(always)]
    fn round_to_int(self) -> (Self, U32x8) {
        let magic = Self::splat(12_582_912.0); // 1.5·2²³, as for the scalar
        let shifted = self + magic;
        (shifted - magic, shifted.to_bits() & U32x8::splat(0x3f_ffff))
    }
    #[inline(always)]
    fn ldexp(self, n: U32x8) -> Self {
        (self.to_bits() + (n << 23)).as_real()
    }
    #[inline(always)]
    fn split_exponent(self) -> (Self, Self) {
        let (one, least) = (1.0_f32.to_bits(), core::f32::consts::FRAC_1_SQRT_2.to_bits());
        let bits = self.to_bits() + U32x8::splat(one - least);
        let exponent = (bits >> 23).to_real() - Self::splat((one >> 23) as f32);
        (((bits & U32x8::splat(0x7f_ffff)) + U32x8::splat(least)).as_real(), exponent)
    }
    #[inline(always)]
    fn int(x: u32) -> U32x8 {
        U32x8::splat(x)
    }
    #[inline(always)]
    fn int_bit(x: U32x8, bit: u32) -> Mask8 {
        let bit = U32x8::splat(1_u32.wrapping_shl(bit));
        (x & bit).same(bit)
    }
    #[inline(always)]
    fn int_same(x: U32x8, y: U32x8) -> Mask8 {
        x.same(y)
    }
    #[inline(always)]
    fn int_add(x: U32x8, y: U32x8) -> U32x8 {
        x + y
    }
    #[inline(always)]
    fn int_lt(x: U32x8, y: U32x8) -> Mask8 {
        x.lt(y)
    }
    #[inline(always)]
    fn int_select(mask: Mask8, yes: U32x8, no: U32x8) -> U32x8 {
        U32x8::select(mask, yes, no)
    }
    #[inline(always)]
    fn to_int(self) -> U32x8 {
        let inside = self.max(Self::ZERO).min(Self::splat(LARGEST_INT as f32));
        U32x8(bytemuck::cast(inside.0.fast_trunc_int()))
    }
    #[inline(always)]
    fn from_int(x: U32x8) -> Self {
        x.to_real()
    }
    #[inline(always)]
    fn lookup(table: Table<'_>, index: U32x8) -> Self {
        let index = index.to_array();
        Self::new(index.map(|index| table.at(index)))
    }
    #[inline(always)]
    #[allow(clippy::eq_op)]
    fn is_finite(self) -> Mask8 {
        // As for the scalar.
        (self - self).same(Self::ZERO)
    }
}

#[cfg(test)]
mod tests;
