//! The cells of a tree: nodes of up to eight children, and blocks of up to eight triangles.

use super::boxes::Box3;
use super::pages::Rows;
use super::stack::{packed, spread, together};
use glam::Vec4;
use gonio_kernel::{F32x8, Mask8, Real, U32x8, Vec3};

/// How many children a node has, and how many triangles a block.
pub(super) const WIDTH: usize = F32x8::LANES;

/// A subtree: an inner node, or a leaf block if the top bit is set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Child(pub(super) u32);

pub(super) const LEAF: u32 = 1 << 31;

/// What is special has no cell: the end of a walk, the exit of a mesh's tree, and entrances to it ([`super::placed`]), numbered from
/// 1 on. A tree has fewer than 2³⁰ cells, so their bits are not those of a place.
const SPECIAL: u32 = LEAF | 1 << 30;

impl Child {
    /// There is no more to visit.
    pub(super) const DONE: Self = Self(SPECIAL);

    /// The way out of a mesh's tree.
    pub(super) const EXIT: Self = Self(u32::MAX);

    /// The entrance of that number, counted from 0.
    pub(super) fn entrance(number: usize) -> Self {
        Self(SPECIAL | (number + 1) as u32)
    }

    #[inline(always)]
    pub(super) fn is_special(self) -> bool {
        self.0 >= SPECIAL
    }

    /// The number of an entrance, counted from 0.
    #[inline(always)]
    pub(super) fn number(self) -> usize {
        ((self.0 & !SPECIAL) as usize).wrapping_sub(1)
    }

    /// A mask instead of a branch.
    #[inline(always)]
    pub(super) fn all_ones_if_special(self) -> u32 {
        ((self.0 << 1) as i32 >> 31) as u32
    }

    #[inline(always)]
    pub(super) fn is_leaf(self) -> bool {
        self.0 & LEAF != 0
    }

    /// Where its cell is; 0 for [`Child::DONE`], so that to look there is no mistake.
    #[inline(always)]
    pub(super) fn place(self) -> usize {
        (self.0 & !SPECIAL) as usize
    }

    /// A mask instead of a branch.
    #[inline(always)]
    pub(super) fn all_ones_if_leaf(self) -> u32 {
        (self.0 as i32 >> 31) as u32
    }
}

/// A node or a block, as ten times eight words, so that where the next one lies is known before which of both it is.
///
/// A **node** has up to eight children: rows 0 to 5 are the lower and upper planes across x, y, z of their boxes, row 6 the
/// children, that where a hit is likeliest last; row 7 has for each octant of directions the slots, the farthest first, three
/// bits each. Bit a of an octant is set if directions point down axis a. An unused slot has an inverted infinite box, which no ray
/// enters. A **block** has up to eight triangles: rows 0 to 8 are x, y, z of their three corners, row 9 their places in the
/// order of (instance, prim). Unused lanes repeat the first, which changes no result.
#[derive(Clone, Copy)]
pub(super) struct Cell<'a>(&'a Rows);

impl<'a> Cell<'a> {
    /// A block that is not one of the tree's.
    #[inline(always)]
    pub(super) fn of(rows: &'a Rows) -> Self {
        Self(rows)
    }

    /// Has the memory fetch it.
    #[inline(always)]
    pub(super) fn prefetch(self) {
        for line in 0..5 {
            fetch(&self.0[2 * line]);
        }
    }

    /// A row of planes of the boxes, by where it starts among the words of the cell.
    #[inline(always)]
    pub(super) fn plane(self, start: usize) -> F32x8 {
        let [rows @ .., _, _] = self.0;
        let words: &[f32; 64] = bytemuck::cast_ref(rows);
        // All bits of 56 are a row's: the compiler sees that it lies within.
        words[start & 56..].first_chunk().map_or(F32x8::ZERO, |row| F32x8::new(*row))
    }

    #[inline(always)]
    pub(super) fn children(self) -> U32x8 {
        F32x8::from_wide(self.0[6]).to_bits()
    }

    /// The order of an octant, packed.
    #[inline(always)]
    pub(super) fn order(self, octant: usize) -> u32 {
        F32x8::from_wide(self.0[7]).lane(octant).to_bits()
    }

    /// The slots of a set, the farthest first.
    #[inline(always)]
    pub(super) fn in_order(self, facing: &Facing, set: Mask8) -> Slots {
        let order = spread(self.order(facing.octant));
        let set = set.permute(order).to_bits();
        Slots { which: order.permute(together(set)), count: set.count_ones() as usize }
    }

    #[inline(always)]
    pub(super) fn corners(self) -> [Vec3<F32x8>; 3] {
        let r = self.0.map(F32x8::from_wide);
        [Vec3::new(r[0], r[1], r[2]), Vec3::new(r[3], r[4], r[5]), Vec3::new(r[6], r[7], r[8])]
    }

    /// The lanes of a block that are used.
    #[inline(always)]
    pub(super) fn used(self) -> u32 {
        (!F32x8::from_wide(self.0[9]).to_bits().same(U32x8::splat(self.index(0)))).to_bits() | 1
    }

