//! What rays have yet to visit, and how the children of a node that they enter get there without a branch.
//!
//! An order of a node's eight slots is a word, three bits for each. The slots that count are moved together by a permutation from
//! a table, and all eight are stored at once: those that do not count are overwritten by the next.

use gonio_kernel::{F32x8, Mask8, U32x8};

/// Subtrees still to be visited, and where rays enter them.
pub(super) struct Stack {
    pub(super) children: Vec<u32>,
    pub(super) nears: Vec<f32>,
}

impl Stack {
    pub(super) fn with_room(entries: usize) -> Self {
        Self { children: vec![0; entries], nears: vec![0.0; entries] }
    }

    /// Stores eight of which the first ones count.
    #[inline(always)]
    pub(super) fn store(&mut self, top: usize, children: U32x8, nears: Option<F32x8>) {
        self.children[top..top + 8].copy_from_slice(&children.to_array());
        if let Some(nears) = nears {
            self.nears[top..top + 8].copy_from_slice(&nears.to_array());
        }
    }
}

/// Slots in a word, the first in the lowest bits.
pub(super) fn packed(slots: impl IntoIterator<Item = usize>) -> u32 {
    slots.into_iter().enumerate().fold(0, |packed, (place, slot)| packed | (slot as u32) << (3 * place))
}

/// The slots of a word, one per lane: in the lowest three bits, with others above, which a permutation does not look at.
#[inline(always)]
pub(super) fn spread(packed: u32) -> U32x8 {
    U32x8::splat(packed).shr_each(U32x8::new([0, 3, 6, 9, 12, 15, 18, 21]))
}

/// The permutation that moves the lanes of a set together, the first lane first.
#[inline(always)]
pub(super) fn together(set: u32) -> U32x8 {
    spread(TOGETHER[set as usize & 0xff])
}

/// For each set of lanes its members, packed; then zeros.
const TOGETHER: [u32; 256] = {
    let mut table = [0; 256];
    let mut set = 0;
    while set < 256 {
        let (mut lane, mut count) = (0, 0);
        while lane < 8 {
            if set >> lane & 1 != 0 {
                table[set] |= (lane as u32) << (3 * count);
                count += 1;
            }
            lane += 1;
        }
        set += 1;
    }
    table
};

/// Calls `f` with each lane of a mask.
#[inline(always)]
pub(super) fn for_each_lane(mask: Mask8, mut f: impl FnMut(usize)) {
    let mut bits = mask.to_bits();
    while bits != 0 {
        f(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}
