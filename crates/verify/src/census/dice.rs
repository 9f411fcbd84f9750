//! The random choices of one ray: a point, a direction, what it is aimed at, and the families that are made of these alone.

use super::aim::{Ray, Target, covers};
use super::ball::Ball;
use super::family::Family;
use super::specimen::{Place, Specimen};
use gonio_kernel::warp::{sample_uniform_sphere, sample_uniform_triangle};
use gonio_kernel::{F32x8, Vec3};
use gonio_lab::random::{bits, unit};
use gonio_tracer::SurfacePoint;

/// Random choices of one ray, by dimension.
pub(crate) struct Dice<'a> {
    pub(crate) specimen: &'a Specimen,
    pub(crate) seed: u64,
    pub(crate) index: u64,
}

impl Dice<'_> {
    /// Uniform in [0, 1): exact, a multiple of 2⁻²⁴.
    pub(super) fn u(&self, dimension: u64) -> f32 {
        unit(self.seed, self.index, dimension) as f32
    }

    pub(super) fn pick(&self, dimension: u64, count: usize) -> usize {
        (bits(self.seed, self.index, dimension) % count.max(1) as u64) as usize
    }

    pub(super) fn direction(&self, dimension: u64) -> Vec3<f32> {
        sample_uniform_sphere([self.u(dimension), self.u(dimension + 1)])
    }

    fn axis(&self, dimension: u64) -> (usize, Vec3<f32>) {
        let (axis, up) = (self.pick(dimension, 3), self.pick(dimension + 1, 2) == 0);
        (axis, unit_along(axis, if up { 1.0 } else { -1.0 }))
    }

    fn place(&self) -> Place {
        self.specimen.place(self.pick(0, self.specimen.count() as usize) as u32)
    }

    fn triangle(&self) -> [Vec3<f32>; 3] {
        self.specimen.corners(self.place())
    }

    /// A vertex, and that it is one.
    fn vertex(&self) -> (Vec3<f32>, Target) {
        let (place, corner) = (self.place(), self.pick(1, 3));
        (self.specimen.corners(place)[corner], Target::Vertex(place, corner))
    }

    /// A point of an edge, often its middle.
    fn on_edge(&self) -> (Vec3<f32>, Target) {
        let (place, corner) = (self.place(), self.pick(1, 3));
        let corners = self.specimen.corners(place);
        let (a, b) = (corners[corner], corners[(corner + 1) % 3]);
        let t = if self.pick(2, 4) == 0 { 0.5 } else { self.u(3) };
        (a.along(t, b - a), Target::Edge(place, corner))
    }

    fn on_edge_or_vertex(&self, dimension: u64) -> (Vec3<f32>, Target) {
        if self.pick(dimension, 2) == 0 { self.on_edge() } else { self.vertex() }
    }

    pub(super) fn within(&self, [a, b, c]: &[Vec3<f32>; 3]) -> Vec3<f32> {
        let [u, v] = sample_uniform_triangle([self.u(3), self.u(4)]);
        a.along(u, *b - *a).along(v, *c - *a)
    }

    fn on_triangle(&self) -> Vec3<f32> {
        self.within(&self.triangle())
    }

    pub(super) fn in_bounds(&self, u: [f32; 3]) -> Vec3<f32> {
        self.specimen.lo + (self.specimen.hi - self.specimen.lo).mul_each(u.into())
    }

    /// Half of the time a point in the bounds, grown by half their size on every side; else one near some vertex, at any
    /// order of magnitude: the bounds of scattered things are mostly empty.
    fn around(&self) -> Vec3<f32> {
        if self.pick(23, 2) == 0 {
            let corners =
                self.specimen.corners(self.specimen.place(self.pick(24, self.specimen.count() as usize) as u32));
            let away = self.specimen.size() * (-12.0 * self.u(25)).exp2();
            return corners[0].along(away, self.direction(20));
        }
        let grown = Vec3::splat(0.02 * self.specimen.size()); // a flat thing has no thickness to grow
        let spread = [20, 21, 22].map(|dimension| 2.0 * self.u(dimension) - 0.5);
        self.in_bounds(spread) + grown.mul_each(Vec3::from(spread) - Vec3::splat(0.5))
    }

    fn open(&self, origin: Vec3<f32>, dir: Vec3<f32>) -> Ray {
        Ray { origin, dir, t_min: 0.0, t_max: f32::INFINITY, covered: false }
    }

    fn towards(&self, origin: Vec3<f32>, to: Vec3<f32>) -> Ray {
        self.open(origin, (to - origin).normalize_or(Vec3::unit_z()))
    }

    fn aimed(&self, ray: Ray, target: Target) -> Ray {
        Ray { covered: covers(self.specimen, target, &ray), ..ray }
    }

    /// One ray of a family that has nothing to do with the camera or the inside.
    pub(super) fn ray(&self, family: Family) -> Ray {
        match family {
            Family::Edge => {
                let (to, target) = self.on_edge();
                self.aimed(self.towards(self.around(), to), target)
            }
            Family::Vertex => {
                let (to, target) = self.vertex();
                self.aimed(self.towards(self.around(), to), target)
            }
            Family::AxisParallel => self.axis_parallel(),
            Family::Grazing => self.grazing(),
            Family::Bounded => self.bounded(),
            Family::Far => {
                let away = self.specimen.size() * 10.0_f32.powf(1.0 + 5.0 * self.u(10));
                let (to, target) = self.on_edge_or_vertex(11);
                let origin = to.along(away, self.direction(12));
                let aside = if self.pick(14, 2) == 0 { self.on_triangle() } else { to };
                self.aimed(self.towards(origin, aside), target)
            }
            Family::Secondary => self.secondary(),
            Family::OnSurface => self.open(self.on_triangle(), self.direction(10)),
            _ => self.open(self.around(), self.direction(10)),
        }
    }

    /// From a point of a triangle, moved off it to the side that the ray leaves to.
    fn secondary(&self) -> Ray {
        let [a, b, c] = self.triangle();
        let bary = sample_uniform_triangle([self.u(3), self.u(4)]).map(F32x8::splat);
        let dir = self.direction(10);
        let normal = (b - a).cross(c - a).normalize_or(dir);
        let normal = normal * 1.0_f32.copysign(normal.dot(dir));
        let point = SurfacePoint::new(&[a, b, c].map(Vec3::broadcast), bary).off_plane(Vec3::broadcast(normal));
        self.open(Vec3::new(point.x.lane(0), point.y.lane(0), point.z.lane(0)), dir)
    }

    fn axis_parallel(&self) -> Ray {
        let (axis, dir) = self.axis(4);
        if self.pick(6, 2) == 0 {
            let (to, target) = self.on_edge_or_vertex(7);
            let mut origin = <[f32; 3]>::from(to);
            origin[axis] -= dir_of(dir, axis) * self.specimen.size() * (0.01 + 1.5 * self.u(8));
            return self.aimed(self.open(origin.into(), dir), target);
        }
        // Each coordinate by itself: between faces, in faces, through vertices.
        let (free, vertex) = (<[f32; 3]>::from(self.around()), <[f32; 3]>::from(self.vertex().0));
        let mixed = [0, 1, 2].map(|a| if self.pick(a as u64 + 9, 2) == 0 { free[a] } else { vertex[a] });
        self.open(mixed.into(), dir)
    }

    fn grazing(&self) -> Ray {
        let [a, b, c] = self.triangle();
        let (s, t) = (2.0 * self.u(10) - 1.0, 2.0 * self.u(11) - 1.0);
        let along = ((b - a) * s + (c - a) * t).normalize_or(Vec3::unit_z());
        let normal = (b - a).cross(c - a).normalize_or(Vec3::unit_z());
        let tilt = [0.0, 1e-7, -1e-7, 1e-5, -1e-5, 1e-3][self.pick(12, 6)];
        let dir = (along + normal * tilt).normalize_or(along);
        self.open(self.on_triangle() - dir * (self.specimen.size() * self.u(13)), dir)
    }

    fn bounded(&self) -> Ray {
        let (origin, to) = (self.around(), self.on_triangle());
        let ray = self.towards(origin, to);
        let distance = (to - origin).length();
        let near = [distance, distance.next_up(), distance.next_down(), distance * 0.5][self.pick(10, 4)];
        match self.pick(11, 3) {
            0 => Ray { t_max: near, ..ray },
            1 => Ray { t_min: near, ..ray },
            _ => Ray { t_min: near.min(distance), t_max: near.max(distance), ..ray },
        }
    }

    /// From anywhere in the inner three quarters of a ball.
    pub(super) fn inside_out(&self, family: Family, ball: &Ball) -> Ray {
        let reach = 0.75 * ball.radius;
        if family == Family::AxisFromInside {
            // Along the ball's own axis the ray meets a vertex or an edge exactly; along another it has one such coordinate.
            let slide = unit_along(ball.axis, reach * (2.0 * self.u(41) - 1.0));
            let (other, dir) = self.axis(42);
            let own = unit_along(ball.axis, dir_of(dir, other));
            return self.open(ball.centre + slide, if self.pick(44, 4) == 0 { dir } else { own });
        }
        let origin = ball.centre.along(reach * self.u(41), self.direction(42));
        let (to, target) = if family == Family::VertexFromInside { self.vertex() } else { self.on_edge() };
        self.aimed(self.towards(origin, to), target)
    }
}

/// A vector of one component.
fn unit_along(axis: usize, length: f32) -> Vec3<f32> {
    let mut v = [0.0; 3];
    v[axis] = length;
    v.into()
}

fn dir_of(v: Vec3<f32>, axis: usize) -> f32 {
    <[f32; 3]>::from(v)[axis]
}
