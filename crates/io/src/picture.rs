//! Pictures of any format.

use std::path::Path;

use gonio_tracer::Picture;
use gonio_tracer::texture::linear_from_srgb8;

use crate::bitmap::read_srgb8;
use crate::{ImageError, exr};

/// Reads a picture: OpenEXR as [`exr::read`] does, anything else as 8-bit sRGB (PNG, JPEG), whose alpha is left out.
///
/// # Errors
/// The file cannot be read.
pub fn read_picture(path: &Path) -> Result<Picture, ImageError> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
        return exr::read(path);
    }
    let (width, height, encoded) = read_srgb8(path).map_err(|why| ImageError::of(path, why))?;
    let rgb = encoded.into_iter().map(|pixel| pixel.map(linear_from_srgb8)).collect();
    Ok(Picture { width, height, rgb, alpha: None })
}
