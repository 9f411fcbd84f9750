//! Triangles of one format, over vertices that faces share.
//!
//! A file numbers positions, texture coordinates and normals apart; a mesh has one number per vertex. A [`Part`] makes a
//! vertex of each combination that faces use, in the order of first use.

use glam::DVec3;
use gonio_tracer::scene::has_area;

use super::polygon;

/// Numbers of a position, a texture coordinate and a normal, from 0.
pub(super) type Corner = [u32; 3];
/// No texture coordinate, or no normal.
pub(super) const NONE: u32 = u32::MAX;
/// How many vertices of one position are compared with a new one. Beyond that it may be made twice, which costs
/// memory but changes no picture; without a limit, a file could make every corner a search through all others.
const COMPARED: usize = 32;

/// What a file defines, in its own numbering.
#[derive(Default)]
pub(super) struct Pool {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) uvs: Vec<[f32; 2]>,
    /// Unit, or zero where the file has no direction.
    pub(super) normals: Vec<[f32; 3]>,
}

/// Triangles of one format: all with texture coordinates or none, all with normals or none.
#[derive(Default)]
pub(crate) struct Part {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) normals: Option<Vec<[f32; 3]>>,
    pub(crate) uvs: Option<Vec<[f32; 2]>>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// How many triangles in turn have which material: 0 where none is named, otherwise its place among the names plus 1.
    pub(crate) materials: Vec<(u32, u32)>,
    /// For each position of the file, the newest vertex made of it, plus 1.
    newest: Vec<u32>,
    /// For each vertex: its texture coordinate, its normal, and the next older vertex at its position, plus 1. Empty
    /// where positions are all there is.
    older: Vec<Corner>,
}

/// What was wrong with faces: first line and count.
#[derive(Default)]
pub(super) struct Faults {
    pub(super) flat: Option<(u32, u32)>,
    pub(super) crossed: Option<(u32, u32)>,
}

fn count(tally: &mut Option<(u32, u32)>, line: u32) {
    tally.get_or_insert((line, 0)).1 += 1;
}

/// Lists that are used again for each face.
#[derive(Default)]
pub(super) struct Scratch {
    points: Vec<DVec3>,
    vertices: Vec<u32>,
    triangles: Vec<[usize; 3]>,
}

impl Part {
    /// Adds the triangles of a face. All corners are of the part's format and exist in the pool.
    pub(super) fn add(
        &mut self,
        pool: &Pool,
        face: &[Corner],
        material: u32,
        line: u32,
        faults: &mut Faults,
        scratch: &mut Scratch,
    ) {
        let Scratch { points, vertices, triangles } = scratch;
        points.clear();
        points.extend(face.iter().map(|corner| DVec3::from_array(pool.positions[corner[0] as usize])));
        vertices.clear();
        vertices.extend(face.iter().map(|&corner| self.vertex(pool, corner)));
        triangles.clear();
        if !polygon::triangulate(points, triangles) {
            count(&mut faults.crossed, line);
        }
        if triangles.is_empty() {
            count(&mut faults.flat, line);
        }
        let before = self.triangles.len();
        for corners in triangles.iter() {
            if has_area(corners.map(|corner| points[corner])) {
                self.triangles.push(corners.map(|corner| vertices[corner]));
            } else {
                count(&mut faults.flat, line);
            }
        }
        let added = (self.triangles.len() - before) as u32;
        match self.materials.last_mut() {
            Some((number, last)) if *last == material => *number += added,
            _ if added > 0 => self.materials.push((added, material)),
            _ => {}
        }
    }

    /// The vertex of a corner, made if it is new.
    fn vertex(&mut self, pool: &Pool, [position, uv, normal]: Corner) -> u32 {
        if self.newest.len() <= position as usize {
            self.newest.resize(pool.positions.len(), 0);
        }
        let newest = &mut self.newest[position as usize];
        let bare = uv == NONE && normal == NONE;
        let mut link = *newest;
        for _ in 0..COMPARED {
            if link == 0 {
                break;
            }
            let vertex = link - 1;
            if bare || self.older[vertex as usize][..2] == [uv, normal] {
                return vertex;
            }
            link = self.older[vertex as usize][2];
        }
        if !bare {
            self.older.push([uv, normal, *newest]);
        }
        let vertex = self.positions.len() as u32;
        *newest = vertex + 1;
        self.positions.push(pool.positions[position as usize]);
        if uv != NONE {
            self.uvs.get_or_insert_default().push(pool.uvs[uv as usize]);
        }
        if normal != NONE {
            self.normals.get_or_insert_default().push(pool.normals[normal as usize]);
        }
        vertex
    }

    /// Forgets the file's numbering, and gives each vertex whose normal had no length the normal of a face; returns how
    /// many.
    pub(super) fn finish(&mut self) -> usize {
        (self.newest, self.older) = (Vec::new(), Vec::new());
        let Some(normals) = &mut self.normals else { return 0 };
        let mut replaced = 0;
        for triangle in &self.triangles {
            for &vertex in triangle {
                if normals[vertex as usize] == [0.0; 3] {
                    let [a, b, c] = triangle.map(|i| DVec3::from_array(self.positions[i as usize]));
                    normals[vertex as usize] = unit((b - a).cross(c - a));
                    replaced += 1;
                }
            }
        }
        replaced
    }
}

/// The unit vector in f32; zero for zero. Scaled first, so that squares neither overflow nor vanish.
pub(super) fn unit(v: DVec3) -> [f32; 3] {
    let largest = v.abs().max_element();
    if largest > 0.0 { (v / largest).normalize().as_vec3().to_array() } else { [0.0; 3] }
}
