//! The rays of the census, by family: each a way in which a ray and a triangle can be on bad terms.

use super::meshes::Specimen;
use crate::random::{bits, unit};
use gonio_accel::{Ray8, RayKind, WorldTriangle};
use gonio_kernel::{F32x8, Mask, Mask8, Vec3, warp::sample_uniform_sphere};
use std::fmt;

/// A way of choosing rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    /// From one point, side by side.
    Camera,
    /// From anywhere in any direction.
    Random,
    /// Exactly along an axis, often at a vertex' own coordinates.
    AxisParallel,
    /// At a point of an edge.
    Edge,
    /// At a vertex.
    Vertex,
    /// In the plane of a triangle, or nearly.
    Grazing,
    /// From a point of a triangle.
    Secondary,
    /// With an interval that begins or ends at a triangle, to the last bit.
    Bounded,
}

impl Family {
    pub(super) const ALL: [Self; 8] = [
        Self::Camera,
        Self::Random,
        Self::AxisParallel,
        Self::Edge,
        Self::Vertex,
        Self::Grazing,
        Self::Secondary,
        Self::Bounded,
    ];

    /// What a renderer would say of them.
    pub(super) fn kind(self) -> RayKind {
        if self == Self::Camera { RayKind::Coherent } else { RayKind::Incoherent }
    }
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Camera => "camera",
            Self::Random => "random",
            Self::AxisParallel => "axis-parallel",
            Self::Edge => "edge-aimed",
            Self::Vertex => "vertex-aimed",
            Self::Grazing => "grazing",
            Self::Secondary => "secondary",
            Self::Bounded => "bounded",
        })
    }
}

/// One ray.
#[derive(Clone, Copy)]
struct Ray {
    origin: Vec3<f32>,
    dir: Vec3<f32>,
    t_min: f32,
    t_max: f32,
}

/// Random choices of one ray.
struct Dice<'a> {
    specimen: &'a Specimen,
    seed: u64,
    index: u64,
}

/// Eight rays of a family. Every eighth packet has dead lanes.
pub(super) fn packet(specimen: &Specimen, family: Family, seed: u64, number: u64) -> Ray8 {
    let rays: [Ray; 8] = std::array::from_fn(|lane| {
        let dice = Dice { specimen, seed, index: number * 8 + lane as u64 };
        dice.ray(family)
    });
    let alive = if number % 8 == 7 { bits(seed, number, 100) as u32 & 0xff } else { 0xff };
    pack(&rays, alive)
}

/// Eight rays from inside of a closed specimen at its edges and vertices.
pub(super) fn from_inside(specimen: &Specimen, seed: u64, number: u64) -> Ray8 {
    let rays: [Ray; 8] = std::array::from_fn(|lane| {
        let dice = Dice { specimen, seed, index: number * 8 + lane as u64 };
        let target = if lane % 2 == 0 { dice.on_edge() } else { dice.vertex() };
        // Somewhere in the ball of radius 0.4, which both closed specimens enclose.
        dice.towards(dice.direction(10) * (0.4 * dice.u(12)), target)
    });
    pack(&rays, 0xff)
}

fn pack(rays: &[Ray; 8], alive: u32) -> Ray8 {
    let real = |f: &dyn Fn(&Ray) -> f32| F32x8::new(std::array::from_fn(|lane| f(&rays[lane])));
    Ray8 {
        origin: Vec3::new(real(&|r| r.origin.x), real(&|r| r.origin.y), real(&|r| r.origin.z)),
        dir: Vec3::new(real(&|r| r.dir.x), real(&|r| r.dir.y), real(&|r| r.dir.z)),
        t_min: real(&|r| r.t_min),
        t_max: real(&|r| r.t_max),
        time: F32x8::splat(0.0),
        mask: Mask8::from_bits(alive) & Mask8::splat(true),
    }
}

