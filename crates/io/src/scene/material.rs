//! `[materials.NAME]` of a scene file, and the material file that holds the same table alone.
//!
//! The models, their keys, ranges and defaults are those that the kernel declares: nothing here names a parameter of theirs.

use std::path::Path;

use gonio_kernel::lobe::{AnyLobe, Coating};
use gonio_kernel::model::{Entry, Model, Parameter, Problem, Quantity, Role, Source, Words, each_key};
use gonio_kernel::{Lobe, Parameters, Rgb, Vec3};
use gonio_tracer::scene::{LobeSpec, MAX_RADIANCE, Material, NormalMapSpec};
use gonio_tracer::{MOST_COATS, MOST_LOBES};

use super::document::{Document, Table, Value};
use crate::error::{SceneError, quoted};
use crate::paths;
use crate::textures::Textures;

/// Largest factor on the slopes of a normal map.
const MAX_NORMAL_SCALE: f64 = 10.0;
/// Combinations of models, by name.
const COMBINATIONS: [&str; 2] = ["mix", "layered"];

/// Reads a material file: the keys of a scene's `[materials.NAME]` table, without that header.
///
/// The material is called after the file. Images are not possible here, because they belong to a scene.
///
/// ```
/// let brass = gonio_io::material_from_toml_str("type = \"mirror\"", "brass.toml".as_ref())?;
/// assert_eq!((brass.name.as_str(), brass.lobes.len()), ("brass", 1));
/// # Ok::<(), gonio_io::SceneError>(())
/// ```
///
/// # Errors
/// The syntax, an unknown key, or a value out of range, with the line.
pub fn material_from_toml_str(text: &str, path: &Path) -> Result<Material, SceneError> {
    let document = Document { path, text };
    let parsed = document.parse()?;
    let table = Table::new(document, "the material", 0, parsed.get_ref());
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut context = Context { textures: None, warn: &mut |_| () };
    read(&name, &table, &mut context)
}

/// What reading a material needs beside its table.
pub(super) struct Context<'c> {
    /// Where images go; without it they are refused.
    pub(super) textures: Option<&'c mut Textures>,
    /// What is read otherwise than it is written.
    pub(super) warn: &'c mut dyn FnMut(String),
}

/// Reads one material.
pub(super) fn read(name: &str, table: &Table<'_>, context: &mut Context<'_>) -> Result<Material, SceneError> {
    let emission = optional(table.get("emission"), |v| v.rgb(0.0..=MAX_RADIANCE))?.unwrap_or(Rgb::splat(0.0));
    let two_sided = optional(table.get("two_sided"), |v| v.boolean())?.unwrap_or(true);
    let normal_map = normal_map(table, context.textures.as_deref_mut())?;
    let lobes = lobes(table, context)?;
    if lobes.len() > MOST_LOBES {
        return Err(table.error(format!(
            "{} has {} lobes; at most {MOST_LOBES} are possible",
            table.name(),
            lobes.len()
        )));
    }
    let coats = lobes.iter().filter(|lobe| lobe.coat.is_some()).count();
    if coats > MOST_COATS {
        return Err(table.error(format!("{} has {coats} coats; at most {MOST_COATS} are possible", table.name())));
    }
    // What lies below a coat receives what the coat leaves: only lobes side by side can reflect too much together.
    let beside = lobes.iter().filter(|lobe| lobe.coat.is_none());
    let sum = beside.fold(Rgb::splat(0.0), |sum, l| sum + l.lobe.albedo_estimate(Vec3::unit_z()) * l.weight);
    if sum.largest() > 1.0001 {
        // The margin covers decimal fractions rounded to f32.
        let text =
            format!("{} reflects {} of the light; the sum over its lobes is at most 1", table.name(), sum.largest());
        return Err(table.error(text));
    }
    Ok(Material { emission, two_sided, normal_map, ..Material::new(name, lobes) })
}

/// The lobes of a table, whatever its type, from the top down.
fn lobes(table: &Table<'_>, context: &mut Context<'_>) -> Result<Vec<LobeSpec>, SceneError> {
    let lobes = match kind(table)? {
        "mix" => {
            let value = table.get("lobes").ok_or_else(|| table.error("a mix needs \"lobes\", an array of tables"))?;
            let items = value.array()?;
            if items.is_empty() || items.len() > MOST_LOBES {
                return Err(value.error(format!("a mix has 1 to {MOST_LOBES} lobes, not {}", items.len())));
            }
            let mut lobes = Vec::new();
            for (number, item) in (1..).zip(&items) {
                let inner = item.table(&format!("lobe {number} of {}", table.name()))?;
                lobes.push(lobe(&inner, context)?);
                inner.finish()?;
            }
            lobes
        }
        "layered" => layered(table, context)?,
        _ => vec![lobe(table, context)?],
    };
    table.finish()?;
    Ok(lobes)
}

