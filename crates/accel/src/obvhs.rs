//! The tree backend: built by the `obvhs` crate, walked by our own eight-wide traversal.
//!
//! `obvhs` builds a binary tree (PLOC with reinsertion); `obvhs/tree.rs` collapses it into nodes of eight children whose
//! boxes lie side by side, over blocks of eight triangles side by side. One ray is tested against eight boxes or eight
//! triangles at a time. So few triangles that a tree does not pay ([`few`]) are kept in a list. The traversal of `obvhs`
//! itself is not used: it is several times slower and its triangle test leaks.
//!
//! **Order.** A ray that looks for its nearest hit visits the nearest child first; one that looks for any hit visits the
//! largest first, where anything is most likely to be met. Incoherent rays take turns, eight in flight, one step
//! each: while the memory fetches one's node, the others go on. None of this changes a result.

mod few;
mod parts;
mod tree;

use crate::Accel;
use crate::brute::scalar_hit;
use crate::geometry::{Geometry, NOTHING, TriangleId};
use crate::ray::{Hit, Hit8, NO_HIT, Opacity, Ray8, RayKind};
use crate::triangle::{Beam, Crossing, Intersect, intersect, intersect_fast};
use few::Few;
use gonio_kernel::{F32x8, Mask8, Real, U32x8, Vec3, each_lane};
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

const MISS: Hit = Hit { t: f32::INFINITY, bary: [0.0; 2], prim: NO_HIT, mesh: NO_HIT, instance: NO_HIT };

