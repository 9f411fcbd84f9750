//! The scene file: its sections and keys; defaults are those of the description. `docs/scene-format.md` is written from this file.

use std::path::Path;
use std::sync::Arc;

use gonio_tracer::light::{self, LightSource};
use gonio_tracer::scene::fields::{Fields, Refusal};
use gonio_tracer::scene::{CameraSpec, FilmSettings, IntegratorSettings, Loading, Scene};

use super::build::{Assignment, Builder};
use super::document::{Document, Table, Value};
use super::{environment, fields, material, transform};
use crate::error::{SceneError, quoted};
use crate::paths;

/// Reads a scene file and everything it names.
pub(super) fn read(text: &str, path: &Path, progress: &mut dyn FnMut(Loading)) -> Result<Scene, SceneError> {
    let document = Document { path, text };
    let parsed = document.parse()?;
    let root = Table::new(document, "the scene", 0, parsed.get_ref());
    let section = |key: &'static str| root.get(key).map(|value| value.table(&format!("[{key}]"))).transpose();
    let film = or_default(section("film")?.as_mut(), FilmSettings::read)?;
    let mut camera_table = section("camera")?;
    let camera = or_default(camera_table.as_mut(), CameraSpec::read)?;
    let integrator = or_default(section("integrator")?.as_mut(), IntegratorSettings::read)?;
    let environment = section("environment")?;
    let materials = section("materials")?;
    let (meshes, lights) = (root.get("meshes"), root.get("lights"));
    root.finish()?;

    let mut builder = Builder::default();
    let environment = environment::read(environment, &mut |text| builder.warn(text))?;
    for (name, _, value) in materials.iter().flat_map(Table::entries) {
        let table = value.table(&format!("material \"{name}\""))?;
        let mut older = Vec::new();
        let mut context =
            material::Context { textures: Some(&mut builder.textures), warn: &mut |text| older.push(text) };
        let material = material::read(name, &table, &mut context)?;
        older.into_iter().for_each(|text| builder.warn(text));
        builder.define(material).map_err(|why| value.error(why))?;
    }
    let (meshes, lights) = (each(meshes.as_ref())?, each(lights.as_ref())?);
    if meshes.is_empty() {
        return Err(document.error(0, "the scene has no [[meshes]]: there is nothing to render"));
    }
    for value in &meshes {
        mesh(value, &mut builder, progress)?;
    }
    let (width, height) = (f64::from(film.width), f64::from(film.height));
    let camera = camera
        .complete(builder.bounds, width / height)
        .map_err(|error| error.to_string())
        .map_err(|why| camera_table.map_or_else(|| document.error(0, &*why), |table| table.error(&*why)))?;
    let lights = lights.iter().map(light).collect::<Result<_, _>>()?;
    Ok(builder.finish(film, camera, integrator, environment, lights))
}

/// The items of an array that may be left out.
fn each<'d>(value: Option<&Value<'d>>) -> Result<Vec<Value<'d>>, SceneError> {
    value.map_or(Ok(Vec::new()), Value::array)
}

/// A section that may be left out.
fn or_default<T: Default>(
    table: Option<&mut Table<'_>>,
    read: fn(&mut dyn Fields) -> Result<T, Refusal>,
) -> Result<T, SceneError> {
    table.map_or_else(|| Ok(T::default()), |table| fields::read(table, read))
}

/// The value of an optional key.
fn or<'d, T>(
    value: Option<Value<'d>>,
    default: T,
    read: impl FnOnce(&Value<'d>) -> Result<T, SceneError>,
) -> Result<T, SceneError> {
    value.as_ref().map_or(Ok(default), read)
}

/// One of `[[lights]]`.
fn light(value: &Value<'_>) -> Result<Arc<dyn LightSource>, SceneError> {
    let mut table = value.table("[[lights]]")?;
    let known = || quoted(light::KINDS.iter().map(|(name, _)| *name));
    let kind =
        table.get("type").ok_or_else(|| table.error(format!("[[lights]] needs \"type\", one of {}", known())))?;
    let name = kind.string()?;
    let Some((_, read)) = light::KINDS.iter().find(|(known, _)| *known == name) else {
        return Err(kind.error(format!("there is no light \"{name}\"; known are {}", known())));
    };
    fields::read(&mut table, read)
}

fn mesh(value: &Value<'_>, builder: &mut Builder, progress: &mut dyn FnMut(Loading)) -> Result<(), SceneError> {
    let table = value.table("[[meshes]]")?;
    let file = table.get("file").ok_or_else(|| table.error("[[meshes]] needs \"file\""))?;
    let (all, renamed, steps) = (table.get("material"), table.get("materials"), table.get("transform"));
    table.finish()?;

    let look_up = |value: &Value<'_>| {
        let name = value.string()?;
        builder.defined(name).ok_or_else(|| {
            let known = quoted(builder.defined_names());
            value.error(format!("material \"{name}\" is not defined; defined are {known}"))
        })
    };
    let mut assignment = Assignment { all: all.as_ref().map(look_up).transpose()?, renamed: Vec::new() };
    let renames = renamed.as_ref().map(|value| value.table("\"materials\"")).transpose()?;
    let renames = renames.iter().flat_map(Table::entries).collect::<Vec<_>>();
    for (obj_name, _, value) in &renames {
        assignment.renamed.push(((*obj_name).to_owned(), look_up(value)?));
    }
    let transform = or(steps, glam::DAffine3::IDENTITY, transform::read)?;

    let name = file.string()?;
    if !name.to_ascii_lowercase().ends_with(".obj") {
        return Err(file.error(format!("\"{name}\" is not an OBJ file, the only kind that is read")));
    }
    let path = paths::find(file.document().path, name)
        .ok_or_else(|| file.error(format!("the file \"{name}\" does not exist")))?;
    let used = builder.place(&path, &assignment, transform, |why| file.error(why), progress)?;
    match renames.iter().find(|(obj_name, ..)| !used.iter().any(|name| name == obj_name)) {
        None => Ok(()),
        Some((obj_name, _, value)) => {
            let known = quoted(used.iter().map(String::as_str));
            Err(value.error(format!("\"{name}\" has no material \"{obj_name}\"; it has {known}")))
        }
    }
}
