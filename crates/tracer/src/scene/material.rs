//! `[materials.NAME]` of a scene file, and the material file that holds the same table alone.

use std::path::Path;

use gonio_kernel::Rgb;

use super::document::{Document, Table, Value};
use super::error::quoted;
use super::textures::Textures;
use super::{
    Color, Compensation, Directional, Distribution, FresnelSpec, LobeSpec, MAX_RADIANCE, MIN_ALPHA, Masking, Material,
    MicrofacetSpec, Model, NormalMapSpec, PhongNorm, SceneError, paths,
};
use gonio_kernel::metal::Metal;

/// Largest number of lobes of one material.
const MAX_LOBES: usize = 4;
/// Largest factor on the slopes of a normal map.
const MAX_NORMAL_SCALE: f64 = 10.0;
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
    let normal_map = normal_map(table, textures.as_deref_mut())?;
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
    Ok(Material { name: name.to_owned(), lobes, emission, two_sided, normal_map })
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
        "eon" => Model::Eon {
            base_color: color(table.get("base_color"), 0.8, textures)?,
            roughness: optional(table.get("roughness"), |v| v.number(0.0..=1.0))?.unwrap_or(0.5) as f32,
            directional: choice(table, "albedo", &[("exact", Directional::Exact), ("fitted", Directional::Fitted)])?,
        },
        "phong" => phong(table, textures)?,
        "conductor" => conductor(table)?,
        "dielectric" => dielectric(table)?,
        _ => {
            let known = quoted(["diffuse", "eon", "mirror", "phong", "conductor", "dielectric", "mix"].into_iter());
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
    let f82 = optional(table.get("f82"), |v| v.rgb(0.0..=1.0))?;
    let eta = optional(table.get("eta"), |v| v.rgb(1e-3..=100.0))?;
    let k = optional(table.get("k"), |v| v.rgb(0.0..=100.0))?;
    let ior = optional(table.get("ior"), |v| v.number(0.01..=100.0))?;
    let metal = table.get("metal");
    let fresnel = match (f0, f82, eta, k, ior, &metal) {
        (Some(f0), None, None, None, None, None) => FresnelSpec::Schlick { f0 },
        (Some(f0), Some(tint), None, None, None, None) => FresnelSpec::F82 { f0, tint },
        (None, None, Some(eta), Some(k), None, None) => FresnelSpec::Conductor { eta, k },
        (None, None, None, None, Some(ior), None) => FresnelSpec::Dielectric { ior: ior as f32 },
        (None, None, None, None, None, Some(value)) => {
            let name = value.string()?;
            let Some(metal) = Metal::named(name) else {
                let known = quoted(Metal::ALL.iter().map(|(name, _)| *name));
                return Err(value.error(format!("the metal \"{name}\" is not known; known are {known}")));
            };
            let [eta, k] = metal.index().map(|index| index.map(|x| x as f32));
            FresnelSpec::Conductor { eta, k }
        }
        _ => {
            let text = "a conductor needs one of \"f0\" (with \"f82\" if wanted), both \"eta\" and \"k\", \"metal\", or \"ior\"";
            return Err(table.error(text));
        }
    };
    // Roughness 0.3 is the default of OpenPBR.
    let microfacets = microfacets(table)?.map_or_else(|| styled(table, (0.09, 0.09)), Ok)?;
    let choices =
        [("none", Compensation::None), ("kulla-conty", Compensation::KullaConty), ("turquin", Compensation::Turquin)];
    let compensation = choice(table, "compensation", &choices)?;
    let plain = microfacets.distribution == Distribution::Ggx && microfacets.masking == Masking::HeightCorrelated;
    if compensation != Compensation::None && !plain {
        return Err(table.error("\"compensation\" needs the distribution \"ggx\" and the masking \"correlated\""));
    }
    Ok(Model::Conductor { fresnel, microfacets, compensation })
}

