//! Which triangles share which edges and vertices, and which surfaces are closed.
//!
//! Vertices are welded by position: two vertices with equal coordinates are one (0 and −0 are equal). An edge is interior if
//! exactly one triangle runs along it each way. Triangles that hang together by vertices form a part; a part is closed if all
//! of its edges are interior, so that every ray from inside must cross it. Triangles that name a welded vertex twice have
//! no area and do not count.

use gonio_accel::Mesh;
use std::collections::HashMap;

/// The neighbourhoods of one mesh.
#[derive(Debug)]
pub(crate) struct Topology {
    /// For each triangle, the welded vertices of its corners.
    corners: Vec<[u32; 3]>,
    /// Where each welded vertex' triangles start in `fans`, and where the last one's end.
    starts: Vec<u32>,
    fans: Vec<u32>,
    /// For each triangle, whether it belongs to a closed part.
    closed: Vec<bool>,
}

impl Topology {
    /// Welds the mesh and finds its neighbourhoods: O(triangles).
    pub(crate) fn of(mesh: &Mesh) -> Self {
        let (welded, vertices) = weld(&mesh.positions);
        let corners: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| t.map(|v| welded[v as usize])).collect();
        let (starts, fans) = fans(&corners, vertices);
        let mut topology = Self { corners, starts, fans, closed: Vec::new() };
        topology.closed = topology.closed_parts(vertices);
        topology
    }

    /// Whether the triangle belongs to a closed part.
    pub(crate) fn is_closed(&self, triangle: u32) -> bool {
        self.closed[triangle as usize]
    }

    /// Triangles that share corner `corner` of a triangle, itself among them.
    pub(crate) fn around_vertex(&self, triangle: u32, corner: usize) -> &[u32] {
        self.fan(self.corners[triangle as usize][corner])
    }

    /// The two triangles along edge `corner` → `corner` + 1 if it is interior.
    pub(crate) fn along_edge(&self, triangle: u32, corner: usize) -> Option<[u32; 2]> {
        let c = self.corners[triangle as usize];
        self.pair(c[corner], c[(corner + 1) % 3])
    }

    /// The corner of `other` that is corner `corner` of `triangle`.
    pub(crate) fn same_corner(&self, triangle: u32, corner: usize, other: u32) -> Option<usize> {
        let vertex = self.corners[triangle as usize][corner];
        self.corners[other as usize].iter().position(|&v| v == vertex)
    }

    /// Whether all edges that meet at a corner are interior, so that its triangles surround it.
    pub(crate) fn is_surrounded(&self, triangle: u32, corner: usize) -> bool {
        self.around_vertex(triangle, corner).iter().all(|&t| {
            let here = self.same_corner(triangle, corner, t);
            here.is_some_and(|k| self.along_edge(t, k).is_some() && self.along_edge(t, (k + 2) % 3).is_some())
        })
    }

    fn fan(&self, vertex: u32) -> &[u32] {
        let [from, to] = [vertex, vertex + 1].map(|v| self.starts[v as usize] as usize);
        &self.fans[from..to]
    }

    fn pair(&self, a: u32, b: u32) -> Option<[u32; 2]> {
        let [one, other] = [self.fan(a), self.fan(b)];
        let fan = if one.len() < other.len() { one } else { other }; // the hub of a wheel has many
        let runs = |t: u32, from: u32, to: u32| {
            let c = self.corners[t as usize];
            (0..3).any(|k| c[k] == from && c[(k + 1) % 3] == to)
        };
        let only = |from: u32, to: u32| {
            let mut along = fan.iter().copied().filter(|&t| runs(t, from, to));
            let first = along.next()?;
            along.next().is_none().then_some(first)
        };
        Some([only(a, b)?, only(b, a)?])
    }

    fn closed_parts(&self, vertices: usize) -> Vec<bool> {
        let mut parent: Vec<u32> = (0..vertices as u32).collect();
        for c in &self.corners {
            for pair in [[c[0], c[1]], [c[1], c[2]]] {
                let [a, b] = pair.map(|v| root(&mut parent, v));
                parent[a.max(b) as usize] = a.min(b);
            }
        }
        let mut open = vec![false; vertices];
        for c in self.corners.iter().filter(|c| has_area(c)) {
            if (0..3).any(|k| self.pair(c[k], c[(k + 1) % 3]).is_none()) {
                open[root(&mut parent, c[0]) as usize] = true;
            }
        }
        self.corners.iter().map(|c| has_area(c) && !open[root(&mut parent, c[0]) as usize]).collect()
    }
}

