//! Sides: on which side of a surface light is, scatters and goes on. The geometric normal decides, here and nowhere else.
//!
//! - A material emits from the front of its winding.
//! - A two-sided material scatters on both sides alike, a one-sided one on its front; one that transmits has an inside, which
//!   lies behind its winding.
//! - A direction counts as reflected if it leaves on the side of wo by the geometric normal *and* by the shading normal, as
//!   transmitted if it leaves on the other side by both; what the two disagree on is black.
//! - A ray starts off the plane of its triangle, on the side that it leaves on, by more than its position can be wrong.

use crate::surface_point::SurfacePoint;
use gonio_kernel::frame::on_its_side;
use gonio_kernel::{F32x8, Mask, Mask8, Real, Vec3};

/// The sides of eight shading points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sides {
    point: SurfacePoint,
    /// Geometric normal, unit, on wo's side.
    normal: Vec3<F32x8>,
    /// Where a ray starts that stays on wo's side.
    origin: Vec3<F32x8>,
    /// Whether something in the scene transmits: otherwise nothing leaves on the other side.
    transmission: bool,
}

impl Sides {
    #[inline(always)]
    pub(crate) fn new(point: SurfacePoint, normal: Vec3<F32x8>, transmission: bool) -> Self {
        Self { point, normal, origin: point.off_plane(normal), transmission }
    }

    /// Where a ray in the direction wi starts, and whether it leaves on the side on which it was scattered: `sides` is the
    /// product of the local cosines of wo and wi.
    #[inline(always)]
    pub(crate) fn leaving(&self, wi: Vec3<F32x8>, sides: F32x8) -> (Vec3<F32x8>, Mask8) {
        if !self.transmission {
            return (self.origin, on_its_side(self.normal, wi, Mask8::splat(false)));
        }
        let above = self.normal.dot(wi).gt(F32x8::ZERO);
        let start = Vec3::select(above, self.origin, self.point.off_plane(-self.normal));
        (start, on_its_side(self.normal, wi, sides.lt(F32x8::ZERO)))
    }

    /// Where a ray to a point starts: on the side where that is.
    #[inline(always)]
    pub(crate) fn origin_towards(&self, target: Vec3<F32x8>) -> Vec3<F32x8> {
        if !self.transmission {
            return self.origin;
        }
        let beside = self.normal.dot(target - self.point.position).lt(F32x8::ZERO);
        Vec3::select(beside, self.point.off_plane(-self.normal), self.origin)
    }
}

/// Where a surface scatters at all that is met from the front or from behind.
#[inline(always)]
pub(crate) fn scattering(front: Mask8, two_sided: Mask8) -> Mask8 {
    front | two_sided
}
