//! Whether a tree is one: everything that a traversal takes for granted.

use super::boxes::Box3;
use super::stack::spread;
use super::tree::{Child, Tree, WIDTH};
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

impl Tree {
    /// Looks at every cell: O(n).
    pub(super) fn check(&self) -> Result<(), TreeError> {
        let mut cells = vec![0_usize; self.cell_count()];
        let mut triangles = vec![0_usize; self.order.count()];
        // (child, what waits when it is visited, who it is)
        let mut work = vec![(self.root, 1, None)];
        while let Some((child, waits, parent)) = work.pop() {
            let place = child.place();
            let beyond = |(cell, slot, _): (usize, usize, Box3)| TreeError::Box { cell, slot };
            let Some(times) = cells.get_mut(place) else {
                return Err(parent.map_or(TreeError::NotOnce { cell: place, times: 0 }, beyond));
            };
            *times += 1;
            if *times > 1 {
                return Err(TreeError::NotOnce { cell: place, times: *times });
            }
            let cell = self.cell(child);
            let bounds = if child.is_leaf() {
                let used = (0..WIDTH).filter(|lane| cell.used() >> lane & 1 != 0);
                used.clone().for_each(|lane| triangles[cell.index(lane) as usize] += 1);
                let corner = |lane: usize, c: usize| {
                    let v = cell.corners()[c];
                    Vec3::new(v.x.lane(lane), v.y.lane(lane), v.z.lane(lane))
                };
                Box3::of_points(used.flat_map(|lane| (0..3).map(move |c| corner(lane, c))))
            } else {
                let slots: Vec<_> = cell.slots().collect();
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
        if let Some(cell) = cells.iter().position(|&times| times != 1) {
            return Err(TreeError::NotOnce { cell, times: cells[cell] });
        }
        match triangles.iter().position(|&times| times != 1) {
            Some(triangle) => Err(TreeError::Triangle { triangle, times: triangles[triangle] }),
            None => Ok(()),
        }
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
