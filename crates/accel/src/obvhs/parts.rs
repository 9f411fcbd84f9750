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
    let mut work = vec![0..order.len()];
    while let Some(range) = work.pop() {
        if range.len() <= most {
            ends.push(range.end);
            continue;
        }
        let middle = range.start + cut(geometry, &mut order[range.clone()]);
        work.push(middle..range.end);
        work.push(range.start..middle);
    }
    (order, ends)
}

/// Brings one side before the other and returns how many it has; neither is empty.
fn cut(geometry: &Geometry, part: &mut [u32]) -> usize {
    let mut centers = Aabb::empty();
    for &triangle in part.iter() {
        centers.extend(bounds_of(geometry, triangle).center());
    }
    let size = centers.diagonal();
    let axis = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.z > size.y) };
    let scale = BINS as f32 / size[axis];
    let bin = |center: f32| (((center - centers.min[axis]) * scale) as usize).min(BINS - 1); // `as` saturates

    let mut bins = [(Aabb::empty(), 0_usize); BINS];
    for &triangle in part.iter() {
        let bounds = bounds_of(geometry, triangle);
        let (sum, count) = &mut bins[bin(bounds.center()[axis])];
        *sum = sum.union(&bounds);
        *count += 1;
    }
    let cost = |side: &[(Aabb, usize)]| {
        let whole = side.iter().filter(|bin| bin.1 > 0).fold(Aabb::empty(), |sum, bin| sum.union(&bin.0));
        let count: usize = side.iter().map(|bin| bin.1).sum();
        (count > 0).then(|| whole.half_area() * count as f32)
    };
    let costs = (1..BINS).filter_map(|at| Some((cost(&bins[..at])? + cost(&bins[at..])?, at)));
    let Some((_, best)) = costs.min_by(|a, b| a.0.total_cmp(&b.0)) else {
        return part.len() / 2; // all centres in one place: any half will do
    };
    let mut before = 0;
    for at in 0..part.len() {
        if bin(bounds_of(geometry, part[at]).center()[axis]) < best {
            part.swap(before, at);
            before += 1;
        }
    }
    before
}
