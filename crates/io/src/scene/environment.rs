//! `[environment]`: light from infinitely far away, the same from everywhere or a picture by latitude and longitude.

use std::path::Path;
use std::sync::Arc;

use gonio_kernel::Rgb;
use gonio_tracer::Picture;
use gonio_tracer::scene::{Environment, MAX_RADIANCE, Sky, SkyMap};

use super::document::{Table, Value};
use crate::{SceneError, hdr, paths};

/// Reads the section; `warn` takes sentences about the picture.
///
/// # Errors
/// A malformed section, or a picture that cannot be used.
pub(super) fn read(table: Option<Table<'_>>, warn: &mut dyn FnMut(String)) -> Result<Environment, SceneError> {
    let mut environment = Environment::default();
    let Some(table) = table else { return Ok(environment) };
    let (radiance, map) = (table.get("radiance"), table.get("map"));
    let (rotation, intensity) = (table.get("rotation"), table.get("intensity"));
    let flag = |value: Option<Value<'_>>| value.map_or(Ok(true), |value| value.boolean());
    environment.camera_visible = flag(table.get("camera_visible"))?;
    environment.illuminates = flag(table.get("illuminates"))?;
    table.finish()?;
    if !environment.camera_visible && !environment.illuminates {
        return Err(table.error("an environment that neither lights nor is visible to the camera does nothing"));
    }
    environment.sky = match (radiance, map) {
        (Some(_), Some(map)) => return Err(map.error("an environment has either \"radiance\" or \"map\", not both")),
        (None, Some(map)) => Sky::Map(sky_map(&map, rotation.as_ref(), intensity.as_ref(), warn)?),
        (radiance, None) => {
            if let Some(stray) = rotation.or(intensity) {
                return Err(stray.error(format!("\"{}\" is for an environment with a \"map\"", stray.name)));
            }
            Sky::Constant(radiance.map_or(Ok(Rgb::splat(0.0)), |value| value.rgb(0.0..=MAX_RADIANCE))?)
        }
    };
    Ok(environment)
}

fn sky_map(
    map: &Value<'_>,
    rotation: Option<&Value<'_>>,
    intensity: Option<&Value<'_>>,
    warn: &mut dyn FnMut(String),
) -> Result<SkyMap, SceneError> {
    let rotation = rotation.map_or(Ok(0.0), |value| value.number(-1e6..=1e6))?;
    let factor = intensity.map_or(Ok(1.0), |value| value.number(0.0..=1e6))? as f32;
    let name = map.string()?;
    let path = paths::find(map.document().path, name)
        .ok_or_else(|| map.error(format!("the file \"{name}\" does not exist")))?;
    let (mut picture, warnings) = hdr::read(&path).map_err(|error| SceneError::file(&error.path, error.message))?;
    warnings.into_iter().for_each(&mut *warn);
    let largest = clean(&mut picture, &path, warn)?;
    if f64::from(largest) * f64::from(factor) > MAX_RADIANCE {
        let most = MAX_RADIANCE / f64::from(largest);
        let text = format!(
            "\"{name}\" has a radiance of {largest:e}, which times \"intensity\" {factor} is more than {MAX_RADIANCE:e}: \
             an \"intensity\" of at most {most:.3e} is possible"
        );
        return Err(intensity.unwrap_or(map).error(text));
    }
    Ok(SkyMap { picture: Arc::new(picture), rotation, intensity: factor })
}

/// Replaces negative texels by 0, with a warning that counts them, and returns the largest channel.
///
/// # Errors
/// A channel is not finite.
fn clean(picture: &mut Picture, path: &Path, warn: &mut dyn FnMut(String)) -> Result<f32, SceneError> {
    let (mut largest, mut negative) = (0.0_f32, 0_usize);
    for (at, texel) in picture.rgb.iter_mut().enumerate() {
        if !texel.iter().all(|x| x.is_finite()) {
            let (x, y) = (at % picture.width as usize, at / picture.width as usize);
            let text = format!("pixel ({x}, {y}), counted from the top left, is not finite: {texel:?}");
            return Err(SceneError::file(path, text));
        }
        negative += usize::from(texel.iter().any(|&x| x < 0.0));
        *texel = texel.map(|x| if x > 0.0 { x } else { 0.0 });
        largest = texel.iter().copied().fold(largest, f32::max);
    }
    if negative > 0 {
        warn(format!("{}: {negative} pixels with negative channels, which count as 0", path.display()));
    }
    Ok(largest)
}
