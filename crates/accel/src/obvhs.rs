//! The tree backend: built by the `obvhs` crate, walked by our own eight-wide traversal.
//!
//! `obvhs` builds a binary tree (PLOC with reinsertion); `obvhs/tree.rs` collapses it into nodes of eight children whose
//! boxes lie side by side, over blocks of eight triangles side by side. One ray is tested against eight boxes or eight
//! triangles at a time. So few triangles that a tree does not pay ([`few`]) are kept in a list. The traversal of `obvhs` itself is not used: it is several times slower and its triangle test leaks.

mod few;
mod tree;

use crate::Accel;
use crate::brute::scalar_hit;
use crate::geometry::Geometry;
use crate::ray::{Hit, Hit8, NO_HIT, Opacity, Ray8, RayKind};
use crate::triangle::{Beam, Crossing, Intersect, intersect, intersect_fast};
use few::Few;
use gonio_kernel::{F32x8, Mask8, Real, U32x8, Vec3};
use tree::{Child, Node, Tree};

/// A tree of eight-wide nodes over the triangles of a geometry, or a list of a few.
#[derive(Clone, Debug)]
pub struct Obvhs {
    tree: Tree,
    few: Option<Few>,
    intersect: Intersect,
}

impl Obvhs {
    /// Builds the tree: deterministic, O(n log n). A list of few triangles keeps the watertight test, which costs it nothing.
    pub fn new(geometry: &Geometry, intersect: Intersect) -> Self {
        Self { few: Few::of(geometry), ..Self::always_tree(geometry, intersect) }
    }

    /// Builds a tree even where a list would be faster: for tests of the tree.
    pub fn always_tree(geometry: &Geometry, intersect: Intersect) -> Self {
        Self { tree: Tree::build(geometry), few: None, intersect }
    }
}

impl Accel for Obvhs {
    fn name(&self) -> &'static str {
        "obvhs"
    }

    fn closest(&self, _kind: RayKind, rays: &[Ray8], hits: &mut [Hit8]) {
        match (&self.few, self.intersect) {
            (Some(few), _) => few.closest(rays, hits),
            (None, Intersect::Robust) => self.closest_in_tree::<false>(rays, hits),
            (None, Intersect::Fast) => self.closest_in_tree::<true>(rays, hits),
        }
    }

    fn occluded(&self, _kind: RayKind, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
        match (&self.few, self.intersect) {
            (Some(few), _) => few.occluded(rays, filter, blocked),
            (None, Intersect::Robust) => self.occluded_in_tree::<false>(rays, filter, blocked),
            (None, Intersect::Fast) => self.occluded_in_tree::<true>(rays, filter, blocked),
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

impl Obvhs {
    fn closest_in_tree<const FAST: bool>(&self, rays: &[Ray8], hits: &mut [Hit8]) {
        let mut stack = Vec::with_capacity(self.tree.stack_size());
        for (ray, hit) in rays.iter().zip(hits) {
            let beam = Beam::new(ray.origin, ray.dir, self.tree.lo, self.tree.hi);
            let mut found = [MISS; F32x8::LANES];
            for_each_lane(ray.mask, |lane| {
                let (one, t_min, t_max) = (beam.splat_lane(lane), ray.t_min.lane(lane), ray.t_max.lane(lane));
                found[lane] = self.closest_of_one::<FAST>(&one, t_min, t_max, &mut stack);
            });
            *hit = side_by_side(&found);
        }
    }

    fn occluded_in_tree<const FAST: bool>(&self, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
        let mut stack = Vec::with_capacity(self.tree.stack_size());
        for ((packet, ray), blocked) in rays.iter().enumerate().zip(blocked) {
            let beam = Beam::new(ray.origin, ray.dir, self.tree.lo, self.tree.hi);
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
        stack.push((f32::NEG_INFINITY, self.tree.root));
        while let Some((t_near, child)) = stack.pop() {
            // Not ≥: a tie may lie behind this box and have the smaller index.
            if t_near > t_best + slack {
                continue;
            }
            match self.tree.open(child) {
                tree::Opened::Node(node) => push_children(node, beam, up, t_min - slack, t_best + slack, stack),
                tree::Opened::Leaf(leaf) => {
                    let c = test::<FAST>(beam, &leaf.corners, t_min, t_best);
                    for_each_lane(c.mask, |lane| {
                        let (t, index) = (c.t.lane(lane), leaf.index[lane]);
                        if t < best.t || (t == best.t && index < best_index) {
                            best = scalar_hit(&c, lane, self.tree.ids[index as usize]);
                            best_index = index;
                            t_best = t;
                        }
                    });
                }
            }
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
        stack.push((f32::NEG_INFINITY, self.tree.root));
        while let Some((_, child)) = stack.pop() {
            match self.tree.open(child) {
                tree::Opened::Node(node) => push_children(node, beam, up, t_min - slack, t_max + slack, stack),
                tree::Opened::Leaf(leaf) => {
                    let c = test::<FAST>(beam, &leaf.corners, t_min, t_max);
                    let blocks = |lane: usize| match filter {
                        None => true,
                        Some((f, ray)) => {
                            f.blocks(ray, &scalar_hit(&c, lane, self.tree.ids[leaf.index[lane] as usize]))
                        }
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
