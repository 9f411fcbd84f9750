//! The tree backend: built by the `obvhs` crate, walked by our own eight-wide traversal.
//!
//! `obvhs` builds a binary tree (PLOC with reinsertion); `obvhs/tree.rs` collapses it into nodes of eight children whose
//! boxes lie side by side, over blocks of eight triangles side by side. One ray is tested against eight boxes or eight
//! triangles at a time. So few triangles that a tree does not pay ([`few`]) are kept in a list. The traversal of `obvhs` itself is not used: it is several times slower and its triangle test leaks.

mod few;
mod parts;
mod tree;

use crate::Accel;
use crate::brute::scalar_hit;
use crate::geometry::{Geometry, NOTHING, TriangleId};
use crate::ray::{Hit, Hit8, NO_HIT, Opacity, Ray8, RayKind};
use crate::triangle::{Beam, Crossing, Intersect, intersect, intersect_fast};
use few::Few;
use gonio_kernel::{F32x8, Mask8, Real, U32x8, Vec3};
use tree::{Child, Node, Tree};

/// A tree of eight-wide nodes over the triangles of a geometry, or a list of a few.
#[derive(Clone, Debug)]
pub struct Obvhs(Structure);

#[derive(Clone, Debug)]
enum Structure {
    Tree(Tree, Intersect),
    List(Few),
}

impl Obvhs {
    /// Builds the tree: deterministic, O(n log n). A list of few triangles keeps the watertight test, which costs it nothing.
    pub fn new(geometry: &Geometry, intersect: Intersect) -> Self {
        Self::with_progress(geometry, intersect, &mut |_| ())
    }

    /// Builds the tree and tells now and then of how many triangles it is done.
    pub fn with_progress(geometry: &Geometry, intersect: Intersect, progress: &mut dyn FnMut(usize)) -> Self {
        Self(match Few::of(geometry) {
            Some(few) => Structure::List(few),
            None => Structure::Tree(Tree::build(geometry, progress), intersect),
        })
    }

