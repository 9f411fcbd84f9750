//! Which binary nodes become wide nodes, their children, and blocks of triangles: the cheapest choice there is.
//!
//! Let c(n, i) be the least cost of what lies below binary node n if it takes at most i places among the children of a wide node.
//! As one child it is a block, if its triangles fit into one, at area × [`BLOCK`], or a wide node at area × [`NODE`] + c(n, 8);
//! with i places its two children share them in the best way. Found from the leaves up (Ylitie, Karras & Laine 2017, "Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3). The area is what a random ray's chance to get
//! there is proportional to.

use super::boxes::Box3;
use super::cell::{Child, WIDTH};
use super::sah::Binary;
use super::tree::Tree;

/// What a visit of a node costs, and that of a block of triangles.
pub(super) const NODE: f32 = 1.0;
pub(super) const BLOCK: f32 = 1.1;

/// c(n, 1) to c(n, 7).
type Costs = [f32; WIDTH - 1];

pub(super) struct Collapse<'a> {
    binary: &'a [Binary],
    costs: Vec<Costs>,
    /// A subtree of at most so many triangles fits into a block.
    most: usize,
}

impl<'a> Collapse<'a> {
    pub(super) fn new(binary: &'a [Binary], most: usize) -> Self {
        let mut costs = vec![[0.0; WIDTH - 1]; binary.len()];
        // Children come after their parents.
        for n in (0..binary.len()).rev() {
            costs[n] = costs_of(binary, &costs, n, most);
        }
        Self { binary, costs, most }
    }

    /// Appends the wide nodes and returns them, their root first or alone; `leaf` makes a child of a binary node.
    pub(super) fn run(&self, tree: &mut Tree, mut leaf: impl FnMut(&mut Tree, usize) -> Child) -> Vec<Child> {
        if self.fits(0) {
            return vec![leaf(tree, 0)];
        }
        let mut nodes = vec![tree.new_node(1)];
        // (binary node, wide node that stands for it, its depth)
        let mut work = vec![(0, nodes[0], 1)];
        let (mut slots, mut children): (Vec<usize>, Vec<(Box3, Child)>) = Default::default();
        while let Some((node, wide, depth)) = work.pop() {
            slots.clear();
            children.clear();
            self.share(node, WIDTH, &mut slots);
            for &slot in &slots {
                let child = if self.is_block(slot) {
                    leaf(tree, slot)
                } else {
                    let node = tree.new_node(depth + 1);
                    work.push((slot, node, depth + 1));
                    nodes.push(node);
                    node
                };
                children.push((self.binary[slot].bounds(), child));
            }
            tree.set_node(wide, &children);
        }
        nodes
    }

    fn fits(&self, n: usize) -> bool {
        self.binary[n].count as usize <= self.most
    }

    /// Whether a child is a block rather than a node.
    fn is_block(&self, n: usize) -> bool {
        self.fits(n) && block(&self.binary[n]) <= self.costs[n][0]
    }

    /// The binary nodes that become children where node n takes `places`.
    fn share(&self, n: usize, places: usize, slots: &mut Vec<usize>) {
        let Some([a, b]) = self.binary[n].children() else { return slots.push(n) };
        let Some((_, of_a)) = best_share(&self.costs[a], &self.costs[b], places) else { return slots.push(n) };
        for (child, mut places) in [(a, of_a), (b, places - of_a)] {
            let costs = &self.costs[child];
            while places > 1 && costs[places - 2] <= costs[places - 1] {
                places -= 1;
            }
            if places == 1 {
                slots.push(child);
            } else {
                self.share(child, places, slots);
            }
        }
    }
}

fn block(node: &Binary) -> f32 {
    node.bounds().half_area() * BLOCK
}

/// The least cost if two children share so many places, and how many the first takes.
#[inline(always)]
fn best_share(a: &Costs, b: &Costs, places: usize) -> Option<(f32, usize)> {
    let mut best = None;
    for of_a in 1..places {
        let cost = a[of_a - 1] + b[places - of_a - 1];
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, of_a));
        }
    }
    best
}

fn costs_of(binary: &[Binary], costs: &[Costs], n: usize, most: usize) -> Costs {
    let node = &binary[n];
    let block = if node.count as usize <= most { block(node) } else { f32::INFINITY };
    let Some([a, b]) = node.children() else { return [block; WIDTH - 1] };
    let share = |places| best_share(&costs[a], &costs[b], places).map_or(f32::INFINITY, |(cost, _)| cost);
    let mut found = [block.min(node.bounds().half_area() * NODE + share(WIDTH)); WIDTH - 1];
    for places in 2..WIDTH {
        found[places - 1] = found[places - 2].min(share(places));
    }
    found
}
