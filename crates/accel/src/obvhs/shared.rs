//! Meshes whose tree instances share, and the entrances that each instance gets to it ([`super::placed`]).

use super::boxes::Box3;
use super::cell::Child;
use super::odds::Odds;
use super::order;
use super::placed::{Entrance, Placed, U, Way};
use super::tree::Tree;
use crate::geometry::{Instance, Mesh};
use gonio_kernel::Vec3;

/// A mesh has an entrance for so many triangles,
const TRIANGLES_EACH: usize = 1024;

/// but no more than these.
const MOST_ENTRANCES: usize = 32;

/// A mesh that keeps a tree, cut into subtrees.
pub(super) struct Shared {
    subtrees: Vec<Subtree>,
    /// The largest absolute coordinate of a corner.
    largest: f64,
}

struct Subtree {
    root: Child,
    odds: Odds,
    /// Vertices of its triangles, each once.
    corners: Vec<[f32; 3]>,
    /// The longest edge of a triangle.
    longest: f64,
}

/// A triangle of a mesh, in its own coordinates.
pub(super) fn local_triangle(mesh: &Mesh, prim: u32) -> [Vec3<f32>; 3] {
    mesh.triangles[prim as usize].map(|v| mesh.positions[v as usize].into())
}

impl Shared {
    /// A mesh whose tree has that root, cut where boxes are largest.
    pub(super) fn new(tree: &Tree, odds: &[Odds], mesh: &Mesh, root: (Box3, Child)) -> Self {
        let wanted = (mesh.triangles.len() / TRIANGLES_EACH).clamp(1, MOST_ENTRANCES);
        let mut cut = vec![root];
        while cut.len() < wanted {
            let nodes = (0..cut.len()).filter(|&i| !cut[i].1.is_leaf());
            let largest = nodes.max_by(|&a, &b| cut[a].0.half_area().total_cmp(&cut[b].0.half_area()));
            let Some(largest) = largest else { break };
            let (_, node) = cut.swap_remove(largest);
            cut.extend(tree.cell(node).slots());
        }
        let subtree = |(bounds, root)| Subtree::new(tree, mesh, root, order::below(tree, odds, root, bounds));
        let subtrees: Vec<Subtree> = cut.into_iter().map(subtree).collect();
        let coordinates = subtrees.iter().flat_map(|subtree| subtree.corners.iter().flatten());
        Self { largest: coordinates.map(|&x| f64::from(x.abs())).fold(0.0, f64::max), subtrees }
    }
}

impl Subtree {
    fn new(tree: &Tree, mesh: &Mesh, root: Child, odds: Odds) -> Self {
        let (mut vertices, mut longest) = (Vec::new(), 0.0_f64);
        let length = |e: Vec3<f32>| <[f32; 3]>::from(e).iter().map(|&x| f64::from(x).powi(2)).sum::<f64>().sqrt();
        for block in tree.blocks_below(root) {
            for prim in block.lanes_used().map(|lane| block.index(lane)) {
                vertices.extend(mesh.triangles[prim as usize]);
                let [a, b, c] = local_triangle(mesh, prim);
                longest = [b - a, c - b, a - c].map(length).into_iter().fold(longest, f64::max);
            }
        }
        vertices.sort_unstable();
        vertices.dedup();
        let corners = vertices.into_iter().map(|v| mesh.positions[v as usize]).collect();
        Self { root, odds, corners, longest }
    }
}

impl Placed {
    /// An instance of the mesh, whose first triangle has that place.
    pub(super) fn new(instance: &Instance, way: Way, mesh: &Shared, first: u32) -> Self {
        let terms = |[a, b, c, t]: [f64; 4]| (a.abs() + b.abs() + c.abs()) * mesh.largest + t.abs();
        let rounding = 4.0 * U * instance.transform.map(terms).into_iter().fold(0.0, f64::max);
        let error = way.stretch.map(|stretch| stretch * rounding + mesh.largest * (U / 4.0));
        Self { instance: *instance, first, way, error }
    }

    /// The entrances of the instance, which has that number.
    pub(super) fn entrances(&self, number: usize, mesh: &Shared) -> impl Iterator<Item = Entrance> {
        let m = self.instance.transform;
        // A bound of the largest singular value; equal to it if the map turns and scales.
        let product = |a: usize, b: usize| (0..3).map(|row| m[row][a] * m[row][b]).sum::<f64>();
        let norm = [0, 1, 2].map(|a| (0..3).map(|b| product(a, b).abs()).sum::<f64>()).into_iter().fold(0.0, f64::max);
        let scale = (3.0 * norm).sqrt() * 1.001;
        mesh.subtrees.iter().map(move |subtree| Entrance {
            subtree: subtree.root,
            placed: number as u32,
            odds: subtree.odds,
            bounds: Box3::of_points(subtree.corners.iter().map(|&p| self.instance.to_world(p).into())),
            diagonal: (scale * subtree.longest) as f32,
        })
    }
}