/// A dielectric coat over whatever `base` is.
fn layered(table: &Table<'_>, context: &mut Context<'_>) -> Result<Vec<LobeSpec>, SceneError> {
    let base = table.get("base").ok_or_else(|| table.error("a layered material needs a \"base\", a table"))?;
    let base = base.table(&format!("the base of {}", table.name()))?;
    let (coating, textured) = Keys::new(table, context).read::<Coating<f64>>()?;
    if let Some((key, _)) = textured.first() {
        return Err(table.error(format!("\"{key}\" of a coat takes no image")));
    }
    let coating = coating.map(&mut |_, _, x| x as f32);
    let mut all = vec![LobeSpec::new(coating.lobe()).as_coat(coating.layering)];
    let below = lobes(&base, context)?;
    let white = coating.color == Rgb::splat(1.0);
    if !white && below.iter().any(|lobe| lobe.coat.is_some()) {
        // A factor on a coat is how much of the surface it covers.
        return Err(
            table.error("\"color\" is that of the innermost coat: a coloured coat over a layered base is not possible")
        );
    }
    for lobe in below {
        all.push(LobeSpec { weight: lobe.weight * coating.color, ..lobe });
    }
    Ok(all)
}

/// One lobe: a model of the kernel.
fn lobe(table: &Table<'_>, context: &mut Context<'_>) -> Result<LobeSpec, SceneError> {
    table.know("type");
    let weight = optional(table.get("weight"), |v| v.rgb(0.0..=1.0))?.unwrap_or(Rgb::splat(1.0));
    let (lobe, textured) = Keys::new(table, context).read::<AnyLobe<'static, f64>>()?;
    // Read in f64, so that alpha = roughness² is rounded once.
    let spec = LobeSpec { weight, ..LobeSpec::new(lobe.map(&mut |_, _, x| x as f32)) };
    Ok(textured.into_iter().fold(spec, |spec, (key, texture)| spec.with_texture(key, texture)))
}

fn kind<'d>(table: &Table<'d>) -> Result<&'d str, SceneError> {
    optional(table.get("type"), |v| v.string()).map(|kind| kind.unwrap_or("diffuse"))
}

fn optional<'d, T>(
    value: Option<Value<'d>>,
    read: impl Fn(&Value<'d>) -> Result<T, SceneError>,
) -> Result<Option<T>, SceneError> {
    value.as_ref().map(read).transpose()
}

/// Which keys are multiplied by which image.
type Textured = Vec<(&'static str, usize)>;

/// The keys of a table as a source of parameters.
struct Keys<'a, 'd, 'c> {
    table: &'a Table<'d>,
    context: &'a mut Context<'c>,
    model: &'d str,
    textured: Textured,
}

impl<'a, 'd, 'c> Keys<'a, 'd, 'c> {
    fn new(table: &'a Table<'d>, context: &'a mut Context<'c>) -> Self {
        Self { table, context, model: kind(table).unwrap_or_default(), textured: Vec::new() }
    }

    fn read<P: Parameters<Real = f64>>(mut self) -> Result<(P, Textured), SceneError> {
        // Every key of the model is known, whichever of its ways is given.
        each_key(P::ENTRIES, &mut |key| self.table.know(key));
        AnyLobe::<f64>::each_model(&mut |info| {
            if info.name == self.model {
                each_key(info.entries, &mut |key| self.table.know(key));
            }
        });
        let read = P::read(&mut self)?;
        Ok((read, self.textured))
    }

    /// A colour from an image: the constant is what multiplies it.
    fn image(&mut self, value: &Value<'_>, parameter: &'static Parameter) -> Result<Rgb<f64>, SceneError> {
        let table = value.table(&format!("\"{}\"", value.name))?;
        let file = table.get("texture").ok_or_else(|| table.error("a colour table needs \"texture\""))?;
        let scale = optional(table.get("scale"), |v| v.rgb(0.0..=parameter.quantity.hi))?.unwrap_or(Rgb::splat(1.0));
        table.finish()?;
        self.textured.push((parameter.key, image(&file, self.context.textures.as_deref_mut(), Textures::load)?));
        Ok(scale.map(f64::from))
    }
}

