//! Decoding, of a size that is known before anything is allocated.

use std::path::Path;

use ::exr::meta::MetaData;
use ::exr::prelude::{self as exr, ReadChannels, ReadLayers};
use gonio_tracer::Picture;

use crate::ImageError;

/// Most pixels of a picture that is read, 16384 × 8192 or alike: 1.5 GiB as three f32. A header of a few bytes can claim
/// any size.
const MOST_PIXELS: usize = 1 << 27;

/// Reads the first layer that has channels R, G and B, as f32.
///
/// # Errors
/// The file cannot be read, no layer has these channels, or a layer has more than 2²⁷ pixels.
pub fn read(path: &Path) -> Result<Picture, ImageError> {
    let meta = MetaData::read_from_file(path, false)
        .map_err(|error| ImageError::of(path, format!("cannot be read: {error}")))?;
    for exr::Vec2(width, height) in meta.headers.iter().map(|header| header.layer_size) {
        if width.checked_mul(height).is_none_or(|pixels| pixels > MOST_PIXELS) {
            return Err(ImageError::of(path, format!("is too large: {width} x {height} pixels")));
        }
    }
    let image = exr::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size.width(), vec![[0.0_f32; 3]; size.width() * size.height()]),
            |(width, pixels), at, (r, g, b): (f32, f32, f32)| pixels[at.y() * *width + at.x()] = [r, g, b],
        )
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(|error| ImageError::of(path, format!("cannot be read: {error}")))?;
    let size = image.layer_data.size;
    let (_, rgb) = image.layer_data.channel_data.pixels;
    match (u32::try_from(size.width()), u32::try_from(size.height())) {
        (Ok(width), Ok(height)) => Ok(Picture { width, height, rgb, alpha: None }),
        _ => Err(ImageError::of(path, "is too large")),
    }
}
