//! A few triangles: no tree, every triangle tested by eight rays at once.
//!
//! For up to [`MOST`] triangles a list is faster than a tree, even for rays that have nothing in common, because eight rays
//! share every load and no branch is mispredicted. Each distinct vertex is projected once per eight rays, and what the
//! distance test needs of a triangle is computed once for all. The formulas are those of [`crate::triangle`], so the
//! results are those of the tree and of `Brute`.

use crate::brute::{bounds, filtered};
use crate::geometry::{Geometry, NOTHING, TriangleId, WorldTriangle};
use crate::ray::{Hit8, NO_HIT, Opacity, Ray8};
use crate::triangle::{Beam, Edges, Plane, barycentric};
use gonio_kernel::{F32x8, Mask, Mask8, Real, U32x8, Vec3, each_lane};

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

impl Row {
    /// Where its corners are.
    #[inline(always)]
    fn projected(&self, projected: &Projected) -> [[F32x8; 2]; 3] {
        self.corners.map(|v| projected[v as usize])
    }
}

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

    /// Bytes that the list occupies.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.vertices.as_slice()) + size_of_val(self.rows.as_slice())
    }

    fn project(&self, ray: &Ray8, projected: &mut Projected) -> Beam {
        let beam = Beam::new(ray.origin, ray.dir, self.lo, self.hi);
        for (v, p) in self.vertices.iter().zip(projected) {
            *p = beam.project(Vec3::broadcast(*v));
        }
        beam
    }

    /// The edge functions of every triangle, and the set of those that some ray is inside of. Without a branch per
    /// triangle: whether eight rays that have nothing in common are all outside is a coin toss.
    #[inline(always)]
    fn candidates(&self, projected: &Projected, edges: &mut [[F32x8; 3]; MOST]) -> u64 {
        let mut inside = 0;
        for (i, (row, edges)) in self.rows.iter().zip(edges).enumerate() {
            let found = Edges::new(&row.projected(projected));
            *edges = found.e;
            inside |= u64::from(found.inside().to_bits() != 0) << i;
        }
        inside
    }

    pub(super) fn closest(&self, rays: &[Ray8], hits: &mut [Hit8]) {
        let (mut projected, mut edges) = ([[F32x8::ZERO; 2]; 256], [[F32x8::ZERO; 3]; MOST]);
        for (ray, hit) in rays.iter().zip(hits) {
            let beam = self.project(ray, &mut projected);
            let candidates = self.candidates(&projected, &mut edges);
            let mut t = F32x8::splat(f32::INFINITY);
            let mut t_best = F32x8::select(ray.mask, ray.t_max, F32x8::splat(-1.0)); // a dead lane's interval is empty
            let mut best_edges = [F32x8::ZERO; 3];
            let mut best_row = U32x8::splat(NO_HIT);
            for_each_bit(candidates, |i| {
                let row = &self.rows[i];
                let (corners, plane) = (|| row.projected(&projected), || row.plane.splat());
                let c = Edges::from(edges[i]).cross(&beam, corners, plane, ray.t_min, t_best);
                let nearer = c.mask & c.t.lt(t); // triangles come in order: on a tie the earlier one stays
                if nearer.any() {
                    t = F32x8::select(nearer, c.t, t);
                    t_best = F32x8::select(nearer, c.t, t_best);
                    for (best, e) in best_edges.iter_mut().zip(edges[i]) {
                        *best = F32x8::select(nearer, e, *best);
                    }
                    best_row = U32x8::select(nearer, U32x8::splat(i as u32), best_row);
                }
            });
            let found = !best_row.same(U32x8::splat(NO_HIT));
            let id = each_lane(|l| self.rows.get(best_row.lane(l) as usize).map_or(NOTHING, |row| row.id));
            *hit = Hit8 {
                t,
                bary: barycentric(&best_edges).map(|b| b.or_zero(found)),
                prim: U32x8::from_fn(|l| id[l].prim),
                mesh: U32x8::from_fn(|l| id[l].mesh),
                instance: U32x8::from_fn(|l| id[l].instance),
            };
        }
    }

    pub(super) fn occluded(&self, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
        let (mut projected, mut edges) = ([[F32x8::ZERO; 2]; 256], [[F32x8::ZERO; 3]; MOST]);
        for ((packet, ray), blocked) in rays.iter().enumerate().zip(blocked) {
            let beam = self.project(ray, &mut projected);
            let candidates = self.candidates(&projected, &mut edges);
            let mut t_max = F32x8::select(ray.mask, ray.t_max, F32x8::splat(-1.0));
            let mut shut = Mask8::splat(false);
            for_each_bit(candidates, |i| {
                let row = &self.rows[i];
                let (corners, plane) = (|| row.projected(&projected), || row.plane.splat());
                let c = Edges::from(edges[i]).cross(&beam, corners, plane, ray.t_min, t_max);
                let hit = match filter {
                    Some(filter) => filtered(filter, packet, c.mask, &c, row.id),
                    None => c.mask,
                };
                shut = shut | hit;
                t_max = F32x8::select(hit, F32x8::splat(-1.0), t_max); // asked no more
            });
            *blocked = shut;
        }
    }
}

#[inline(always)]
fn for_each_bit(mut bits: u64, mut f: impl FnMut(usize)) {
    while bits != 0 {
        f(bits.trailing_zeros() as usize % MOST);
        bits &= bits - 1;
    }
}

/// Equal to the last bit: −0 and 0 are two vertices, as they are to the other backends.
fn same_bits(a: Vec3<f32>, b: Vec3<f32>) -> bool {
    <[f32; 3]>::from(a).map(f32::to_bits) == <[f32; 3]>::from(b).map(f32::to_bits)
}
