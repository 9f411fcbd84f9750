//! The watertight ray–triangle test, and the slab interval that goes with it.
//!
//! Over 400 lines: the proof that no hit is lost speaks of the test, of the slack and of the slab at once.
//!
//! **Watertight.** The vertices, relative to the origin, are projected on two axes across the direction; a projected vertex
//! depends on nothing but itself and the ray, so triangles that share a vertex see the same point. The ray is inside if
//! the three edge functions p.x·q.y − p.y·q.x have no two different signs. Rounding is monotonic, so the difference of two
//! rounded products never has the wrong sign, but it may be zero: then the sign is found in `f64`, where the products are
//! exact. One that is truly zero counts as inside on both sides, so no ray falls between two triangles that share an
//! edge. This is the idea of Woop, Benthin & Wald 2013, "Watertight Ray/Triangle Intersection", with an
//! orthonormal projection instead of a shear, which needs no permutation of axes per lane. The products must stay unfused.
//!
//! **Distance** comes from the plane: t = n·(v₀ − o)/n·d. An origin that lies in the plane up to rounding (|n·(v₀ − o)| below
//! its error bound) is on the triangle and does not hit it, which is what makes t_min = 0 safe for secondary rays.
//!
//! **Agreement.** A traversal enters a box if the ray meets it, grown by [`PAD`], no farther than [`Beam::slack`] behind the
//! best hit so far. That loses no hit, because a hit's t is within the slack of where the ray truly is inside the triangle's
//! box: by the error bound of h/n·d where the ray is not too nearly parallel to the plane (`STEEP`), and where it is, by
//! limiting t to the slab interval of the triangle's own box. That interval lies within the interval of every box around
//! it, in floating point too, because each of its steps is monotonic. So every backend finds the hit that all triangles in
//! turn would give, to the last bit.

use gonio_kernel::frame::tangents;
use gonio_kernel::{F32x8, Mask, Mask8, Real, Vec3};
use std::fmt;

/// How strictly rays are tested against triangles. `Brute` is always robust, because it is what the others are measured against.
///
/// Measured with 400,000 rays from above at inner points of inner edges of a height field, each of which must hit: lost are
/// 0 robust, by obvhs and by Embree; fast, 8.9 % by obvhs and 6.1 % by Embree. Of 200,000 rays from within a closed sphere at its
/// vertices, obvhs loses none and Embree's robust test 121. (`tests/backends/edges.rs` repeats both.)
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Intersect {
    /// Watertight: no ray falls between triangles that share an edge, wherever it is aimed.
    #[default]
    Robust,
    /// For speed: a ray aimed at a shared edge or vertex may fall through. Elsewhere the same hits up to rounding. The gain is
    /// small, because the robust tests are cheap: 0 to 25 % (obvhs), 0 to 35 % (Embree), see docs/performance.md.
    Fast,
}

impl fmt::Display for Intersect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Robust => "robust",
            Self::Fast => "fast",
        })
    }
}

/// Unit roundoff of `f32`.
const U: f32 = 1.0 / 16_777_216.0;

/// Boxes are grown by this times the distance to the farthest corner of the scene. A projected vertex is off by at most
/// 8u of its distance (one subtraction, three products and sums, and axes that are perpendicular to 2u); the slab
/// arithmetic adds 2u. Sixteen leaves room.
pub const PAD: f32 = 16.0 * U;

/// And by this times the origin's coordinate: origin/d and what is added to it are rounded once each.
const OFFSET_ERROR: f64 = 4.0 / 16_777_216.0;

/// The inverse of a direction's component is at most this: times a coordinate of 1e18 it is still finite.
const STEEPEST: f64 = 1e18;

/// Error bound of n·(v₀ − o), and of n·d, in units of the sum of its absolute products: three roundings for the edges and
/// the difference, two for the cross product, three for the dot product.
const PLANE_ERROR: f32 = 8.0 * U;

/// The ray is steep if |n·d| is at least this times the sum of the absolute products of n. Then h/n·d is off by at most
/// 2 · 8u/2⁻⁴ of the reach, and the place where the ray meets the plane lies at most 8u/2⁻⁴ of it outside the triangle:
/// together 1.5·2⁻¹⁶.
const STEEP: f32 = 1.0 / 16.0;

/// The slack of distances as a part of the reach: 2⁻¹⁵, see [`STEEP`].
const SLACK: f32 = 1.0 / 32_768.0;

/// The slack of the fast test, which promises nothing to the last bit: no more than the padding of boxes.
const FAST_SLACK: f32 = PAD;

