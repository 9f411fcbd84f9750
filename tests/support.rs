//! What several test modules need: the shipped scenes, small meshes, and random numbers that repeat.

use gonio_accel::{Geometry, Mesh};
use gonio_kernel::{F32x8, Vec3};
use gonio_tracer::scene::Scene;
use std::path::{Path, PathBuf};

/// A file of the repository.
pub(crate) fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The shipped Cornell box, `size` pixels wide and high.
pub(crate) fn cornell_box(size: u32, spp: u32) -> Scene {
    let mut scene = Scene::load(&repository("scenes/cornell-box.toml")).expect("the shipped scene loads");
    scene.film.width = size;
    scene.film.height = size;
    scene.film.spp = spp;
    scene
}

/// SplitMix64 (Steele, Lea & Flood 2014): small, seeded, good enough to place test rays.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub(crate) fn unit(&mut self) -> f32 {
        (self.word() >> 40) as f32 / 16_777_216.0
    }

    /// Uniform in [lo, hi).
    pub(crate) fn within(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.unit()
    }

    /// One of `n`.
    pub(crate) fn pick(&mut self, n: usize) -> usize {
        (self.word() % n as u64) as usize
    }

    /// A uniform point of a cube about the origin.
    pub(crate) fn point(&mut self, half: f32) -> Vec3<f32> {
        Vec3::new(self.within(-half, half), self.within(-half, half), self.within(-half, half))
    }

    /// A uniform unit direction.
    pub(crate) fn direction(&mut self) -> Vec3<f32> {
        gonio_kernel::warp::sample_uniform_sphere([self.unit(), self.unit()])
    }
}

/// Eight vectors side by side.
pub(crate) fn side_by_side(v: [Vec3<f32>; 8]) -> Vec3<F32x8> {
    Vec3::from_lanes(|l| v[l])
}

/// A closed sphere of n·n·2 triangles, radius 1, moved by `center`.
pub(crate) fn sphere(n: u32, center: [f32; 3]) -> Mesh {
    let mut positions = Vec::new();
    for i in 0..=n {
        for j in 0..n {
            let theta = std::f32::consts::PI * i as f32 / n as f32;
            let phi = std::f32::consts::TAU * j as f32 / n as f32;
            // The poles are one point each, to the bit.
            let sin = if i == 0 || i == n { 0.0 } else { theta.sin() };
            let p = [sin * phi.cos(), theta.cos(), sin * phi.sin()];
            positions.push([p[0] + center[0], p[1] + center[1], p[2] + center[2]]);
        }
    }
    let at = |i: u32, j: u32| i * n + j % n;
    let quads = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let triangles = quads
        .flat_map(|(i, j)| [[at(i, j), at(i, j + 1), at(i + 1, j)], [at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]])
        .collect();
    Mesh { positions, triangles }
}

/// A flat grid of n × n squares with corners at integers, in the plane z = 0.
pub(crate) fn grid(n: u32) -> Mesh {
    let positions = (0..=n).flat_map(|y| (0..=n).map(move |x| [x as f32, y as f32, 0.0])).collect();
    let at = |x: u32, y: u32| y * (n + 1) + x;
    let squares = (0..n).flat_map(|y| (0..n).map(move |x| (x, y)));
    let triangles = squares
        .flat_map(|(x, y)| [[at(x, y), at(x + 1, y), at(x + 1, y + 1)], [at(x, y), at(x + 1, y + 1), at(x, y + 1)]])
        .collect();
    Mesh { positions, triangles }
}

/// Triangles of all sizes and shapes, slivers and points among them.
pub(crate) fn soup(count: u32, random: &mut Random) -> Mesh {
    let mut positions = Vec::new();
    for i in 0..count {
        let (center, size) = (random.point(1.0), 10_f32.powf(random.within(-4.0, 0.5)));
        let mut corner = || {
            let p = center + random.point(size);
            [p.x, p.y, p.z]
        };
        let (a, b, c) = (corner(), corner(), corner());
        let sliver = [a[0] + 1e-6 * size, a[1], a[2]];
        positions.extend(match i % 8 {
            0 => [a, b, sliver],
            1 => [a, a, a],
            2 => [[a[0], a[1], 0.25], [b[0], b[1], 0.25], [c[0], c[1], 0.25]],
            _ => [a, b, c],
        });
    }
    Mesh { positions, triangles: (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect() }
}

/// A geometry of one mesh.
pub(crate) fn geometry(mesh: Mesh) -> Geometry {
    Geometry::of_mesh(mesh).expect("the mesh is in order")
}
