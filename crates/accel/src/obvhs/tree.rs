//! The eight-wide tree: `obvhs`' binary tree, collapsed.
//!
//! A subtree of at most eight triangles becomes one leaf block, because eight triangles cost as much to test as one. An
//! inner node starts with the two children of its binary node and keeps opening the one of largest area that is too large
//! for a block; slots that remain open blocks whose halves are smaller than the whole. The surface area is what a random
//! ray's chance to enter a box is proportional to (Goldsmith & Salmon 1987).

use crate::brute::bounds;
use crate::geometry::{Geometry, TriangleId, WorldTriangle};
use gonio_kernel::{F32x8, Vec3};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;

/// How many children a node has, and how many triangles a block.
const WIDTH: usize = F32x8::LANES;

/// A subtree: an inner node, or a leaf block if the top bit is set.
#[derive(Clone, Copy, Debug)]
pub(super) struct Child(u32);

const LEAF: u32 = 1 << 31;

/// Eight children, their boxes side by side. An unused slot has an inverted infinite box, which no ray enters.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// Lower and upper planes.
    pub(super) planes: [Vec3<F32x8>; 2],
    pub(super) children: [Child; WIDTH],
}

/// Eight triangles side by side. Unused lanes repeat the first, which changes no result.
#[derive(Clone, Debug)]
pub(super) struct Leaf {
    pub(super) corners: [Vec3<F32x8>; 3],
    /// Place in [`Tree::ids`], in the order of (instance, prim).
    pub(super) index: [u32; WIDTH],
}

/// A child, looked at.
pub(super) enum Opened<'a> {
    Node(&'a Node),
    Leaf(&'a Leaf),
}

/// The whole tree.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    pub(super) root: Child,
    pub(super) ids: Vec<TriangleId>,
    pub(super) lo: Vec3<f32>,
    pub(super) hi: Vec3<f32>,
    depth: usize,
}

impl Tree {
    pub(super) fn build(geometry: &Geometry) -> Self {
        let triangles: Vec<WorldTriangle> = geometry.world_triangles().collect();
        let (lo, hi) = bounds(&triangles);
        let boxes: Vec<Aabb> = triangles.iter().map(|t| Aabb::from_points(&t.corners.map(point))).collect();
        let params = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
        let mut unused_timer = std::time::Duration::ZERO;
        let binary = build_bvh2(&boxes, params, &mut unused_timer);
        let ids = triangles.iter().map(|t| t.id).collect();
        let mut tree = Self { nodes: Vec::new(), leaves: Vec::new(), root: Child(0), ids, lo, hi, depth: 1 };
        if binary.nodes.is_empty() || triangles.is_empty() {
            tree.nodes.push(Node::empty());
        } else {
            let sizes = subtree_sizes(&binary);
            Collapse { binary: &binary, sizes: &sizes, triangles: &triangles }.run(&mut tree);
        }
        tree
    }

    /// How many entries a traversal can have waiting at once.
    pub(super) fn stack_size(&self) -> usize {
        (WIDTH - 1) * self.depth + 1
    }

    #[inline(always)]
    pub(super) fn open(&self, child: Child) -> Opened<'_> {
        if child.0 & LEAF != 0 {
            Opened::Leaf(&self.leaves[(child.0 & !LEAF) as usize])
        } else {
            Opened::Node(&self.nodes[child.0 as usize])
        }
    }
}

impl Node {
    fn empty() -> Self {
        let all = |x: f32| Vec3::new(F32x8::splat(x), F32x8::splat(x), F32x8::splat(x));
        Self { planes: [all(f32::INFINITY), all(f32::NEG_INFINITY)], children: [Child(0); WIDTH] }
    }
}

fn point(v: Vec3<f32>) -> glam::Vec3A {
    glam::Vec3A::new(v.x, v.y, v.z)
}

/// How many triangles lie below each binary node.
fn subtree_sizes(binary: &Bvh2) -> Vec<u32> {
    let mut sizes = vec![0; binary.nodes.len()];
    let mut order = Vec::with_capacity(binary.nodes.len());
    let mut stack = vec![0_usize];
    while let Some(n) = stack.pop() {
        order.push(n);
        if let Some([a, b]) = inner(binary, n) {
            stack.extend([a, b]);
        }
    }
    for &n in order.iter().rev() {
        sizes[n] = match inner(binary, n) {
            Some([a, b]) => sizes[a] + sizes[b],
            None => binary.nodes[n].prim_count,
        };
    }
    sizes
}

