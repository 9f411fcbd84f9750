//! The tree backend: eight-wide trees, walked in the way that suits the rays.
//!
//! - [`tree`] is the tree of [`cell`]s: nodes of eight boxes side by side over blocks of eight triangles side by side, so that a ray,
//!   or a whole tile of rays, is tested against eight of them at once.
//! - It is made ([`growth`]) of a binary tree, from the top down by [`sah`] or by the crate `obvhs` ([`bridge`]), which [`collapse`] makes wide in
//!   the cheapest way; [`order`] says what a ray that looks for any hit visits first, and [`check`] whether all of it is sound.
//! - Rays that have nothing in common walk alone, many at a time ([`flight`]); rays of a camera walk as tiles ([`tile`]).
//!   Those that look for any hit first try the triangles that blocked the last ones ([`occluders`]).
//! - A mesh that is placed many times may keep one tree, in its own coordinates ([`shared`], [`placed`]).
//! - So few triangles that a tree does not pay are kept in a list ([`few`]).
//!
//! None of this changes a result: all share the test of [`crate::triangle`], whose hits do not depend on the order of visits. The
//! traversals of `obvhs` itself are not used: they are several times slower and their triangle test leaks.

mod boxes;
mod bridge;
mod cell;
mod check;
mod collapse;
mod few;
mod flight;
mod growth;
mod occluders;
mod odds;
mod options;
mod order;
mod pages;
mod placed;
mod sah;
mod shared;
mod stack;
mod tile;
mod tree;

use crate::Accel;
use crate::brute::scalar_hit;
use crate::geometry::{Geometry, TriangleId};
use crate::ray::{Hit, Hit8, NO_HIT, Opacity, Ray8, RayKind};
use crate::triangle::{Beam, Crossing, Intersect, barycentric};
pub use check::TreeError;
pub use options::{ObvhsOptions, ObvhsPreset, Sharing};

use cell::Cell;
use few::Few;
use flight::{Quest, Walk};
use gonio_kernel::{F32x8, Mask8};
use occluders::Occluders;
use stack::for_each_lane;
use tree::Tree;

/// A tree of eight-wide nodes over the triangles of a geometry, or a list of a few.
#[derive(Clone, Debug)]
pub struct Obvhs(Structure);

#[derive(Clone, Debug)]
enum Structure {
    Tree(Tree, Intersect),
    List(Few),
}

impl Obvhs {
    /// Builds a tree by the preset [`ObvhsPreset::Medium`]: O(n log n). The tree is the same for any number of threads.
    pub fn new(geometry: &Geometry, intersect: Intersect) -> Self {
        Self::with(geometry, ObvhsOptions { intersect, ..ObvhsOptions::default() }, &mut |_| ())
    }

    /// Builds a tree and tells now and then of how many triangles it is done.
    pub fn with(geometry: &Geometry, options: ObvhsOptions, progress: &mut dyn FnMut(usize)) -> Self {
        Self(match Few::of(geometry) {
            Some(few) => Structure::List(few),
            None => Structure::Tree(Tree::build(geometry, &options, progress), options.intersect),
        })
    }

    /// Builds a tree even where a list would be faster: for tests of the tree.
    pub fn always_tree(geometry: &Geometry, options: ObvhsOptions) -> Self {
        Self(Structure::Tree(Tree::build(geometry, &options, &mut |_| ()), options.intersect))
    }

    /// Bytes of nodes and triangles together, without the geometry that they were made from.
    pub fn bytes(&self) -> usize {
        match &self.0 {
            Structure::List(few) => few.bytes(),
            Structure::Tree(tree, _) => tree.bytes(),
        }
    }

    /// Looks at every cell of the tree: whether boxes contain what is below them, and every triangle is there once. O(n).
    ///
    /// # Errors
    /// The first thing that is wrong, which is a bug of ours.
    pub fn validate(&self) -> Result<(), TreeError> {
        match &self.0 {
            Structure::List(_) => Ok(()),
            Structure::Tree(tree, _) => tree.check(),
        }
    }

    #[cfg(test)]
    fn of_tree(tree: Tree) -> Self {
        Self(Structure::Tree(tree, Intersect::Robust))
    }
}

