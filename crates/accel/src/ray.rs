//! Rays and hits, eight side by side.

use gonio_kernel::{F32x8, Mask, Mask8, Real, U32x8, Vec3};

/// The prim of a ray that hit nothing.
pub const NO_HIT: u32 = u32::MAX;

/// How alike neighbouring rays are; a hint that chooses a traversal, never a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// Neighbours start together and point the same way: camera rays, which meet the same nodes one after the other.
    Coherent,
    /// Anything else: bounces, shadow rays, each with a way of its own through the memory.
    Incoherent,
}

/// Eight rays. Directions are unit (to 1e-3 in |d|²); t is a distance along them.
#[derive(Clone, Copy, Debug)]
pub struct Ray8 {
    /// Where the rays start.
    pub origin: Vec3<F32x8>,
    /// Where they go, unit.
    pub dir: Vec3<F32x8>,
    /// Hits nearer than this do not count; ≥ 0.
    pub t_min: F32x8,
    /// Hits farther than this do not count; +∞ for none.
    pub t_max: F32x8,
    /// Time within the shutter, [0, 1]; for moving geometry.
    pub time: F32x8,
    /// Which lanes are alive.
    pub mask: Mask8,
}

impl Ray8 {
    /// Eight live rays from 0 to infinity at time 0.
    pub fn new(origin: Vec3<F32x8>, dir: Vec3<F32x8>) -> Self {
        Self {
            origin,
            dir,
            t_min: F32x8::ZERO,
            t_max: F32x8::splat(f32::INFINITY),
            time: F32x8::ZERO,
            mask: Mask8::splat(true),
        }
    }
}

/// Eight hits.
#[derive(Clone, Copy, Debug)]
pub struct Hit8 {
    /// Distance along the ray; +∞ for a miss.
    pub t: F32x8,
    /// Barycentric weights of the second and third vertex; the first has 1 − b1 − b2.
    pub bary: [F32x8; 2],
    /// Triangle within the mesh, or [`NO_HIT`].
    pub prim: U32x8,
    /// Mesh within the geometry.
    pub mesh: U32x8,
    /// Instance within the geometry.
    pub instance: U32x8,
}

impl Hit8 {
    /// Eight misses.
    pub fn miss() -> Self {
        let none = U32x8::splat(NO_HIT);
        Self { t: F32x8::splat(f32::INFINITY), bary: [F32x8::ZERO; 2], prim: none, mesh: none, instance: none }
    }

    /// Puts a hit into a lane, which is taken modulo 8.
    #[inline]
    pub fn set(&mut self, lane: usize, hit: &Hit) {
        self.t.set_lane(lane, hit.t);
        self.bary[0].set_lane(lane, hit.bary[0]);
        self.bary[1].set_lane(lane, hit.bary[1]);
        self.prim.set_lane(lane, hit.prim);
        self.mesh.set_lane(lane, hit.mesh);
        self.instance.set_lane(lane, hit.instance);
    }

    /// The hit of one lane, `None` for a miss.
    pub fn lane(&self, lane: usize) -> Option<Hit> {
        let hit = Hit {
            t: self.t.to_array()[lane],
            bary: self.bary.map(|b| b.to_array()[lane]),
            prim: self.prim.to_array()[lane],
            mesh: self.mesh.to_array()[lane],
            instance: self.instance.to_array()[lane],
        };
        (hit.prim != NO_HIT).then_some(hit)
    }
}

/// One hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f32,
    /// Barycentric weights of the second and third vertex.
    pub bary: [f32; 2],
    /// Triangle within the mesh.
    pub prim: u32,
    /// Mesh within the geometry.
    pub mesh: u32,
    /// Instance within the geometry.
    pub instance: u32,
}

/// Decides whether a hit blocks a shadow ray: for cut-out textures.
pub trait Opacity: Sync {
    /// `ray` counts lanes through the slice that was passed: packet · 8 + lane.
    fn blocks(&self, ray: usize, hit: &Hit) -> bool;
}
