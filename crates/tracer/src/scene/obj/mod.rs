//! OBJ files: geometry with material names, every polygon a set of triangles.
//!
//! `tobj` reads the text that [`clean`] prepared; [`polygon`] makes the triangles, because `tobj`'s own fan is wrong on
//! concave outlines. One file yields up to four parts: with and without texture coordinates, with and without normals.

use std::collections::HashMap;
use std::path::Path;

use glam::DVec3;

use super::{SceneError, paths};

mod clean;
mod polygon;

/// What an OBJ file holds.
pub(super) struct ObjFile {
    pub(super) parts: Vec<Part>,
    /// Material names with the line of their first use; [`Part::materials`] counts them from 1.
    pub(super) materials: Vec<(String, u32)>,
    /// Arguments of `mtllib` with their lines.
    pub(super) libraries: Vec<(String, u32)>,
    pub(super) warnings: Vec<String>,
}

/// Triangles of one format.
#[derive(Default)]
pub(super) struct Part {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) normals: Option<Vec<[f32; 3]>>,
    pub(super) uvs: Option<Vec<[f32; 2]>>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// 0 where no material is named, otherwise an index into [`ObjFile::materials`] plus 1.
    pub(super) materials: Vec<u32>,
}

/// Reads an OBJ file without its materials.
///
/// # Errors
/// The file cannot be read, a line means nothing, or no triangle with an area is left.
pub(super) fn load(path: &Path) -> Result<ObjFile, SceneError> {
    let clean = clean::clean(path, &paths::read_text(path)?)?;
    let models = read_with_tobj(path, &clean)?;
    let mut parts: [Part; 4] = std::array::from_fn(|_| Part::default());
    let mut faces = Faces { lines: clean.face_lines.iter().copied(), flat: None, crossed: None, corners: Vec::new() };
    for model in &models {
        let mesh = &model.mesh;
        let (with_uv, with_normal) = (!mesh.texcoords.is_empty(), !mesh.normals.is_empty());
        let part = &mut parts[usize::from(with_uv) + 2 * usize::from(with_normal)];
        part.append(mesh, &mut faces).ok_or_else(|| SceneError::file(path, "has more than 2³² vertices"))?;
    }
    let mut warnings = Vec::new();
    for (why, &(line, count, _)) in &clean.dropped {
        warnings.push(warning(path, line, format!("{why}: {}", ignored(count))));
    }
    if let Some((line, count)) = faces.flat {
        warnings.push(warning(path, line, format!("triangles without area: {count} dropped, the first on this line")));
    }
    if let Some((line, count)) = faces.crossed {
        warnings.push(warning(path, line, format!("faces that cross themselves: {count}, the first on this line")));
    }
    let mut missing_normals = 0;
    let mut kept = Vec::new();
    for mut part in parts.into_iter().filter(|part| !part.triangles.is_empty()) {
        missing_normals += part.complete_normals();
        kept.push(part);
    }
    if missing_normals > 0 {
        let text = format!("normals without length: {missing_normals} replaced by the normal of the face");
        warnings.push(format!("{}: {text}", path.display()));
    }
    if kept.is_empty() {
        return Err(match (faces.flat, clean.dropped.first_key_value()) {
            (Some((line, count)), _) => {
                SceneError::at(path, line, format!("every triangle has zero area ({count}); nothing is left to draw"))
            }
            (None, Some((why, &(line, ..)))) => SceneError::at(path, line, format!("the file has no triangles; {why}")),
            (None, None) => SceneError::at(path, clean.lines.max(1), "the file ends here and has no faces"),
        });
    }
    Ok(ObjFile { parts: kept, materials: clean.materials, libraries: clean.libraries, warnings })
}

fn warning(path: &Path, line: u32, message: String) -> String {
    SceneError::at(path, line, message).to_string() // one format for errors and warnings
}

fn ignored(count: u32) -> String {
    if count == 1 { "ignored".to_owned() } else { format!("{count} lines ignored, the first is this") }
}