#[inline(always)]
fn for_each_lane(mask: Mask8, mut f: impl FnMut(usize)) {
    let mut bits = mask.to_bits();
    while bits != 0 {
        f(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

/// Lets the lanes take turns, one step each, until every one of them has said that it is done.
#[inline(always)]
fn take_turns(mask: Mask8, mut is_done: impl FnMut(usize) -> bool) {
    let mut live = mask;
    while live.to_bits() != 0 {
        let mut left = 0;
        for_each_lane(live, |lane| left |= u32::from(!is_done(lane)) << lane);
        live = Mask8::from_bits(left);
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

/// A ray on its way through the tree.
struct Walk {
    beam: Beam,
    up: [bool; 3],
    t_min: f32,
    /// The best hit so far; t_max before there is one.
    t_best: f32,
    best: Hit,
    best_index: u32,
    /// Subtrees still to be visited, the next one last.
    stack: Vec<Entry>,
}

impl Walk {
    /// Back to the root, with another ray.
    fn start(&mut self, beam: Beam, t_min: f32, t_max: f32, root: Child) {
        (self.beam, self.up, self.t_min, self.t_best) = (beam, beam.points_up(), t_min, t_max);
        (self.best, self.best_index) = (MISS, NO_HIT);
        self.stack.clear();
        self.stack.push((f32::NEG_INFINITY, root));
    }
}

impl Tree {
    /// Eight walks that take turns, one step each: while the memory fetches the node of one, the others go on.
    fn walks(&self) -> [Walk; F32x8::LANES] {
        let nowhere = Vec3::splat(F32x8::ONE);
        let beam = Beam::new(nowhere, nowhere, self.lo, self.hi);
        each_lane(|_| Walk {
            beam,
            up: [true; 3],
            t_min: 0.0,
            t_best: 0.0,
            best: MISS,
            best_index: NO_HIT,
            stack: Vec::with_capacity(self.stack_size()),
        })
    }

    /// Sends the live rays of eight on their way.
    fn start(&self, walks: &mut [Walk; F32x8::LANES], ray: &Ray8) {
        let beam = Beam::new(ray.origin, ray.dir, self.lo, self.hi);
        for_each_lane(ray.mask, |lane| {
            walks[lane].start(beam.splat_lane(lane), ray.t_min.lane(lane), ray.t_max.lane(lane), self.root);
        });
    }

    fn closest<const FAST: bool>(&self, kind: RayKind, rays: &[Ray8], hits: &mut [Hit8]) {
        let mut walks = self.walks();
        for (ray, hit) in rays.iter().zip(hits) {
            let mut found = [MISS; F32x8::LANES];
            self.start(&mut walks, ray);
            match kind {
                RayKind::Coherent => for_each_lane(ray.mask, |lane| while self.step::<FAST>(&mut walks[lane]) {}),
                RayKind::Incoherent => take_turns(ray.mask, |lane| !self.step::<FAST>(&mut walks[lane])),
            }
            for_each_lane(ray.mask, |lane| {
                let walk = &walks[lane];
                if walk.best_index != NO_HIT {
                    let TriangleId { prim, mesh, instance } = self.order.id(walk.best_index);
                    found[lane] = Hit { prim, mesh, instance, ..walk.best };
                }
            });
            *hit = side_by_side(&found);
        }
    }

    /// Visits the next subtree of a ray that looks for its nearest hit; false if that was the last one.
    #[inline(always)]
    fn step<const FAST: bool>(&self, walk: &mut Walk) -> bool {
        let slack = walk.beam.slack();
        while let Some((t_near, child)) = walk.stack.pop() {
            // Not ≥: a tie may lie behind this box and have the smaller index.
            if t_near > walk.t_best + slack {
                continue;
            }
            match self.open(child) {
                tree::Opened::Node(node) => {
                    let which = entered(node, &walk.beam, walk.up, walk.t_min - slack, walk.t_best + slack);
                    push_nearest(node, which, &mut walk.stack);
                }
                tree::Opened::Leaf(leaf) => {
                    let c = test::<FAST>(&walk.beam, &leaf.corners, walk.t_min, walk.t_best);
                    for_each_lane(c.mask, |lane| {
                        let (t, index) = (c.t.lane(lane), leaf.index[lane]);
                        if t < walk.best.t || (t == walk.best.t && index < walk.best_index) {
                            walk.best = scalar_hit(&c, lane, NOTHING);
                            walk.best_index = index;
                            walk.t_best = t;
                        }
                    });
                }
            }
            return !walk.stack.is_empty();
        }
        false
    }

    fn occluded<const FAST: bool>(&self, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
        let mut walks = self.walks();
        for ((packet, ray), blocked) in rays.iter().enumerate().zip(blocked) {
            self.start(&mut walks, ray);
            let mut shut = 0;
            take_turns(ray.mask, |lane| {
                let filter = filter.map(|f| (f, packet * F32x8::LANES + lane));
                let hit = self.step_to_any::<FAST>(&mut walks[lane], filter);
                shut |= u32::from(hit) << lane;
                hit || walks[lane].stack.is_empty()
            });
            *blocked = Mask8::from_bits(shut);
        }
    }

    /// Visits the next subtree of a ray that looks for any hit: whether it found one.
    #[inline(always)]
    fn step_to_any<const FAST: bool>(&self, walk: &mut Walk, filter: Option<(&dyn Opacity, usize)>) -> bool {
        let (slack, t_max) = (walk.beam.slack(), walk.t_best);
        let Some((_, child)) = walk.stack.pop() else { return false };
        match self.open(child) {
            tree::Opened::Node(node) => {
                let (bits, _) = entered(node, &walk.beam, walk.up, walk.t_min - slack, t_max + slack);
                push_largest(node, bits, &mut walk.stack);
            }
            tree::Opened::Leaf(leaf) => {
                let c = test::<FAST>(&walk.beam, &leaf.corners, walk.t_min, t_max);
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
        false
    }
}

/// Which children's boxes the ray enters, as bits, and where.
#[inline(always)]
fn entered(node: &Node, beam: &Beam, up: [bool; 3], t_min: f32, t_max: f32) -> (u32, F32x8) {
    // Indices, not branches: rays that take turns point to different sides.
    let [x, y, z] = up.map(usize::from);
    let (planes, flip) = (&node.planes, 1);
    let near = Vec3::new(planes[flip - x].x, planes[flip - y].y, planes[flip - z].z);
    let [near, far] = beam.slab(near, Vec3::new(planes[x].x, planes[y].y, planes[z].z));
    let entered = near.le(far) & near.le(F32x8::splat(t_max)) & far.ge(F32x8::splat(t_min));
    (entered.to_bits(), near)
}

/// Pushes the children whose boxes the ray enters, the nearest last.
#[inline(always)]
fn push_nearest(node: &Node, (mut bits, near): (u32, F32x8), stack: &mut Vec<Entry>) {
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

/// Pushes the children whose boxes the ray enters, the largest last, which is where anything is most likely to be met.
#[inline(always)]
fn push_largest(node: &Node, mut bits: u32, stack: &mut Vec<Entry>) {
    while bits != 0 {
        let slot = 31 - bits.leading_zeros() as usize;
        bits &= !(1 << slot);
        stack.push((0.0, node.children[slot & 7]));
    }
}