    /// The same, one after the other.
    pub(super) fn lanes_used(self) -> impl Iterator<Item = usize> + Clone {
        let used = self.used();
        (0..WIDTH).filter(move |lane| used >> lane & 1 != 0)
    }

    /// The place of a triangle of the block.
    #[inline(always)]
    pub(super) fn index(self, lane: usize) -> u32 {
        F32x8::from_wide(self.0[9]).lane(lane).to_bits()
    }
}

/// Some slots of a node, one after the other.
#[derive(Clone, Copy)]
pub(super) struct Slots {
    /// In the lowest three bits of the first lanes.
    pub(super) which: U32x8,
    pub(super) count: usize,
}

impl Slots {
    /// The slots of a set, that where a hit is likeliest last.
    #[inline(always)]
    pub(super) fn as_they_are(set: Mask8) -> Self {
        let set = set.to_bits();
        Self { which: together(set), count: set.count_ones() as usize }
    }
}

/// Which sides of boxes rays meet first: where among a node's words the rows of near planes start, and those of far ones.
#[derive(Clone, Copy, Default)]
pub(super) struct Facing {
    near: [usize; 3],
    far: [usize; 3],
    octant: usize,
}

impl Facing {
    /// Of rays that point down those axes that have a 1, and up those that have a 0.
    #[inline(always)]
    pub(super) fn of([x, y, z]: [usize; 3]) -> Self {
        let rows = |x: usize, y: usize, z: usize| [x, 2 + y, 4 + z].map(|row| WIDTH * row);
        Self { near: rows(x, y, z), far: rows(x ^ 1, y ^ 1, z ^ 1), octant: x | y << 1 | z << 2 }
    }

    /// The near and the far planes of a node's children.
    #[inline(always)]
    pub(super) fn planes(&self, node: Cell<'_>) -> [Vec3<F32x8>; 2] {
        self.planes_of(|row| node.plane(row))
    }

    /// The near and the far planes of boxes whose rows start where those of a node do.
    #[inline(always)]
    pub(super) fn planes_of(&self, plane: impl Fn(usize) -> F32x8) -> [Vec3<F32x8>; 2] {
        [self.near, self.far].map(|[x, y, z]| Vec3::new(plane(x), plane(y), plane(z)))
    }
}

/// Has the memory fetch the line that a value starts in.
#[inline(always)]
fn fetch<T>(value: &T) {
    #[cfg(target_arch = "x86_64")]
    safe_arch::prefetch_t0(value);
    #[cfg(not(target_arch = "x86_64"))]
    let _ = value;
}

/// A node of children and their boxes, whose orders are not known yet.
pub(super) fn node_of(children: &[(Box3, Child)]) -> Rows {
    let plane = |pick: fn(&Box3) -> f32| {
        F32x8::new(std::array::from_fn(|slot| pick(children.get(slot).map_or(&Box3::EMPTY, |(bounds, _)| bounds))))
    };
    [
        plane(|b| b.lo.x),
        plane(|b| b.hi.x),
        plane(|b| b.lo.y),
        plane(|b| b.hi.y),
        plane(|b| b.lo.z),
        plane(|b| b.hi.z),
        U32x8::new(std::array::from_fn(|slot| children.get(slot).map_or(0, |child| child.1.0))).as_real(),
        F32x8::ZERO,
        F32x8::ZERO,
        F32x8::ZERO,
    ]
    .map(F32x8::to_wide)
}

/// The orders of children for each octant.
pub(super) fn orders_of(children: &[(Box3, Child)]) -> F32x8 {
    let order = |octant: usize| {
        let sign = |axis: usize| if octant >> axis & 1 == 0 { 1.0 } else { -1.0 };
        let depth = |slot: &usize| {
            let center = children[*slot].0.center2();
            center.x * sign(0) + center.y * sign(1) + center.z * sign(2)
        };
        let mut slots: Vec<usize> = (0..children.len()).collect();
        slots.sort_by(|a, b| depth(b).total_cmp(&depth(a)));
        // Unused slots too have a place in the order: slot 0 must not stand in for them.
        packed(slots.into_iter().chain(children.len()..WIDTH))
    };
    U32x8::new(std::array::from_fn(order)).as_real()
}

impl Cell<'_> {
    /// The children of a node and their boxes.
    pub(super) fn slots(self) -> impl Iterator<Item = (Box3, Child)> {
        let corner = |side: usize, slot: usize| {
            let [x, y, z] = [0, 2, 4].map(|axis| F32x8::from_wide(self.0[axis + side]).lane(slot));
            Vec4::new(x, y, z, 1.0)
        };
        let children = self.children();
        let slot = move |slot| (Box3 { lo: corner(0, slot), hi: corner(1, slot) }, Child(children.lane(slot)));
        (0..WIDTH).map(slot).filter(|(bounds, _)| bounds.lo.x <= bounds.hi.x)
    }
}
