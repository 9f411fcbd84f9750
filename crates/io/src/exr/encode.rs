//! Encoding: channels, attributes, and their order, so that equal pictures are equal files.

use std::io::Cursor;
use std::path::Path;

use ::exr::meta::attribute::{Chromaticities, IntegerBounds};
use ::exr::prelude::{self as exr, WritableImage};
use gonio_tracer::{Layers, Picture};

use super::{Metadata, REC_709, Window};
use crate::ImageError;
use crate::encoded::{check, replace};

/// Writes an EXR file, see [`encode`].
///
/// # Errors
/// As [`encode`], or the file cannot be written.
pub fn write(path: &Path, picture: &Picture, layers: Option<&Layers>, metadata: &Metadata) -> Result<(), ImageError> {
    replace(path, encode(picture, layers, metadata))
}

/// The bytes of an EXR file: ZIP compressed, lines in increasing order, equal bytes for equal input.
///
/// # Errors
/// A sentence: the picture has no pixels, or it or a layer has the wrong number of them.
pub fn encode(picture: &Picture, layers: Option<&Layers>, metadata: &Metadata) -> Result<Vec<u8>, String> {
    check(picture)?;
    let mut channels = Vec::new();
    colours(&mut channels, "", ["R", "G", "B"], &picture.rgb);
    if let Some(alpha) = &picture.alpha {
        channels.push(Channel::new(text("A"), exr::FlatSamples::F32(alpha.clone())));
    }
    if let Some(layers) = layers {
        layer_channels(&mut channels, layers);
    }
    if let Some(wrong) = channels.iter().find(|c| c.sample_data.len() != picture.rgb.len()) {
        return Err(format!("the channel {} has {} pixels", wrong.name, wrong.sample_data.len()));
    }
    let encoding = exr::Encoding {
        compression: exr::Compression::ZIP16,
        blocks: exr::Blocks::ScanLines,
        line_order: exr::LineOrder::Increasing,
    };
    let size = (picture.width as usize, picture.height as usize);
    let channels = exr::AnyChannels::sort(channels.into());
    let mut image = exr::Image::from_layer(exr::Layer::new(size, layer_attributes(metadata), encoding, channels));
    if let Some(Window { of: [width, height], .. }) = metadata.window {
        image.attributes.display_window = IntegerBounds::from_dimensions((width as usize, height as usize));
    }
    let [red, green, blue, white] = REC_709.map(|[x, y]| exr::Vec2(x, y));
    image.attributes.chromaticities = Some(Chromaticities { red, green, blue, white });
    let mut bytes = Vec::new();
    image
        .write()
        .non_parallel() // called from inside a thread pool, a picture is small beside its rendering
        .to_buffered(Cursor::new(&mut bytes))
        .map_err(|error| format!("it cannot be encoded: {error}"))?;
    sort_attributes(&mut bytes);
    Ok(bytes)
}

type Channel = exr::AnyChannel<exr::FlatSamples>;

/// Three channels of a layer.
fn colours(channels: &mut Vec<Channel>, layer: &str, names: [&str; 3], values: &[[f32; 3]]) {
    for (c, name) in names.into_iter().enumerate() {
        let samples = values.iter().map(|v| v[c]).collect();
        channels.push(Channel::new(text(&format!("{layer}{name}")), exr::FlatSamples::F32(samples)));
    }
}

fn layer_channels(channels: &mut Vec<Channel>, layers: &Layers) {
    let rgb = ["R", "G", "B"];
    colours(channels, "albedo.", rgb, &layers.albedo);
    colours(channels, "normal.", ["X", "Y", "Z"], &layers.normal);
    colours(channels, "direct.", rgb, &layers.direct);
    colours(channels, "indirect.", rgb, &layers.indirect);
    if let Some(variance) = &layers.variance {
        colours(channels, "variance.", rgb, variance);
    }
    channels.push(Channel::new(text("depth.Z"), exr::FlatSamples::F32(layers.depth.clone())));
    channels.push(Channel::new(text("sampleCount"), exr::FlatSamples::U32(layers.sample_count.clone())));
}

/// Brings the header's attributes into the order of their names: `exr` takes them from a hash map, in an order that
/// differs between runs. Their total length stays, so every offset in the file stays right.
fn sort_attributes(file: &mut [u8]) {
    const START: usize = 8; // after the magic number and the version
    let mut attributes = Vec::new();
    let mut rest = file.get(START..).unwrap_or_default();
    while rest.first().is_some_and(|&byte| byte != 0) {
        // name, 0, type, 0, size in four bytes, value
        let mut zeros = rest.iter().enumerate().filter(|(_, byte)| **byte == 0).map(|(at, _)| at);
        let (Some(_), Some(end_of_type)) = (zeros.next(), zeros.next()) else { return };
        let Some(size) = rest[end_of_type + 1..].first_chunk() else { return };
        let Some(length) = (end_of_type + 5).checked_add(u32::from_le_bytes(*size) as usize) else { return };
        let Some((attribute, after)) = rest.split_at_checked(length) else { return };
        attributes.push(attribute.to_vec());
        rest = after;
    }
    attributes.sort();
    let sorted = attributes.concat();
    file[START..START + sorted.len()].copy_from_slice(&sorted);
}

fn layer_attributes(metadata: &Metadata) -> exr::LayerAttributes {
    let mut attributes = exr::LayerAttributes {
        software_name: Some(text(&format!("gonio {}", metadata.version))),
        layer_position: metadata.window.map_or(exr::Vec2(0, 0), |w| exr::Vec2(w.at[0] as i32, w.at[1] as i32)),
        world_to_camera: metadata.matrices.map(|m| m[0]),
        world_to_normalized_device: metadata.matrices.map(|m| m[1]),
        ..exr::LayerAttributes::default()
    };
    let strings = [
        ("version", metadata.version.clone()),
        ("seed", metadata.seed.to_string()),
        ("spp", metadata.spp.to_string()),
        ("max_depth", metadata.max_depth.to_string()),
        ("backend", metadata.backend.clone()),
        ("samples", metadata.samples.to_string()),
        ("film_hash", metadata.film_hash.clone()),
    ];
    let numbers = [
        ("load_seconds", metadata.load_seconds),
        ("build_seconds", metadata.build_seconds),
        ("render_seconds", metadata.render_seconds),
    ];
    let other = metadata.other.iter().map(|(name, value)| (name.as_str(), value.clone()));
    let own = |name: &str| text(&format!("gonio_{name}")); // `version` and many more are reserved
    for (name, value) in strings.into_iter().chain(other) {
        attributes.other.insert(own(name), exr::AttributeValue::Text(text(&value)));
    }
    for (name, value) in numbers {
        attributes.other.insert(own(name), exr::AttributeValue::F64(value));
    }
    attributes
}

/// EXR texts hold single bytes; anything else becomes `?`.
pub(super) fn text(string: &str) -> exr::Text {
    let plain: String = string.chars().map(|c| if c.is_ascii() { c } else { '?' }).collect();
    exr::Text::new_or_none(plain).unwrap_or_default()
}