/// Rays with what their tests need, computed once per ray: eight rays, or one ray in all eight lanes; or one ray as it is kept.
#[derive(Clone, Copy, Debug)]
pub struct Beam<R = F32x8> {
    origin: Vec3<R>,
    dir: Vec3<R>,
    across: [Vec3<R>; 2],
    inverse: Vec3<R>,
    /// What a near plane's coordinate times the inverse lacks to be the distance of the padded plane.
    enter: Vec3<R>,
    /// The same for a far plane.
    leave: Vec3<R>,
    /// The distance to the farthest corner of the scene, at most.
    reach: R,
}

impl Beam<f32> {
    /// This ray in all eight lanes.
    #[inline(always)]
    pub fn splat(&self) -> Beam {
        let each = Vec3::broadcast;
        Beam {
            origin: each(self.origin),
            dir: each(self.dir),
            across: [each(self.across[0]), each(self.across[1])],
            inverse: each(self.inverse),
            enter: each(self.enter),
            leave: each(self.leave),
            reach: F32x8::splat(self.reach),
        }
    }

    /// The same ray for boxes in other coordinates, where it starts at `origin` and goes by `dir` per unit of t, up to an error
    /// along each axis. Triangles cannot be tested with it.
    pub(crate) fn moved(&self, origin: Vec3<f32>, dir: Vec3<f32>, error: Vec3<f32>) -> Self {
        let [inverse, enter, leave] = slabs(origin, dir, error);
        Self { origin, dir, inverse, enter, leave, ..*self }
    }
}

impl<R: Real> Beam<R> {
    /// Where the rays start.
    #[inline(always)]
    pub fn origin(&self) -> Vec3<R> {
        self.origin
    }

    /// Where they go.
    #[inline(always)]
    pub(crate) fn dir(&self) -> Vec3<R> {
        self.dir
    }

    /// One over each component of the directions, finite.
    #[inline(always)]
    pub fn inverse(&self) -> Vec3<R> {
        self.inverse
    }

    /// The distance to the farthest corner of the scene, at most.
    #[inline(always)]
    pub(crate) fn reach(&self) -> R {
        self.reach
    }
}

impl Beam {
    /// Prepares rays for triangles within the bounds [lo, hi].
    pub fn new(origin: Vec3<F32x8>, dir: Vec3<F32x8>, lo: Vec3<f32>, hi: Vec3<f32>) -> Self {
        let (u, v) = tangents(dir);
        let (to_lo, to_hi) = ((Vec3::broadcast(lo) - origin).abs(), (Vec3::broadcast(hi) - origin).abs());
        let reach = to_lo.x.max(to_hi.x) + to_lo.y.max(to_hi.y) + to_lo.z.max(to_hi.z);
        let [inverse, enter, leave] = slabs(origin, dir, Vec3::splat(reach * F32x8::splat(PAD)));
        Self { origin, dir, across: [u, v], inverse, enter, leave, reach }
    }

    /// One of these rays.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Beam<f32> {
        let each = |v: &Vec3<F32x8>| v.lane(lane);
        Beam {
            origin: each(&self.origin),
            dir: each(&self.dir),
            across: [each(&self.across[0]), each(&self.across[1])],
            inverse: each(&self.inverse),
            enter: each(&self.enter),
            leave: each(&self.leave),
            reach: self.reach.lane(lane),
        }
    }

    /// A point, relative to the origin, on the two axes across the direction.
    #[inline(always)]
    pub fn project(&self, v: Vec3<F32x8>) -> [F32x8; 2] {
        let a = v - self.origin;
        [a.dot(self.across[0]), a.dot(self.across[1])]
    }

    /// The rays whose directions point down each axis, as sets of lanes: chooses which planes are near.
    #[inline(always)]
    pub fn points_down(&self) -> [u32; 3] {
        [self.inverse.x, self.inverse.y, self.inverse.z].map(|i| i.lt(F32x8::ZERO).to_bits())
    }

    /// By how much slab intervals are padded at either end, along each axis.
    #[inline(always)]
    pub fn pad(&self) -> Vec3<F32x8> {
        (self.leave - self.enter) * F32x8::splat(0.5)
    }

    /// By how much a hit's t may lie outside the slab interval of a box around the triangle, by either test.
    #[inline(always)]
    pub fn slack<const FAST: bool>(&self) -> F32x8 {
        self.reach * F32x8::splat(if FAST { FAST_SLACK } else { SLACK })
    }

    /// The padded slab interval \[t_near, t_far\] of boxes whose near and far planes are given.
    #[inline(always)]
    pub fn slab(&self, near: Vec3<F32x8>, far: Vec3<F32x8>) -> [F32x8; 2] {
        let i = self.inverse;
        let enter =
            [near.x.mul_add(i.x, self.enter.x), near.y.mul_add(i.y, self.enter.y), near.z.mul_add(i.z, self.enter.z)];
        let leave =
            [far.x.mul_add(i.x, self.leave.x), far.y.mul_add(i.y, self.leave.y), far.z.mul_add(i.z, self.leave.z)];
        [enter[0].max(enter[1]).max(enter[2]), leave[0].min(leave[1]).min(leave[2])]
    }
}

