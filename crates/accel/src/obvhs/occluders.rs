//! The triangles that blocked the last rays: the next ones may be blocked by the same.
//!
//! Neighbours look for a way to the same light, or out of the same room, and a wall is two triangles. So rays that look for any
//! hit are first tested, eight at once, against the [`MOST`] triangles that were of use lately, which costs a ray less than one visit
//! of a node (compare Haines & Greenberg 1986, "The Light Buffer: A Shadow-Testing Accelerator"). One that blocks a ray again moves
//! ahead; a new one takes the last place. Where none is of use, ever fewer packets are tested. The answer is that of the tree,
//! because the test is.

use super::cell::Cell;
use super::flight::crossing;
use crate::ray::Ray8;
use crate::triangle::Beam;
use gonio_kernel::{F32x8, Mask, Mask8, Vec3};

/// How many are remembered.
const MOST: usize = 8;

/// Corners of triangles, each in all eight lanes.
#[derive(Default)]
pub(super) struct Occluders {
    corners: Vec<[Vec3<F32x8>; 3]>,
    /// Their places, the most useful first.
    order: [u8; MOST],
    /// How many packets go by before the next is tested; doubles with each that was tested in vain.
    pause: u32,
    passed: u32,
}

/// The longest pause.
const LONGEST: u32 = 16;

impl Occluders {
    /// The live rays that one of the triangles blocks.
    #[inline(always)]
    pub(super) fn shut<const FAST: bool>(&mut self, ray: &Ray8, beam: &Beam, live: Mask8) -> Mask8 {
        if self.passed < self.pause {
            self.passed += 1;
            return Mask8::splat(false);
        }
        let mut open = live;
        for rank in 0..self.corners.len() {
            let corners = &self.corners[usize::from(self.order[rank])];
            let hit = crossing::<FAST>(beam, corners, ray.t_min, ray.t_max).mask & open;
            if hit.any() {
                open = open & !hit;
                self.order.swap(rank, rank.saturating_sub(1));
            }
        }
        let shut = live & !open;
        self.passed = 0;
        self.pause = if shut.any() { 0 } else { (2 * self.pause + 1).min(LONGEST) };
        shut
    }

    /// Remembers a triangle of a block.
    #[inline(always)]
    pub(super) fn add(&mut self, block: Cell<'_>, lane: usize) {
        let corners = block.corners().map(|c| c.splat_lane(lane));
        if self.corners.len() < MOST {
            self.order[self.corners.len()] = self.corners.len() as u8;
            self.corners.push(corners);
        } else {
            self.corners[usize::from(self.order[MOST - 1])] = corners;
        }
    }
}
