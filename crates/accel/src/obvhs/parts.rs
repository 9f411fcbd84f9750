//! Very many triangles in parts that are built one after the other.
//!
//! The builder of `obvhs` needs about 250 bytes per triangle while it works. So that its memory does not grow with the
//! scene, triangles beyond [`MOST`] are split: along the longest axis of their centres, where the surface area heuristic
//! over sixteen bins is least (Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies"), until every
//! part is small enough. The splits are those of the topmost levels of a tree, so the tree over the parts is as good as
//! one built at once, and a scene of one part is built exactly so.

use crate::geometry::Geometry;
use crate::obvhs::tree::bounds_of;
use obvhs::aabb::Aabb;

/// Most triangles of a part.
pub(super) const MOST: usize = 1 << 20;
const BINS: usize = 16;

/// The places of all triangles of the geometry, and the ends of the parts among them.
pub(super) fn split(geometry: &Geometry, most: usize) -> (Vec<u32>, Vec<usize>) {
    let mut order: Vec<u32> = (0..geometry.triangle_count() as u32).collect();
    let mut ends = Vec::new();
    let center = |&triangle: &u32| Aabb::from_point(bounds_of(geometry, triangle).center());
    let whole = if order.len() > most {
        order.iter().map(center).fold(Aabb::empty(), |a, b| a.union(&b))
    } else {
        Aabb::empty()
    };
    let mut work = vec![(0..order.len(), whole)];
    while let Some((range, centers)) = work.pop() {
        if range.len() <= most {
            ends.push(range.end);
            continue;
        }
        let (before, [first, second]) = cut(geometry, &mut order[range.clone()], &centers);
        let middle = range.start + before;
        work.push((middle..range.end, second));
        work.push((range.start..middle, first));
    }
    (order, ends)
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Aabb,
    centers: Aabb,
    count: usize,
}

impl Bin {
    fn empty() -> Self {
        Self { bounds: Aabb::empty(), centers: Aabb::empty(), count: 0 }
    }

    fn add(&mut self, other: &Self) {
        self.bounds = self.bounds.union(&other.bounds);
        self.centers = self.centers.union(&other.centers);
        self.count += other.count;
    }

    fn sum(bins: &[Self]) -> Self {
        bins.iter().fold(Self::empty(), |mut sum, bin| {
            sum.add(bin);
            sum
        })
    }
}

/// Brings one side of a part before the other, given the bounds of its centres; returns how many are before, and the
/// bounds of both sides' centres. Neither side is empty.
fn cut(geometry: &Geometry, part: &mut [u32], centers: &Aabb) -> (usize, [Aabb; 2]) {
    let size = centers.diagonal();
    let axis = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.z > size.y) };
    let scale = BINS as f32 / size[axis];
    let mut bins = [Bin::empty(); BINS];
    let places: Vec<u8> = part
        .iter()
        .map(|&triangle| {
            let bounds = bounds_of(geometry, triangle);
            let center = bounds.center();
            let place = (((center[axis] - centers.min[axis]) * scale) as usize).min(BINS - 1); // `as` saturates
            bins[place].add(&Bin { bounds, centers: Aabb::from_point(center), count: 1 });
            place as u8
        })
        .collect();
    let cost = |side: &[Bin]| {
        let sum = Bin::sum(side);
        (sum.count > 0).then(|| sum.bounds.half_area() * sum.count as f32)
    };
    let costs = (1..BINS).filter_map(|at| Some((cost(&bins[..at])? + cost(&bins[at..])?, at)));
    let Some((_, best)) = costs.min_by(|a, b| a.0.total_cmp(&b.0)) else {
        return (part.len() / 2, [*centers; 2]); // all centres in one place: any half will do
    };
    // Stable, so that neighbours in the file stay neighbours in memory.
    let mut before = 0;
    let mut after = Vec::new();
    for at in 0..part.len() {
        if usize::from(places[at]) < best {
            part[before] = part[at];
            before += 1;
        } else {
            after.push(part[at]);
        }
    }
    part[before..].copy_from_slice(&after);
    (before, [&bins[..best], &bins[best..]].map(|side| Bin::sum(side).centers))
}