/// What slab intervals need of rays whose points are known up to an error along each axis: the inverse directions, and what is
/// added for near and for far planes.
#[inline(always)]
fn slabs<R: Real>(origin: Vec3<R>, dir: Vec3<R>, error: Vec3<R>) -> [Vec3<R>; 3] {
    // A direction without an x never leaves its slab: a large finite slope says so without 0·∞.
    let slope = |d: R| d.abs().recip().min(R::lit(STEEPEST)).copysign(d);
    let inverse = Vec3::new(slope(dir.x), slope(dir.y), slope(dir.z));
    let pad = |i: R, o: R, error: R| i.abs() * o.abs().mul_add(R::lit(OFFSET_ERROR), error);
    let pad = Vec3::new(
        pad(inverse.x, origin.x, error.x),
        pad(inverse.y, origin.y, error.y),
        pad(inverse.z, origin.z, error.z),
    );
    let offset = Vec3::new(inverse.x * origin.x, inverse.y * origin.y, inverse.z * origin.z);
    [inverse, Vec3::new(-offset.x - pad.x, -offset.y - pad.y, -offset.z - pad.z), pad - offset]
}

/// Where rays meet triangles, lane by lane.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// Which lanes meet.
    pub mask: Mask8,
    /// Distance.
    pub t: F32x8,
    edges: [F32x8; 3],
}

impl Crossing {
    /// Whether some lane meets.
    #[inline(always)]
    pub fn any(&self) -> bool {
        self.mask.to_bits() != 0
    }

    /// The edge functions, each opposite its corner, up to a common factor.
    #[inline(always)]
    pub fn edges(&self) -> &[F32x8; 3] {
        &self.edges
    }

    /// What one lane found, in all eight.
    #[inline(always)]
    pub fn splat_lane(&self, lane: usize) -> Self {
        let edges = self.edges.map(|e| e.splat_lane(lane));
        Self { mask: Mask8::splat(self.mask.lane(lane)), t: self.t.splat_lane(lane), edges }
    }

    /// Barycentric weights of the second and third vertex; the first has 1 − b1 − b2.
    #[inline(always)]
    pub fn bary(&self) -> [F32x8; 2] {
        barycentric(&self.edges)
    }
}

/// Barycentric weights of the second and third vertex from the edge functions.
#[inline(always)]
pub fn barycentric<R: Real>(edges: &[R; 3]) -> [R; 2] {
    let [e0, e1, e2] = *edges;
    let scale = (e0 + e1 + e2).recip();
    [e1 * scale, e2 * scale]
}

/// Tests lane by lane whether the ray meets the triangle with t_min ≤ t ≤ t_max.
#[inline(always)]
pub fn intersect(beam: &Beam, corners: &[Vec3<F32x8>; 3], t_min: F32x8, t_max: F32x8) -> Crossing {
    let [c0, c1, c2] = *corners;
    let projected = [beam.project(c0), beam.project(c1), beam.project(c2)];
    Edges::new(&projected).cross(beam, || projected, || Plane::of(corners), t_min, t_max)
}

/// The fast test, lane by lane.
#[inline(always)]
pub fn intersect_fast(beam: &Beam, corners: &[Vec3<F32x8>; 3], t_min: F32x8, t_max: F32x8) -> Crossing {
    Facet::of(corners).cross(beam, t_min, t_max)
}

/// What the fast test needs of triangles: Möller & Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection", without the
/// division until the ray is known to be inside.
///
/// Every triangle measures the edge that it shares with its neighbour from its own first corner, so a ray at the edge may
/// be outside of both: see [`Intersect::Fast`] for how often. An origin that lies in the plane may hit at a t of its rounding.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    corner: Vec3<F32x8>,
    /// From the second corner to the first, and from the first to the third.
    sides: [Vec3<F32x8>; 2],
    normal: Vec3<F32x8>,
}

