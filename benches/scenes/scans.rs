//! Nine scans in a box of 12 × 8 × 12 units, each turned another way.
//!
//! The scan is the Stanford bunny (Turk & Levoy 1994), 69,630 triangles, if the test data are there:
//! `scenes/meshes/stanford-bunny.obj` in the folder that `GONIO_DATA` names, or else in `../shared/data` beside the repository.
//! Otherwise it is a lump with the bunny's irregularity: triangles of changing size, none like its neighbour, over a surface of
//! bumps upon bumps.

use super::random::{at_lattice, fractal};
use super::{Camera, Random, Scene, Sheets, assemble, lamp};
use gonio_accel::Mesh;
use gonio_kernel::warp::sample_uniform_sphere;
use gonio_kernel::{Frame, Vec3};
use gonio_tracer::World;
use std::path::{Path, PathBuf};

const SCANS: usize = 9;
const BOX: Vec3<f32> = Vec3::new(12.0, 8.0, 12.0);

/// With lumps.
pub(crate) fn generated(triangles: usize) -> Scene {
    scene("scans (generated)", &lump(triangles / SCANS))
}

/// With the Stanford bunny, if it is there.
pub(crate) fn bunnies() -> Option<Scene> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let path = std::env::var_os("GONIO_DATA").map_or_else(beside, PathBuf::from);
    let path = path.join("scenes/meshes/stanford-bunny.obj");
    let scanned = gonio_tracer::scene::Scene::load(&path).ok().filter(|_| path.exists())?;
    let world = World::new(&scanned).ok()?;
    Some(scene("scans (bunny)", &world.geometry().meshes()[0]))
}

fn scene(name: &str, scan: &Mesh) -> Scene {
    let mut sheets = Sheets::default();
    sheets.cuboid(Vec3::splat(0.0), BOX);
    let positions: Vec<Vec3<f32>> = scan.positions.iter().map(|&p| p.into()).collect();
    let extreme = |pick: fn(f32, f32) -> f32| {
        positions.iter().fold(positions[0], |a, b| Vec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z)))
    };
    let (lo, hi) = (extreme(f32::min), extreme(f32::max));
    let scale = 4.0 / (hi - lo).length();
    let mut random = Random(5);
    for i in 0..SCANS {
        let middle = Vec3::new(2.5 + 3.5 * (i % 3) as f32, 2.0 + 2.0 * random.next(), 2.5 + 3.5 * (i / 3) as f32);
        let frame = Frame::from_normal(sample_uniform_sphere([random.next(), random.next()]));
        let first = sheets.mesh.positions.len() as u32;
        let placed = positions.iter().map(|&p| middle + frame.to_world((p - (lo + hi) * 0.5) * scale));
        sheets.mesh.positions.extend(placed.map(|p| [p.x, p.y, p.z]));
        sheets.mesh.triangles.extend(scan.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    let camera = Camera { eye: Vec3::new(0.8, 5.5, 0.8), target: Vec3::new(6.5, 3.0, 6.5), field_of_view: 60.0 };
    assemble(name, sheets, camera, lamp(Vec3::new(6.0, 7.9, 6.0), 2.0, 2.0))
}

/// A closed surface of about so many triangles: the sides of a cube blown up to a sphere, with bumps, and vertices pushed about
/// within it.
fn lump(triangles: usize) -> Mesh {
    let squares = (triangles as f32 / 12.0).sqrt().round().max(1.0);
    let mut sheets = Sheets::default();
    for side in 0..6 {
        sheets.add([squares as usize; 2], |u, v| {
            let w = if side < 3 { [v, u, 0.0] } else { [u, v, 1.0] };
            let cube: [f32; 3] = std::array::from_fn(|axis| w[(axis + side) % 3]);
            // From the whole numbers of the cube's surface, so that sides agree about the vertices that they share.
            let place = cube.map(|c| (c * squares).round() as i32);
            let push = |seed: i32| (at_lattice(place.map(|n| n + seed)) - 0.5) * 0.8 / squares;
            let from_middle = Vec3::from(cube) - Vec3::splat(0.5) + Vec3::new(push(1000), push(2000), push(3000));
            let out = from_middle.normalize();
            out * (0.6 + 0.5 * fractal(out * 2.5 + Vec3::splat(40.0), 7))
        });
    }
    sheets.mesh
}
