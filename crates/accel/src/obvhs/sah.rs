//! A binary tree from the top down: every range of triangles is cut where the surface area heuristic is least.
//!
//! The heuristic: a random ray that enters a box enters a box inside it with a chance proportional to its area (Goldsmith & Salmon
//! 1987), so a cut costs area × blocks on either side, counted in blocks of eight triangles, because eight cost as much to
//! test as one. Cuts are looked for between [`BINS`] bins along all three axes (Wald 2007, "On fast Construction of
//! SAH-based Bounding Volume Hierarchies"), in ranges of few triangles between all of them.
//!
//! **Parallel and deterministic.** A tree over n triangles has n − 1 pairs of siblings, so each subtree's place in memory is known
//! before it is built. Halves are built at the same time and the result is the same for any number of threads.

use super::boxes::{Box3, Ref};
use super::cell::WIDTH;
use glam::Vec4;

/// Bins along each axis.
const BINS: usize = 16;
/// Up to so many triangles are sorted instead of binned.
const FEW: usize = 8;
/// Ranges of fewer triangles are not worth another thread.
const ALONE: usize = 4096;

/// A node of the binary tree: a triangle, or two children side by side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Binary {
    lo: [f32; 3],
    /// The first of two children; for a triangle its number.
    pub(super) first: u32,
    hi: [f32; 3],
    /// How many triangles are below.
    pub(super) count: u32,
}

impl Binary {
    pub(super) fn new(bounds: Box3, first: u32, count: u32) -> Self {
        let [lo, hi] = [bounds.lo, bounds.hi].map(|v| [v.x, v.y, v.z]);
        Self { lo, first, hi, count }
    }

    #[inline(always)]
    pub(super) fn bounds(&self) -> Box3 {
        let [lo, hi] = [self.lo, self.hi].map(|[x, y, z]| Vec4::new(x, y, z, 1.0));
        Box3 { lo, hi }
    }

    #[inline(always)]
    pub(super) fn children(&self) -> Option<[usize; 2]> {
        (self.count > 1).then_some([self.first as usize, self.first as usize + 1])
    }
}

/// The tree over some triangles, its root first. The triangles change places. Empty for none.
pub(super) fn build(refs: &mut [Ref]) -> Vec<Binary> {
    let Some(bounds) = bounds_of(refs) else { return Vec::new() };
    let mut nodes = vec![Binary::new(bounds, 0, 0); 2 * refs.len() - 1];
    let (root, pairs) = nodes.split_at_mut(1);
    grow(&mut root[0], bounds, refs, pairs, 1);
    nodes
}

/// Cuts triangles into ranges of at most so many, where a tree would be cut: the ends of the ranges.
pub(super) fn split(refs: &mut [Ref], most: usize) -> Vec<usize> {
    let mut ends = Vec::new();
    let whole = 0..refs.len();
    let mut work = vec![whole];
    while let Some(range) = work.pop() {
        if range.len() <= most {
            ends.push(range.end);
        } else {
            let middle = range.start + cut_many(&mut refs[range.clone()]).0;
            work.extend([middle..range.end, range.start..middle]);
        }
    }
    ends
}

/// Builds the subtree of a node over `refs`, into `pairs`, which start at `place` in the tree.
fn grow(node: &mut Binary, bounds: Box3, refs: &mut [Ref], pairs: &mut [Binary], place: usize) {
    if refs.len() == 1 {
        *node = Binary::new(bounds, refs[0].index(), 1);
        return;
    }
    *node = Binary::new(bounds, place as u32, refs.len() as u32);
    let (middle, [bounds_a, bounds_b]) = if refs.len() <= FEW { cut_few(refs) } else { cut_many(refs) };
    let (pair, below) = pairs.split_at_mut(2);
    let (refs_a, refs_b) = refs.split_at_mut(middle);
    let (below_a, below_b) = below.split_at_mut(2 * (middle - 1));
    let [node_a, node_b] = pair else { unreachable!("a pair has two") };
    let many = refs_a.len().min(refs_b.len()) >= ALONE;
    let mut a = || grow(node_a, bounds_a, refs_a, below_a, place + 2);
    let mut b = || grow(node_b, bounds_b, refs_b, below_b, place + 2 * middle);
    if many {
        rayon::join(a, b);
    } else {
        a();
        b();
    }
}

/// The box of all, if there are any.
fn bounds_of(refs: &[Ref]) -> Option<Box3> {
    refs.iter().map(Ref::bounds).reduce(Box3::union)
}

/// The boxes of both sides of a cut, neither of them empty.
fn sides(refs: &[Ref], middle: usize) -> [Box3; 2] {
    [&refs[..middle], &refs[middle..]].map(|side| bounds_of(side).unwrap_or(Box3::EMPTY))
}

