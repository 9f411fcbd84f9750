//! Places of rays and triangles in `f64`: what decides a question of rounding is not itself rounded to `f32`.

use gonio_kernel::Vec3;

/// The same vector in `f64`, exactly.
pub(crate) fn wide(v: Vec3<f32>) -> Vec3<f64> {
    Vec3::new(v.x.into(), v.y.into(), v.z.into())
}
