//! A vector of three reals: a direction, a point or a displacement, in whichever frame the caller keeps it.

use crate::operators::{by_component, by_number};
use crate::real::Real;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// Three reals. `Vec3<f32>` is 12 bytes, `repr(C)`, and converts from and to `[f32; 3]`.
///
/// Vectors are added and subtracted, and multiplied and divided by numbers. Products of two are [`Vec3::dot`], [`Vec3::cross`] and
/// [`Vec3::mul_each`].
///
/// ```
/// use gonio_kernel::Vec3;
/// let (a, mut b) = (Vec3::new(1.0_f32, 2.0, 4.0), Vec3::unit_z());
/// b += 2.0 * a;
/// assert_eq!(b / 2.0 - a, Vec3::new(0.0, 0.0, 0.5));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "bytemuck", derive(bytemuck::AnyBitPattern))]
#[repr(C)]
pub struct Vec3<R> {
    /// Along the first axis (in the local frame: the tangent).
    pub x: R,
    /// Along the second axis (in the local frame: the bitangent).
    pub y: R,
    /// Along the third axis (in the local frame: the shading normal).
    pub z: R,
}

impl<R> Vec3<R> {
    /// (x, y, z)
    #[inline(always)]
    pub const fn new(x: R, y: R, z: R) -> Self {
        Self { x, y, z }
    }
}

impl<R: Real> Vec3<R> {
    /// The same number in all three components.
    #[inline(always)]
    pub fn splat(x: R) -> Self {
        Self::new(x, x, x)
    }
    /// The unit vector (0, 0, 1): the normal of the local frame.
    #[inline(always)]
    pub fn unit_z() -> Self {
        Self::new(R::ZERO, R::ZERO, R::ONE)
    }
    /// self · other
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        self.x.mul_add(other.x, self.y.mul_add(other.y, self.z * other.z))
    }
    /// self × other, unfused, so that `a.cross(b)` is exactly `-b.cross(a)`.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }
    /// self · self
    #[inline(always)]
    pub fn length2(self) -> R {
        self.dot(self)
    }
    /// |self|
    #[inline(always)]
    pub fn length(self) -> R {
        self.length2().sqrt()
    }
    /// self / |self|; not finite for the zero vector and outside about 1e±19 in `f32`.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        self * self.length().recip()
    }
    /// The unit vector along self for any finite non-zero self, denormal or huge; `fallback` for zero, NaN and infinities.
    #[inline(always)]
    pub fn normalize_or(self, fallback: Self) -> Self {
        let largest = self.x.abs().max(self.y.abs()).max(self.z.abs());
        // Two steps keep the scale finite: 1/denormal would overflow.
        let lift = R::select(largest.lt(R::lit(1e-30)), R::lit(1e30), R::ONE);
        let scaled = self * lift * (largest * lift).recip();
        let unit = scaled.normalize();
        let ok = self.is_finite() & largest.gt(R::ZERO) & unit.is_finite();
        Self::select(ok, unit, fallback)
    }
    /// Each component multiplied by the like component.
    #[inline(always)]
    pub fn mul_each(self, other: Self) -> Self {
        Self::new(self.x * other.x, self.y * other.y, self.z * other.z)
    }
    /// The absolute value of each component.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self::new(self.x.abs(), self.y.abs(), self.z.abs())
    }
    /// self + t·dir
    #[inline(always)]
    pub fn along(self, t: R, dir: Self) -> Self {
        Self::new(t.mul_add(dir.x, self.x), t.mul_add(dir.y, self.y), t.mul_add(dir.z, self.z))
    }
    /// `yes` where `mask`, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self::new(R::select(mask, yes.x, no.x), R::select(mask, yes.y, no.y), R::select(mask, yes.z, no.z))
    }
    /// Whether all three components are finite.
    #[inline(always)]
    pub fn is_finite(self) -> R::Mask {
        self.x.is_finite() & self.y.is_finite() & self.z.is_finite()
    }
    /// Whether self is a direction in the kernel's domain: finite and | |self|² − 1 | ≤ 1e-3.
    #[inline(always)]
    pub fn is_direction(self) -> R::Mask {
        // A NaN or an infinity makes the difference NaN or infinite, and both fail the comparison.
        (self.length2() - R::ONE).abs().le(R::lit(1e-3))
    }
}

by_component!(Vec3(x, y, z): Add add AddAssign add_assign +, Sub sub SubAssign sub_assign -);
by_number!(Vec3(x, y, z));

/// The opposite direction.
impl<R: Real> Neg for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}
impl<R> From<[R; 3]> for Vec3<R> {
    fn from([x, y, z]: [R; 3]) -> Self {
        Self::new(x, y, z)
    }
}
impl<R> From<Vec3<R>> for [R; 3] {
    fn from(v: Vec3<R>) -> Self {
        [v.x, v.y, v.z]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{close, special_values};

    #[test]
    fn any_finite_vector_but_zero_has_a_direction() {
        let (values, fallback) = (special_values(), Vec3::new(0.0, 1.0, 0.0));
        for &x in &values {
            for &y in &values {
                let v = Vec3::new(x, y, 0.0);
                let unit = v.normalize_or(fallback);
                if x.is_finite() && y.is_finite() && (x != 0.0 || y != 0.0) {
                    let length = f64::from(x).hypot(y.into());
                    assert!(close(unit.x.into(), f64::from(x) / length, 2e-7), "{v:?} became {unit:?}");
                    assert!(close(unit.y.into(), f64::from(y) / length, 2e-7), "{v:?} became {unit:?}");
                } else {
                    assert_eq!(unit, fallback, "{v:?}");
                }
            }
        }
    }

    #[test]
    fn assigning_operators_do_what_the_others_do() {
        let (a, b, k) = (Vec3::new(1.0_f64, 2.0, 3.0), Vec3::new(0.5, 4.0, 0.25), 8.0);
        let (mut sum, mut difference, mut product, mut quotient) = (a, a, a, a);
        sum += b;
        difference -= b;
        product *= k;
        quotient /= k;
        assert_eq!((sum, difference, product, quotient), (a + b, a - b, a * k, a / k));
        assert_eq!((k * a, a / k), (Vec3::new(8.0, 16.0, 24.0), Vec3::new(0.125, 0.25, 0.375)));
    }

    #[test]
    fn a_direction_is_finite_and_unit_to_a_thousandth() {
        let z = |z: f32| Vec3::new(0.0, 0.0, z).is_direction();
        assert!(z(1.0) && z(-1.0004) && z(0.9996));
        assert!(!z(1.001) && !z(0.0) && !z(f32::NAN) && !z(f32::INFINITY));
    }

    #[test]
    fn the_cross_product_turns_its_sign_with_its_order() {
        let (a, b) = (Vec3::new(0.1_f32, 0.7, -0.3), Vec3::new(0.9_f32, -0.2, 0.4));
        assert_eq!(a.cross(b), -b.cross(a));
        assert_eq!(Vec3::new(1.0, 0.0, 0.0).cross(Vec3::new(0.0, 1.0, 0.0)), Vec3::<f32>::unit_z());
    }
}