/// Blocks that so many triangles fill.
#[inline(always)]
fn blocks(count: usize) -> f32 {
    count.div_ceil(WIDTH) as f32
}

/// Sorts few triangles along the axis with the best cut: how many come before it, and the boxes of both sides.
fn cut_few(refs: &mut [Ref]) -> (usize, [Box3; 2]) {
    let n = refs.len();
    let mut best = (f32::INFINITY, 0, 1);
    for axis in 0..3 {
        sort(refs, axis);
        let mut areas = [0.0; FEW];
        let mut after = Box3::EMPTY;
        for i in (1..n).rev() {
            after = after.union(refs[i].bounds());
            areas[i] = after.half_area() * (n - i) as f32;
        }
        let mut before = Box3::EMPTY;
        for i in 1..n {
            before = before.union(refs[i - 1].bounds());
            let cost = before.half_area() * i as f32 + areas[i];
            if cost < best.0 {
                best = (cost, axis, i);
            }
        }
    }
    let (_, axis, middle) = best;
    if axis != 2 {
        sort(refs, axis);
    }
    (middle, sides(refs, middle))
}

/// Stable, so that the result depends on nothing but the order before.
fn sort(refs: &mut [Ref], axis: usize) {
    for i in 1..refs.len() {
        let mut at = i;
        let (moved, key) = (refs[i], refs[i].bounds().center2()[axis]);
        while at > 0 && refs[at - 1].bounds().center2()[axis] > key {
            refs[at] = refs[at - 1];
            at -= 1;
        }
        refs[at] = moved;
    }
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Box3,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Box3::EMPTY, count: 0 };
}

/// Brings one side of the best cut between bins before the other: how many are before, and the bounds of both sides.
fn cut_many(refs: &mut [Ref]) -> (usize, [Box3; 2]) {
    let centers = centers_of(refs);
    let [lo, hi] = [centers.lo, centers.hi];
    // A little less, so that the largest centre too is in the last bin.
    let scale = |size: f32| if size > 0.0 { BINS as f32 * 0.9999 / size } else { 0.0 };
    let scale = [scale(hi.x - lo.x), scale(hi.y - lo.y), scale(hi.z - lo.z)];
    let place = |center: Vec4, axis: usize| (((center[axis] - lo[axis]) * scale[axis]) as usize).min(BINS - 1);
    let mut bins = [[Bin::EMPTY; BINS]; 3];
    for r in &*refs {
        let (bounds, center) = (r.bounds(), r.bounds().center2());
        for (axis, bins) in bins.iter_mut().enumerate() {
            let bin = &mut bins[place(center, axis)];
            bin.bounds = bin.bounds.union(bounds);
            bin.count += 1;
        }
    }
    let mut best = (f32::INFINITY, 0, 0);
    for (axis, bins) in bins.iter().enumerate() {
        if scale[axis] == 0.0 {
            continue;
        }
        let mut after = [0.0; BINS];
        let (mut sum, mut count) = (Box3::EMPTY, 0);
        for i in (1..BINS).rev() {
            sum = sum.union(bins[i].bounds);
            count += bins[i].count as usize;
            after[i] = if count > 0 { sum.half_area() * blocks(count) } else { f32::INFINITY };
        }
        (sum, count) = (Box3::EMPTY, 0);
        for i in 1..BINS {
            sum = sum.union(bins[i - 1].bounds);
            count += bins[i - 1].count as usize;
            let cost = if count > 0 { sum.half_area() * blocks(count) + after[i] } else { f32::INFINITY };
            if cost < best.0 {
                best = (cost, axis, i);
            }
        }
    }
    let (cost, axis, cut) = best;
    if cost == f32::INFINITY {
        // All centres in one place, or areas beyond what f32 can hold: any half will do.
        let middle = refs.len() / 2;
        return (middle, sides(refs, middle));
    }
    let middle = partition(refs, |r| place(r.bounds().center2(), axis) < cut);
    let around = |bins: &[Bin]| bins.iter().fold(Box3::EMPTY, |all, bin| all.union(bin.bounds));
    (middle, [around(&bins[axis][..cut]), around(&bins[axis][cut..])])
}

/// The bounds of doubled centres.
fn centers_of(refs: &[Ref]) -> Box3 {
    refs.iter().fold(Box3::EMPTY, |all, r| all.grown(r.bounds().center2()))
}

/// Brings those for which `first` holds before the others; how many they are.
fn partition(refs: &mut [Ref], first: impl Fn(&Ref) -> bool) -> usize {
    let (mut low, mut high) = (0, refs.len());
    loop {
        while low < high && first(&refs[low]) {
            low += 1;
        }
        while low < high && !first(&refs[high - 1]) {
            high -= 1;
        }
        if low >= high {
            return low;
        }
        high -= 1;
        refs.swap(low, high);
        low += 1;
    }
}
