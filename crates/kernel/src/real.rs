//! `Real`: the few operations that physics needs of a number, named as on `f32`, and the `Mask` that goes with it.
//!
//! Two rules make eight lanes equal the scalar bit for bit. `min`, `max` and `select` are written here, with one
//! answer for NaN and for the sign of zero (std leaves both open). `sqrt` and `mul_add` of a scalar are lane 0 of
//! `wide`'s narrow types: `core` has neither, and std's fused multiply-add rounds differently where the target has none.
//! Without the feature `wide` both are software that rounds once, as the instructions do: a feature never changes a result.

use crate::table::Table;
use core::fmt::Debug;
use core::ops::{Add, AddAssign, BitAnd, BitOr, BitXor, Div, DivAssign, Mul, MulAssign, Neg, Not, Sub, SubAssign};

/// The truth of a comparison, lane by lane: `bool` for a scalar.
pub trait Mask:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + BitXor<Output = Self> + Not<Output = Self>
{
    /// The same truth in every lane.
    fn splat(value: bool) -> Self;
    /// True if some lane is true.
    fn any(self) -> bool;
    /// True if every lane is true.
    fn all(self) -> bool;
}

/// How many bits a significand has: chooses the coefficient table of [`crate::math`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// IEEE binary32.
    Single,
    /// IEEE binary64.
    Double,
}

/// What seals [`Real`]: only a crate that records the kernel's operations implements it, and it is no part of what versions promise.
///
/// A recorder answers [`Mask::any`] with true and [`Mask::all`] with false, so that the text of both branches is recorded. Therefore
/// control flow on values asks only "is there any work?": the result has the same bits whichever way the branch goes.
#[doc(hidden)]
pub trait Recordable: Copy {
    /// f(args), a function worth keeping under its name in what is recorded. Everybody else's is transparent.
    ///
    /// `f` uses nothing but its arguments and constants, and is marked `#[inline(always)]`, without which long ones become calls.
    #[inline(always)]
    fn named<const N: usize, const M: usize>(
        name: &'static str,
        args: [Self; N],
        f: impl FnOnce([Self; N]) -> [Self; M],
    ) -> [Self; M] {
        let _ = name;
        f(args)
    }
}

