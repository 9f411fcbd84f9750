//! The operators of lanes, each lane by itself, and the arrays that lanes are made of.

use super::{F32x8, Mask8, U32x8};
use core::ops::{
    Add, AddAssign, BitAnd, BitOr, BitXor, Div, DivAssign, Mul, MulAssign, Neg, Not, Shl, Shr, Sub, SubAssign,
};

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
lanewise!(Mask8: BitAnd bitand, BitOr bitor, BitXor bitxor);

macro_rules! arrays {
    ($($t:ident $element:ident),*) => {$(
        impl From<[$element; 8]> for $t {
            #[inline(always)]
            fn from(lanes: [$element; 8]) -> Self {
                Self::new(lanes)
            }
        }
        impl From<$t> for [$element; 8] {
            #[inline(always)]
            fn from(lanes: $t) -> Self {
                lanes.to_array()
            }
        }
    )*};
}
arrays!(F32x8 f32, U32x8 u32);

impl Shr<u32> for U32x8 {
    type Output = Self;
    #[inline(always)]
    fn shr(self, bits: u32) -> Self {
        Self(self.0 >> bits)
    }
}
impl Shl<u32> for U32x8 {
    type Output = Self;
    #[inline(always)]
    fn shl(self, bits: u32) -> Self {
        Self(self.0 << bits)
    }
}
impl Neg for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}
macro_rules! assign {
    ($($op:ident $f:ident $sign:tt),*) => {$(
        impl $op for F32x8 {
            #[inline(always)]
            fn $f(&mut self, other: Self) {
                *self = *self $sign other;
            }
        }
    )*};
}
assign!(AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *, DivAssign div_assign /);
impl Not for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}
