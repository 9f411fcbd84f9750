//! Pictures of radiance from other programs: Radiance (.hdr, .pic) and OpenEXR, told apart by their first bytes.
//!
//! Radiance files (Ward, "Real Pixels", Graphics Gems II, 1991) hold a shared exponent per pixel: flat, with the old run
//! lengths or with the new ones, rows from the top. A mantissa m of exponent e is m · 2^(e − 136). The header's EXPOSURE and
//! COLORCORR are factors that were applied to the pixels; like most programs this reader leaves the pixels as they are, but
//! says so.
//!
//! A header is believed only as far as the file is long: before anything is allocated, the picture that it promises must be
//! one that the file can hold.

use std::fs;
use std::io::{Cursor, ErrorKind};
use std::path::Path;

use exr::meta::MetaData;
use exr::meta::header::Header;
use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;

use gonio_tracer::Picture;

use crate::ImageError;
use crate::exr::REC_709;

/// Most pixels along an edge.
const MAX_EDGE: usize = 65_536;
/// Most pixels: 2²⁸, three gigabytes.
const MAX_PIXELS: usize = 1 << 28;
/// Most pixels per byte of a file: no picture of interest is packed closer, by any of the formats' compressions.
const MAX_PIXELS_PER_BYTE: usize = 4096;
/// How far a file's chromaticities may be from those of Rec. 709.
const SAME_CHROMATICITY: f32 = 0.002;

/// Reads a picture of radiance, and what was noticed on the way: one sentence each.
///
/// # Errors
/// The file cannot be read, is neither Radiance nor OpenEXR, is damaged, has no pixels or too many, or holds no RGB.
pub fn read(path: &Path) -> Result<(Picture, Vec<String>), ImageError> {
    let bytes = fs::read(path).map_err(|error| ImageError::of(path, format!("cannot be read: {error}")))?;
    match bytes.as_slice() {
        [0x76, 0x2f, 0x31, 0x01, ..] => {
            drop(bytes);
            read_open_exr(path)
        }
        [b'#', b'?', ..] => read_radiance(path, &bytes),
        [0x89, b'P', b'N', b'G', ..] | [0xff, 0xd8, 0xff, ..] => Err(ImageError::of(
            path,
            "has eight or sixteen bits per channel, which cannot hold the radiance of an environment: \
             Radiance (.hdr) or OpenEXR (.exr) is needed",
        )),
        _ => Err(ImageError::of(path, "is neither Radiance (.hdr) nor OpenEXR (.exr)")),
    }
}

fn read_radiance(path: &Path, bytes: &[u8]) -> Result<(Picture, Vec<String>), ImageError> {
    let refuse = |error: image::ImageError| match error {
        image::ImageError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => {
            ImageError::of(path, "is truncated: it ends before its last pixel")
        }
        error => ImageError::of(path, format!("cannot be decoded: {error}")),
    };
    let decoder = HdrDecoder::new_nonstrict(Cursor::new(bytes)).map_err(|error| match has_xyz(bytes) {
        true => {
            ImageError::of(path, "holds XYZ colours (FORMAT=32-bit_rle_xyze); convert it to RGB first (ra_xyze -r)")
        }
        false => refuse(error),
    })?;
    let header = decoder.metadata();
    check_size(path, [header.width as usize, header.height as usize], bytes.len())?;
    let mut warnings = Vec::new();
    let corrected = header.color_correction.is_some_and(|(r, g, b)| [r, g, b] != [1.0; 3]);
    if header.exposure.is_some_and(|exposure| exposure != 1.0) || corrected {
        let text = "the header's EXPOSURE or COLORCORR is not divided out: the pixels are used as they are";
        warnings.push(format!("{}: {text}", path.display()));
    }
    let mut rgb = vec![[0.0_f32; 3]; header.width as usize * header.height as usize];
    decoder.read_image(bytemuck::cast_slice_mut(&mut rgb)).map_err(refuse)?;
    Ok((Picture { width: header.width, height: header.height, rgb, alpha: None }, warnings))
}

/// Whether a Radiance header asks for CIE XYZ.
fn has_xyz(bytes: &[u8]) -> bool {
    let lines = bytes.split(|&byte| byte == b'\n').take_while(|line| !line.is_empty());
    lines.filter_map(|line| line.strip_prefix(b"FORMAT=")).any(|value| value.starts_with(b"32-bit_rle_xyze"))
}

fn read_open_exr(path: &Path) -> Result<(Picture, Vec<String>), ImageError> {
    let meta = MetaData::read_from_file(path, false)
        .map_err(|error| ImageError::of(path, format!("cannot be read: {error}")))?;
    let length = fs::metadata(path).map_or(0, |file| usize::try_from(file.len()).unwrap_or(usize::MAX));
    for header in &meta.headers {
        check_size(path, [header.layer_size.width(), header.layer_size.height()], length)?;
    }
    let Some(header) = meta.headers.iter().find(|header| has_rgb(header)) else {
        let names = meta.headers.iter().flat_map(|header| &header.channels.list).map(|c| c.name.to_string());
        let names = names.collect::<Vec<_>>().join(", ");
        return Err(ImageError::of(path, format!("has no layer with channels R, G and B; its channels are {names}")));
    };
    let display = header.shared_attributes.display_window;
    if (header.own_attributes.layer_position, header.layer_size) != (display.position, display.size) {
        return Err(ImageError::of(path, "is cropped: its data window is not its display window"));
    }
    let mut warnings = Vec::new();
    let found = header.shared_attributes.chromaticities.map(|c| [c.red, c.green, c.blue, c.white]);
    let is_709 = |found: [exr::math::Vec2<f32>; 4]| {
        let near = |a: f32, b: f32| (a - b).abs() < SAME_CHROMATICITY;
        found.iter().zip(REC_709).all(|(found, [x, y])| near(found.x(), x) && near(found.y(), y))
    };
    if found.is_some_and(|found| !is_709(found)) {
        let text = "its chromaticities are not those of Rec. 709, as which its pixels are used all the same";
        warnings.push(format!("{}: {text}", path.display()));
    }
    Ok((crate::exr::read(path)?, warnings))
}

fn has_rgb(header: &Header) -> bool {
    ["R", "G", "B"].iter().all(|name| header.channels.list.iter().any(|channel| channel.name.eq(name)))
}

/// Whether a file of `length` bytes can hold the picture that its header promises.
fn check_size(path: &Path, [width, height]: [usize; 2], length: usize) -> Result<(), ImageError> {
    let pixels = width.saturating_mul(height);
    if pixels == 0 {
        return Err(ImageError::of(path, format!("has no pixels: {width} x {height}")));
    }
    if width > MAX_EDGE || height > MAX_EDGE || pixels > MAX_PIXELS {
        let text =
            format!("is too large: {width} x {height}; at most {MAX_EDGE} along an edge and {MAX_PIXELS} pixels");
        return Err(ImageError::of(path, text));
    }
    if pixels / MAX_PIXELS_PER_BYTE > length {
        return Err(ImageError::of(
            path,
            format!("is truncated: {length} bytes cannot hold {width} x {height} pixels"),
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
