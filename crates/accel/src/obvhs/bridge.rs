//! What the `obvhs` crate does for us: binary trees from the bottom up, and better ones out of given ones.
//!
//! PLOC joins the nearest neighbours along a space-filling curve (Meister & Bittner 2018, "Parallel Locally-Ordered Clustering
//! for Bounding Volume Hierarchy Construction"): the fastest to build. Reinsertion takes subtrees out and puts them
//! where they cost least (Meister & Bittner 2018, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization").

use super::boxes::{Box3, Ref};
use super::sah::Binary;
use glam::{Vec3A, Vec4};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::bvh2::{Bvh2, node::Bvh2Node};

/// How much of a tree is looked at to be put in another place, in the first of sixteen rounds.
const SHARE: f32 = 0.2;

/// A tree over some triangles, its root first. Empty for none.
pub(super) fn ploc(refs: &[Ref]) -> Vec<Binary> {
    if refs.is_empty() {
        return Vec::new();
    }
    let boxes: Vec<Aabb> = refs.iter().map(|r| aabb(r.bounds())).collect();
    let mut unused_timer = std::time::Duration::ZERO;
    let tree = build_bvh2(&boxes, BvhBuildParams::fastest_build(), &mut unused_timer);
    binary(&tree, |place| refs[tree.primitive_indices[place as usize] as usize].index())
}

/// A tree over the same triangles that costs less.
pub(super) fn reinserted(nodes: Vec<Binary>) -> Vec<Binary> {
    let node = |n: &Binary| match n.children() {
        Some([first, _]) => Bvh2Node::new(aabb(n.bounds()), 0, first as u32),
        None => Bvh2Node::new(aabb(n.bounds()), 1, n.first),
    };
    let mut tree = Bvh2 {
        primitive_indices: Vec::new(),
        nodes: nodes.iter().map(node).collect(),
        children_are_ordered_after_parents: true,
        ..Bvh2::default()
    };
    drop(nodes);
    ReinsertionOptimizer::default().run(&mut tree, SHARE, None);
    binary(&tree, |triangle| triangle)
}

fn aabb(bounds: Box3) -> Aabb {
    Aabb::new(Vec3A::from_vec4(bounds.lo), Vec3A::from_vec4(bounds.hi))
}

/// The same tree with children after their parents; `triangle` is told what leaves know.
fn binary(tree: &Bvh2, triangle: impl Fn(u32) -> u32) -> Vec<Binary> {
    let bounds = |n: &Bvh2Node| {
        let [lo, hi] = [n.aabb.min, n.aabb.max].map(|v| Vec4::new(v.x, v.y, v.z, 1.0));
        Box3 { lo, hi }
    };
    let mut nodes = vec![Binary::new(bounds(&tree.nodes[0]), 0, 0)];
    let mut work = vec![(0_usize, 0_usize)];
    while let Some((from, to)) = work.pop() {
        let n = &tree.nodes[from];
        if n.prim_count > 0 {
            nodes[to] = Binary::new(bounds(n), triangle(n.first_index), 1);
            continue;
        }
        let pair = nodes.len();
        nodes[to] = Binary::new(bounds(n), pair as u32, 0);
        for child in [0, 1] {
            let from = n.first_index as usize + child;
            nodes.push(Binary::new(bounds(&tree.nodes[from]), 0, 0));
            work.push((from, pair + child));
        }
    }
    for n in (0..nodes.len()).rev() {
        if nodes[n].count == 0 {
            let pair = nodes[n].first as usize;
            nodes[n].count = nodes[pair].count + nodes[pair + 1].count;
        }
    }
    nodes
}
