//! Polygons into triangles by ear clipping (Meisters 1975, "Polygons have ears").
//!
//! The polygon is projected along its Newell normal onto the coordinate plane it faces most. A corner is an ear if it
//! is convex and no other corner lies in its triangle; cutting ears off one by one ends in a triangulation. If every
//! triangle cut is positively oriented, they cover a simple polygon exactly, without overlap: that is how a
//! self-crossing one is recognised. A convex polygon yields the fan around its first corner, as in other readers.

use glam::{DVec2, DVec3};

/// Steps of the search for ears before it is given up, each a few nanoseconds. A simple polygon of n corners takes about n²
/// in practice, so this is enough for 20,000 corners; but a file can hold one of a million for which it is n³.
const MOST_STEPS: usize = 1 << 28;
/// Steps that one look at a corner counts for.
const LOOK: usize = 8;

/// Appends triangles as indices into `points`, oriented like the polygon; at least three points.
///
/// Returns whether the polygon was simple. One that crosses itself, has no area, or is too large to find out still yields
/// triangles, which need not cover it. Never more than `points.len() - 2` triangles.
pub(super) fn triangulate(points: &[DVec3], out: &mut Vec<[usize; 3]>) -> bool {
    let n = points.len();
    if n == 3 {
        out.push([0, 1, 2]);
        return true;
    }
    let Some((flat, epsilon)) = project(points) else {
        out.extend((2..n).map(|i| [0, i - 1, i]));
        return false;
    };
    Ring::new(&flat, epsilon).clip(out)
}

/// Counter-clockwise plane coordinates and the cross product below which three points count as collinear.
fn project(points: &[DVec3]) -> Option<(Vec<DVec2>, f64)> {
    let origin = *points.first()?;
    let largest = points.iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
    let local: Vec<DVec3> = points.iter().map(|&p| p - origin).collect();
    let extent = local.iter().fold(0.0, |m: f64, p| m.max(p.length()));
    // Coordinates carry a relative rounding error of EPSILON; over a length of `extent` it sweeps this area.
    let epsilon = 4.0 * f64::EPSILON * largest * extent;
    let normal: DVec3 = local.windows(2).map(|pair| pair[0].cross(pair[1])).sum(); // Newell, seen from `origin`
    let size = normal.abs();
    let facing = size.max_element();
    if facing <= epsilon || !facing.is_finite() {
        return None;
    }
    type Axes = fn(&DVec3) -> DVec2;
    let (axes, towards): (Axes, f64) = if facing == size.x {
        (|p| DVec2::new(p.y, p.z), normal.x)
    } else if facing == size.y {
        (|p| DVec2::new(p.z, p.x), normal.y)
    } else {
        (|p| DVec2::new(p.x, p.y), normal.z)
    };
    let mirror = DVec2::new(towards.signum(), 1.0); // seen from the front, corners run counter-clockwise
    let flat = local.iter().map(|p| axes(p) * mirror).collect();
    Some((flat, epsilon))
}

/// The corners not cut off yet, as a doubly linked ring.
struct Ring<'a> {
    points: &'a [DVec2],
    epsilon: f64,
    next: Vec<usize>,
    prev: Vec<usize>,
    /// Corners that were not convex at last sight: only they can lie inside an ear. It only shrinks.
    reflex: Vec<usize>,
    cut: Vec<bool>,
    /// What is left of [`MOST_STEPS`].
    steps: usize,
}

impl<'a> Ring<'a> {
    fn new(points: &'a [DVec2], epsilon: f64) -> Self {
        let n = points.len();
        let next = (0..n).map(|i| (i + 1) % n).collect();
        let prev = (0..n).map(|i| (i + n - 1) % n).collect();
        let (reflex, cut) = (Vec::new(), vec![false; n]);
        let mut ring = Self { points, epsilon, next, prev, reflex, cut, steps: MOST_STEPS };
        ring.reflex = (0..n).filter(|&i| ring.turn(i) <= epsilon).collect();
        ring
    }

    fn clip(&mut self, out: &mut Vec<[usize; 3]>) -> bool {
        let mut left = self.points.len();
        let mut at = 1;
        let mut refused = 0;
        let mut simple = true;
        while left > 3 {
            if self.is_ear(at) {
                out.push([self.prev[at], at, self.next[at]]);
            } else if self.steps == 0 && self.turn(at).abs() <= self.epsilon {
                // dropped at once
            } else if refused < left {
                refused += 1;
                at = self.next[at];
                continue;
            } else if let Some(flat) = self.find(at, |turn, e| turn.abs() <= e) {
                at = flat; // a repeated or collinear corner: dropping it loses no area
            } else if let Some(convex) = self.find(at, |turn, e| turn > e) {
                at = convex; // no ear among convex corners: the outline crosses itself
                simple = false;
                out.push([self.prev[at], at, self.next[at]]);
            } else {
                return false; // what is left runs backwards
            }
            at = self.remove(at);
            left -= 1;
            refused = 0;
        }
        simple &= self.steps > 0 && self.turn(at) >= -self.epsilon;
        if self.turn(at) > self.epsilon {
            // Starting at the lowest index keeps a quad's second triangle [0, 2, 3].
            let mut corners = [self.prev[at], at, self.next[at]];
            while corners[0] > corners[1] || corners[0] > corners[2] {
                corners.rotate_left(1);
            }
            out.push(corners);
        }
        simple
    }

    /// Twice the signed area of the triangle at corner `i`: positive where the outline turns left.
    fn turn(&self, i: usize) -> f64 {
        let (a, b, c) = (self.points[self.prev[i]], self.points[i], self.points[self.next[i]]);
        (b - a).perp_dot(c - b)
    }

    fn is_ear(&mut self, i: usize) -> bool {
        self.steps = self.steps.saturating_sub(LOOK);
        if self.turn(i) <= self.epsilon {
            return false;
        }
        if self.steps == 0 {
            return true; // given up: any convex corner will do
        }
        self.steps = self.steps.saturating_sub(self.reflex.len());
        let points = self.points;
        let (a, b, c) = (points[self.prev[i]], points[i], points[self.next[i]]);
        !self.reflex.iter().any(|&r| {
            let p = points[r];
            // A hole is bridged by corners that occur twice; its second copy does not block the first.
            p != a
                && p != b
                && p != c
                && (b - a).perp_dot(p - a) >= 0.0
                && (c - b).perp_dot(p - b) >= 0.0
                && (a - c).perp_dot(p - c) >= 0.0
        })
    }

    fn find(&self, start: usize, accept: impl Fn(f64, f64) -> bool) -> Option<usize> {
        let mut at = start;
        loop {
            if accept(self.turn(at), self.epsilon) {
                return Some(at);
            }
            at = self.next[at];
            if at == start {
                return None;
            }
        }
    }

    /// Takes corner `i` out and returns the one after it.
    fn remove(&mut self, i: usize) -> usize {
        let (before, after) = (self.prev[i], self.next[i]);
        self.next[before] = after;
        self.prev[after] = before;
        self.cut[i] = true;
        if self.steps == 0 {
            return after;
        }
        self.steps = self.steps.saturating_sub(self.reflex.len());
        let (points, cut) = (self.points, &self.cut);
        let (next, prev, epsilon) = (&self.next, &self.prev, self.epsilon);
        self.reflex.retain(|&r| {
            let touched = r == before || r == after;
            let turn = |r: usize| (points[r] - points[prev[r]]).perp_dot(points[next[r]] - points[r]);
            !(cut[r] || touched && turn(r) > epsilon)
        });
        after
    }
}

#[cfg(test)]
mod tests;
