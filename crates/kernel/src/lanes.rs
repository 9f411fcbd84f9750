//! Eight `f32` side by side: the only file of the kernel that knows the width.
//!
//! A thin coat over `wide`, whose instruction set is chosen at compile time (x86-64-v3: one AVX2 register). Masks hold
//! all ones or all zeros per lane, so that `and`, `or` and blends agree on what true means. `wide`'s own `min` and `max`
//! cost three instructions and hide NaNs; ours are the single instruction, with the rule of [`Real::min`].

use crate::real::{Mask, Precision, Real};
use core::ops::{Add, AddAssign, BitAnd, BitOr, BitXor, Div, Mul, MulAssign, Neg, Not, Shr, Sub};
use wide::{f32x8, i32x8, u32x8};

/// Eight `f32`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct F32x8(pub f32x8);

/// Eight truths, each all ones or all zeros.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Mask8(f32x8);

/// Eight `u32`, with wrapping arithmetic.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct U32x8(pub u32x8);

impl F32x8 {
    /// How many lanes there are.
    pub const LANES: usize = 8;

    /// Lane *i* is `lanes[i]`.
    #[inline(always)]
    pub const fn new(lanes: [f32; 8]) -> Self {
        Self(f32x8::new(lanes))
    }
    /// `x` in every lane.
    #[inline(always)]
    pub fn splat(x: f32) -> Self {
        Self(f32x8::splat(x))
    }
    /// The lanes in order.
    #[inline(always)]
    pub fn to_array(self) -> [f32; 8] {
        self.0.to_array()
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
    /// `x` in every lane.
    #[inline(always)]
    pub fn splat(x: u32) -> Self {
        Self(u32x8::splat(x))
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
    /// `yes` where `mask`, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        F32x8::select(mask, yes.as_real(), no.as_real()).to_bits()
    }
}

macro_rules! lanewise {
    ($t:ty: $($op:ident $f:ident),*) => {$(
        impl $op for $t {
            type Output = Self;
            #[inline(always)]
            fn $f(self, other: Self) -> Self {
                Self($op::$f(self.0, other.0))
            }
        }
    )*};
}
lanewise!(F32x8: Add add, Sub sub, Mul mul, Div div);
lanewise!(U32x8: Add add, Mul mul, BitXor bitxor, BitAnd bitand, BitOr bitor);
lanewise!(Mask8: BitAnd bitand, BitOr bitor);

impl Shr<u32> for U32x8 {
    type Output = Self;
    #[inline(always)]
    fn shr(self, bits: u32) -> Self {
        Self(self.0 >> bits)
    }
}
impl Neg for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}
impl AddAssign for F32x8 {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl MulAssign for F32x8 {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}
impl Not for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
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

impl Real for F32x8 {
    type Mask = Mask8;
    type Int = U32x8;
    const PRECISION: Precision = Precision::Single;
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
    fn int_select(mask: Mask8, yes: U32x8, no: U32x8) -> U32x8 {
        U32x8::select(mask, yes, no)
    }
}
