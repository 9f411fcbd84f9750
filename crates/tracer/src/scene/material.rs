//! `[materials.NAME]` of a scene file, and the material file that holds the same table alone.

use std::path::Path;

use gonio_kernel::Rgb;

use super::document::{Document, Table, Value};
use super::error::quoted;
use super::textures::Textures;
use super::{Color, FresnelSpec, LobeSpec, MAX_RADIANCE, MIN_ALPHA, Material, Model, SceneError, paths};

/// Largest number of lobes of one material.
const MAX_LOBES: usize = 4;
/// Largest width of microfacets.
const MAX_ALPHA: f64 = 1.0;

impl Material {
    /// Reads a material file: the keys of a scene's `[materials.NAME]` table, without that header.
    ///
    /// The material is called after the file. Images are not possible here, because they belong to a scene.
    ///
    /// # Errors
    /// The syntax, an unknown key, or a value out of range, with the line.
    pub fn from_toml_str(text: &str, path: &Path) -> Result<Self, SceneError> {
        let document = Document { path, text };
        let parsed = document.parse()?;
        let table = Table::new(document, "the material", 0, parsed.get_ref());
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        read(&name, &table, None)
    }
}

/// Reads one material; without `textures`, images are refused.
pub(super) fn read(name: &str, table: &Table<'_>, mut textures: Option<&mut Textures>) -> Result<Material, SceneError> {
    let emission = optional(table.get("emission"), |v| v.rgb(0.0..=MAX_RADIANCE))?.unwrap_or(Rgb::splat(0.0));
    let two_sided = optional(table.get("two_sided"), |v| v.boolean())?.unwrap_or(true);
    let kind = kind(table)?;
    let lobes = if kind == "mix" {
        let value = table.get("lobes").ok_or_else(|| table.error("a mix needs \"lobes\", an array of tables"))?;
        let items = value.array()?;
        if items.is_empty() || items.len() > MAX_LOBES {
            return Err(value.error(format!("a mix has 1 to {MAX_LOBES} lobes, not {}", items.len())));
        }
        let mut lobes = Vec::new();
        for (number, item) in (1..).zip(&items) {
            let inner = item.table(&format!("lobe {number} of {}", table.name()))?;
            let inner_kind = self::kind(&inner)?;
            lobes.push(lobe(&inner, inner_kind, textures.as_deref_mut())?);
            inner.finish()?;
        }
        lobes
    } else {
        vec![lobe(table, kind, textures)?]
    };
    table.finish()?;
    let sum = lobes.iter().fold(Rgb::splat(0.0), |sum, lobe| sum + reflectance(&lobe.model) * lobe.weight);
    if sum.largest() > 1.0001 {
        // The margin covers decimal fractions rounded to f32.
        let text =
            format!("{} reflects {} of the light; the sum over its lobes is at most 1", table.name(), sum.largest());
        return Err(table.error(text));
    }
    Ok(Material { name: name.to_owned(), lobes, emission, two_sided })
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

fn lobe(table: &Table<'_>, kind: &str, textures: Option<&mut Textures>) -> Result<LobeSpec, SceneError> {
    let weight = optional(table.get("weight"), |v| v.number(0.0..=1.0))?.unwrap_or(1.0) as f32;
    let model = match kind {
        "diffuse" => Model::Diffuse { base_color: color(table.get("base_color"), 0.8, textures)? },
        "mirror" => Model::Mirror { reflectance: color(table.get("reflectance"), 1.0, textures)? },
        "conductor" => conductor(table)?,
        _ => {
            let known = quoted(["diffuse", "mirror", "conductor", "mix"].into_iter());
            let blame = table.get("type").map_or_else(|| table.error(""), |value| value.error(""));
            return Err(SceneError {
                message: format!("type \"{kind}\" is not possible here; known are {known}"),
                ..blame
            });
        }
    };
    Ok(LobeSpec { weight, model })
}

fn conductor(table: &Table<'_>) -> Result<Model, SceneError> {
    let f0 = optional(table.get("f0"), |v| v.rgb(0.0..=1.0))?;
    let eta = optional(table.get("eta"), |v| v.rgb(1e-3..=100.0))?;
    let k = optional(table.get("k"), |v| v.rgb(0.0..=100.0))?;
    let fresnel = match (f0, eta, k) {
        (Some(f0), None, None) => FresnelSpec::Schlick { f0 },
        (None, Some(eta), Some(k)) => FresnelSpec::Conductor { eta, k },
        _ => return Err(table.error("a conductor needs either \"f0\" or both \"eta\" and \"k\"")),
    };
    let (alpha_x, alpha_y) = widths(table)?;
    Ok(Model::Conductor { fresnel, alpha_x, alpha_y })
}

/// Microfacet widths from exactly one of their three spellings.
fn widths(table: &Table<'_>) -> Result<(f32, f32), SceneError> {
    let width = |value: &Value<'_>, to_alpha: fn(f64) -> f64| {
        let alpha = to_alpha(value.number(0.0..=MAX_ALPHA)?) as f32;
        if alpha < MIN_ALPHA {
            let text = format!("\"{}\" gives an alpha below {MIN_ALPHA}: use type = \"mirror\"", value.name);
            return Err(value.error(text));
        }
        Ok(alpha)
    };
    let plain = |value: &Value<'_>| width(value, |alpha| alpha);
    let roughness = optional(table.get("roughness"), |v| width(v, |roughness| roughness * roughness))?;
    let alpha = optional(table.get("alpha"), plain)?;
    let alpha_x = optional(table.get("alpha_x"), plain)?;
    let alpha_y = optional(table.get("alpha_y"), plain)?;
    match (roughness, alpha, alpha_x, alpha_y) {
        (None, None, None, None) => Ok((0.09, 0.09)), // roughness 0.3, the default of OpenPBR
        (Some(same), None, None, None) | (None, Some(same), None, None) => Ok((same, same)),
        (None, None, Some(x), Some(y)) => Ok((x, y)),
        _ => Err(table.error("give one of \"roughness\", \"alpha\", or \"alpha_x\" with \"alpha_y\"")),
    }
}

