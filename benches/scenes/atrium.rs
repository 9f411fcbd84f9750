//! A closed hall, 40 × 16 × 20 units: walls of two triangles each, two rows of twelve fluted columns with arches from each to
//! the next, four hangings of cloth, and boxes on the floor.

use super::{Camera, Random, Scene, Sheets, assemble, lamp};
use gonio_kernel::Vec3;
use gonio_kernel::math::sin_cos_turns;

const HALL: Vec3<f32> = Vec3::new(40.0, 16.0, 20.0);
/// In a row.
const COLUMNS: usize = 12;
const HEIGHT: f32 = 8.0;
const BOXES: usize = 100;

pub(crate) fn scene(triangles: usize) -> Scene {
    let mut sheets = Sheets::default();
    sheets.cuboid(Vec3::splat(0.0), HALL);
    // Of every hundred fine triangles 60 are in columns, 20 in arches and 20 in cloth; 10 boxes more or less do not show.
    let boxes = BOXES.min(triangles / 100);
    let fine = triangles.saturating_sub(12 * (boxes + 1)) as f32;
    let squares = |share: f32, pieces: usize| (0.5 * share * fine / pieces as f32).sqrt();
    let (column, arch, cloth) = (squares(0.6, 2 * COLUMNS), squares(0.2, 2 * COLUMNS - 2), squares(0.2, 4));
    let grid = |columns: f32, rows: f32| [columns.round().max(3.0) as usize, rows.round().max(3.0) as usize];

    let step = HALL.x / (COLUMNS as f32 + 1.0);
    for z in [5.0, 15.0] {
        for i in 0..COLUMNS {
            let foot = Vec3::new(step * (i as f32 + 1.0), 0.0, z);
            sheets.add(grid(column, column), |u, v| foot + fluted(u, v));
            if i > 0 {
                sheets.add(grid(2.0 * arch, 0.5 * arch), |u, v| foot + half_ring(u, v, step));
            }
        }
    }
    for i in 0..4 {
        let corner = Vec3::new(6.0 + 8.0 * i as f32, 15.0, 3.0 + 4.0 * i as f32);
        sheets.add(grid(cloth, cloth), |u, v| corner + hanging(u, v));
    }
    let mut random = Random(7);
    for _ in 0..boxes {
        let lo = Vec3::new(1.0 + 36.0 * random.next(), 0.0, 1.0 + 16.0 * random.next());
        sheets.cuboid(lo, lo + Vec3::new(0.2 + random.next(), 0.2 + 1.5 * random.next(), 0.2 + random.next()));
    }
    let camera = Camera { eye: Vec3::new(2.0, 5.0, 10.0), target: Vec3::new(38.0, 6.0, 9.0), field_of_view: 60.0 };
    assemble("atrium", sheets, camera, lamp(Vec3::new(20.0, 15.5, 10.0), 8.0, 4.0))
}

/// The surface of a column: 16 flutes, narrower towards the top.
fn fluted(u: f32, v: f32) -> Vec3<f32> {
    let (sin, cos) = sin_cos_turns(-u);
    let (flute, _) = sin_cos_turns(16.0 * u);
    let radius = (0.6 - 0.15 * v) * (1.0 + 0.05 * flute);
    Vec3::new(radius * cos, HEIGHT * v, radius * sin)
}

/// The surface of an arch from a column's top back to that of the one before: half a ring of round section.
fn half_ring(u: f32, v: f32, step: f32) -> Vec3<f32> {
    let ((up, along), (sin, cos)) = (sin_cos_turns(0.5 * u), sin_cos_turns(v));
    let radius = 0.5 * step + 0.3 * cos;
    Vec3::new(radius * along - 0.5 * step, HEIGHT + radius * up, 0.3 * sin)
}

/// Cloth, 4 wide and 7 high, in folds that grow towards its lower end.
fn hanging(u: f32, v: f32) -> Vec3<f32> {
    let ((fold, _), (wave, _)) = (sin_cos_turns(5.0 * u + 0.3 * v), sin_cos_turns(3.0 * v + u));
    Vec3::new(v * (0.4 * fold + 0.1 * wave), -7.0 * v, 4.0 * u)
}