impl Facet {
    /// The facets of triangles.
    #[inline(always)]
    pub fn of(corners: &[Vec3<F32x8>; 3]) -> Self {
        let [c0, c1, c2] = *corners;
        let (e1, e2) = (c0 - c1, c2 - c0);
        Self { corner: c0, sides: [e1, e2], normal: e2.cross(e1) }
    }

    /// That of one lane, in all eight.
    #[inline(always)]
    pub fn splat_lane(&self, lane: usize) -> Self {
        Self {
            corner: self.corner.splat_lane(lane),
            sides: [self.sides[0].splat_lane(lane), self.sides[1].splat_lane(lane)],
            normal: self.normal.splat_lane(lane),
        }
    }

    /// Tests lane by lane whether the ray meets the triangle with t_min ≤ t ≤ t_max.
    #[inline(always)]
    pub fn cross(&self, beam: &Beam, t_min: F32x8, t_max: F32x8) -> Crossing {
        let [e1, e2] = self.sides;
        let to_corner = self.corner - beam.origin;
        let moment = to_corner.cross(beam.dir);
        let fall = self.normal.dot(beam.dir);
        let (size, sign) = (fall.abs(), F32x8::ONE.copysign(fall));
        // One moment serves both edges at the first corner: neighbours that share it as their first see the same.
        let (second, third) = (moment.dot(e2) * sign, moment.dot(e1) * sign);
        let first = size - second - third;
        let inside = first.ge(F32x8::ZERO) & second.ge(F32x8::ZERO) & third.ge(F32x8::ZERO);
        let mut crossing = Crossing { mask: inside, t: F32x8::ZERO, edges: [first, second, third] };
        if inside.to_bits() != 0 {
            let height = self.normal.dot(to_corner) * sign;
            crossing.t = height / size;
            // height > 0 also fails for a triangle without an area, whose t is not a number.
            crossing.mask = inside & height.gt(F32x8::ZERO) & crossing.t.ge(t_min) & crossing.t.le(t_max);
        }
        crossing
    }
}

/// The three edge functions of projected triangles.
#[derive(Clone, Copy, Debug)]
pub struct Edges {
    /// Each opposite its corner.
    pub e: [F32x8; 3],
    least: F32x8,
    most: F32x8,
}

impl From<[F32x8; 3]> for Edges {
    #[inline(always)]
    fn from(e: [F32x8; 3]) -> Self {
        Self { e, least: e[0].min(e[1]).min(e[2]), most: e[0].max(e[1]).max(e[2]) }
    }
}

impl Edges {
    /// From projected corners, see [`Beam::project`].
    #[inline(always)]
    pub fn new(projected: &[[F32x8; 2]; 3]) -> Self {
        Self::from(edge_functions(projected, |p, q| p[0] * q[1] - p[1] * q[0]))
    }

    /// Where no two edge functions have different signs.
    #[inline(always)]
    pub fn inside(&self) -> Mask8 {
        self.least.ge(F32x8::ZERO) | self.most.le(F32x8::ZERO)
    }

    /// Completes the test; the projected corners and the plane are asked for only where they are needed.
    #[inline(always)]
    pub fn cross(
        &self,
        beam: &Beam,
        projected: impl FnOnce() -> [[F32x8; 2]; 3],
        plane: impl FnOnce() -> Plane<F32x8>,
        t_min: F32x8,
        t_max: F32x8,
    ) -> Crossing {
        let inside = self.inside();
        let mut crossing = Crossing { mask: inside, t: F32x8::ZERO, edges: self.e };
        if inside.to_bits() != 0 {
            let [e0, e1, e2] = self.e;
            let has_area = !(e0 + e1 + e2).same(F32x8::ZERO);
            let mut mask = inside & has_area;
            // A zero may be the rounding of a tiny triangle far to the side, where it says nothing.
            let on_edge = mask & !(self.least.gt(F32x8::ZERO) | self.most.lt(F32x8::ZERO));
            if on_edge.to_bits() != 0 {
                mask = mask & (!on_edge | exactly_inside(&projected(), on_edge));
            }
            let (t, in_front) = plane().distance(beam, mask, t_min, t_max);
            crossing.mask = mask & in_front;
            crossing.t = t;
        }
        crossing
    }
}

/// The edge functions of three projected corners, each opposite its corner.
#[inline(always)]
fn edge_functions<P, E>([p0, p1, p2]: &[P; 3], edge: impl Fn(&P, &P) -> E) -> [E; 3] {
    [edge(p1, p2), edge(p2, p0), edge(p0, p1)]
}