/// A constant colour or `{ texture = "file.png", scale = [1, 1, 1] }`.
fn color(value: Option<Value<'_>>, default: f32, textures: Option<&mut Textures>) -> Result<Color, SceneError> {
    let Some(value) = value else { return Ok(Color::Constant(Rgb::splat(default))) };
    if !value.is_table() {
        return value.rgb(0.0..=1.0).map(Color::Constant);
    }
    let table = value.table(&format!("\"{}\"", value.name))?;
    let file = table.get("texture").ok_or_else(|| table.error("a colour table needs \"texture\""))?;
    let scale = optional(table.get("scale"), |v| v.rgb(0.0..=1.0))?.unwrap_or(Rgb::splat(1.0));
    table.finish()?;
    let Some(textures) = textures else {
        return Err(file.error("an image is only possible in a scene file"));
    };
    let name = file.string()?;
    let path = paths::find(file.document().path, name)
        .ok_or_else(|| file.error(format!("the image \"{name}\" does not exist")))?;
    let texture = textures.load(&path).map_err(|error| file.error(error.to_string()))?;
    Ok(Color::Texture { texture, scale })
}

/// The most that a model reflects at normal incidence.
fn reflectance(model: &Model) -> Rgb<f32> {
    match *model {
        Model::Diffuse { base_color: color } | Model::Mirror { reflectance: color } => match color {
            Color::Constant(color) | Color::Texture { scale: color, .. } => color,
        },
        Model::Conductor { fresnel: FresnelSpec::Schlick { f0 }, .. } => f0,
        Model::Conductor { fresnel: FresnelSpec::Conductor { eta, k }, .. } => {
            // ((η-1)² + k²) / ((η+1)² + k²)
            let channel = |eta: f32, k: f32| ((eta - 1.0).powi(2) + k * k) / ((eta + 1.0).powi(2) + k * k);
            Rgb::new(channel(eta.r, k.r), channel(eta.g, k.g), channel(eta.b, k.b))
        }
    }
}

#[cfg(test)]
#[path = "material_tests.rs"]
mod tests;