fn read_with_tobj(path: &Path, clean: &clean::Clean) -> Result<Vec<tobj::Model>, SceneError> {
    // `usemtl` holds an index instead of a name; this library defines them all, so a model's material id is the index.
    let text = format!("mtllib names\n{}", clean.text);
    let names = |_: &Path| {
        let named = |i: usize| tobj::Material { name: i.to_string(), ..tobj::Material::default() };
        let materials: Vec<tobj::Material> = (0..clean.materials.len()).map(named).collect();
        let index: HashMap<String, usize> = (0..clean.materials.len()).map(|i| (i.to_string(), i)).collect();
        Ok((materials, index))
    };
    let options = tobj::LoadOptions { single_index: true, ..tobj::LoadOptions::default() };
    tobj::load_obj_buf(&mut text.as_bytes(), &options, names).map(|(models, _)| models).map_err(|error| {
        match clean.forward {
            Some(line) => SceneError::at(path, line, "a face uses a vertex that is only defined further down"),
            None => SceneError::file(path, format!("cannot be read: {error}")),
        }
    })
}

/// Where we are among the file's faces, and what was wrong with them: first line and count.
struct Faces<L> {
    lines: L,
    flat: Option<(u32, u32)>,
    crossed: Option<(u32, u32)>,
    corners: Vec<[usize; 3]>,
}

fn count(tally: &mut Option<(u32, u32)>, line: u32) {
    tally.get_or_insert((line, 0)).1 += 1;
}

impl Part {
    /// Adds the triangles of one `tobj` model; `None` if vertices outgrow their index.
    fn append(&mut self, mesh: &tobj::Mesh, faces: &mut Faces<impl Iterator<Item = u32>>) -> Option<()> {
        let base = u32::try_from(self.positions.len()).ok()?;
        self.positions.extend(mesh.positions.as_chunks().0);
        u32::try_from(self.positions.len()).ok()?;
        if !mesh.texcoords.is_empty() {
            let uvs = mesh.texcoords.as_chunks().0.iter().map(|uv: &[f64; 2]| uv.map(|x| x as f32));
            self.uvs.get_or_insert_default().extend(uvs);
        }
        if !mesh.normals.is_empty() {
            let normals = mesh.normals.as_chunks().0.iter().map(|&normal| unit(DVec3::from_array(normal)));
            self.normals.get_or_insert_default().extend(normals);
        }
        let material = mesh.material_id.map_or(0, |id| id as u32 + 1);
        let mut arities = mesh.face_arities.iter().map(|&arity| arity as usize);
        let mut rest = &mesh.indices[..];
        let mut points = Vec::new();
        while !rest.is_empty() {
            let arity = if mesh.face_arities.is_empty() { 3 } else { arities.next()? };
            let (face, after) = rest.split_at_checked(arity)?;
            rest = after;
            let line = faces.lines.next().unwrap_or(0);
            points.clear();
            points.extend(face.iter().map(|&i| DVec3::from_array(self.positions[(base + i) as usize])));
            faces.corners.clear();
            if !polygon::triangulate(&points, &mut faces.corners) {
                count(&mut faces.crossed, line);
            }
            if faces.corners.is_empty() {
                count(&mut faces.flat, line);
            }
            for corners in &faces.corners {
                if has_area(corners.map(|corner| points[corner])) {
                    self.triangles.push(corners.map(|corner| base + face[corner]));
                    self.materials.push(material);
                } else {
                    count(&mut faces.flat, line);
                }
            }
        }
        Some(())
    }

    /// Gives each vertex whose normal had no length the normal of a face; returns how many.
    fn complete_normals(&mut self) -> usize {
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
fn unit(v: DVec3) -> [f32; 3] {
    let largest = v.abs().max_element();
    if largest > 0.0 { (v / largest).normalize().as_vec3().to_array() } else { [0.0; 3] }
}

/// Whether the corners span more than the rounding of their coordinates.
fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    let largest = a.abs().max(b.abs()).max(c.abs()).max_element();
    let edge = (b - a).length().max((c - a).length()).max((c - b).length());
    (b - a).cross(c - a).length() > 4.0 * f64::EPSILON * largest * edge
}
