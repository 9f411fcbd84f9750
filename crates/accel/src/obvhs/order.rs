//! In which order a ray that looks for any hit visits the children of a node.
//!
//! Of alternatives that each succeed with a chance p at a cost c, those of the largest p/c come first: then the expected cost is
//! least. For a block of triangles p is the chance that a random line through its box meets a triangle, area of the triangles
//! over half the surface of the box, and c one visit; for a node both follow from its children in their order, each of which is
//! entered with the ratio of the areas, as if independent (Ize & Hansen 2011, "RTSAH Traversal Order for Occlusion Rays").

use super::boxes::Box3;
use super::cell::{Cell, Child};
use super::collapse::{BLOCK, NODE};
use super::odds::Odds;
use super::tree::Tree;
use gonio_kernel::{F32x8, Real};

/// Puts the children of nodes in order, the best last. Children come after their parents in `nodes`, or have their odds.
pub(super) fn settle(tree: &mut Tree, nodes: &[Child], odds: &mut Vec<Odds>) {
    odds.resize(tree.cell_count(), Odds { hit: 0.0, cost: 0.0 });
    for &node in nodes.iter().rev().filter(|node| !node.is_leaf()) {
        let slots = tree.cell(node).slots().map(|(bounds, child)| (bounds, child, below(tree, odds, child, bounds)));
        let mut slots: Vec<(Box3, Child, Odds)> = slots.collect();
        let worth = |o: &Odds| o.hit / o.cost;
        slots.sort_by(|a, b| worth(&a.2).total_cmp(&worth(&b.2)));
        odds[node.0 as usize] = of_node(&slots);
        let children: Vec<(Box3, Child)> = slots.iter().map(|s| (s.0, s.1)).collect();
        tree.settle_node(node, &children);
    }
}

/// The odds of a child in its box; a node has its own already.
pub(super) fn below(tree: &Tree, odds: &[Odds], child: Child, bounds: Box3) -> Odds {
    if child.is_special() {
        tree.entrances[child.number()].odds
    } else if child.is_leaf() {
        of_block(tree.cell(child), bounds)
    } else {
        odds[child.place()]
    }
}

fn of_block(block: Cell<'_>, bounds: Box3) -> Odds {
    let [a, b, c] = block.corners();
    let normal = (b - a).cross(c - a);
    let areas = (normal.dot(normal).sqrt() * F32x8::splat(0.5)).to_array();
    // Unused lanes repeat the first triangle.
    let distinct = (0..F32x8::LANES).filter(|&i| i == 0 || block.index(i) != block.index(0));
    let area: f32 = distinct.map(|i| areas[i]).sum();
    Odds { hit: (area / bounds.half_area()).min(1.0), cost: BLOCK }
}

fn of_node(slots: &[(Box3, Child, Odds)]) -> Odds {
    let whole = slots.iter().fold(Box3::EMPTY, |all, s| all.union(s.0)).half_area();
    let (mut open, mut cost) = (1.0, NODE);
    for (bounds, _, below) in slots.iter().rev() {
        let entered = (bounds.half_area() / whole).min(1.0);
        cost += open * entered * below.cost;
        open *= 1.0 - entered * below.hit;
    }
    Odds { hit: 1.0 - open, cost }
}
