//! Why a file was refused: always which, and the line wherever a line is to blame.

use std::path::{Path, PathBuf};

/// Input that cannot be rendered as written.
///
/// It prints as `scene.toml:14: material "brass" is not defined; defined are "white", "red"`. Without a line (a file
/// that cannot be opened) it prints as `mesh.obj: …`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{}: {message}", .path.display(), line_suffix(*.line))]
pub struct SceneError {
    /// The file as it was named to the loader.
    pub path: PathBuf,
    /// The line to blame, counted from 1.
    pub line: Option<u32>,
    /// What is wrong, and where it helps, what would be right.
    pub message: String,
}

impl SceneError {
    /// Blames one line, counted from 1.
    pub fn at(path: &Path, line: u32, message: impl Into<String>) -> Self {
        Self { path: path.to_path_buf(), line: Some(line), message: message.into() }
    }

    /// Blames the whole file.
    pub fn file(path: &Path, message: impl Into<String>) -> Self {
        Self { path: path.to_path_buf(), line: None, message: message.into() }
    }
}

/// Why a picture could not be written or read. It prints as `out/a.exr: cannot be written: …`.
#[derive(Debug, thiserror::Error)]
#[error("{}: {message}", .path.display())]
pub struct ImageError {
    /// The picture's file.
    pub path: PathBuf,
    /// What went wrong.
    pub message: String,
}

impl ImageError {
    /// Blames a file.
    pub(crate) fn of(path: &Path, message: impl Into<String>) -> Self {
        Self { path: path.to_path_buf(), message: message.into() }
    }
}

fn line_suffix(line: Option<u32>) -> String {
    line.map_or_else(String::new, |line| format!(":{line}"))
}

/// Writes `"a", "b"` for messages; long lists end in a count.
pub(crate) fn quoted<'a>(names: impl Iterator<Item = &'a str>) -> String {
    const SHOWN: usize = 12; // a line that still fits a terminal
    let all: Vec<String> = names.map(|name| format!("\"{name}\"")).collect();
    match all.len() {
        0 => "none".to_owned(),
        n if n <= SHOWN => all.join(", "),
        n => format!("{} and {} more", all[..SHOWN].join(", "), n - SHOWN),
    }
}
