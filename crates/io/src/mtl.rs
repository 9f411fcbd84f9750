//! MTL libraries: the materials of the 1990s, and their PBR extension, as lobes.
//!
//! `docs/scene-format.md` has a row for each statement. Phong's exponent becomes a GGX width by
//! α² = 2/(Ns + 2), which matches the curvature of both lobes at the mirror direction (Walter et al. 2007,
//! "Microfacet Models for Refraction"). What has no counterpart yet is named once per file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gonio_kernel::Rgb;
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::{Conductor, Lambert, Layering, Mirror};
use gonio_kernel::microfacet::Ggx;
use gonio_tracer::scene::{LobeSpec, Material};

use crate::error::{SceneError, quoted};
use crate::paths;
use crate::textures::Textures;

mod clean;

/// Exponent from which a ray-traced reflection (illum 3 and up) is a mirror: the largest that exporters write.
const MIRROR_NS: f64 = 1000.0;
/// A reflection narrower than this is a mirror, whatever the exponent was meant to say.
const MIRROR_ALPHA: f32 = 1e-4;

/// One MTL file.
pub(crate) struct Library {
    path: PathBuf,
    names: Vec<String>,
    materials: Vec<tobj::Material>,
    warnings: Vec<String>,
    /// For each thing that was not carried over, the materials that wanted it.
    lost: BTreeMap<String, Vec<String>>,
}

impl Library {
    /// Reads an MTL file; odd lines become warnings.
    ///
    /// # Errors
    /// The file cannot be read.
    pub(crate) fn load(path: &Path) -> Result<Self, SceneError> {
        let clean = clean::clean(path, &paths::read_text(path)?);
        let (materials, _) = tobj::load_mtl_buf(&mut clean.text.as_bytes())
            .map_err(|error| SceneError::file(path, format!("cannot be read: {error}")))?;
        let (names, warnings) = (clean.names, clean.warnings);
        Ok(Self { path: path.to_path_buf(), names, materials, warnings, lost: BTreeMap::new() })
    }

    /// The first material of that name.
    pub(crate) fn find(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|candidate| candidate == name)
    }

    /// Warnings so far; called once all materials that are used have been converted.
    pub(crate) fn into_warnings(mut self) -> Vec<String> {
        let path = self.path.display();
        let lost = self
            .lost
            .iter()
            .map(|(what, who)| format!("{path}: {what} (in {})", quoted(who.iter().map(String::as_str))));
        self.warnings.extend(lost);
        self.warnings
    }

    /// The material as lobes.
    ///
    /// # Errors
    /// A base-colour image exists but cannot be decoded.
    pub(crate) fn convert(&mut self, index: usize, textures: &mut Textures) -> Result<Material, SceneError> {
        let (name, mtl) = (self.names[index].clone(), self.materials[index].clone());
        let unknown = |key: &str| mtl.unknown_param.get(key).and_then(|text| text.parse::<f64>().ok());
        self.note_unsupported(&name, &mtl);

        let emission = rgb(mtl.emissive.unwrap_or_default());
        let metalness = unknown("Pm").unwrap_or(0.0) as f32;
        let illum = mtl.illumination_model.unwrap_or(2);
        let specular = if illum >= 2 { rgb(mtl.specular.unwrap_or_default()) } else { Rgb::splat(0.0) };
        let plain = is_black(emission) && is_black(specular);
        let mut base = rgb(mtl.diffuse.unwrap_or(if plain { [0.8; 3] } else { [0.0; 3] }));
        let map = self.base_color_map(&name, &mtl, textures)?;
        if map.is_some() && is_black(base) {
            base = Rgb::splat(1.0); // exporters that rely on the image write a black Kd, or none
        }

        let diffuse = base * (1.0 - metalness);
        let f0 = (base * metalness + specular * (1.0 - metalness)).map(|x| x.min(1.0));

        let mut lobes = Vec::new();
        if !is_black(f0) {
            if map.is_some() && metalness > 0.0 {
                self.lose("not supported yet: map_Kd on the metal part", &name);
            }
            let top = reflection(f0, illum, &mtl, unknown("Pr"), unknown("Pm"), unknown("aniso"));
            // What the reflection leaves of the light falls on the diffuse part: their sum conserves energy at every angle.
            lobes.push(if is_black(diffuse) { top } else { top.as_coat(Layering::Reciprocal) });
        }
        if !is_black(diffuse) || is_black(f0) {
            let lobe = LobeSpec::new(Lambert::new(diffuse));
            lobes.push(match map {
                Some(texture) => lobe.with_texture("base_color", texture),
                None => lobe,
            });
        }
        Ok(Material { emission, ..Material::new(&name, lobes) })
    }

    /// Notes every statement that `convert` does not read.
    fn note_unsupported(&mut self, name: &str, mtl: &tobj::Material) {
        let value = |key: &str| mtl.unknown_param.get(key).and_then(|text| text.parse::<f64>().ok());
        let present = [
            ("map_Ka", mtl.ambient_texture.is_some()),
            ("map_Ks", mtl.specular_texture.is_some()),
            ("map_Ns", mtl.shininess_texture.is_some()),
            ("map_d", mtl.dissolve_texture.is_some()),
            ("bump", mtl.normal_texture.is_some()),
            ("Ni", mtl.optical_density.is_some_and(|ni| ni != 1.0)),
            ("d or Tr (drawn opaque)", mtl.dissolve.is_some_and(|d| d < 1.0) || value("Tr").is_some_and(|tr| tr > 0.0)),
            ("illum of a refracting material", mtl.illumination_model.is_some_and(|i| matches!(i, 6 | 7))),
        ];
        for (what, _) in present.into_iter().filter(|&(_, is)| is) {
            self.lose(&format!("not supported yet: {what}"), name);
        }
        for (key, text) in &mtl.unknown_param {
            let idle = match key.as_str() {
                "Pr" | "Pm" | "aniso" | "Tr" => true,
                "Tf" => text == "1 1 1",
                "anisor" | "Ps" | "Pc" | "Pcr" => value(key) == Some(0.0),
                _ => false,
            };
            if !idle {
                self.lose(&format!("not supported yet: {key}"), name);
            }
        }
    }

    fn base_color_map(
        &mut self,
        name: &str,
        mtl: &tobj::Material,
        textures: &mut Textures,
    ) -> Result<Option<usize>, SceneError> {
        let Some(statement) = &mtl.diffuse_texture else { return Ok(None) };
        let (options, file) = split_options(statement);
        for option in options {
            self.lose(&format!("not supported yet: option {option} of map_Kd"), name);
        }
        let Some(path) = paths::find(&self.path, file) else {
            self.lose(&format!("the image \"{file}\" does not exist; Kd is used alone"), name);
            return Ok(None);
        };
        let known = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        if !matches!(known.as_deref(), Some("png" | "jpg" | "jpeg")) {
            self.lose(&format!("the image \"{file}\" is neither PNG nor JPEG; Kd is used alone"), name);
            return Ok(None);
        }
        textures.load(&path).map(Some)
    }

    fn lose(&mut self, what: &str, name: &str) {
        self.lost.entry(what.to_owned()).or_default().push(name.to_owned());
    }
}

