//! The operators of values of three components, which colours and vectors share.

/// Operators between two values: component by component.
macro_rules! by_component {
    ($value:ident($x:ident, $y:ident, $z:ident): $($op:ident $f:ident $assign:ident $assign_f:ident $sign:tt),*) => {$(
        /// Component by component.
        impl<R: Real> $op for $value<R> {
            type Output = Self;
            #[inline(always)]
            fn $f(self, other: Self) -> Self {
                Self::new(self.$x $sign other.$x, self.$y $sign other.$y, self.$z $sign other.$z)
            }
        }
        /// Component by component.
        impl<R: Real> $assign for $value<R> {
            #[inline(always)]
            fn $assign_f(&mut self, other: Self) {
                *self = *self $sign other;
            }
        }
    )*};
}

/// Multiplication and division by a number: each component by the same.
macro_rules! by_number {
    ($value:ident($x:ident, $y:ident, $z:ident)) => {
        $crate::operators::by_number!($value($x, $y, $z): Mul mul MulAssign mul_assign *, Div div DivAssign div_assign /);
        $crate::operators::by_number!($value: f32);
        $crate::operators::by_number!($value: f64);
        #[cfg(feature = "wide")]
        $crate::operators::by_number!($value: $crate::lanes::F32x8);
    };
    ($value:ident($x:ident, $y:ident, $z:ident): $($op:ident $f:ident $assign:ident $assign_f:ident $sign:tt),*) => {$(
        /// Each component by the same number; a division is a true one.
        impl<R: Real> $op<R> for $value<R> {
            type Output = Self;
            #[inline(always)]
            fn $f(self, k: R) -> Self {
                Self::new(self.$x $sign k, self.$y $sign k, self.$z $sign k)
            }
        }
        /// Each component by the same number.
        impl<R: Real> $assign<R> for $value<R> {
            #[inline(always)]
            fn $assign_f(&mut self, k: R) {
                *self = *self $sign k;
            }
        }
    )*};
    ($value:ident: $number:ty) => {
        /// Each component times the number.
        impl Mul<$value<$number>> for $number {
            type Output = $value<$number>;
            #[inline(always)]
            fn mul(self, value: $value<$number>) -> $value<$number> {
                value * self
            }
        }
    };
}

pub(crate) use {by_component, by_number};
