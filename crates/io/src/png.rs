//! PNG files: pictures to look at, in 8-bit sRGB.

use std::path::Path;

use gonio_tracer::Picture;

use crate::ImageError;
use crate::encoded::{check, replace};

/// Writes a PNG file, see [`encode`].
///
/// # Errors
/// As [`encode`], or the file cannot be written.
pub fn write(path: &Path, picture: &Picture, exposure: f32) -> Result<(), ImageError> {
    replace(path, encode(picture, exposure))
}

/// The bytes of an 8-bit sRGB PNG file of the picture brightened by `exposure` stops.
///
/// Values are clamped to [0, 1]; a value that is not a number is black.
///
/// # Errors
/// A sentence: the picture has no pixels or the wrong number of them.
pub fn encode(picture: &Picture, exposure: f32) -> Result<Vec<u8>, String> {
    check(picture)?;
    encode_rgb8(picture.width, picture.height, &srgb8(picture, exposure))
}

/// The picture as 8-bit sRGB, three bytes per pixel, brightened by `exposure` stops: clamped to [0, 1], and black where a
/// value is not a number.
pub fn srgb8(picture: &Picture, exposure: f32) -> Vec<u8> {
    let gain = exposure.exp2();
    picture.rgb.iter().flatten().map(|&value| encode_srgb(value * gain)).collect()
}

/// The bytes of a PNG file of 8-bit sRGB colours, three bytes per pixel, rows from the top.
///
/// # Errors
/// A sentence: there are no pixels, or the wrong number of them.
pub fn encode_rgb8(width: u32, height: u32, rgb: &[u8]) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut bytes);
    image::ImageEncoder::write_image(encoder, rgb, width, height, image::ExtendedColorType::Rgb8)
        .map_err(|error| format!("it cannot be encoded: {error}"))?;
    Ok(bytes)
}

/// IEC 61966-2-1, encoding, rounded to the nearest of 256 levels.
fn encode_srgb(linear: f32) -> u8 {
    let x = if linear > 0.0 { linear.min(1.0) } else { 0.0 }; // NaN > 0 is false: black
    let encoded = if x <= 0.003_130_8 { x * 12.92 } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_tracer::texture::linear_from_srgb8;

    #[test]
    fn a_png_has_srgb_values_of_the_exposed_picture() {
        let rgb = vec![[0.0, 0.25, 0.5], [-1.0, f32::NAN, f32::INFINITY]];
        let bytes = encode(&Picture { width: 2, height: 1, rgb, alpha: None }, 1.0).unwrap();
        let read = image::load_from_memory(&bytes).unwrap().into_rgb8();
        assert_eq!(read.as_raw().as_slice(), [0, 188, 255, 0, 0, 255]); // 0.25 twice as bright: 0.5 is 187.5 of 255
    }

    #[test]
    fn encoding_undoes_decoding() {
        for byte in 0..=255 {
            assert_eq!(encode_srgb(linear_from_srgb8(byte)), byte);
        }
    }
}
