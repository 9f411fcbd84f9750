//! Nine scans in a box of 12 × 8 × 12 units, each turned another way.
//!
//! The scan is the Stanford bunny (Turk & Levoy 1994), 69,630 triangles, if the test data are there:
//! `scenes/meshes/stanford-bunny.obj` in the folder that `GONIO_DATA` names, or else in `../shared/data` beside the repository.
//! Otherwise it is a lump with the bunny's irregularity: triangles of changing size, none like its neighbour, over a surface of
//! bumps upon bumps.

use super::random::{at_lattice, fractal};
use super::{Camera, Quad, Random, Scene, Sheets, assemble, lamp};
use gonio_accel::{Geometry, Instance, Mesh};
use gonio_kernel::warp::sample_uniform_sphere;
use gonio_kernel::{Frame, Vec3};
use gonio_tracer::World;
use std::path::{Path, PathBuf};

const SCANS: usize = 9;
const BOX: Vec3<f32> = Vec3::new(12.0, 8.0, 12.0);
const CAMERA: Camera = Camera { eye: Vec3::new(0.8, 5.5, 0.8), target: Vec3::new(6.5, 3.0, 6.5), field_of_view: 60.0 };

/// With lumps.
pub(crate) fn generated(triangles: usize) -> Scene {
    merged("scans (generated)", &lump(triangles / SCANS))
}

/// With the Stanford bunny, if it is there.
pub(crate) fn bunnies() -> Option<Scene> {
    Some(merged("scans (bunny)", &bunny()?))
}

/// The same scans as instances of one mesh.
pub(crate) fn instances() -> Scene {
    bunny().map_or_else(|| placed("scans (generated)", lump(70_000)), |bunny| placed("scans (bunny)", bunny))
}

fn bunny() -> Option<Mesh> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let path = std::env::var_os("GONIO_DATA").map_or_else(beside, PathBuf::from);
    let path = path.join("scenes/meshes/stanford-bunny.obj");
    let scanned = gonio_io::load(&path).ok().filter(|_| path.exists())?;
    let world = World::new(&scanned).ok()?;
    Some(world.geometry().meshes()[0].clone())
}

/// The box, as one mesh with all scans.
fn merged(name: &str, scan: &Mesh) -> Scene {
    let (mut sheets, places) = (the_box(), Places::of(scan));
    for (middle, frame) in places.places {
        let first = sheets.mesh.positions.len() as u32;
        let away = |p: &[f32; 3]| middle + frame.to_world((Vec3::from(*p) - places.middle) * places.scale);
        sheets.mesh.positions.extend(scan.positions.iter().map(|p| <[f32; 3]>::from(away(p))));
        sheets.mesh.triangles.extend(scan.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    assemble(name, sheets, CAMERA, light())
}

/// The box, and the scan as often as it is placed.
fn placed(name: &str, scan: Mesh) -> Scene {
    let places = Places::of(&scan);
    let mut instances = vec![Instance { mesh: 0, transform: Instance::IDENTITY }];
    instances.extend(places.places.iter().map(|(middle, frame)| {
        let columns = [frame.x, frame.y, frame.z].map(|axis| axis * places.scale);
        let start = *middle - frame.to_world(places.middle) * places.scale;
        let row = |pick: fn(&Vec3<f32>) -> f32| {
            [pick(&columns[0]), pick(&columns[1]), pick(&columns[2]), pick(&start)].map(f64::from)
        };
        Instance { mesh: 1, transform: [row(|v| v.x), row(|v| v.y), row(|v| v.z)] }
    }));
    let geometry = Geometry::new(vec![the_box().mesh, scan], instances).expect("generated meshes are sound");
    Scene { name: name.to_owned(), geometry, camera: CAMERA, light: light() }
}

fn the_box() -> Sheets {
    let mut sheets = Sheets::default();
    sheets.cuboid(Vec3::splat(0.0), BOX);
    sheets
}

fn light() -> Quad {
    lamp(Vec3::new(6.0, 7.9, 6.0), 2.0, 2.0)
}

/// Where scans are.
struct Places {
    /// The middle of the scan, and what it is multiplied by.
    middle: Vec3<f32>,
    scale: f32,
    /// Where each middle is, and how it is turned.
    places: [(Vec3<f32>, Frame<f32>); SCANS],
}

impl Places {
    fn of(scan: &Mesh) -> Self {
        let positions: Vec<Vec3<f32>> = scan.positions.iter().map(|&p| p.into()).collect();
        let extreme = |pick: fn(f32, f32) -> f32| {
            positions.iter().fold(positions[0], |a, b| Vec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z)))
        };
        let (lo, hi) = (extreme(f32::min), extreme(f32::max));
        let mut random = Random(5);
        let places = std::array::from_fn(|i| {
            let middle = Vec3::new(2.5 + 3.5 * (i % 3) as f32, 2.0 + 2.0 * random.next(), 2.5 + 3.5 * (i / 3) as f32);
            (middle, Frame::from_normal(sample_uniform_sphere([random.next(), random.next()])))
        });
        Self { middle: (lo + hi) * 0.5, scale: 4.0 / (hi - lo).length(), places }
    }
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