/// The children of an inner binary node.
fn inner(binary: &Bvh2, node: usize) -> Option<[usize; 2]> {
    let n = &binary.nodes[node];
    (n.prim_count == 0).then_some([n.first_index as usize, n.first_index as usize + 1])
}

struct Collapse<'a> {
    binary: &'a Bvh2,
    sizes: &'a [u32],
    triangles: &'a [WorldTriangle],
}

impl Collapse<'_> {
    fn run(&self, tree: &mut Tree) {
        // (binary node, wide node that stands for it, its depth)
        tree.nodes.push(Node::empty());
        let mut work = vec![(0_usize, 0_usize, 1_usize)];
        while let Some((binary, wide, depth)) = work.pop() {
            tree.depth = tree.depth.max(depth);
            let mut planes = [[f32::INFINITY; WIDTH]; 3].map(|lo| [lo, [f32::NEG_INFINITY; WIDTH]]);
            let mut children = [Child(0); WIDTH];
            for (slot, n) in self.children_of(binary).into_iter().enumerate() {
                let b = &self.binary.nodes[n].aabb;
                for (axis, planes) in planes.iter_mut().enumerate() {
                    planes[0][slot] = b.min[axis];
                    planes[1][slot] = b.max[axis];
                }
                children[slot] = if self.sizes[n] as usize <= WIDTH {
                    tree.leaves.push(self.leaf(n));
                    Child((tree.leaves.len() - 1) as u32 | LEAF)
                } else {
                    tree.nodes.push(Node::empty());
                    work.push((n, tree.nodes.len() - 1, depth + 1));
                    Child((tree.nodes.len() - 1) as u32)
                };
            }
            let side =
                |s: usize| Vec3::new(F32x8::new(planes[0][s]), F32x8::new(planes[1][s]), F32x8::new(planes[2][s]));
            tree.nodes[wide] = Node { planes: [side(0), side(1)], children };
        }
    }

    /// The binary nodes that become the children of the wide node for `node`.
    fn children_of(&self, node: usize) -> Vec<usize> {
        let area = |n: usize| self.binary.nodes[n].aabb.half_area();
        let mut children = inner(self.binary, node).map_or(vec![node], Vec::from);
        while children.len() < WIDTH {
            // How much opening a child is worth: one too large for a block must be opened some day, the largest first.
            let worth = |n: usize| {
                let [a, b] = inner(self.binary, n)?;
                let gain = area(n) - area(a) - area(b);
                let must = self.sizes[n] as usize > WIDTH;
                (must || gain > 0.0).then_some((must, if must { area(n) } else { gain }))
            };
            let best = children.iter().enumerate().filter_map(|(i, &n)| Some((worth(n)?, i)));
            let Some((_, i)) = best.max_by(|(a, _), (b, _)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))) else { break };
            let [a, b] = inner(self.binary, children[i]).expect("only inner nodes are worth opening");
            children[i] = a;
            children.push(b);
        }
        children
    }

    fn leaf(&self, node: usize) -> Leaf {
        let mut index = Vec::with_capacity(WIDTH);
        let mut stack = vec![node];
        while let Some(n) = stack.pop() {
            match inner(self.binary, n) {
                Some(children) => stack.extend(children),
                None => {
                    let b = &self.binary.nodes[n];
                    let range = b.first_index as usize..(b.first_index + b.prim_count) as usize;
                    index.extend(&self.binary.primitive_indices[range]);
                }
            }
        }
        index.sort_unstable();
        let index: [u32; WIDTH] = std::array::from_fn(|i| index.get(i).copied().unwrap_or(index[0]));
        let axis = |corner: usize, f: fn(Vec3<f32>) -> f32| {
            F32x8::new(index.map(|i| f(self.triangles[i as usize].corners[corner])))
        };
        let corners = [0, 1, 2].map(|c| Vec3::new(axis(c, |v| v.x), axis(c, |v| v.y), axis(c, |v| v.z)));
        Leaf { corners, index }
    }
}