/// A real number: `f32`, `f64`, or several `f32` in lanes.
pub trait Real:
    Recordable
    + Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
    + 'static
{
    /// The result of a comparison.
    type Mask: Mask;
    /// A small non-negative integer per lane: which lobe, which quadrant.
    type Int: Copy + Debug;

    /// The precision of one lane.
    const PRECISION: Precision;
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;
    /// 0
    const ZERO: Self;
    /// 1
    const ONE: Self;

    /// The constant `x`, rounded to this precision, in every lane.
    fn lit(x: f64) -> Self;
    /// √self, correctly rounded; NaN below zero.
    fn sqrt(self) -> Self;
    /// |self|
    fn abs(self) -> Self;
    /// self·a + b, fused where the build's target has the instruction, and always without the feature `wide`.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// The smaller of two: `if self < b { self } else { b }`, so a NaN on either side gives `b`.
    fn min(self, b: Self) -> Self;
    /// The larger of two: `if self > b { self } else { b }`, so a NaN on either side gives `b`.
    fn max(self, b: Self) -> Self;
    /// |self| with the sign bit of `sign`, that of a zero included.
    fn copysign(self, sign: Self) -> Self;
    /// −self where `mask`, self elsewhere.
    fn negated(self, mask: Self::Mask) -> Self;
    /// self < b, false for NaN.
    fn lt(self, b: Self) -> Self::Mask;
    /// self ≤ b, false for NaN.
    fn le(self, b: Self) -> Self::Mask;
    /// self = b, false for NaN.
    fn same(self, b: Self) -> Self::Mask;
    /// `yes` where `mask`, `no` elsewhere; neither is computed with.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// The nearest integer (ties to even) as a real and as an integer modulo 2²²; for |self| < 2²¹.
    fn round_to_int(self) -> (Self, Self::Int);
    /// self·2ⁿ, n modulo 2⁹ (2¹² in `f64`), by adding n to the exponent's bits: self and the result must be normal numbers.
    fn ldexp(self, n: Self::Int) -> Self;
    /// m in [√½, √2) and an integer e with self = m·2ᵉ, for a positive normal number.
    fn split_exponent(self) -> (Self, Self);
    /// The integer `x` in every lane.
    fn int(x: u32) -> Self::Int;
    /// Whether `bit` of `x` is set.
    fn int_bit(x: Self::Int, bit: u32) -> Self::Mask;
    /// x = y
    fn int_same(x: Self::Int, y: Self::Int) -> Self::Mask;
    /// x + y, wrapping.
    fn int_add(x: Self::Int, y: Self::Int) -> Self::Int;
    /// x < y, for both below 2³¹: lanes compare signed.
    fn int_lt(x: Self::Int, y: Self::Int) -> Self::Mask;
    /// `yes` where `mask`, `no` elsewhere.
    fn int_select(mask: Self::Mask, yes: Self::Int, no: Self::Int) -> Self::Int;
    /// The integer part of self limited to [0, 2²² − 1]; a NaN gives 0. Exact: nothing is rounded.
    ///
    /// ```
    /// # use gonio_kernel::Real;
    /// assert_eq!([3.99_f32, -5.0, f32::NAN, 1e30].map(Real::to_int), [3, 0, 0, 4_194_303]);
    /// ```
    fn to_int(self) -> Self::Int;
    /// The real nearest to an integer below 2³¹.
    fn from_int(x: Self::Int) -> Self;
    /// The value of `table` at `index`: beyond its end the last one, and 0 if it has none.
    ///
    /// Lanes cannot gather: each does a look-up of its own. So tables belong into what is prepared once, not into what depends on wi.
    fn lookup(table: Table<'_>, index: Self::Int) -> Self;
    /// Neither NaN nor infinite.
    fn is_finite(self) -> Self::Mask;

    /// self > b, false for NaN.
    #[inline(always)]
    fn gt(self, b: Self) -> Self::Mask {
        b.lt(self)
    }
    /// self ≥ b, false for NaN.
    #[inline(always)]
    fn ge(self, b: Self) -> Self::Mask {
        b.le(self)
    }
    /// self where `mask`, +0 elsewhere, whatever self is there, NaN included.
    #[inline(always)]
    fn or_zero(self, mask: Self::Mask) -> Self {
        Self::select(mask, self, Self::ZERO)
    }
    /// self²
    #[inline(always)]
    fn sqr(self) -> Self {
        self * self
    }
    /// 1 / self, a true division.
    #[inline(always)]
    fn recip(self) -> Self {
        Self::ONE / self
    }
    /// self limited to [lo, hi]; a NaN gives `lo`.
    #[inline(always)]
    fn clamp(self, lo: f64, hi: f64) -> Self {
        self.max(Self::lit(lo)).min(Self::lit(hi))
    }
}

impl Mask for bool {
    #[inline(always)]
    fn splat(value: bool) -> bool {
        value
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
}

macro_rules! scalar_real {
    ($t:ty, $bits:ty, $narrow:ident, [$sqrt:ident, $fma:ident], $precision:ident, $sign:expr, $magic:expr, $fraction:expr) => {
        impl Real for $t {
            type Mask = bool;
            type Int = u32;
            const PRECISION: Precision = Precision::$precision;
            const EPSILON: $t = <$t>::EPSILON;
            const ZERO: $t = 0.0;
            const ONE: $t = 1.0;

            #[inline(always)]
            fn lit(x: f64) -> $t {
                x as $t
            }
            #[inline(always)]
            fn sqrt(self) -> $t {
                #[cfg(feature = "wide")]
                return wide::$narrow::splat(self).sqrt().to_array()[0];
                #[cfg(not(feature = "wide"))]
                return libm::$sqrt(self);
            }
            #[inline(always)]
            fn abs(self) -> $t {
                <$t>::from_bits(self.to_bits() & !$sign)
            }
            #[inline(always)]
            fn mul_add(self, a: $t, b: $t) -> $t {
                #[cfg(feature = "wide")]
                return wide::$narrow::splat(self).mul_add(wide::$narrow::splat(a), wide::$narrow::splat(b)).to_array()
                    [0];
                #[cfg(not(feature = "wide"))]
                return libm::$fma(self, a, b);
            }
            #[inline(always)]
            fn min(self, b: $t) -> $t {
                if self < b { self } else { b }
            }
            #[inline(always)]
            fn max(self, b: $t) -> $t {
                if self > b { self } else { b }
            }
            #[inline(always)]
            fn copysign(self, sign: $t) -> $t {
                <$t>::from_bits((self.to_bits() & !$sign) | (sign.to_bits() & $sign))
            }
            #[inline(always)]
            fn negated(self, mask: bool) -> $t {
                if mask { -self } else { self }
            }
            #[inline(always)]
            fn lt(self, b: $t) -> bool {
                self < b
            }
            #[inline(always)]
            fn le(self, b: $t) -> bool {
                self <= b
            }
            #[inline(always)]
            fn same(self, b: $t) -> bool {
                self == b
            }
            #[inline(always)]
            fn select(mask: bool, yes: $t, no: $t) -> $t {
                if mask { yes } else { no }
            }
            #[inline(always)]
            fn round_to_int(self) -> ($t, u32) {
                // Adding 1.5·2^(p−1) leaves the integer in the low bits of the sum: no cast, no SSE4.1.
                let shifted = self + $magic;
                (shifted - $magic, (shifted.to_bits() & 0x3f_ffff) as u32)
            }
            #[inline(always)]
            fn ldexp(self, n: u32) -> $t {
                <$t>::from_bits(self.to_bits().wrapping_add(<$bits>::from(n) << $fraction))
            }
            #[inline(always)]
            fn split_exponent(self) -> ($t, $t) {
                // Counted from √½ on, the exponent's bits change where e does.
                let (one, least) = (<$t>::to_bits(1.0), <$t>::to_bits(core::f64::consts::FRAC_1_SQRT_2 as $t));
                let bits = self.to_bits().wrapping_add(one - least);
                let exponent = (bits >> $fraction) as $t - (one >> $fraction) as $t;
                (<$t>::from_bits((bits & ((1 << $fraction) - 1)) + least), exponent)
            }
            #[inline(always)]
            fn int(x: u32) -> u32 {
                x
            }
            #[inline(always)]
            fn int_bit(x: u32, bit: u32) -> bool {
                x & 1_u32.wrapping_shl(bit) != 0
            }
            #[inline(always)]
            fn int_same(x: u32, y: u32) -> bool {
                x == y
            }
            #[inline(always)]
            fn int_add(x: u32, y: u32) -> u32 {
                x.wrapping_add(y)
            }
            #[inline(always)]
            fn int_lt(x: u32, y: u32) -> bool {
                x < y
            }
            #[inline(always)]
            fn int_select(mask: bool, yes: u32, no: u32) -> u32 {
                if mask { yes } else { no }
            }
            #[inline(always)]
            fn to_int(self) -> u32 {
                Real::min(Real::max(self, 0.0), LARGEST_INT as $t) as u32
            }
            #[inline(always)]
            fn from_int(x: u32) -> $t {
                x.cast_signed() as $t // signed as in lanes
            }
            #[inline(always)]
            fn lookup(table: Table<'_>, index: u32) -> $t {
                table.at(index).into()
            }
            #[inline(always)]
            #[allow(clippy::eq_op)]
            fn is_finite(self) -> bool {
                // inf − inf and NaN − NaN are NaN, which equals nothing.
                self - self == 0.0
            }
        }
        impl Recordable for $t {}
    };
}

/// The largest result of [`Real::to_int`]: every real up to it has its integer part among the reals of `f32`.
pub(crate) const LARGEST_INT: u32 = (1 << 22) - 1;
scalar_real!(f32, u32, f32x4, [sqrtf, fmaf], Single, 0x8000_0000_u32, 12_582_912.0, 23); // 1.5·2²³
scalar_real!(f64, u64, f64x2, [sqrt, fma], Double, 0x8000_0000_0000_0000_u64, 6_755_399_441_055_744.0, 52); // 1.5·2⁵²
