//! Scenes from files: a TOML scene file (`docs/scene-format.md` lists every key with its unit and default), or an OBJ file alone,
//! which then gets an automatic camera and a white sky.
//!
//! Whatever leaves this module is checked: all numbers are finite and in their ranges, all indices point at something, every
//! mesh has a triangle with an area. Bad input is a [`SceneError`] that names file and line; what a viewer would tolerate is
//! loaded with a sentence in [`Scene::warnings`].

use std::path::Path;

use glam::DAffine3;
use gonio_kernel::Rgb;
use gonio_tracer::scene::{CameraSpec, Environment, FilmSettings, IntegratorSettings, Loading, Scene};

use crate::{SceneError, paths};

mod build;
mod document;
mod environment;
mod fields;
mod file;
mod material;
mod nesting;
mod transform;

pub use material::material_from_toml_str;

/// Reads a scene file (`.toml`), or an OBJ file alone (`.obj`) under a white sky with an automatic camera.
///
/// # Errors
/// Anything that cannot be rendered as written, with file and line.
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    load_with(path, &mut |_| ())
}

/// Like [`load`]; `progress` is told how much of each OBJ file is read.
///
/// # Errors
/// Anything that cannot be rendered as written, with file and line.
pub fn load_with(path: &Path, progress: &mut dyn FnMut(Loading)) -> Result<Scene, SceneError> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    match extension.to_ascii_lowercase().as_str() {
        "toml" => file::read(&paths::read_text(path)?, path, progress),
        "obj" => from_obj(path, progress),
        _ => Err(SceneError::file(path, "is neither a scene file (.toml) nor an OBJ file (.obj)")),
    }
}

/// Reads a scene file from its text; files it names are looked for beside `path`.
///
/// # Errors
/// Anything that cannot be rendered as written, with file and line.
pub fn scene_from_toml_str(text: &str, path: &Path) -> Result<Scene, SceneError> {
    file::read(text, path, &mut |_| ())
}

fn from_obj(path: &Path, progress: &mut dyn FnMut(Loading)) -> Result<Scene, SceneError> {
    let mut builder = build::Builder::default();
    let blame = |why: String| SceneError::at(path, 1, why);
    builder.place(path, &build::Assignment::default(), DAffine3::IDENTITY, blame, progress)?;
    let film = FilmSettings::default();
    let aspect = f64::from(film.width) / f64::from(film.height);
    let camera = CameraSpec::default().complete(builder.bounds, aspect).map_err(|why| blame(why.to_string()))?;
    Ok(builder.finish(film, camera, IntegratorSettings::default(), Environment::constant(Rgb::splat(1.0)), Vec::new()))
}
