//! A fractal height field over 40 × 40 units, as many squares wide as deep.

use super::random::fractal;
use super::{Camera, Scene, Sheets, assemble, lamp};
use gonio_kernel::Vec3;

const SIDE: f32 = 40.0;

pub(crate) fn scene(triangles: usize) -> Scene {
    let squares = (0.5 * triangles as f32).sqrt().round().max(1.0) as usize;
    let mut sheets = Sheets::default();
    sheets.add([squares, squares], |u, v| {
        // v falls along z, so that the front of the triangles is above.
        let at = Vec3::new(SIDE * u, 0.0, SIDE * (1.0 - v));
        Vec3::new(at.x, 3.0 * fractal(at * 0.15, 9), at.z)
    });
    let camera = Camera { eye: Vec3::new(20.0, 12.0, -6.0), target: Vec3::new(20.0, 2.0, 18.0), field_of_view: 50.0 };
    assemble("terrain", sheets, camera, lamp(Vec3::new(8.0, 16.0, 30.0), 8.0, 8.0))
}