    /// Builds a tree even where a list would be faster: for tests of the tree.
    pub fn always_tree(geometry: &Geometry, intersect: Intersect) -> Self {
        Self(Structure::Tree(Tree::build(geometry, &mut |_| ()), intersect))
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

    fn closest(&self, _kind: RayKind, rays: &[Ray8], hits: &mut [Hit8]) {
        match &self.0 {
            Structure::List(few) => few.closest(rays, hits),
            Structure::Tree(tree, Intersect::Robust) => tree.closest::<false>(rays, hits),
            Structure::Tree(tree, Intersect::Fast) => tree.closest::<true>(rays, hits),
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

const MISS: Hit = Hit { t: f32::INFINITY, bary: [0.0; 2], prim: NO_HIT, mesh: NO_HIT, instance: NO_HIT };

#[inline(always)]
fn for_each_lane(mask: Mask8, mut f: impl FnMut(usize)) {
    let mut bits = mask.to_bits();
    while bits != 0 {
        f(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

fn side_by_side(hits: &[Hit; F32x8::LANES]) -> Hit8 {
    Hit8 {
        t: F32x8::from_fn(|l| hits[l].t),
        bary: [F32x8::from_fn(|l| hits[l].bary[0]), F32x8::from_fn(|l| hits[l].bary[1])],
        prim: U32x8::from_fn(|l| hits[l].prim),
        mesh: U32x8::from_fn(|l| hits[l].mesh),
        instance: U32x8::from_fn(|l| hits[l].instance),
    }
}

/// A subtree still to be visited, and where the ray enters its box.
type Entry = (f32, Child);

/// The test that a traversal is compiled with.
#[inline(always)]
fn test<const FAST: bool>(beam: &Beam, corners: &[Vec3<F32x8>; 3], t_min: f32, t_max: f32) -> Crossing {
    let (t_min, t_max) = (F32x8::splat(t_min), F32x8::splat(t_max));
    if FAST { intersect_fast(beam, corners, t_min, t_max) } else { intersect(beam, corners, t_min, t_max) }
}

impl Tree {
    fn closest<const FAST: bool>(&self, rays: &[Ray8], hits: &mut [Hit8]) {
        let mut stack = Vec::with_capacity(self.stack_size());
        for (ray, hit) in rays.iter().zip(hits) {
            let beam = Beam::new(ray.origin, ray.dir, self.lo, self.hi);
            let mut found = [MISS; F32x8::LANES];
            for_each_lane(ray.mask, |lane| {
                let (one, t_min, t_max) = (beam.splat_lane(lane), ray.t_min.lane(lane), ray.t_max.lane(lane));
                found[lane] = self.closest_of_one::<FAST>(&one, t_min, t_max, &mut stack);
            });
            *hit = side_by_side(&found);
        }
    }

    fn occluded<const FAST: bool>(&self, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
        let mut stack = Vec::with_capacity(self.stack_size());
        for ((packet, ray), blocked) in rays.iter().enumerate().zip(blocked) {
            let beam = Beam::new(ray.origin, ray.dir, self.lo, self.hi);
            let mut bits = 0;
            for_each_lane(ray.mask, |lane| {
                let one = beam.splat_lane(lane);
                let filter = filter.map(|f| (f, packet * F32x8::LANES + lane));
                let (t_min, t_max) = (ray.t_min.lane(lane), ray.t_max.lane(lane));
                bits |= u32::from(self.one_is_occluded::<FAST>(&one, t_min, t_max, filter, &mut stack)) << lane;
            });
            *blocked = Mask8::from_bits(bits);
        }
    }

    fn closest_of_one<const FAST: bool>(&self, beam: &Beam, t_min: f32, t_max: f32, stack: &mut Vec<Entry>) -> Hit {
        let mut best = MISS;
        let mut best_index = NO_HIT;
        let mut t_best = t_max;
        let up = beam.points_up();
        let slack = beam.slack();
        stack.clear();
        stack.push((f32::NEG_INFINITY, self.root));
        while let Some((t_near, child)) = stack.pop() {
            // Not ≥: a tie may lie behind this box and have the smaller index.
            if t_near > t_best + slack {
                continue;
            }
            match self.open(child) {
                tree::Opened::Node(node) => push_children(node, beam, up, t_min - slack, t_best + slack, stack),
                tree::Opened::Leaf(leaf) => {
                    let c = test::<FAST>(beam, &leaf.corners, t_min, t_best);
                    for_each_lane(c.mask, |lane| {
                        let (t, index) = (c.t.lane(lane), leaf.index[lane]);
                        if t < best.t || (t == best.t && index < best_index) {
                            best = scalar_hit(&c, lane, NOTHING);
                            best_index = index;
                            t_best = t;
                        }
                    });
                }
            }
        }
        if best_index != NO_HIT {
            let TriangleId { prim, mesh, instance } = self.order.id(best_index);
            best = Hit { prim, mesh, instance, ..best };
        }
        best
    }

    fn one_is_occluded<const FAST: bool>(
        &self,
        beam: &Beam,
        t_min: f32,
        t_max: f32,
        filter: Option<(&dyn Opacity, usize)>,
        stack: &mut Vec<Entry>,
    ) -> bool {
        let up = beam.points_up();
        let slack = beam.slack();
        stack.clear();
        stack.push((f32::NEG_INFINITY, self.root));
        while let Some((_, child)) = stack.pop() {
            match self.open(child) {
                tree::Opened::Node(node) => push_children(node, beam, up, t_min - slack, t_max + slack, stack),
                tree::Opened::Leaf(leaf) => {
                    let c = test::<FAST>(beam, &leaf.corners, t_min, t_max);
                    let blocks = |lane: usize| match filter {
                        None => true,
                        Some((f, ray)) => f.blocks(ray, &scalar_hit(&c, lane, self.order.id(leaf.index[lane]))),
                    };
                    let mut bits = c.mask.to_bits();
                    while bits != 0 {
                        if blocks(bits.trailing_zeros() as usize) {
                            return true;
                        }
                        bits &= bits - 1;
                    }
                }
            }
        }
        false
    }
}

/// Pushes the children whose boxes the ray enters, the nearest last.
#[inline(always)]
fn push_children(node: &Node, beam: &Beam, up: [bool; 3], t_min: f32, t_max: f32, stack: &mut Vec<Entry>) {
    let [lo, hi] = node.planes;
    let pick = |up: bool, a: F32x8, b: F32x8| if up { (a, b) } else { (b, a) };
    let (x, y, z) = (pick(up[0], lo.x, hi.x), pick(up[1], lo.y, hi.y), pick(up[2], lo.z, hi.z));
    let [near, far] = beam.slab(Vec3::new(x.0, y.0, z.0), Vec3::new(x.1, y.1, z.1));
    let entered = near.le(far) & near.le(F32x8::splat(t_max)) & far.ge(F32x8::splat(t_min));
    let mut bits = entered.to_bits();
    let near = near.to_array();
    let first = stack.len();
    while bits != 0 {
        let slot = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        let entry = (near[slot], node.children[slot]);
        // Insertion keeps the new entries sorted, farthest first; there are seldom more than three.
        let mut at = stack.len();
        stack.push(entry);
        while at > first && stack[at - 1].0 < entry.0 {
            stack[at] = stack[at - 1];
            at -= 1;
        }
        stack[at] = entry;
    }
}