impl Source<f64> for Keys<'_, '_, '_> {
    type Error = SceneError;

    fn model(&self) -> &str {
        self.model
    }
    fn has(&self, key: &str) -> bool {
        self.table.has(key)
    }
    fn number(&mut self, parameter: &'static Parameter) -> Result<Option<f64>, SceneError> {
        let Some(value) = self.table.get(parameter.key) else { return Ok(None) };
        let Quantity { lo, hi, role, .. } = parameter.quantity;
        value.number(lo..=hi).map(Some).map_err(|error| {
            let too_smooth = matches!(role, Role::Alpha | Role::Roughness) && value.number(0.0..=lo).is_ok();
            let hint = "; what is smooth is a \"mirror\", a \"smooth-conductor\" or a \"dielectric\" without roughness";
            SceneError { message: error.message.clone() + if too_smooth { hint } else { "" }, ..error }
        })
    }
    fn color(&mut self, parameter: &'static Parameter) -> Result<Option<Rgb<f64>>, SceneError> {
        let Some(value) = self.table.get(parameter.key) else { return Ok(None) };
        if value.is_table() {
            return self.image(&value, parameter).map(Some);
        }
        value.rgb_f64(parameter.quantity.lo..=parameter.quantity.hi).map(Some)
    }
    fn word(&mut self, words: &'static Words) -> Result<Option<usize>, SceneError> {
        let Some(value) = self.table.get(words.key) else { return Ok(None) };
        let word = value.string()?;
        let Some(which) = words.find(word) else {
            let text = format!("\"{}\" cannot be \"{word}\"; known are {}", words.key, quoted(words.each()));
            return Err(value.error(text));
        };
        if let Some(now) = words.each().nth(which).filter(|now| *now != word) {
            let text = format!("\"{word}\" is an older word for the {} \"{now}\"", words.key);
            (self.context.warn)(value.error(text).to_string());
        }
        Ok(Some(which))
    }
    fn refuse(&mut self, problem: Problem) -> SceneError {
        match problem {
            Problem::OneOf(ways) => self.table.error(format!("{} needs one of {}", self.table.name(), spelled(ways))),
            Problem::Missing(key) => self.table.error(format!("{} needs \"{key}\"", self.table.name())),
            Problem::Rule(text) => self.table.error(text),
            Problem::UnknownModel => {
                let mut known: Vec<&str> = Vec::new();
                AnyLobe::<f64>::each_model(&mut |info| {
                    if !known.contains(&info.name) {
                        known.push(info.name);
                    }
                });
                let known = quoted(known.into_iter().chain(COMBINATIONS));
                let text = format!("type \"{}\" is not possible here; known are {known}", self.model);
                self.table.get("type").map_or_else(|| self.table.error(text.clone()), |value| value.error(text.clone()))
            }
            other => self.table.error(format!("{other:?}")),
        }
    }
}

/// The ways in words: `"eta" with "k", "f0", or "metal"`.
fn spelled(ways: &'static [&'static [Entry]]) -> String {
    let way = |way: &&'static [Entry]| {
        let mut keys = Vec::new();
        each_key(way, &mut |key| keys.push(format!("\"{key}\"")));
        (!keys.is_empty()).then(|| keys.join(" with "))
    };
    let mut each: Vec<String> = ways.iter().filter_map(way).collect();
    match (each.pop(), each.is_empty()) {
        (Some(last), false) => format!("{}, or {last}", each.join(", ")),
        (last, _) => last.unwrap_or_default(),
    }
}

/// `normal_map = "file.png"`, and how steep it is.
fn normal_map(table: &Table<'_>, textures: Option<&mut Textures>) -> Result<Option<NormalMapSpec>, SceneError> {
    let (file, scale) = (table.get("normal_map"), table.get("normal_scale"));
    let Some(file) = file else {
        return scale.map_or(Ok(None), |scale| Err(scale.error("\"normal_scale\" needs a \"normal_map\"")));
    };
    let scale = optional(scale, |v| v.number(0.0..=MAX_NORMAL_SCALE))?.unwrap_or(1.0) as f32;
    let map = image(&file, textures, Textures::load_normals)?;
    Ok(Some(NormalMapSpec { map, scale }))
}

/// The index of the image that a value names.
fn image(
    file: &Value<'_>,
    textures: Option<&mut Textures>,
    load: impl Fn(&mut Textures, &Path) -> Result<usize, SceneError>,
) -> Result<usize, SceneError> {
    let Some(textures) = textures else {
        return Err(file.error("an image is only possible in a scene file"));
    };
    let name = file.string()?;
    let path = paths::find(file.document().path, name)
        .ok_or_else(|| file.error(format!("the image \"{name}\" does not exist")))?;
    load(textures, &path).map_err(|error| file.error(error.to_string()))
}

#[cfg(test)]
mod tests;