/// The lanes of a set in which no two edge functions have different signs, those of `f64` products, which are exact.
#[cold]
fn exactly_inside(projected: &[[F32x8; 2]; 3], lanes: Mask8) -> Mask8 {
    let is_inside = |lane: usize| {
        let corners = projected.map(|p| p.map(|x| f64::from(x.lane(lane))));
        let edges = edge_functions(&corners, |p, q| p[0] * q[1] - p[1] * q[0]);
        edges.iter().all(|&e| e >= 0.0) || edges.iter().all(|&e| e <= 0.0)
    };
    let inside = (0..F32x8::LANES).filter(|&lane| lanes.lane(lane) && is_inside(lane));
    Mask8::from_bits(inside.fold(0, |bits, lane| bits | 1 << lane))
}

/// What the distance test needs of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Plane<R> {
    /// The first corner.
    pub corner: Vec3<R>,
    /// (v₁ − v₀) × (v₂ − v₀), of twice the triangle's area.
    pub normal: Vec3<R>,
    /// The same with absolute products and sums: bounds the rounding of the normal.
    pub products: Vec3<R>,
    /// Lower corner of the triangle's box.
    pub lo: Vec3<R>,
    /// Upper corner of the triangle's box.
    pub hi: Vec3<R>,
}

impl<R: Real> Plane<R> {
    /// The plane of a triangle.
    #[inline(always)]
    pub fn of(corners: &[Vec3<R>; 3]) -> Self {
        let [v0, v1, v2] = *corners;
        let (e1, e2) = (v1 - v0, v2 - v0);
        let (f1, f2) = (e1.abs(), e2.abs());
        let products = Vec3::new(
            f1.y.mul_add(f2.z, f1.z * f2.y),
            f1.z.mul_add(f2.x, f1.x * f2.z),
            f1.x.mul_add(f2.y, f1.y * f2.x),
        );
        let least = |a: R, b: R, c: R| a.min(b).min(c);
        let most = |a: R, b: R, c: R| a.max(b).max(c);
        Self {
            corner: v0,
            normal: e1.cross(e2),
            products,
            lo: Vec3::new(least(v0.x, v1.x, v2.x), least(v0.y, v1.y, v2.y), least(v0.z, v1.z, v2.z)),
            hi: Vec3::new(most(v0.x, v1.x, v2.x), most(v0.y, v1.y, v2.y), most(v0.z, v1.z, v2.z)),
        }
    }
}

impl Plane<f32> {
    /// The same plane in every lane.
    #[inline(always)]
    pub fn splat(&self) -> Plane<F32x8> {
        let each = Vec3::broadcast;
        Plane {
            corner: each(self.corner),
            normal: each(self.normal),
            products: each(self.products),
            lo: each(self.lo),
            hi: each(self.hi),
        }
    }
}

impl Plane<F32x8> {
    /// The distance at which the ray meets the plane, and whether it lies in front; only for the lanes of `mask`. Lanes
    /// that are shallow must meet the triangle's box.
    #[inline(always)]
    fn distance(&self, beam: &Beam, mask: Mask8, t_min: F32x8, t_max: F32x8) -> (F32x8, Mask8) {
        let to_corner = self.corner - beam.origin;
        let height = self.normal.dot(to_corner);
        let rounding = self.products.dot(to_corner.abs()) * F32x8::splat(PLANE_ERROR);
        let mut ok = height.abs().gt(rounding);
        let fall = self.normal.dot(beam.dir);
        let mut t = height / fall;
        let steepest = (self.products.x + self.products.y + self.products.z) * F32x8::splat(STEEP);
        let shallow = mask & ok & !fall.abs().ge(steepest);
        if shallow.to_bits() != 0 {
            let [t_near, t_far] = self.own_slab(beam);
            t = F32x8::select(shallow, t.max(t_near).min(t_far), t);
            ok = ok & (!shallow | t_near.le(t_far));
        }
        (t, ok & t.ge(t_min) & t.le(t_max))
    }

    /// The slab interval of the triangle's own box.
    #[inline(always)]
    fn own_slab(&self, beam: &Beam) -> [F32x8; 2] {
        let order = |i: F32x8, lo: F32x8, hi: F32x8| {
            let up = i.gt(F32x8::ZERO);
            (F32x8::select(up, lo, hi), F32x8::select(up, hi, lo))
        };
        let x = order(beam.inverse.x, self.lo.x, self.hi.x);
        let y = order(beam.inverse.y, self.lo.y, self.hi.y);
        let z = order(beam.inverse.z, self.lo.z, self.hi.z);
        beam.slab(Vec3::new(x.0, y.0, z.0), Vec3::new(x.1, y.1, z.1))
    }
}
