//! Curly ribbons that grow out of a ball: 16 squares each, a few hundredths of a unit wide.

use super::{Camera, Random, Scene, Sheets, assemble, lamp};
use gonio_kernel::math::sin_cos_turns;
use gonio_kernel::warp::sample_uniform_sphere;
use gonio_kernel::{Frame, Vec3};

const SQUARES: usize = 16;
/// Of a ribbon in the full scene; fewer ribbons are wider, so that a ball of hair stays one.
const WIDTH: f32 = 0.006;

pub(crate) fn scene(triangles: usize) -> Scene {
    let ribbons = (triangles / (2 * SQUARES)).max(1);
    let width = WIDTH * (31_250.0 / ribbons as f32).sqrt();
    let mut sheets = Sheets::default();
    let mut random = Random(3);
    for _ in 0..ribbons {
        let out = sample_uniform_sphere([random.next(), random.next()]);
        let frame = Frame::from_normal(out);
        let [turns, phase, length, curl] = [1.0 + 2.0 * random.next(), random.next(), random.next(), random.next()];
        let (length, radius) = (0.6 + 0.8 * length, 0.02 + 0.08 * curl);
        let centre = |t: f32| {
            let (sin, cos) = sin_cos_turns(phase + turns * t);
            let hanging = Vec3::new(0.0, -0.6 * t * t, 0.0);
            out * (1.0 + length * t) + (frame.x * cos + frame.y * sin) * (radius * t) + hanging
        };
        sheets.add([1, SQUARES], |u, v| {
            let (sin, cos) = sin_cos_turns(phase + turns * v);
            // Across the curl, and to a point at the tip.
            let across = frame.y * cos - frame.x * sin;
            centre(v) + across * (width * (u - 0.5) * (1.0 - 0.8 * v))
        });
    }
    let camera = Camera { eye: Vec3::new(0.8, 0.4, -4.4), target: Vec3::new(0.0, -0.2, 0.0), field_of_view: 40.0 };
    assemble("hair", sheets, camera, lamp(Vec3::new(3.0, 4.0, -3.0), 1.5, 1.5))
}
