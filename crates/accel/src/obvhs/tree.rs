//! The eight-wide tree: `obvhs`' binary tree, collapsed.
//!
//! A subtree of at most eight triangles becomes one leaf block, because eight triangles cost as much to test as one. An
//! inner node starts with the two children of its binary node and keeps opening the one of largest area that is too large
//! for a block; slots that remain open blocks whose halves are smaller than the whole. The surface area is what a random
//! ray's chance to enter a box is proportional to (Goldsmith & Salmon 1987). Beyond a million triangles the tree is made of
//! parts ([`parts`]), each collapsed before the next is built, and a small tree over the parts.

use super::parts;
use crate::geometry::{Geometry, Order};
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

/// Eight children, their boxes side by side, the largest first. An unused slot has an inverted infinite box, which no ray enters.
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
    /// Place in the order of (instance, prim).
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
    pub(super) order: Order,
    pub(super) lo: Vec3<f32>,
    pub(super) hi: Vec3<f32>,
    depth: usize,
}

impl Tree {
    /// The tree over all triangles; `progress` is told how many are done.
    pub(super) fn build(geometry: &Geometry, progress: &mut dyn FnMut(usize)) -> Self {
        Self::in_parts(geometry, parts::MOST, progress)
    }

    /// The tree in parts of at most so many triangles.
    pub(super) fn in_parts(geometry: &Geometry, most: usize, progress: &mut dyn FnMut(usize)) -> Self {
        let none = Vec3::splat(0.0);
        let order = geometry.order().clone();
        let mut tree =
            Self { nodes: Vec::new(), leaves: Vec::new(), root: Child(0), order, lo: none, hi: none, depth: 1 };
        let (triangles, ends) = parts::split(geometry, most);
        let mut roots: Vec<(Aabb, Child)> = Vec::new();
        let mut start = 0;
        for end in ends {
            let part = &triangles[start..end];
            let boxes: Vec<Aabb> = part.iter().map(|&triangle| bounds_of(geometry, triangle)).collect();
            if let Some((bounds, binary)) = binary(&boxes) {
                drop(boxes);
                let leaf = |tree: &mut Self, node| tree.block(geometry, &binary, part, node);
                roots.push((bounds, Collapse::new(&binary, WIDTH).run(&mut tree, leaf)));
            }
            start = end;
            progress(end);
        }
        let boxes: Vec<Aabb> = roots.iter().map(|root| root.0).collect();
        match (binary(&boxes), &roots[..]) {
            (None, _) => tree.nodes.push(Node::empty()),
            (Some((bounds, _)), [root]) => {
                (tree.root, tree.lo, tree.hi) = (root.1, vector(bounds.min), vector(bounds.max))
            }
            (Some((bounds, binary)), _) => {
                let below = std::mem::replace(&mut tree.depth, 1);
                let part = |_: &mut Self, node| roots[primitives(&binary, node)[0] as usize].1;
                tree.root = Collapse::new(&binary, 1).run(&mut tree, part);
                tree.depth += below;
                (tree.lo, tree.hi) = (vector(bounds.min), vector(bounds.max));
            }
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

/// The box of a triangle of the geometry.
pub(super) fn bounds_of(geometry: &Geometry, triangle: u32) -> Aabb {
    Aabb::from_points(&geometry.world_triangle(triangle).corners.map(|v| glam::Vec3A::new(v.x, v.y, v.z)))
}

fn vector(v: glam::Vec3A) -> Vec3<f32> {
    Vec3::new(v.x, v.y, v.z)
}

/// The bounds and the binary tree of boxes, if there are any.
fn binary(boxes: &[Aabb]) -> Option<(Aabb, Bvh2)> {
    let bounds = boxes.iter().copied().reduce(|a, b| a.union(&b))?;
    let params = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
    let mut unused_timer = std::time::Duration::ZERO;
    Some((bounds, build_bvh2(boxes, params, &mut unused_timer)))
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

/// The primitives of a leaf of the binary tree.
fn primitives(binary: &Bvh2, leaf: usize) -> &[u32] {
    let b = &binary.nodes[leaf];
    &binary.primitive_indices[b.first_index as usize..(b.first_index + b.prim_count) as usize]
}

struct Collapse<'a> {
    binary: &'a Bvh2,
    sizes: Vec<u32>,
    /// A subtree of at most so many primitives becomes a leaf.
    most: usize,
}

impl<'a> Collapse<'a> {
    fn new(binary: &'a Bvh2, most: usize) -> Self {
        Self { binary, sizes: subtree_sizes(binary), most }
    }

    /// Appends the wide nodes and returns their root; `leaf` makes a child of a binary node.
    fn run(&self, tree: &mut Tree, mut leaf: impl FnMut(&mut Tree, usize) -> Child) -> Child {
        let root = tree.nodes.len();
        tree.nodes.push(Node::empty());
        // (binary node, wide node that stands for it, its depth)
        let mut work = vec![(0_usize, root, 1_usize)];
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
                children[slot] = if self.sizes[n] as usize <= self.most {
                    leaf(tree, n)
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
        Child(root as u32)
    }

    /// The binary nodes that become the children of the wide node for `node`, the largest first.
    fn children_of(&self, node: usize) -> Vec<usize> {
        let area = |n: usize| self.binary.nodes[n].aabb.half_area();
        let mut children = inner(self.binary, node).map_or(vec![node], Vec::from);
        while children.len() < WIDTH {
            // How much opening a child is worth: one too large for a leaf must be opened some day, the largest first.
            let worth = |n: usize| {
                let [a, b] = inner(self.binary, n)?;
                let gain = area(n) - area(a) - area(b);
                let must = self.sizes[n] as usize > self.most;
                (must || gain > 0.0).then_some((must, if must { area(n) } else { gain }))
            };
            let best = children.iter().enumerate().filter_map(|(i, &n)| Some((worth(n)?, i)));
            let Some((_, i)) = best.max_by(|(a, _), (b, _)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))) else { break };
            let [a, b] = inner(self.binary, children[i]).expect("only inner nodes are worth opening");
            children[i] = a;
            children.push(b);
        }
        children.sort_by(|&a, &b| area(b).total_cmp(&area(a)));
        children
    }
}

impl Tree {
    /// Appends a block of the triangles below a binary node; its primitives are places in `part`.
    fn block(&mut self, geometry: &Geometry, binary: &Bvh2, part: &[u32], node: usize) -> Child {
        let mut index = Vec::with_capacity(WIDTH);
        let mut stack = vec![node];
        while let Some(n) = stack.pop() {
            match inner(binary, n) {
                Some(children) => stack.extend(children),
                None => index.extend(primitives(binary, n).iter().map(|&at| part[at as usize])),
            }
        }
        index.sort_unstable();
        let index: [u32; WIDTH] = std::array::from_fn(|i| index.get(i).copied().unwrap_or(index[0]));
        let corners = index.map(|i| geometry.world_triangle(i).corners);
        let corners = [0, 1, 2].map(|c| Vec3::from_lanes(|l| corners[l][c]));
        self.leaves.push(Leaf { corners, index });
        Child((self.leaves.len() - 1) as u32 | LEAF)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Accel, Brute, Hit8, Mesh, Obvhs, Ray8, RayKind};

    /// Waves of n × n squares, of which a strip is one point, so that no plane can part it.
    fn waves(n: u32) -> Geometry {
        let at = |x: u32, y: u32| y * (n + 1) + x;
        let height = |x: u32, y: u32| ((x * 37 + y * 61) % 17) as f32 * 0.1;
        let position = |x: u32, y: u32| if y < 4 { [0.0; 3] } else { [x as f32, height(x, y), y as f32] };
        let positions = (0..=n).flat_map(|y| (0..=n).map(move |x| position(x, y))).collect();
        let squares = (0..n).flat_map(|y| (0..n).map(move |x| (x, y)));
        let triangles = squares
            .flat_map(|(x, y)| [[at(x, y), at(x + 1, y), at(x + 1, y + 1)], [at(x, y), at(x + 1, y + 1), at(x, y + 1)]])
            .collect();
        Geometry::of_mesh(Mesh { positions, triangles }).unwrap()
    }

    #[test]
    fn a_tree_in_parts_finds_what_brute_finds() {
        let geometry = waves(24);
        let brute = Brute::new(&geometry);
        for most in [1, 7, 100, 1000, parts::MOST] {
            let mut told = Vec::new();
            let tree = Tree::in_parts(&geometry, most, &mut |done| told.push(done));
            assert_eq!(told.last(), Some(&geometry.triangle_count()));
            assert!(told.len() >= geometry.triangle_count() / most);
            let tree = Obvhs::of_tree(tree);
            let mut met = 0;
            for i in 0..400 {
                let lane = |l: usize| (i * 8 + l) as f32;
                let origin = Vec3::from_lanes(|l| Vec3::new(lane(l) * 0.618 % 24.0, 5.0, lane(l) * 0.414 % 24.0));
                let dir = Vec3::from_lanes(|l| {
                    Vec3::new(lane(l) * 0.732 % 2.0 - 1.0, -0.3, lane(l) * 0.236 % 2.0 - 1.0).normalize()
                });
                let rays = [Ray8::new(origin, dir)];
                let (mut a, mut b) = ([Hit8::miss()], [Hit8::miss()]);
                brute.closest(RayKind::Incoherent, &rays, &mut a);
                tree.closest(RayKind::Incoherent, &rays, &mut b);
                assert_eq!(format!("{a:?}"), format!("{b:?}"));
                met += a[0].t.to_array().iter().filter(|t| t.is_finite()).count();
            }
            assert!(met > 1000, "{met} of 3200 rays meet something");
        }
    }
}
