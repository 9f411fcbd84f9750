//! How a tree grows: in parts, each collapsed before the next is built, so that the memory it takes to build does not grow with the
//! scene, and a small tree over the parts.

use super::boxes::{Box3, Ref};
use super::cell::{Child, WIDTH};
use super::collapse::Collapse;
use super::odds::Odds;
use super::options::{ObvhsOptions, ObvhsPreset, Sharing};
use super::placed::{Placed, Way};
use super::shared::{Shared, local_triangle};
use super::tree::Tree;
use super::{bridge, order, sah};
use crate::geometry::{Geometry, Instance};
use gonio_kernel::Vec3;
use std::ops::Range;

/// Most triangles of a part.
const PART: usize = 1 << 20;

impl Tree {
    /// The tree over all triangles; `progress` is told how many are done.
    pub(super) fn build(geometry: &Geometry, options: &ObvhsOptions, progress: &mut dyn FnMut(usize)) -> Self {
        Self::in_parts(geometry, options, PART, progress)
    }

    /// The tree in parts of at most so many triangles.
    fn in_parts(geometry: &Geometry, options: &ObvhsOptions, most: usize, progress: &mut dyn FnMut(usize)) -> Self {
        let mut tree = Self::empty(geometry.order().clone());
        let mut ways = ways(options.sharing, geometry);
        let mut growth = Growth { tree: &mut tree, preset: options.preset, most, odds: Vec::new(), done: 0, progress };

        let laid_out = (0..ways.len()).filter(|&instance| ways[instance].is_none());
        let laid_out: Vec<_> = laid_out.map(|instance| geometry.order().places(instance)).collect();
        let mut roots = growth.parts(&laid_out, |place| geometry.world_triangle(place).corners);
        let mut below = std::mem::replace(&mut growth.tree.depth, 0);
        let mut sharing: Vec<Vec<usize>> = vec![Vec::new(); geometry.meshes().len()];
        for (number, instance) in geometry.instances().iter().enumerate().filter(|&(number, _)| ways[number].is_some())
        {
            sharing[instance.mesh as usize].push(number);
        }
        for (mesh, places) in geometry.meshes().iter().zip(sharing).filter(|(_, places)| !places.is_empty()) {
            let all = 0..mesh.triangles.len() as u32;
            let parts = growth.parts(&[all], |prim| local_triangle(mesh, prim));
            let root = growth.join(&parts);
            below = below.max(std::mem::replace(&mut growth.tree.depth, 0));
            let shared = Shared::new(growth.tree, &growth.odds, mesh, (bounds_of(&parts), root));
            growth.tree.shared.push(root);
            for instance in places {
                let Some(way) = ways[instance].take() else { continue };
                let first = geometry.order().places(instance).start;
                let placed = Placed::new(&geometry.instances()[instance], way, &shared, first);
                for entrance in placed.entrances(growth.tree.placed.len(), &shared) {
                    roots.push((entrance.bounds, Child::entrance(growth.tree.entrances.len())));
                    growth.tree.entrances.push(entrance);
                }
                growth.tree.placed.push(placed);
            }
        }
        growth.tree.root = growth.join(&roots);
        (growth.progress)(geometry.triangle_count());
        if !roots.is_empty() {
            let bounds = bounds_of(&roots);
            [tree.lo, tree.hi] = [bounds.lo, bounds.hi].map(|v| Vec3::new(v.x, v.y, v.z));
        }
        tree.depth += below;
        tree.cells.settle();
        tree
    }
}

/// For each instance that shares a tree, the way to its mesh.
fn ways(sharing: Sharing, geometry: &Geometry) -> Vec<Option<Way>> {
    let mut uses = vec![0; geometry.meshes().len()];
    geometry.instances().iter().for_each(|instance| uses[instance.mesh as usize] += 1);
    let way = |instance: &Instance| {
        let mesh = instance.mesh as usize;
        let shares = sharing.shares(geometry.triangle_count(), uses[mesh]);
        (shares && !geometry.meshes()[mesh].triangles.is_empty()).then(|| Way::to(instance)).flatten()
    };
    geometry.instances().iter().map(way).collect()
}

/// A tree while it grows.
struct Growth<'a> {
    tree: &'a mut Tree,
    preset: ObvhsPreset,
    /// Most triangles of a part.
    most: usize,
    odds: Vec<Odds>,
    /// How many triangles are done.
    done: usize,
    progress: &'a mut dyn FnMut(usize),
}

impl Growth<'_> {
    /// Trees over parts of some triangles.
    fn parts(&mut self, triangles: &[Range<u32>], corners: impl Fn(u32) -> [Vec3<f32>; 3]) -> Vec<(Box3, Child)> {
        let mut refs = Vec::with_capacity(triangles.iter().map(|range| range.len()).sum());
        let of = |triangle: u32| Ref::new(Box3::of_points(corners(triangle)), triangle);
        refs.extend(triangles.iter().cloned().flatten().map(of));
        let (mut roots, mut start) = (Vec::new(), 0);
        for end in sah::split(&mut refs, self.most) {
            let part = &mut refs[start..end];
            let binary = match self.preset {
                ObvhsPreset::Fast => bridge::ploc(part),
                ObvhsPreset::Medium => sah::build(part),
                ObvhsPreset::High => bridge::reinserted(sah::build(part)),
            };
            if let Some(root) = binary.first() {
                let leaf = |tree: &mut Tree, node: usize| tree.block(&triangles_below(&binary, node), &corners);
                roots.push((root.bounds(), self.settle(&binary, WIDTH, leaf)));
            }
            self.done += end - start;
            (self.progress)(self.done);
            start = end;
        }
        roots
    }

    /// One tree over some.
    fn join(&mut self, roots: &[(Box3, Child)]) -> Child {
        if let [(_, root)] = roots {
            return *root;
        }
        let below = std::mem::replace(&mut self.tree.depth, 0);
        let mut refs: Vec<Ref> = roots.iter().enumerate().map(|(i, root)| Ref::new(root.0, i as u32)).collect();
        let top = sah::build(&mut refs);
        let root = if top.is_empty() {
            let node = self.tree.new_node(1);
            self.tree.settle_node(node, &[]);
            node
        } else {
            self.settle(&top, 1, |_, node| roots[top[node].first as usize].1)
        };
        self.tree.depth += below;
        root
    }

    /// The wide tree of a binary one.
    fn settle(&mut self, binary: &[sah::Binary], most: usize, leaf: impl FnMut(&mut Tree, usize) -> Child) -> Child {
        let nodes = Collapse::new(binary, most).run(self.tree, leaf);
        order::settle(self.tree, &nodes, &mut self.odds);
        nodes[0]
    }
}

/// The box of all.
fn bounds_of(roots: &[(Box3, Child)]) -> Box3 {
    roots.iter().fold(Box3::EMPTY, |all, root| all.union(root.0))
}

/// The triangles below a binary node, in order.
fn triangles_below(binary: &[sah::Binary], node: usize) -> Vec<u32> {
    let mut found = Vec::with_capacity(WIDTH);
    let mut stack = vec![node];
    while let Some(n) = stack.pop() {
        match binary[n].children() {
            Some(children) => stack.extend(children),
            None => found.push(binary[n].first),
        }
    }
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests;
