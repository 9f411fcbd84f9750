//! The tree backend: built by the `obvhs` crate, walked by our own eight-wide traversal.
//!
//! `obvhs` builds a binary tree (PLOC with reinsertion); `obvhs/tree.rs` collapses it into nodes of eight children whose
//! boxes lie side by side, over blocks of eight triangles side by side. One ray is tested against eight boxes or eight
//! triangles at a time. The traversal of `obvhs` itself is not used: it is several times slower and its triangle test leaks.

mod tree;

use crate::Accel;
use crate::brute::scalar_hit;
use crate::geometry::Geometry;
use crate::ray::{Hit, Hit8, NO_HIT, Opacity, Ray8, RayKind};
use crate::triangle::{Beam, intersect};
use gonio_kernel::{F32x8, Mask8, Real, U32x8, Vec3};
use tree::{Child, Node, Tree};

/// A tree of eight-wide nodes over the triangles of a geometry.
#[derive(Clone, Debug)]
pub struct Obvhs {
    tree: Tree,
}

impl Obvhs {
    /// Builds the tree: deterministic, O(n log n).
    pub fn new(geometry: &Geometry) -> Self {
        Self { tree: Tree::build(geometry) }
    }
}

impl Accel for Obvhs {
    fn name(&self) -> &'static str {
        "obvhs"
    }

    fn closest(&self, _kind: RayKind, rays: &[Ray8], hits: &mut [Hit8]) {
        let mut stack = Vec::with_capacity(self.tree.stack_size());
        for (ray, hit) in rays.iter().zip(hits) {
            let beam = Beam::new(ray.origin, ray.dir, self.tree.lo, self.tree.hi);
            let found = each_live_lane(ray, |lane, t_min, t_max| {
                self.closest_of_one(&beam.splat_lane(lane), t_min, t_max, &mut stack)
            });
            *hit = gather(&found);
        }
    }

    fn occluded(&self, _kind: RayKind, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
        let mut stack = Vec::with_capacity(self.tree.stack_size());
        for ((packet, ray), blocked) in rays.iter().enumerate().zip(blocked) {
            let beam = Beam::new(ray.origin, ray.dir, self.tree.lo, self.tree.hi);
            let found = each_live_lane(ray, |lane, t_min, t_max| {
                let filter = filter.map(|f| (f, packet * F32x8::LANES + lane));
                self.one_is_occluded(&beam.splat_lane(lane), t_min, t_max, filter, &mut stack).then_some(())
            });
            let bits = found.iter().enumerate().fold(0, |bits, (lane, f)| bits | u32::from(f.is_some()) << lane);
            *blocked = Mask8::from_bits(bits);
        }
    }
}

/// Asks `f(lane, t_min, t_max)` for each live lane.
fn each_live_lane<T: Copy>(ray: &Ray8, mut f: impl FnMut(usize, f32, f32) -> Option<T>) -> [Option<T>; F32x8::LANES] {
    let (t_min, t_max, live) = (ray.t_min.to_array(), ray.t_max.to_array(), ray.mask.to_bits());
    std::array::from_fn(|lane| if live >> lane & 1 != 0 { f(lane, t_min[lane], t_max[lane]) } else { None })
}

/// Eight scalar hits side by side.
fn gather(hits: &[Option<Hit>; F32x8::LANES]) -> Hit8 {
    let real = |f: fn(&Hit) -> f32, miss: f32| F32x8::new(hits.map(|h| h.as_ref().map_or(miss, f)));
    let index = |f: fn(&Hit) -> u32| U32x8::new(hits.map(|h| h.as_ref().map_or(NO_HIT, f)));
    Hit8 {
        t: real(|h| h.t, f32::INFINITY),
        bary: [real(|h| h.bary[0], 0.0), real(|h| h.bary[1], 0.0)],
        prim: index(|h| h.prim),
        mesh: index(|h| h.mesh),
        instance: index(|h| h.instance),
    }
}

/// A subtree still to be visited, and where the ray enters its box.
type Entry = (f32, Child);

impl Obvhs {
    fn closest_of_one(&self, beam: &Beam, t_min: f32, t_max: f32, stack: &mut Vec<Entry>) -> Option<Hit> {
        let mut best: Option<(Hit, u32)> = None;
        let mut t_best = t_max;
        let up = beam.points_up();
        stack.clear();
        stack.push((t_min, self.tree.root));
        while let Some((t_near, child)) = stack.pop() {
            // Not ≥: a tie may lie behind this box and have the smaller index.
            if t_near > t_best {
                continue;
            }
            match self.tree.open(child) {
                tree::Opened::Node(node) => push_children(node, beam, up, t_min, t_best, stack),
                tree::Opened::Leaf(leaf) => {
                    let c = intersect(beam, &leaf.corners, F32x8::splat(t_min), F32x8::splat(t_best));
                    let mut bits = c.mask.to_bits();
                    while bits != 0 {
                        let lane = bits.trailing_zeros() as usize;
                        bits &= bits - 1;
                        let (t, index) = (c.t.to_array()[lane], leaf.index[lane]);
                        if best.as_ref().is_none_or(|(b, i)| t < b.t || (t == b.t && index < *i)) {
                            best = Some((scalar_hit(&c, lane, self.tree.ids[index as usize]), index));
                            t_best = t;
                        }
                    }
                }
            }
        }
        best.map(|(hit, _)| hit)
    }

    fn one_is_occluded(
        &self,
        beam: &Beam,
        t_min: f32,
        t_max: f32,
        filter: Option<(&dyn Opacity, usize)>,
        stack: &mut Vec<Entry>,
    ) -> bool {
        let up = beam.points_up();
        stack.clear();
        stack.push((t_min, self.tree.root));
        while let Some((_, child)) = stack.pop() {
            match self.tree.open(child) {
                tree::Opened::Node(node) => push_children(node, beam, up, t_min, t_max, stack),
                tree::Opened::Leaf(leaf) => {
                    let c = intersect(beam, &leaf.corners, F32x8::splat(t_min), F32x8::splat(t_max));
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
    let near = near.max(F32x8::splat(t_min));
    let far = far.min(F32x8::splat(t_max));
    let mut bits = near.le(far).to_bits();
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
