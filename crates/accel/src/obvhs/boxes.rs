//! Boxes for building: two corners in a vector register each, and a triangle's box together with its number.

use glam::Vec4;
use gonio_kernel::Vec3;

/// An axis-aligned box. The fourth components mean nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Box3 {
    pub(super) lo: Vec4,
    pub(super) hi: Vec4,
}

impl Box3 {
    /// The box of no points.
    pub(super) const EMPTY: Self = Self { lo: Vec4::splat(f32::INFINITY), hi: Vec4::splat(f32::NEG_INFINITY) };

    /// The box of some points.
    pub(super) fn of_points(points: impl IntoIterator<Item = Vec3<f32>>) -> Self {
        points.into_iter().map(|v| Vec4::new(v.x, v.y, v.z, 1.0)).fold(Self::EMPTY, Self::grown)
    }

    /// The box of this one and a point.
    #[inline(always)]
    pub(super) fn grown(self, point: Vec4) -> Self {
        Self { lo: self.lo.min(point), hi: self.hi.max(point) }
    }

    /// The box of both.
    #[inline(always)]
    pub(super) fn union(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Whether the other lies within this one.
    pub(super) fn contains(self, other: Self) -> bool {
        let (lo, hi) = (self.lo.cmple(other.lo), self.hi.cmpge(other.hi));
        (lo & hi).bitmask() & 7 == 7
    }

    /// Half the surface; of no points not a number or infinite.
    #[inline(always)]
    pub(super) fn half_area(self) -> f32 {
        let d = self.hi - self.lo;
        d.x * d.y + d.y * d.z + d.z * d.x
    }

    /// Twice the centre: saves a product.
    #[inline(always)]
    pub(super) fn center2(self) -> Vec4 {
        self.lo + self.hi
    }
}

/// The box of a triangle and the triangle's number, in 32 bytes: half of the number is in the fraction of either fourth component,
/// under the exponent of 1, because whole numbers as bits of reals would be denormal, and those are slow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ref(Box3);

const ONE: u32 = 0x3f80_0000;
const HALF: u32 = 0xffff;

impl Ref {
    pub(super) fn new(mut bounds: Box3, index: u32) -> Self {
        bounds.lo.w = f32::from_bits(ONE | index & HALF);
        bounds.hi.w = f32::from_bits(ONE | index >> 16);
        Self(bounds)
    }

    #[inline(always)]
    pub(super) fn bounds(&self) -> Box3 {
        self.0
    }

    #[inline(always)]
    pub(super) fn index(&self) -> u32 {
        (self.0.lo.w.to_bits() & HALF) | (self.0.hi.w.to_bits() & HALF) << 16
    }
}
