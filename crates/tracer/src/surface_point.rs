//! Points of triangles with a bound of their error: where rays start that must not meet the triangle they leave.

use gonio_kernel::{F32x8, Real, Vec3};

/// Error bound of a position formed from barycentrics, in units of the sum of its absolute terms: two roundings for the
/// weight of the first corner, three for products and sums, one for adding the offset, and room for the offset's own.
const POSITION_ERROR: f32 = 10.0 / 16_777_216.0;

/// A point of a triangle, and how far it can be from the exact plane.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Where it is.
    pub position: Vec3<F32x8>,
    error: Vec3<F32x8>,
}

impl SurfacePoint {
    /// From barycentrics on the corners, never from o + t·d: the error does not grow with the distance travelled.
    #[inline(always)]
    pub fn new(corners: &[Vec3<F32x8>; 3], bary: [F32x8; 2]) -> Self {
        let [b1, b2] = bary;
        let b0 = F32x8::ONE - b1 - b2;
        let blend = |c: [Vec3<F32x8>; 3]| (c[0] * b0).along(b1, c[1]).along(b2, c[2]);
        let error = blend(corners.map(Vec3::abs)) * F32x8::splat(POSITION_ERROR);
        Self { position: blend(*corners), error }
    }

    /// The point moved off the plane to the side that the unit normal n points to, by at least its error.
    #[inline(always)]
    pub fn off_plane(&self, n: Vec3<F32x8>) -> Vec3<F32x8> {
        self.position.along(self.error.dot(n.abs()), n)
    }
}
