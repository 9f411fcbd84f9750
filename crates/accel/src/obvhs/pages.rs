//! Where the cells of a tree lie: in huge pages, if the system has them.
//!
//! A ray's next cell may be anywhere. With pages of 4 KiB a tree of a million triangles needs nearly twenty thousand, of which the
//! processor remembers two thousand, and looking up one more costs as much as the cell. With pages of 2 MiB it needs forty.

use memmap2::MmapMut;
use std::fmt;
use wide::f32x8;

/// A cell: ten times eight words, five lines of the cache.
pub(super) type Rows = [f32x8; 10];

/// What is smaller is not worth a page of its own.
const LEAST_BYTES: usize = 1 << 20;

/// Cells, one after the other.
pub(super) enum Pages {
    /// While they are made, and where there are few.
    Heap(Vec<Rows>),
    Huge(MmapMut),
}

impl Pages {
    #[inline(always)]
    pub(super) fn rows(&self) -> &[Rows] {
        match self {
            Self::Heap(rows) => rows,
            Self::Huge(map) => bytemuck::cast_slice(map),
        }
    }

    pub(super) fn push(&mut self, rows: Rows) {
        match self {
            Self::Heap(all) => all.push(rows),
            Self::Huge(_) => unreachable!("a tree that has settled does not grow"),
        }
    }

    pub(super) fn set(&mut self, place: usize, rows: Rows) {
        match self {
            Self::Heap(all) => all[place] = rows,
            Self::Huge(map) => bytemuck::cast_slice_mut(map)[place] = rows,
        }
    }

    /// Moves them to where they stay. If the system gives no such memory they stay where they are.
    pub(super) fn settle(&mut self) {
        let Self::Heap(rows) = self else { return };
        rows.shrink_to_fit();
        if size_of_val(rows.as_slice()) < LEAST_BYTES {
            return;
        }
        if let Some(map) = huge(bytemuck::cast_slice(rows)) {
            *self = Self::Huge(map);
        }
    }
}

/// A copy of some bytes in huge pages, or in usual ones if the system has no others.
fn huge(bytes: &[u8]) -> Option<MmapMut> {
    let mut map = MmapMut::map_anon(bytes.len()).ok()?;
    #[cfg(target_os = "linux")]
    let _ = map.advise(memmap2::Advice::HugePage); // a wish
    map.copy_from_slice(bytes);
    Some(map)
}

impl Default for Pages {
    fn default() -> Self {
        Self::Heap(Vec::new())
    }
}

impl Clone for Pages {
    fn clone(&self) -> Self {
        let mut copy = Self::Heap(self.rows().to_vec());
        copy.settle();
        copy
    }
}

impl fmt::Debug for Pages {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} cells", self.rows().len())
    }
}