/// The reflecting lobe of a given reflectance at normal incidence.
fn reflection(
    f0: Rgb<f32>,
    illum: u8,
    mtl: &tobj::Material,
    pr: Option<f64>,
    pm: Option<f64>,
    aniso: Option<f64>,
) -> LobeSpec {
    let ray_traced = matches!(illum, 3..=7);
    let sharp = mtl.shininess.is_none_or(|ns| ns >= MIRROR_NS);
    let alpha = match (pr, mtl.shininess) {
        (Some(roughness), _) => roughness * roughness,
        (None, _) if ray_traced && sharp && pm.is_none() => 0.0,
        (None, Some(ns)) => (2.0 / (ns + 2.0)).sqrt(),
        (None, None) if pm.is_some() => 0.25, // roughness 0.5
        (None, None) => 1.0,                  // Ns = 0
    };
    if alpha < f64::from(MIRROR_ALPHA) {
        return LobeSpec::new(Mirror::new(f0));
    }
    let aniso = aniso.unwrap_or(0.0);
    let aspect = (1.0 - 0.9 * aniso.abs()).sqrt(); // Burley 2012, "Physically-Based Shading at Disney"
    let clamp = |alpha: f64| (alpha as f32).clamp(MIRROR_ALPHA, 1.0);
    let (long, short) = (clamp(alpha / aspect), clamp(alpha * aspect));
    let (alpha_x, alpha_y) = if aniso < 0.0 { (short, long) } else { (long, short) };
    LobeSpec::new(Conductor::new(Ggx { alpha_x, alpha_y }, Fresnel::Schlick { f0 }))
}

/// Splits `-s 2 2 2 -clamp on wood grain.png` into the options' names and the file's.
fn split_options(statement: &str) -> (Vec<&str>, &str) {
    let mut options = Vec::new();
    let mut rest = statement.trim();
    while rest.starts_with('-') {
        let (option, mut after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        let (least, most) = match option {
            "-o" | "-s" | "-t" => (1, 3),
            "-mm" => (2, 2),
            "-blendu" | "-blendv" | "-cc" | "-clamp" | "-texres" | "-bm" | "-boost" | "-imfchan" | "-type" => (1, 1),
            _ => break, // a file name that begins with a dash
        };
        options.push(option);
        for taken in 0..most {
            let (value, next) = after.trim_start().split_once(char::is_whitespace).unwrap_or((after.trim_start(), ""));
            if taken >= least && value.parse::<f64>().is_err() {
                break;
            }
            after = next;
        }
        rest = after.trim_start();
    }
    (options, rest.trim().trim_matches('"'))
}

fn rgb([r, g, b]: [f64; 3]) -> Rgb<f32> {
    Rgb::new(r as f32, g as f32, b as f32)
}

fn is_black(color: Rgb<f32>) -> bool {
    color.r == 0.0 && color.g == 0.0 && color.b == 0.0
}

#[cfg(test)]
mod tests;
