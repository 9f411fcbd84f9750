//! Whether a tree is one: everything that a traversal takes for granted.

use super::boxes::Box3;
use super::cell::{Cell, Child, WIDTH};
use super::stack::spread;
use super::tree::Tree;
use gonio_kernel::Vec3;
use thiserror::Error;

/// What is wrong with a tree.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum TreeError {
    /// A cell is nobody's child, or has two parents.
    #[error("cell {cell} is reached {times} times")]
    NotOnce {
        /// The cell.
        cell: usize,
        /// How often it is reached.
        times: usize,
    },
    /// A triangle is in no block, or in two.
    #[error("triangle {triangle} is in {times} blocks")]
    Triangle {
        /// Its place in the order of (instance, prim).
        triangle: usize,
        /// In how many blocks it is.
        times: usize,
    },
    /// A child reaches beyond the box that its parent has for it, or is none of the tree.
    #[error("slot {slot} of cell {cell}: the child reaches beyond its box")]
    Box {
        /// The parent.
        cell: usize,
        /// Its slot.
        slot: usize,
    },
    /// An entrance to the tree of an instance is not there once, or what is behind it reaches beyond its box.
    #[error("entrance {entrance} is not there once, or what is behind it reaches beyond its box")]
    Entrance {
        /// The number of the entrance.
        entrance: usize,
    },
    /// An order of children leaves one out.
    #[error("cell {cell}: the order of octant {octant} is none")]
    Order {
        /// The node.
        cell: usize,
        /// The octant of directions.
        octant: usize,
    },
    /// It is deeper than the room that traversals have.
    #[error("a stack of {needed} is needed, but there is room for {room}")]
    Stack {
        /// What a traversal may have waiting.
        needed: usize,
        /// What it has room for.
        room: usize,
    },
}

/// What has been seen of a tree so far.
struct Seen {
    /// How often each cell was reached,
    cells: Vec<usize>,
    /// and each entrance.
    entrances: Vec<usize>,
    /// The most that waits when an entrance is visited.
    waits: usize,
}

impl Tree {
    /// Looks at every cell, and at every triangle of every instance: O(n).
    pub(super) fn check(&self) -> Result<(), TreeError> {
        let mut seen = Seen { cells: vec![0; self.cell_count()], entrances: vec![0; self.entrances.len()], waits: 2 };
        let mut triangles = vec![0_usize; self.order.count()];
        self.check_below(self.root, 2, &mut seen, &mut |block| {
            block.lanes_used().for_each(|lane| triangles[block.index(lane) as usize] += 1);
        })?;
        let waits = seen.waits + 1; // the exit
        for &root in &self.shared {
            self.check_below(root, waits, &mut seen, &mut |_| ())?;
        }
        for (number, entrance) in self.entrances.iter().enumerate() {
            for block in self.blocks_below(entrance.subtree) {
                let rows = self.placed[entrance.placed as usize].in_world(block);
                let block = Cell::of(&rows);
                block.lanes_used().for_each(|lane| triangles[block.index(lane) as usize] += 1);
                if !entrance.bounds.contains(block.bounds()) {
                    return Err(TreeError::Entrance { entrance: number });
                }
            }
        }
        if let Some(entrance) = seen.entrances.iter().position(|&times| times != 1) {
            return Err(TreeError::Entrance { entrance });
        }
        if let Some(cell) = seen.cells.iter().position(|&times| times != 1) {
            return Err(TreeError::NotOnce { cell, times: seen.cells[cell] });
        }
        match triangles.iter().position(|&times| times != 1) {
            Some(triangle) => Err(TreeError::Triangle { triangle, times: triangles[triangle] }),
            None => Ok(()),
        }
    }

    /// Looks at every cell below one, when so many wait already.
    fn check_below<'a>(
        &'a self,
        root: Child,
        waits: usize,
        seen: &mut Seen,
        visit: &mut dyn FnMut(Cell<'a>),
    ) -> Result<(), TreeError> {
        // (child, what waits when it is visited, who it is)
        let mut work = vec![(root, waits, None)];
        while let Some((child, waits, parent)) = work.pop() {
            let place = child.place();
            let beyond = |(cell, slot, _): (usize, usize, Box3)| TreeError::Box { cell, slot };
            let times = match child.is_special() {
                true => seen.entrances.get_mut(child.number()),
                false => seen.cells.get_mut(place),
            };
            let Some(times) = times else {
                return Err(parent.map_or(TreeError::NotOnce { cell: place, times: 0 }, beyond));
            };
            *times += 1;
            if *times > 1 {
                return Err(TreeError::NotOnce { cell: place, times: *times });
            }
            let bounds = if child.is_special() {
                seen.waits = seen.waits.max(waits);
                self.entrances[child.number()].bounds
            } else if child.is_leaf() {
                visit(self.view().cell(child));
                self.cell(child).bounds()
            } else {
                let slots: Vec<_> = self.cell(child).slots().collect();
                if waits - 1 + slots.len() + WIDTH > self.stack_size() {
                    let needed = waits - 1 + slots.len() + WIDTH;
                    return Err(TreeError::Stack { needed, room: self.stack_size() });
                }
                self.check_orders(child)?;
                work.extend(
                    slots
                        .iter()
                        .enumerate()
                        .map(|(slot, &(bounds, child))| (child, waits - 1 + slots.len(), Some((place, slot, bounds)))),
                );
                slots.iter().fold(Box3::EMPTY, |all, slot| all.union(slot.0))
            };
            if let Some(parent) = parent.filter(|parent| !parent.2.contains(bounds)) {
                return Err(beyond(parent));
            }
        }
        Ok(())
    }

    fn check_orders(&self, node: Child) -> Result<(), TreeError> {
        for octant in 0..8 {
            let order = spread(self.cell(node).order(octant)).to_array();
            let slots = order.into_iter().fold(0, |all, slot| all | 1 << (slot & 7));
            if slots != 0xff {
                return Err(TreeError::Order { cell: node.place(), octant });
            }
        }
        Ok(())
    }
}

impl Cell<'_> {
    /// The box of a block's triangles.
    fn bounds(&self) -> Box3 {
        let corner = |lane: usize, c: usize| {
            let v = self.corners()[c];
            Vec3::new(v.x.lane(lane), v.y.lane(lane), v.z.lane(lane))
        };
        Box3::of_points(self.lanes_used().flat_map(|lane| (0..3).map(move |c| corner(lane, c))))
    }
}
