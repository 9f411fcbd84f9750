//! A triangle as shading sees it.

use gonio_kernel::Vec3;

/// What shading needs of every triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    pub(crate) corners: [Vec3<f32>; 3],
    /// Geometric normal on the front of the winding, unit; 0 if the triangle is too small to have one.
    pub(crate) normal: Vec3<f32>,
    /// Index into `World::materials`.
    pub(crate) material: u32,
}

/// The unit normal on the front of a triangle's winding; 0 if it is too small to have one.
pub(super) fn unit_normal([a, b, c]: &[Vec3<f32>; 3]) -> Vec3<f32> {
    (*b - *a).cross(*c - *a).normalize_or(Vec3::new(0.0, 0.0, 0.0))
}
