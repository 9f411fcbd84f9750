//! What several test modules need: the shipped scenes, small meshes, and random numbers that repeat.

use gonio_accel::{Geometry, Instance, Mesh};
use gonio_kernel::{F32x8, Vec3};
use gonio_tracer::scene::Scene;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A file of the repository.
pub(crate) fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// A file or folder of the test data, which is not part of the repository; says so in one line if it is not there.
pub(crate) fn data(path: &str) -> Option<PathBuf> {
    let found = std::env::var_os("GONIO_DATA").map_or_else(|| repository("../shared/data"), PathBuf::from).join(path);
    if !found.exists() {
        println!("{path}: not there ({}), not run", found.display());
    }
    found.exists().then_some(found)
}

/// The shipped Cornell box, `size` pixels wide and high.
pub(crate) fn cornell_box(size: u32, spp: u32) -> Scene {
    let mut scene = gonio_io::load(&repository("scenes/cornell-box.toml")).expect("the shipped scene loads");
    scene.film.width = size;
    scene.film.height = size;
    scene.film.spp = spp;
    scene
}

/// A folder of its own for one test, removed at its end.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("there is room for temporary files"))
    }

    /// Writes a file, and the folders it lies in.
    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, content).unwrap();
        path
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    /// The refusal of a file, without the folder's name.
    pub(crate) fn refusal(&self, path: &Path) -> String {
        let error = gonio_io::load(path).expect_err("this should have been refused");
        self.strip(&error.to_string())
    }

    /// A text without the folder's name.
    pub(crate) fn strip(&self, text: &str) -> String {
        text.replace(&format!("{}/", self.path().display()), "")
    }

    /// The warnings of a scene, without the folder's name.
    pub(crate) fn warnings(&self, scene: &Scene) -> Vec<String> {
        scene.warnings.iter().map(|warning| self.strip(warning)).collect()
    }
}

/// Mean and variance (n − 1) of the same quantity over seeds.
pub(crate) struct Moments {
    pub(crate) mean: f64,
    pub(crate) variance: f64,
}

/// The moments of at least two values.
pub(crate) fn moments(values: impl Iterator<Item = f64> + Clone) -> Moments {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    Moments { mean, variance: values.map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0) }
}

/// Two-sided p-value of Welch's t-test for two samples of n.
pub(crate) fn welch(a: &Moments, b: &Moments, n: f64) -> f64 {
    let (va, vb) = (a.variance / n, b.variance / n);
    if va + vb == 0.0 {
        return if a.mean == b.mean { 1.0 } else { 0.0 };
    }
    let freedom = (va + vb).powi(2) / ((va * va + vb * vb) / (n - 1.0));
    let t = (a.mean - b.mean).abs() / (va + vb).sqrt();
    student(t, freedom)
}

/// Two-sided p-value of Student's t ≥ 0.
pub(crate) fn student(t: f64, freedom: f64) -> f64 {
    2.0 * StudentsT::new(0.0, 1.0, freedom).expect("positive degrees of freedom").sf(t)
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

/// A hilly height field over n × n squares, open at the sides: whatever falls through it is lost. Corners lie at odd places, so
/// that no product is exact.
pub(crate) fn hills(n: u32) -> Mesh {
    let mut mesh = grid(n);
    for p in &mut mesh.positions {
        let [x, y] = [p[0] * 0.317, p[1] * 0.291];
        *p = [x - 0.137 * n as f32, y, (1.7 * x).sin() * (2.3 * y).cos() * 0.4];
    }
    mesh
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

/// Several meshes, one of them empty and one unused, each placed several times: turned, stretched, mirrored.
pub(crate) fn crowd(random: &mut Random) -> Geometry {
    let meshes = vec![sphere(9, [0.0; 3]), Mesh::default(), soup(80, random), grid(3), grid(1)];
    let places = (0..12).map(|i| {
        let mut row = |axis: usize| -> [f64; 4] {
            std::array::from_fn(|c| {
                let own = if c == axis { 0.5 } else { 0.0 };
                own + f64::from(random.within(-0.3, 0.3))
                    + if c == 3 { f64::from(random.within(-1.0, 1.0)) } else { 0.0 }
            })
        };
        Instance { mesh: i % 4, transform: [row(0), row(1), row(2)] }
    });
    Geometry::new(meshes, places.collect()).expect("the meshes are in order")
}

/// A geometry of one mesh.
pub(crate) fn geometry(mesh: Mesh) -> Geometry {
    Geometry::of_mesh(mesh).expect("the mesh is in order")
}