impl Accel for Obvhs {
    fn name(&self) -> &'static str {
        "obvhs"
    }

    fn closest(&self, kind: RayKind, rays: &[Ray8], hits: &mut [Hit8]) {
        match &self.0 {
            Structure::List(few) => few.closest(rays, hits),
            Structure::Tree(tree, Intersect::Robust) => tree.closest::<false>(kind, rays, hits),
            Structure::Tree(tree, Intersect::Fast) => tree.closest::<true>(kind, rays, hits),
        }
    }

    fn occluded(&self, _kind: RayKind, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
        match &self.0 {
            Structure::List(few) => few.occluded(rays, filter, blocked),
            Structure::Tree(tree, Intersect::Robust) => tree.occluded::<false>(rays, filter, blocked),
            Structure::Tree(tree, Intersect::Fast) => tree.occluded::<true>(rays, filter, blocked),
        }
    }
}

/// Looks for the nearest hit of each ray.
struct Nearest<'a> {
    tree: &'a Tree,
    hits: &'a mut [Hit8],
}

impl Quest for Nearest<'_> {
    const ANY: bool = false;

    #[inline(always)]
    fn begin<const FAST: bool>(&mut self, _: usize, _: &Ray8, _: &Beam, live: Mask8) -> Mask8 {
        live
    }

    #[inline(always)]
    fn meet(&mut self, walk: &mut Walk<'_>, crossing: &Crossing, block: Cell<'_>) -> bool {
        for_each_lane(crossing.mask, |lane| {
            let (t, index) = (crossing.t.lane(lane), block.index(lane));
            if t < walk.t_best() || (t == walk.t_best() && index < walk.index) {
                walk.shorten(t, index, crossing.edges().map(|e| e.lane(lane)));
            }
        });
        false
    }

    #[inline(always)]
    fn done(&mut self, walk: &Walk<'_>) {
        if walk.index == NO_HIT {
            return;
        }
        let (hit, lane) = (&mut self.hits[walk.ray / F32x8::LANES], walk.ray % F32x8::LANES);
        let TriangleId { prim, mesh, instance } = self.tree.order.id(walk.index);
        hit.set(lane, &Hit { t: walk.t_best(), bary: barycentric(&walk.edges), prim, mesh, instance });
    }
}

/// Looks for any hit of each ray.
struct Any<'a> {
    tree: &'a Tree,
    filter: Option<&'a dyn Opacity>,
    blocked: &'a mut [Mask8],
    occluders: Occluders,
}

impl Quest for Any<'_> {
    const ANY: bool = true;

    #[inline(always)]
    fn begin<const FAST: bool>(&mut self, packet: usize, ray: &Ray8, beam: &Beam, live: Mask8) -> Mask8 {
        let shut = self.occluders.shut::<FAST>(ray, beam, live);
        self.blocked[packet] = shut;
        live & !shut
    }

    #[inline(always)]
    fn meet(&mut self, walk: &mut Walk<'_>, crossing: &Crossing, block: Cell<'_>) -> bool {
        let blocks = |lane: usize| match self.filter {
            None => true,
            Some(f) => f.blocks(walk.ray, &scalar_hit(crossing, lane, self.tree.order.id(block.index(lane)))),
        };
        let mut bits = crossing.mask.to_bits();
        while bits != 0 {
            if blocks(bits.trailing_zeros() as usize) {
                let blocked = &mut self.blocked[walk.ray / F32x8::LANES];
                *blocked = *blocked | Mask8::from_bits(1 << (walk.ray % F32x8::LANES));
                if self.filter.is_none() {
                    self.occluders.add(block, bits.trailing_zeros() as usize);
                }
                return true;
            }
            bits &= bits - 1;
        }
        false
    }

    fn done(&mut self, _: &Walk<'_>) {}
}

impl Tree {
    fn closest<const FAST: bool>(&self, kind: RayKind, rays: &[Ray8], hits: &mut [Hit8]) {
        let count = rays.len().min(hits.len());
        let (rays, hits) = (&rays[..count], &mut hits[..count]);
        hits.fill(Hit8::miss());
        let alone = |rays: &[Ray8], hits: &mut [Hit8]| self.fly::<FAST, _>(rays, &mut Nearest { tree: self, hits });
        match kind {
            RayKind::Coherent => self.view().closest_in_tiles::<FAST>(rays, hits, alone),
            RayKind::Incoherent => alone(rays, hits),
        }
    }

    fn occluded<const FAST: bool>(&self, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
        let count = rays.len().min(blocked.len());
        blocked[..count].fill(Mask8::from_bits(0));
        self.fly::<FAST, _>(&rays[..count], &mut Any { tree: self, filter, blocked, occluders: Occluders::default() });
    }

    fn fly<const FAST: bool, Q: Quest>(&self, rays: &[Ray8], quest: &mut Q) {
        if self.placed.is_empty() {
            self.view().fly::<FAST, false, Q>(rays, quest);
        } else {
            self.view().fly::<FAST, true, Q>(rays, quest);
        }
    }
}