fn dielectric(table: &Table<'_>) -> Result<Model, SceneError> {
    let ior = optional(table.get("ior"), |v| v.number(0.01..=100.0))?.unwrap_or(1.5) as f32;
    Ok(Model::Dielectric { ior, microfacets: microfacets(table)? })
}

fn phong(table: &Table<'_>, textures: Option<&mut Textures>) -> Result<Model, SceneError> {
    let diffuse = color(table.get("diffuse"), 0.5, textures)?;
    let glossy = optional(table.get("glossy"), |v| v.rgb(0.0..=1.0))?.unwrap_or(Rgb::splat(0.5));
    let exponent = optional(table.get("exponent"), |v| v.number(0.0..=1e7))?.unwrap_or(30.0) as f32;
    let norms = [("lafortune", PhongNorm::Lafortune), ("lecture", PhongNorm::Lecture)];
    Ok(Model::Phong { diffuse, glossy, exponent, norm: choice(table, "normalization", &norms)? })
}

/// One of several words; the first is the default.
fn choice<T: Copy>(table: &Table<'_>, key: &'static str, choices: &[(&str, T)]) -> Result<T, SceneError> {
    let Some(value) = table.get(key) else { return Ok(choices[0].1) };
    let word = value.string()?;
    choices.iter().find(|(name, _)| *name == word).map(|(_, choice)| *choice).ok_or_else(|| {
        let known = quoted(choices.iter().map(|(name, _)| *name));
        value.error(format!("\"{key}\" cannot be \"{word}\"; known are {known}"))
    })
}

/// The distribution of microfacets; none if no width is given.
fn microfacets(table: &Table<'_>) -> Result<Option<MicrofacetSpec>, SceneError> {
    widths(table)?.map(|widths| styled(table, widths)).transpose()
}

/// Microfacets of these widths with the table's distribution and masking.
fn styled(table: &Table<'_>, (alpha_x, alpha_y): (f32, f32)) -> Result<MicrofacetSpec, SceneError> {
    let distribution =
        choice(table, "distribution", &[("ggx", Distribution::Ggx), ("beckmann", Distribution::Beckmann)])?;
    let maskings = [("correlated", Masking::HeightCorrelated), ("separable", Masking::Separable)];
    Ok(MicrofacetSpec { distribution, masking: choice(table, "masking", &maskings)?, alpha_x, alpha_y })
}

/// Microfacet widths from at most one of their three spellings.
fn widths(table: &Table<'_>) -> Result<Option<(f32, f32)>, SceneError> {
    let width = |value: &Value<'_>, to_alpha: fn(f64) -> f64| {
        let alpha = to_alpha(value.number(0.0..=MAX_ALPHA)?) as f32;
        if alpha < MIN_ALPHA {
            let text = format!(
                "\"{}\" gives an alpha below {MIN_ALPHA:e}: use type = \"mirror\", or a dielectric without roughness",
                value.name
            );
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
        (None, None, None, None) => Ok(None),
        (Some(same), None, None, None) | (None, Some(same), None, None) => Ok(Some((same, same))),
        (None, None, Some(x), Some(y)) => Ok(Some((x, y))),
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
    Ok(Color::Texture { texture: image(&file, textures, Textures::load)?, scale })
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

/// The most that a model reflects at normal incidence.
fn reflectance(model: &Model) -> Rgb<f32> {
    let constant = |color: Color| match color {
        Color::Constant(color) | Color::Texture { scale: color, .. } => color,
    };
    match *model {
        Model::Diffuse { base_color: color } | Model::Mirror { reflectance: color } => constant(color),
        Model::Eon { base_color, .. } => constant(base_color),
        Model::Phong { diffuse, glossy, .. } => constant(diffuse) + glossy,
        Model::Dielectric { .. } => Rgb::splat(1.0),
        Model::Conductor { fresnel: FresnelSpec::Schlick { f0 } | FresnelSpec::F82 { f0, .. }, .. } => f0,
        Model::Conductor { fresnel: FresnelSpec::Dielectric { ior }, .. } => {
            Rgb::splat(((ior - 1.0) / (ior + 1.0)).powi(2))
        }
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
