//! Ray casting: which triangle does a ray meet first, and is anything between two points?
//!
//! - [`Geometry`] is the input: meshes and the instances that place them.
//! - [`Ray8`] and [`Hit8`] carry eight rays and their hits, side by side; [`RayKind`] says how alike the eight are.
//! - [`Accel`] is the question, answered by backends that find the same hit: [`Brute`] tests every triangle and is the
//!   oracle, [`Obvhs`] builds a tree, with help of the crate of that name, and walks it eight boxes or triangles at a time. With
//!   the feature `embree`, `Embree` hands everything to Intel's library of that name.
//!
//! [`Intersect`] says how strictly a backend shall test. Robust, Brute and Obvhs share one watertight triangle test ([`triangle`])
//! and agree bit for bit: a hit counts only inside the padded slab interval of its own triangle's box, so every ancestor box is
//! entered by construction. Ties go to the smallest (t, instance, mesh, prim).
//!
//! ```
//! use gonio_accel::{Accel, Brute, Geometry, Hit8, Mesh, Ray8, RayKind};
//! use gonio_kernel::{F32x8, Vec3};
//!
//! let mesh = Mesh { positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], triangles: vec![[0, 1, 2]] };
//! let geometry = Geometry::of_mesh(mesh).unwrap();
//! let accel = Brute::new(&geometry);
//! let up = |x, y, z| Vec3::new(F32x8::splat(x), F32x8::splat(y), F32x8::splat(z));
//! let rays = [Ray8::new(up(0.2, 0.2, -1.0), up(0.0, 0.0, 1.0))];
//! let mut hits = [Hit8::miss()];
//! accel.closest(RayKind::Coherent, &rays, &mut hits);
//! assert_eq!(hits[0].t.to_array()[0], 1.0);
//! ```
#![cfg_attr(not(feature = "embree"), forbid(unsafe_code))]
#![cfg_attr(feature = "embree", deny(unsafe_code))]

mod brute;
#[cfg(feature = "embree")]
#[allow(unsafe_code, reason = "it calls a library written in C++")]
mod embree;
mod geometry;
mod obvhs;
mod ray;
pub mod triangle;

pub use brute::Brute;
#[cfg(feature = "embree")]
pub use embree::{Embree, EmbreeError, EmbreeOptions, EmbreeQuality, EmbreeWidth};
pub use geometry::{Geometry, GeometryError, Instance, Mesh, TriangleId, WorldTriangle};
pub use obvhs::{Obvhs, ObvhsOptions, ObvhsPreset, Sharing, TreeError};
pub use ray::{Hit, Hit8, NO_HIT, Opacity, Ray8, RayKind};
pub use triangle::Intersect;

use gonio_kernel::Mask8;

/// A backend: answers ray queries on the geometry that it was built from.
pub trait Accel: Send + Sync {
    /// The backend's name, as the command line spells it.
    fn name(&self) -> &'static str;

    /// The nearest hit of every live ray with t_min ≤ t ≤ t_max, into the like place of `hits`; a miss has
    /// [`NO_HIT`] as its prim. Dead lanes become misses. The slices must be of equal length, or the rest is left alone.
    fn closest(&self, kind: RayKind, rays: &[Ray8], hits: &mut [Hit8]);

    /// Whether anything lies on each live ray with t_min ≤ t ≤ t_max. With a filter, only hits that it lets block count.
    /// Dead lanes are not blocked.
    fn occluded(&self, kind: RayKind, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]);
}

/// Runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
