//! A few triangles: no tree, every triangle tested by eight rays at once.
//!
//! For up to [`MOST`] triangles a list is faster than a tree, even for rays that have nothing in common, because eight rays
//! share every load and no branch is mispredicted. Each distinct vertex is projected once per eight rays, and what the
//! distance test needs of a triangle is computed once for all. The formulas are those of [`crate::triangle`], so the
//! results are those of the tree and of `Brute`.

use crate::brute::{bounds, filtered, record};
use crate::geometry::{Geometry, TriangleId, WorldTriangle};
use crate::ray::{Hit8, Opacity, Ray8};
use crate::triangle::{Beam, Edges, Plane};
use gonio_kernel::{F32x8, Mask, Mask8, Real, Vec3};

/// Up to this many triangles a list is used. A ray costs about as much as in the tree at 100 triangles.
const MOST: usize = 64;

/// A list of triangles over distinct vertices.
#[derive(Clone, Debug)]
pub(super) struct Few {
    vertices: Vec<Vec3<f32>>,
    rows: Vec<Row>,
    lo: Vec3<f32>,
    hi: Vec3<f32>,
}

#[derive(Clone, Debug)]
struct Row {
    corners: [u8; 3],
    plane: Plane<f32>,
    id: TriangleId,
}

/// A ray's projection of every vertex: three corners each for [`MOST`] triangles, and room so that a byte is an index.
type Projected = [[F32x8; 2]; 256];

impl Few {
    /// The list, if the geometry is small enough.
    pub(super) fn of(geometry: &Geometry) -> Option<Self> {
        let triangles: Vec<WorldTriangle> = geometry.world_triangles().take(MOST + 1).collect();
        if triangles.len() > MOST {
            return None;
        }
        let mut vertices: Vec<Vec3<f32>> = Vec::new();
        let mut place = |v: Vec3<f32>| {
            let at = vertices.iter().position(|w| same_bits(*w, v)).unwrap_or_else(|| {
                vertices.push(v);
                vertices.len() - 1
            });
            at as u8 // at most 192
        };
        let rows = triangles
            .iter()
            .map(|t| Row { corners: t.corners.map(&mut place), plane: Plane::of(&t.corners), id: t.id })
            .collect();
        let (lo, hi) = bounds(&triangles);
        Some(Self { vertices, rows, lo, hi })
    }

    fn project(&self, ray: &Ray8, projected: &mut Projected) -> Beam {
        let beam = Beam::new(ray.origin, ray.dir, self.lo, self.hi);
        for (v, p) in self.vertices.iter().zip(projected) {
            *p = beam.project(Vec3::new(F32x8::splat(v.x), F32x8::splat(v.y), F32x8::splat(v.z)));
        }
        beam
    }

    pub(super) fn closest(&self, rays: &[Ray8], hits: &mut [Hit8]) {
        let mut projected = [[F32x8::ZERO; 2]; 256];
        for (ray, hit) in rays.iter().zip(hits) {
            let beam = self.project(ray, &mut projected);
            let mut best = Hit8::miss();
            let mut t_best = F32x8::select(ray.mask, ray.t_max, F32x8::splat(-1.0)); // a dead lane's interval is empty
            for row in &self.rows {
                let c = row.edges(&projected).cross(&beam, || row.plane.splat(), ray.t_min, t_best);
                let nearer = c.mask & c.t.lt(best.t); // triangles come in order: on a tie the earlier one stays
                if nearer.any() {
                    t_best = F32x8::select(nearer, c.t, t_best);
                    record(&mut best, nearer, &c, row.id);
                }
            }
            *hit = best;
        }
    }

    pub(super) fn occluded(&self, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
        let mut projected = [[F32x8::ZERO; 2]; 256];
        for ((packet, ray), blocked) in rays.iter().enumerate().zip(blocked) {
            let beam = self.project(ray, &mut projected);
            let mut open = ray.mask;
            for row in &self.rows {
                let t_max = F32x8::select(open, ray.t_max, F32x8::splat(-1.0));
                let c = row.edges(&projected).cross(&beam, || row.plane.splat(), ray.t_min, t_max);
                let hit = match filter {
                    Some(filter) => filtered(filter, packet, c.mask, &c, row.id),
                    None => c.mask,
                };
                open = open & !hit;
                if !open.any() {
                    break;
                }
            }
            *blocked = ray.mask & !open;
        }
    }
}

impl Row {
    #[inline(always)]
    fn edges(&self, projected: &Projected) -> Edges {
        let [a, b, c] = self.corners.map(|v| projected[v as usize]);
        Edges::new(a, b, c)
    }
}

/// Equal to the last bit: −0 and 0 are two vertices, as they are to the other backends.
fn same_bits(a: Vec3<f32>, b: Vec3<f32>) -> bool {
    <[f32; 3]>::from(a).map(f32::to_bits) == <[f32; 3]>::from(b).map(f32::to_bits)
}
