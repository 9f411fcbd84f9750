//! Meshes out of sheets: surfaces over the unit square, divided into a grid of triangles.

use gonio_accel::Mesh;
use gonio_kernel::Vec3;

/// A mesh that grows.
#[derive(Default)]
pub(crate) struct Sheets {
    pub(crate) mesh: Mesh,
}

impl Sheets {
    /// Adds columns × rows squares of two triangles; `at(u, v)` is the surface, u and v in [0, 1].
    pub(crate) fn add(&mut self, [columns, rows]: [usize; 2], at: impl Fn(f32, f32) -> Vec3<f32>) {
        let first = self.mesh.positions.len() as u32;
        for row in 0..=rows {
            for column in 0..=columns {
                let p = at(column as f32 / columns as f32, row as f32 / rows as f32);
                self.mesh.positions.push([p.x, p.y, p.z]);
            }
        }
        let across = columns as u32 + 1;
        for row in 0..rows as u32 {
            for column in 0..columns as u32 {
                let a = first + row * across + column;
                let [b, c, d] = [a + 1, a + across, a + across + 1];
                self.mesh.triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
    }

    /// Adds a flat parallelogram of two triangles.
    pub(crate) fn quad(&mut self, corner: Vec3<f32>, u: Vec3<f32>, v: Vec3<f32>) {
        self.add([1, 1], |a, b| corner + u * a + v * b);
    }

    /// Adds the six sides of a box along the axes.
    pub(crate) fn cuboid(&mut self, lo: Vec3<f32>, hi: Vec3<f32>) {
        let size = hi - lo;
        let (x, y, z) = (Vec3::new(size.x, 0.0, 0.0), Vec3::new(0.0, size.y, 0.0), Vec3::new(0.0, 0.0, size.z));
        for (u, v, across) in [(x, y, z), (y, z, x), (z, x, y)] {
            self.quad(lo, v, u);
            self.quad(lo + across, u, v);
        }
    }
}
