//! OBJ files: geometry with material names, every polygon a set of triangles.
//!
//! [`lines`] hands out the statements of a file of any size, [`statements`] says what they mean, [`part`] makes vertices
//! of the corners of faces, and [`polygon`] makes triangles of them. One file yields up to four parts: with and without
//! texture coordinates, with and without normals.
//!
//! The crate `tobj` read these files before, from a copy of the text in which every line had been checked, because
//! it gives no line numbers and misreads some inputs without a word. The check already knew every number; without the
//! copies, ten million triangles load ten times as fast.

use std::fs::File;
use std::path::Path;

use crate::SceneError;

mod lines;
mod part;
mod polygon;
mod statements;

use lines::{Lines, Survey};
pub(crate) use part::Part;
use statements::Reader;

/// What an OBJ file holds.
pub(crate) struct ObjFile {
    pub(crate) parts: Vec<Part>,
    /// Material names with the line of their first use; [`Part::materials`] counts them from 1.
    pub(crate) materials: Vec<(String, u32)>,
    /// Arguments of `mtllib` with their lines.
    pub(crate) libraries: Vec<(String, u32)>,
    pub(crate) warnings: Vec<String>,
}

/// Reads an OBJ file without its materials; `progress` is told how many bytes are done, and of how many.
///
/// # Errors
/// The file cannot be read, a line means nothing, or no triangle with an area is left.
pub(crate) fn load(path: &Path, progress: &mut dyn FnMut(u64, u64)) -> Result<ObjFile, SceneError> {
    let unreadable = |error: std::io::Error| SceneError::file(path, format!("cannot be read: {error}"));
    let file = File::open(path).map_err(unreadable)?;
    let size = file.metadata().map_err(unreadable)?.len();
    progress(0, size);
    let survey = Survey::of(path, &file)?;
    let mut lines = Lines::new(path, &file, &survey)?;
    let mut reader = Reader::new(path, &survey);
    reader.read(&mut lines, &mut |bytes| progress(bytes, size))?;
    progress(size, size);

    let mut warnings = Vec::new();
    for (why, &(line, count, _)) in &reader.dropped {
        warnings.push(warning(path, line, format!("{why}: {}", ignored(count))));
    }
    let (flat, crossed) = (reader.faults.flat, reader.faults.crossed);
    if let Some((line, count)) = flat {
        warnings.push(warning(path, line, format!("triangles without area: {count} dropped, the first on this line")));
    }
    if let Some((line, count)) = crossed {
        warnings.push(warning(
            path,
            line,
            format!("faces that cross themselves or are too intricate: {count}, the first on this line"),
        ));
    }
    let nothing = match (flat, reader.dropped.first_key_value()) {
        (Some((line, count)), _) => (line, format!("every triangle has zero area ({count}); nothing is left to draw")),
        (None, Some((why, &(line, ..)))) => (line, format!("the file has no triangles; {why}")),
        (None, None) => (lines.number.max(1), "the file ends here and has no faces".to_owned()),
    };
    let (materials, libraries) = (std::mem::take(&mut reader.materials), std::mem::take(&mut reader.libraries));
    let mut missing_normals = 0;
    let mut parts = Vec::new();
    for mut part in reader.into_parts().into_iter().filter(|part| !part.triangles.is_empty()) {
        missing_normals += part.finish();
        parts.push(part);
    }
    if missing_normals > 0 {
        let text = format!("normals without length: {missing_normals} replaced by the normal of the face");
        warnings.push(format!("{}: {text}", path.display()));
    }
    if parts.is_empty() {
        return Err(SceneError::at(path, nothing.0, nothing.1));
    }
    Ok(ObjFile { parts, materials, libraries, warnings })
}

fn warning(path: &Path, line: u32, message: String) -> String {
    SceneError::at(path, line, message).to_string() // one format for errors and warnings
}

fn ignored(count: u32) -> String {
    if count == 1 { "ignored".to_owned() } else { format!("{count} lines ignored, the first is this") }
}