impl Dice<'_> {
    fn u(&self, dimension: u64) -> f32 {
        unit(self.seed, self.index, dimension) as f32 // exact: multiples of 2⁻²⁴
    }

    fn pick(&self, dimension: u64, count: usize) -> usize {
        (bits(self.seed, self.index, dimension) % count.max(1) as u64) as usize
    }

    fn direction(&self, dimension: u64) -> Vec3<f32> {
        sample_uniform_sphere([self.u(dimension), self.u(dimension + 1)])
    }

    fn triangle(&self) -> WorldTriangle {
        self.specimen.triangles[self.pick(0, self.specimen.triangles.len())]
    }

    fn vertex(&self) -> Vec3<f32> {
        self.triangle().corners[self.pick(1, 3)]
    }

    fn on_edge(&self) -> Vec3<f32> {
        let (corners, first) = (self.triangle().corners, self.pick(1, 3));
        let (a, b) = (corners[first], corners[(first + 1) % 3]);
        a.along(self.u(2), b - a)
    }

    fn on_triangle(&self) -> Vec3<f32> {
        let [a, b, c] = self.triangle().corners;
        let (u, v) = (self.u(2), self.u(3));
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        a.along(u, b - a).along(v, c - a)
    }

    /// Half of the time a point in the bounds, grown by half their size on every side, else one near some vertex: the
    /// bounds of scattered things are mostly empty.
    fn around(&self) -> Vec3<f32> {
        let spread = [20, 21, 22].map(|dimension| 2.0 * self.u(dimension) - 0.5);
        if self.pick(23, 2) == 0 {
            let vertex = self.specimen.triangles[self.pick(24, self.specimen.triangles.len())].corners[0];
            return vertex + (Vec3::from(spread) - Vec3::splat(0.5)) * 2.0;
        }
        let (lo, hi) = (self.specimen.lo, self.specimen.hi);
        Vec3::from([0, 1, 2].map(|axis| lo[axis] + (hi[axis] - lo[axis] + 0.1) * spread[axis]))
    }

    fn towards(&self, origin: Vec3<f32>, target: Vec3<f32>) -> Ray {
        let dir = (target - origin).normalize_or(Vec3::unit_z());
        Ray { origin, dir, t_min: 0.0, t_max: f32::INFINITY }
    }

    fn ray(&self, family: Family) -> Ray {
        let open = |origin, dir| Ray { origin, dir, t_min: 0.0, t_max: f32::INFINITY };
        match family {
            Family::Camera => {
                // Eight neighbours of a picture of 256 columns, seen from a corner beyond the bounds, aimed at a triangle:
                // the eight throw the same dice for their place.
                let packet = Dice { index: self.index / 8, seed: self.seed ^ 1, ..*self };
                let hi = Vec3::from(self.specimen.hi);
                let eye = hi + (hi - Vec3::from(self.specimen.lo)) * 0.7;
                let (x, y) = ((self.index % 8) as f32 / 128.0, 0.25 * packet.u(4));
                let centre = packet.vertex();
                let forward = (centre - eye).normalize_or(Vec3::unit_z());
                let (right, up) = gonio_kernel::frame::tangents(forward);
                open(eye, (forward + right * (0.5 * x) + up * (0.5 * y)).normalize_or(forward))
            }
            Family::Random => open(self.around(), self.direction(10)),
            Family::AxisParallel => {
                let mut dir = [0.0; 3];
                dir[self.pick(4, 3)] = if self.pick(5, 2) == 0 { 1.0 } else { -1.0 };
                let (free, vertex) = (self.around(), self.vertex());
                // Each coordinate by itself: between faces, in faces, through vertices.
                let mix = |dimension, a: f32, b: f32| if self.pick(dimension, 2) == 0 { a } else { b };
                let origin = Vec3::new(mix(6, free.x, vertex.x), mix(7, free.y, vertex.y), mix(8, free.z, vertex.z));
                open(origin, Vec3::from(dir))
            }
            Family::Edge => self.towards(self.around(), self.on_edge()),
            Family::Vertex => self.towards(self.around(), self.vertex()),
            Family::Grazing => {
                let [a, b, c] = self.triangle().corners;
                let (s, t) = (2.0 * self.u(4) - 1.0, 2.0 * self.u(5) - 1.0);
                let along = ((b - a) * s + (c - a) * t).normalize_or(Vec3::unit_z());
                let normal = (b - a).cross(c - a).normalize_or(Vec3::unit_z());
                let tilt = [0.0, 1e-7, -1e-7, 1e-5, -1e-5, 1e-3][self.pick(6, 6)];
                let dir = (along + normal * tilt).normalize_or(along);
                open(self.on_triangle() - dir * (3.0 * self.u(7)), dir)
            }
            Family::Secondary => open(self.on_triangle(), self.direction(10)),
            Family::Bounded => {
                let (origin, target) = (self.around(), self.on_triangle());
                let ray = self.towards(origin, target);
                let distance = (target - origin).length();
                let near = [distance, distance.next_up(), distance.next_down(), distance * 0.5][self.pick(6, 4)];
                match self.pick(7, 3) {
                    0 => Ray { t_max: near, ..ray },
                    1 => Ray { t_min: near, ..ray },
                    _ => Ray { t_min: near.min(distance), t_max: near.max(distance), ..ray },
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::meshes::specimens;
    use super::*;

    #[test]
    fn every_family_makes_rays_in_the_domain_and_some_hit() {
        for specimen in specimens() {
            for family in Family::ALL {
                let brute = gonio_accel::Brute::new(&specimen.geometry);
                let mut hits = 0;
                for number in 0..64 {
                    let ray = packet(&specimen, family, 3, number);
                    assert!(ray.dir.is_direction().all() && ray.origin.is_finite().all(), "{} {family}", specimen.name);
                    let mut hit = [gonio_accel::Hit8::miss()];
                    gonio_accel::Accel::closest(&brute, family.kind(), &[ray], &mut hit);
                    hits += (0..8).filter(|&lane| hit[0].lane(lane).is_some()).count();
                }
                assert!(hits > 0, "{} {family}", specimen.name);
            }
        }
    }
}
