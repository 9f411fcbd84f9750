//! The scene file: its sections and keys; defaults are those of the description. `docs/scene-format.md` is written from this file.

use std::path::Path;

use gonio_tracer::scene::{CameraSpec, FilmSettings, IntegratorSettings, Loading, Scene};

use super::build::{Assignment, Builder};
use super::document::{Document, Table, Value};
use super::{environment, material, transform};
use crate::error::{SceneError, quoted};
use crate::paths;

/// Reads a scene file and everything it names.
pub(super) fn read(text: &str, path: &Path, progress: &mut dyn FnMut(Loading)) -> Result<Scene, SceneError> {
    let document = Document { path, text };
    let parsed = document.parse()?;
    let root = Table::new(document, "the scene", 0, parsed.get_ref());
    let section = |key: &'static str| root.get(key).map(|value| value.table(&format!("[{key}]"))).transpose();
    let film = film(section("film")?)?;
    let camera_table = section("camera")?;
    let camera = camera(camera_table.as_ref())?;
    let integrator = integrator(section("integrator")?)?;
    let environment = section("environment")?;
    let materials = section("materials")?;
    let meshes = root.get("meshes");
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
    let meshes = match &meshes {
        Some(value) => value.array()?,
        None => Vec::new(),
    };
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
    Ok(builder.finish(film, camera, integrator, environment))
}

/// The value of an optional key.
fn or<'d, T>(
    value: Option<Value<'d>>,
    default: T,
    read: impl FnOnce(&Value<'d>) -> Result<T, SceneError>,
) -> Result<T, SceneError> {
    value.as_ref().map_or(Ok(default), read)
}

fn film(table: Option<Table<'_>>) -> Result<FilmSettings, SceneError> {
    let mut film = FilmSettings::default();
    let Some(table) = table else { return Ok(film) };
    let whole = |value: &Value<'_>, most: u64| value.integer(1..=most).map(|number| number as u32);
    film.width = or(table.get("width"), film.width, |v| whole(v, 65_536))?;
    film.height = or(table.get("height"), film.height, |v| whole(v, 65_536))?;
    film.spp = or(table.get("spp"), film.spp, |v| whole(v, 1 << 20))?;
    film.exposure = or(table.get("exposure"), film.exposure, |v| v.number(-100.0..=100.0).map(|stops| stops as f32))?;
    table.finish()?;
    Ok(film)
}

fn camera(table: Option<&Table<'_>>) -> Result<CameraSpec, SceneError> {
    let Some(table) = table else { return Ok(CameraSpec::default()) };
    let vector = |key| table.get(key).map(|value| value.vector()).transpose();
    let camera = CameraSpec {
        origin: vector("origin")?,
        target: vector("target")?,
        up: vector("up")?,
        vfov: or(table.get("vfov"), None, |v| v.number(0.01..=179.0).map(Some))?,
    };
    table.finish()?;
    Ok(camera)
}

fn integrator(table: Option<Table<'_>>) -> Result<IntegratorSettings, SceneError> {
    let mut settings = IntegratorSettings::default();
    let Some(table) = table else { return Ok(settings) };
    settings.max_depth = or(table.get("max_depth"), settings.max_depth, |v| v.integer(0..=1024).map(|n| n as u32))?;
    settings.russian_roulette = or(table.get("russian_roulette"), settings.russian_roulette, Value::boolean)?;
    settings.seed = or(table.get("seed"), settings.seed, |v| v.integer(0..=u64::MAX))?;
    table.finish()?;
    Ok(settings)
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
