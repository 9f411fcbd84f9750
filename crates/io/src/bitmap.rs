//! PNG and JPEG files, decoded: colours and normals on surfaces, and pictures of eight bits.
//!
//! Errors are sentences without the file's name, which the caller knows.

use std::path::Path;

use gonio_tracer::normal_map::NormalMap;
use gonio_tracer::texture::Texture;
use image::{DynamicImage, ImageReader};

/// Decodes a PNG or JPEG file as sRGB colour.
///
/// Sixteen-bit images are rounded to eight bits, grey becomes three equal channels, alpha is left out.
///
/// # Errors
/// A sentence without the file's name: it cannot be opened, is not a PNG or JPEG, is corrupt or too large.
pub fn read_texture(path: &Path) -> Result<Texture, String> {
    let (width, height, texels) = read_srgb8(path)?;
    Texture::from_srgb8(width, height, texels).ok_or_else(|| "has no pixels".to_owned())
}

/// Decodes a PNG of eight or sixteen bits per channel, or a JPEG, as normals.
///
/// # Errors
/// A sentence without the file's name: it cannot be opened, is not a PNG or JPEG, is corrupt or too large, or is grey.
pub fn read_normal_map(path: &Path) -> Result<NormalMap, String> {
    let image = open(path)?;
    if !image.color().has_color() {
        return Err("is grey: a normal map has three channels, and a height map is no normal map".to_owned());
    }
    let image = image.into_rgb16();
    let (width, height) = image.dimensions();
    let texels = image.pixels().map(|pixel| pixel.0).collect();
    NormalMap::from_linear16(width, height, texels).ok_or_else(|| "has no pixels".to_owned())
}

/// Width, height and 8-bit sRGB pixels, rows from the top; see [`read_texture`].
pub(crate) fn read_srgb8(path: &Path) -> Result<(u32, u32, Vec<[u8; 3]>), String> {
    let image = open(path)?.into_rgb8();
    let (width, height) = image.dimensions();
    Ok((width, height, image.pixels().map(|pixel| pixel.0).collect()))
}

/// The image as the file has it.
fn open(path: &Path) -> Result<DynamicImage, String> {
    ImageReader::open(path)
        .and_then(ImageReader::with_guessed_format)
        .map_err(|error| format!("cannot be read: {error}"))?
        .decode()
        .map_err(|error| format!("cannot be decoded: {error}"))
}