/// The welded number of each vertex, and how many there are.
fn weld(positions: &[[f32; 3]]) -> (Vec<u32>, usize) {
    let mut numbers = HashMap::with_capacity(positions.len());
    let mut number = |p: &[f32; 3]| {
        let next = numbers.len() as u32;
        *numbers.entry(p.map(|x| (x + 0.0).to_bits())).or_insert(next) // −0 + 0 is 0
    };
    let welded = positions.iter().map(&mut number).collect();
    (welded, numbers.len())
}

/// The triangles of each welded vertex, one after the other.
fn fans(corners: &[[u32; 3]], vertices: usize) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0_u32; vertices + 2];
    for &v in corners.iter().filter(|c| has_area(c)).flatten() {
        starts[v as usize + 2] += 1;
    }
    for v in 2..starts.len() {
        starts[v] += starts[v - 1];
    }
    let mut fans = vec![0; starts.last().map_or(0, |&n| n as usize)];
    // starts[v + 1] is where v begins; while filling, it runs to where v ends, which is where v + 1 begins.
    for (t, c) in corners.iter().enumerate().filter(|(_, c)| has_area(c)) {
        for &v in c {
            let place = &mut starts[v as usize + 1];
            fans[*place as usize] = t as u32;
            *place += 1;
        }
    }
    starts.pop();
    (starts, fans)
}

fn has_area(c: &[u32; 3]) -> bool {
    c[0] != c[1] && c[1] != c[2] && c[2] != c[0]
}

/// The smallest vertex of a part, by path halving.
fn root(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        let above = parent[parent[v as usize] as usize];
        parent[v as usize] = above;
        v = above;
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron in which every triangle has vertices of its own.
    fn tetrahedron() -> Mesh {
        let p = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0, 0.0, 1.0]];
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let positions = faces.iter().flatten().map(|&v: &usize| p[v]).collect();
        Mesh { positions, triangles: (0..4).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect() }
    }

    #[test]
    fn a_tetrahedron_of_loose_triangles_is_closed_until_one_is_missing_or_turned() {
        let mut mesh = tetrahedron();
        let whole = Topology::of(&mesh);
        assert!((0..4).all(|t| whole.is_closed(t)));
        assert_eq!(whole.along_edge(0, 2), Some([0, 1]));
        assert!(whole.is_surrounded(1, 2) && whole.around_vertex(1, 2).len() == 3);

        mesh.triangles.swap(0, 3);
        mesh.triangles[3].swap(0, 1);
        assert!((0..4).all(|t| !Topology::of(&mesh).is_closed(t)), "one face is turned over");
        mesh.triangles.pop();
        let open = Topology::of(&mesh);
        assert!((0..3).all(|t| !open.is_closed(t)));
        assert!((0..3).any(|t| (0..3).any(|k| open.along_edge(t, k).is_none())));
    }

    #[test]
    fn parts_are_judged_one_by_one_and_triangles_without_area_do_not_count() {
        let mut mesh = tetrahedron();
        let n = mesh.positions.len() as u32;
        mesh.positions.extend([[5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [5.0, 1.0, 0.0]]);
        mesh.triangles.extend([[n, n + 1, n + 2], [0, 1, 0]]);
        let topology = Topology::of(&mesh);
        let closed: Vec<bool> = (0..6).map(|t| topology.is_closed(t)).collect();
        assert_eq!(closed, [true, true, true, true, false, false]);
    }
}
