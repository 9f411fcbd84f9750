//! A room with two blocks, as in the Cornell box: so few triangles that a list may serve better than a tree.

use super::{Camera, Scene, Sheets, assemble, lamp};
use gonio_kernel::Vec3;

/// 36 triangles; the camera is inside.
#[allow(dead_code, reason = "times of so little say nothing; its instructions are counted")]
pub(crate) fn scene() -> Scene {
    let mut sheets = Sheets::default();
    for (lo, hi) in [
        ([-1.0, 0.0, -1.0], [1.0, 2.0, 1.0]),
        ([-0.7, 0.0, -0.6], [-0.1, 1.2, 0.0]),
        ([0.1, 0.0, 0.0], [0.7, 0.6, 0.6]),
    ] {
        sheets.cuboid(lo.into(), hi.into());
    }
    let camera = Camera { eye: Vec3::new(0.1, 1.1, 0.95), target: Vec3::new(0.0, 0.9, 0.0), field_of_view: 75.0 };
    assemble("room", sheets, camera, lamp(Vec3::new(0.0, 1.98, 0.0), 0.5, 0.5))
}
