//! The eight-wide tree.
//!
//! A leaf is a block of up to eight triangles side by side, because eight triangles cost as much to test as one; a node has
//! up to eight children, their boxes side by side. Which subtrees of the binary tree ([`super::sah`]) become nodes, children and
//! blocks is decided by [`super::collapse`]; [`super::growth`] puts large trees together of parts.

use super::boxes::Box3;
use super::cell::{Cell, Child, LEAF, WIDTH, node_of, orders_of};
use super::pages::{Pages, Rows};
use super::placed::{Entrance, Placed};
use crate::geometry::Order;
use gonio_kernel::{U32x8, Vec3};
use wide::f32x8;

/// The whole tree.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    pub(super) cells: Pages,
    pub(super) root: Child,
    pub(super) order: Order,
    /// The trees of meshes that instances share,
    pub(super) shared: Vec<Child>,
    /// those instances,
    pub(super) placed: Vec<Placed>,
    /// and where rays enter them.
    pub(super) entrances: Vec<Entrance>,
    pub(super) lo: Vec3<f32>,
    pub(super) hi: Vec3<f32>,
    pub(super) depth: usize,
}

impl Tree {
    /// A tree without cells, over triangles in that order.
    pub(super) fn empty(order: Order) -> Self {
        let none = Vec3::splat(0.0);
        Self {
            cells: Pages::default(),
            root: Child(0),
            order,
            shared: Vec::new(),
            placed: Vec::new(),
            entrances: Vec::new(),
            lo: none,
            hi: none,
            depth: 0,
        }
    }

    /// How many entries a traversal can have waiting at once, the end and an exit among them, and room for eight more.
    pub(super) fn stack_size(&self) -> usize {
        (WIDTH - 1) * self.depth + 3 + WIDTH
    }

    pub(super) fn cell(&self, child: Child) -> Cell<'_> {
        self.view().cell(child)
    }

    /// The tree as traversals see it.
    pub(super) fn view(&self) -> View<'_> {
        View { tree: self, rows: self.cells.rows() }
    }

    /// Bytes that the tree occupies.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.cells.rows()) + size_of_val(self.placed.as_slice()) + size_of_val(self.entrances.as_slice())
    }

    /// How many nodes and blocks there are.
    pub(super) fn cell_count(&self) -> usize {
        self.cells.rows().len()
    }

    /// The blocks below a node or block; not behind entrances.
    pub(super) fn blocks_below(&self, root: Child) -> Vec<Cell<'_>> {
        let (mut blocks, mut work) = (Vec::new(), vec![root]);
        while let Some(child) = work.pop() {
            if child.is_leaf() {
                blocks.push(self.cell(child));
            } else {
                work.extend(self.cell(child).slots().map(|slot| slot.1).filter(|child| !child.is_special()));
            }
        }
        blocks
    }

    /// Appends a node, to be filled in, and takes note of how deep it lies.
    pub(super) fn new_node(&mut self, depth: usize) -> Child {
        self.depth = self.depth.max(depth);
        self.cells.push(node_of(&[]));
        Child((self.cells.rows().len() - 1) as u32)
    }

    /// Fills in a node.
    pub(super) fn set_node(&mut self, node: Child, children: &[(Box3, Child)]) {
        self.cells.set(node.place(), node_of(children));
    }

    /// Fills in a node whose children are in the slots where they stay.
    pub(super) fn settle_node(&mut self, node: Child, children: &[(Box3, Child)]) {
        let mut rows = node_of(children);
        rows[7] = orders_of(children).to_wide();
        self.cells.set(node.place(), rows);
    }

    /// Appends a block of triangles.
    pub(super) fn block(&mut self, triangles: &[u32], corners: impl Fn(u32) -> [Vec3<f32>; 3]) -> Child {
        let (mut rows, mut index) = ([[0.0; WIDTH]; 9], [triangles[0]; WIDTH]);
        for (lane, &triangle) in triangles.iter().enumerate() {
            let [a, b, c] = corners(triangle);
            for (row, x) in rows.iter_mut().zip([a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z]) {
                row[lane] = x;
            }
            index[lane] = triangle;
        }
        for row in &mut rows {
            let first = row[0];
            row[triangles.len()..].fill(first);
        }
        let [ax, ay, az, bx, by, bz, cx, cy, cz] = rows.map(f32x8::new);
        self.cells.push([ax, ay, az, bx, by, bz, cx, cy, cz, U32x8::new(index).as_real().to_wide()]);
        Child((self.cells.rows().len() - 1) as u32 | LEAF)
    }
}

/// A tree while rays are cast.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub(super) tree: &'a Tree,
    rows: &'a [Rows],
}

impl<'a> View<'a> {
    #[inline(always)]
    pub(super) fn cell(self, child: Child) -> Cell<'a> {
        Cell::of(&self.rows[child.place()])
    }
}
