//! A real whose masks answer as those of eight lanes do that disagree: `any()` is true and `all()` is false, always.
//!
//! What is computed with it must have the bits of the plain number. Then no branch on `any()` or `all()` chooses a formula, and a
//! recorder, which answers like this, records what is computed. Use: run the same generic function with `R` and `MixedLanes<R>`.

use crate::real::{Mask, Precision, Real, Recordable};
use crate::table::Table;
use core::ops::{Add, AddAssign, BitAnd, BitOr, BitXor, Div, DivAssign, Mul, MulAssign, Neg, Not, Sub, SubAssign};

/// The number, and nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MixedLanes<R>(pub(crate) R);

/// A truth that nobody can branch on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MixedMask<M>(pub(crate) M);

macro_rules! delegate {
    ($t:ident, $bound:ident: $($op:ident $f:ident),*) => {$(
        impl<T: $bound> $op for $t<T> {
            type Output = Self;
            fn $f(self, other: Self) -> Self {
                Self(self.0.$f(other.0))
            }
        }
    )*};
}
delegate!(MixedLanes, Real: Add add, Sub sub, Mul mul, Div div);
delegate!(MixedMask, Mask: BitAnd bitand, BitOr bitor, BitXor bitxor);

macro_rules! delegate_assign {
    ($($op:ident $f:ident),*) => {$(
        impl<R: Real> $op for MixedLanes<R> {
            fn $f(&mut self, other: Self) {
                self.0.$f(other.0);
            }
        }
    )*};
}
delegate_assign!(AddAssign add_assign, SubAssign sub_assign, MulAssign mul_assign, DivAssign div_assign);

impl<R: Real> Neg for MixedLanes<R> {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}
impl<M: Mask> Not for MixedMask<M> {
    type Output = Self;
    fn not(self) -> Self {
        Self(!self.0)
    }
}
impl<M: Mask> Mask for MixedMask<M> {
    fn splat(value: bool) -> Self {
        Self(M::splat(value))
    }
    fn any(self) -> bool {
        true
    }
    fn all(self) -> bool {
        false
    }
}

impl<R: Real> Recordable for MixedLanes<R> {}
impl<R: Real> Real for MixedLanes<R> {
    type Mask = MixedMask<R::Mask>;
    type Int = R::Int;
    const PRECISION: Precision = R::PRECISION;
    const EPSILON: Self = Self(R::EPSILON);
    const ZERO: Self = Self(R::ZERO);
    const ONE: Self = Self(R::ONE);

    fn lit(x: f64) -> Self {
        Self(R::lit(x))
    }
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self(self.0.mul_add(a.0, b.0))
    }
    fn min(self, b: Self) -> Self {
        Self(self.0.min(b.0))
    }
    fn max(self, b: Self) -> Self {
        Self(self.0.max(b.0))
    }
    fn copysign(self, sign: Self) -> Self {
        Self(self.0.copysign(sign.0))
    }
    fn negated(self, mask: Self::Mask) -> Self {
        Self(self.0.negated(mask.0))
    }
    fn lt(self, b: Self) -> Self::Mask {
        MixedMask(self.0.lt(b.0))
    }
    fn le(self, b: Self) -> Self::Mask {
        MixedMask(self.0.le(b.0))
    }
    fn same(self, b: Self) -> Self::Mask {
        MixedMask(self.0.same(b.0))
    }
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self(R::select(mask.0, yes.0, no.0))
    }
    fn round_to_int(self) -> (Self, R::Int) {
        let (real, int) = self.0.round_to_int();
        (Self(real), int)
    }
    fn ldexp(self, n: R::Int) -> Self {
        Self(self.0.ldexp(n))
    }
    fn split_exponent(self) -> (Self, Self) {
        let (mantissa, exponent) = self.0.split_exponent();
        (Self(mantissa), Self(exponent))
    }
    fn int(x: u32) -> R::Int {
        R::int(x)
    }
    fn int_bit(x: R::Int, bit: u32) -> Self::Mask {
        MixedMask(R::int_bit(x, bit))
    }
    fn int_same(x: R::Int, y: R::Int) -> Self::Mask {
        MixedMask(R::int_same(x, y))
    }
    fn int_add(x: R::Int, y: R::Int) -> R::Int {
        R::int_add(x, y)
    }
    fn int_lt(x: R::Int, y: R::Int) -> Self::Mask {
        MixedMask(R::int_lt(x, y))
    }
    fn int_select(mask: Self::Mask, yes: R::Int, no: R::Int) -> R::Int {
        R::int_select(mask.0, yes, no)
    }
    fn to_int(self) -> R::Int {
        self.0.to_int()
    }
    fn from_int(x: R::Int) -> Self {
        Self(R::from_int(x))
    }
    fn lookup(table: Table<'_>, index: R::Int) -> Self {
        Self(R::lookup(table, index))
    }
    fn is_finite(self) -> Self::Mask {
        MixedMask(self.0.is_finite())
    }
}

mod tests {
    use super::*;
    use crate::testing::results::{physics, reals, triples, truths};
    use crate::testing::same_bits;

    /// What must not be: a shortcut that gives another answer where every lane takes it.
    fn shortcut<R: Real>(x: R) -> R {
        if x.lt(R::ONE).all() { x * R::lit(0.1) } else { x / R::lit(10.0) }
    }

    #[test]
    fn no_result_depends_on_what_other_lanes_do() {
        for triple in triples() {
            let mixed = triple.map(MixedLanes);
            let alone = reals(triple).into_iter().chain(physics(triple));
            for (i, (x, mixed)) in alone.zip(reals(mixed).into_iter().chain(physics(mixed))).enumerate() {
                assert!(same_bits(x, mixed.0), "result {i} of {triple:?}: {x:e} alone, {:e} among others", mixed.0);
            }
            for (i, (x, mixed)) in truths(triple).into_iter().zip(truths(mixed)).enumerate() {
                assert_eq!(x, mixed.0, "truth {i} of {triple:?}");
            }
        }
    }

    #[test]
    fn a_shortcut_with_another_formula_is_noticed() {
        let noticed = |x: f32| shortcut(x).to_bits() != shortcut(MixedLanes(x)).0.to_bits();
        assert!((1..100).any(|i| noticed(i as f32 / 128.0)));
    }
}
