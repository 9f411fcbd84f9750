//! The oracle: every ray against every triangle, in order. Slow, and too simple to be wrong.

use crate::Accel;
use crate::geometry::{Geometry, TriangleId, WorldTriangle};
use crate::ray::{Hit, Hit8, Opacity, Ray8, RayKind};
use crate::triangle::{Beam, Crossing, intersect};
use gonio_kernel::{F32x8, Mask, Mask8, Real, U32x8, Vec3};

/// All triangles in a list. Cost per ray is proportional to their number.
#[derive(Clone, Debug)]
pub struct Brute {
    triangles: Vec<WorldTriangle>,
    lo: Vec3<f32>,
    hi: Vec3<f32>,
}

impl Brute {
    /// Lists the triangles of the geometry.
    pub fn new(geometry: &Geometry) -> Self {
        let triangles: Vec<_> = geometry.world_triangles().collect();
        let (lo, hi) = bounds(&triangles);
        Self { triangles, lo, hi }
    }
}

impl Accel for Brute {
    fn name(&self) -> &'static str {
        "brute"
    }

    fn closest(&self, _kind: RayKind, rays: &[Ray8], hits: &mut [Hit8]) {
        for (ray, hit) in rays.iter().zip(hits) {
            let beam = Beam::new(ray.origin, ray.dir, self.lo, self.hi);
            let mut best = Hit8::miss();
            // A dead lane has an empty interval.
            let mut t_best = F32x8::select(ray.mask, ray.t_max, F32x8::splat(-1.0));
            for triangle in &self.triangles {
                let c = intersect(&beam, &splat_corners(triangle), ray.t_min, t_best);
                // Triangles come in order, so on a tie the earlier one stays.
                let nearer = c.mask & c.t.lt(best.t);
                if nearer.any() {
                    t_best = F32x8::select(nearer, c.t, t_best);
                    record(&mut best, nearer, &c, triangle.id);
                }
            }
            *hit = best;
        }
    }

    fn occluded(&self, _kind: RayKind, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
        for ((packet, ray), blocked) in rays.iter().enumerate().zip(blocked) {
            let beam = Beam::new(ray.origin, ray.dir, self.lo, self.hi);
            let mut open = ray.mask;
            for triangle in &self.triangles {
                let c = intersect(&beam, &splat_corners(triangle), ray.t_min, ray.t_max);
                let mut hit = c.mask & open;
                if let Some(filter) = filter {
                    hit = filtered(filter, packet, hit, &c, triangle.id);
                }
                open = open & !hit;
                if !open.any() {
                    break;
                }
            }
            *blocked = ray.mask & !open;
        }
    }
}

/// One triangle in all eight lanes.
#[inline(always)]
fn splat_corners(triangle: &WorldTriangle) -> [Vec3<F32x8>; 3] {
    triangle.corners.map(Vec3::broadcast)
}

#[inline(always)]
fn record(best: &mut Hit8, mask: Mask8, c: &Crossing, id: TriangleId) {
    best.t = F32x8::select(mask, c.t, best.t);
    let bary = c.bary();
    best.bary = [F32x8::select(mask, bary[0], best.bary[0]), F32x8::select(mask, bary[1], best.bary[1])];
    best.prim = U32x8::select(mask, U32x8::splat(id.prim), best.prim);
    best.mesh = U32x8::select(mask, U32x8::splat(id.mesh), best.mesh);
    best.instance = U32x8::select(mask, U32x8::splat(id.instance), best.instance);
}

/// Those lanes of `hit` that the filter lets block.
pub(crate) fn filtered(filter: &dyn Opacity, packet: usize, hit: Mask8, c: &Crossing, id: TriangleId) -> Mask8 {
    let mut bits = hit.to_bits();
    for lane in 0..F32x8::LANES {
        if bits >> lane & 1 != 0 && !filter.blocks(packet * F32x8::LANES + lane, &scalar_hit(c, lane, id)) {
            bits &= !(1 << lane);
        }
    }
    Mask8::from_bits(bits)
}

/// One lane of a crossing.
pub(crate) fn scalar_hit(c: &Crossing, lane: usize, id: TriangleId) -> Hit {
    Hit { t: c.t.lane(lane), bary: c.bary().map(|b| b.lane(lane)), prim: id.prim, mesh: id.mesh, instance: id.instance }
}

/// The bounds of all corners; an empty list has the bounds of a point at the origin.
pub(crate) fn bounds(triangles: &[WorldTriangle]) -> (Vec3<f32>, Vec3<f32>) {
    let corners = triangles.iter().flat_map(|t| t.corners);
    let fold = |pick: fn(f32, f32) -> f32| {
        corners.clone().reduce(|a, b| Vec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z)))
    };
    (fold(f32::min).unwrap_or(Vec3::splat(0.0)), fold(f32::max).unwrap_or(Vec3::splat(0.0)))
}
