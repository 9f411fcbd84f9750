//! Pictures on disk: OpenEXR with everything needed to render it again, and PNG to look at.
//!
//! An EXR file has one part, whose channels are `R`, `G`, `B` and, with [`Layers`], `albedo.R` … `sampleCount`: dotted names
//! are how compositors find layers. Channels are f32, `sampleCount` is u32. A crop's data window lies where the crop lies in
//! the display window of the whole picture.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use ::exr::meta::MetaData;
use ::exr::meta::attribute::{Chromaticities, IntegerBounds};
use ::exr::prelude::{self as exr, ReadChannels, ReadLayers, WritableImage};

use crate::layers::Layers;
use crate::texture::{SRGB_TO_LINEAR, decode_srgb8};
use crate::whole_file::WholeFile;

/// (x, y) of the primaries and the white of Rec. 709.
pub(crate) const REC_709: [[f32; 2]; 4] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], [0.3127, 0.3290]];

/// A picture in linear Rec. 709, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels per row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Radiance, `width * height` entries.
    pub rgb: Vec<[f32; 3]>,
}

/// How a picture came about; stored as EXR attributes of these names with `gonio_` before them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Metadata {
    /// Version of the renderer; the standard attribute `software` says `gonio` and this.
    pub version: String,
    /// Seed of all random numbers; stored as text, because EXR integers have 32 bits.
    pub seed: u64,
    /// Samples per pixel.
    pub spp: u32,
    /// Scattering events after which a path ends.
    pub max_depth: u32,
    /// Ray-casting backend.
    pub backend: String,
    /// Number of paths; stored as text.
    pub samples: u64,
    /// Seconds spent reading the scene.
    pub load_seconds: f64,
    /// Seconds spent building the acceleration structure.
    pub build_seconds: f64,
    /// Seconds spent rendering.
    pub render_seconds: f64,
    /// Hash of the film's integers, in hexadecimal.
    pub film_hash: String,
    /// Where a crop's upper left pixel lies in the whole picture, and the size of that; `None` if the picture is whole.
    pub window: Option<Window>,
    /// The standard attributes `worldToCamera` and `worldToNDC`, see [`crate::scene::Camera::matrices`].
    pub matrices: Option<[[f32; 16]; 2]>,
    /// Further attributes: name and text.
    pub other: Vec<(String, String)>,
}

/// A picture's place in a larger one, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Column and row of its upper left pixel.
    pub at: [u32; 2],
    /// Size of the larger one.
    pub of: [u32; 2],
}

/// Why a picture could not be written or read. It prints as `out/a.exr: cannot be written: …`.
#[derive(Debug, thiserror::Error)]
#[error("{}: {message}", .path.display())]
pub struct ImageError {
    /// The picture's file.
    pub path: PathBuf,
    /// What went wrong.
    pub message: String,
}

/// Writes an EXR file, see [`encode_exr`].
///
/// # Errors
/// As [`encode_exr`], or the file cannot be written.
pub fn write_exr(
    path: &Path,
    picture: &Picture,
    layers: Option<&Layers>,
    metadata: &Metadata,
) -> Result<(), ImageError> {
    replace(path, encode_exr(picture, layers, metadata))
}

/// The bytes of an EXR file: ZIP compressed, lines in increasing order, equal bytes for equal input.
///
/// # Errors
/// A sentence: the picture has no pixels, or it or a layer has the wrong number of them.
pub fn encode_exr(picture: &Picture, layers: Option<&Layers>, metadata: &Metadata) -> Result<Vec<u8>, String> {
    check(picture)?;
    let mut channels = Vec::new();
    colours(&mut channels, "", ["R", "G", "B"], &picture.rgb);
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
fn text(string: &str) -> exr::Text {
    let plain: String = string.chars().map(|c| if c.is_ascii() { c } else { '?' }).collect();
    exr::Text::new_or_none(plain).unwrap_or_default()
}

/// Writes a PNG file, see [`encode_png`].
///
/// # Errors
/// As [`encode_png`], or the file cannot be written.
pub fn write_png(path: &Path, picture: &Picture, exposure: f32) -> Result<(), ImageError> {
    replace(path, encode_png(picture, exposure))
}

/// The bytes of an 8-bit sRGB PNG file of the picture brightened by `exposure` stops.
///
/// Values are clamped to [0, 1]; a value that is not a number is black.
///
/// # Errors
/// A sentence: the picture has no pixels or the wrong number of them.
pub fn encode_png(picture: &Picture, exposure: f32) -> Result<Vec<u8>, String> {
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

/// Reads a picture: OpenEXR as [`read_exr`] does, anything else as 8-bit sRGB (PNG, JPEG), whose alpha is left out.
///
/// # Errors
/// The file cannot be read.
pub fn read_picture(path: &Path) -> Result<Picture, ImageError> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
        return read_exr(path);
    }
    let (width, height, encoded) = decode_srgb8(path).map_err(|why| failure(path, why))?;
    let rgb = encoded.into_iter().map(|pixel| pixel.map(|byte| SRGB_TO_LINEAR[usize::from(byte)])).collect();
    Ok(Picture { width, height, rgb })
}

/// Most pixels of a picture that is read, 16384 × 8192 or alike: 1.5 GiB as three f32. A header of a few bytes can claim
/// any size.
const MOST_PIXELS: usize = 1 << 27;

/// Reads the first layer that has channels R, G and B, as f32.
///
/// # Errors
/// The file cannot be read, no layer has these channels, or a layer has more than 2²⁷ pixels.
pub fn read_exr(path: &Path) -> Result<Picture, ImageError> {
    let meta =
        MetaData::read_from_file(path, false).map_err(|error| failure(path, format!("cannot be read: {error}")))?;
    for exr::Vec2(width, height) in meta.headers.iter().map(|header| header.layer_size) {
        if width.checked_mul(height).is_none_or(|pixels| pixels > MOST_PIXELS) {
            return Err(failure(path, format!("is too large: {width} x {height} pixels")));
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
        .map_err(|error| failure(path, format!("cannot be read: {error}")))?;
    let size = image.layer_data.size;
    let (_, rgb) = image.layer_data.channel_data.pixels;
    match (u32::try_from(size.width()), u32::try_from(size.height())) {
        (Ok(width), Ok(height)) => Ok(Picture { width, height, rgb }),
        _ => Err(failure(path, "is too large")),
    }
}

fn check(picture: &Picture) -> Result<(), String> {
    let count = u64::from(picture.width) * u64::from(picture.height);
    if count == 0 || count != picture.rgb.len() as u64 {
        let (width, height, found) = (picture.width, picture.height, picture.rgb.len());
        return Err(format!("a picture of {width} x {height} cannot have {found} pixels"));
    }
    Ok(())
}

pub(crate) fn failure(path: &Path, message: impl Into<String>) -> ImageError {
    ImageError { path: path.to_path_buf(), message: message.into() }
}

/// Puts an encoded picture in place of `path`, or changes nothing.
fn replace(path: &Path, encoded: Result<Vec<u8>, String>) -> Result<(), ImageError> {
    let bytes = encoded.map_err(|why| failure(path, why))?;
    WholeFile::write(path, &bytes).map_err(|error| failure(path, format!("cannot be written: {error}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn picture() -> Picture {
        let rgb = (0..15).map(|i| [i as f32, 1e-9 * i as f32, 1e9]).collect();
        Picture { width: 5, height: 3, rgb }
    }

    fn folder(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("gonio-image-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        path
    }

    #[test]
    fn an_exr_returns_every_bit_and_its_history() {
        let folder = folder("exr");
        let path = folder.join("a.exr");
        let seed = u64::MAX;
        let other = vec![("scene".to_owned(), "caf\u{e9}.toml".to_owned())];
        let metadata = Metadata {
            version: "1.2.3".to_owned(),
            seed,
            render_seconds: 0.5,
            window: Some(Window { at: [7, 2], of: [64, 32] }),
            other,
            ..Metadata::default()
        };
        write_exr(&path, &picture(), None, &metadata).unwrap();
        let bytes = fs::read(&path).unwrap();
        assert_eq!(read_exr(&path).unwrap(), picture());
        write_exr(&path, &picture(), None, &metadata).unwrap(); // over the old one, with the same bytes
        assert!(fs::read(&path).unwrap() == bytes, "the same picture has the same bytes");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "no temporary file is left");

        let meta = ::exr::meta::MetaData::read_from_file(&path, true).unwrap();
        let header = &meta.headers[0];
        assert_eq!(header.line_order, exr::LineOrder::Increasing);
        assert_eq!(header.compression, exr::Compression::ZIP16);
        assert_eq!(header.own_attributes.layer_position, exr::Vec2(7, 2));
        assert_eq!(header.shared_attributes.display_window, IntegerBounds::from_dimensions((64, 32)));
        assert_eq!(header.shared_attributes.chromaticities.unwrap().red, exr::Vec2(0.64, 0.33));
        assert_eq!(header.own_attributes.software_name.as_ref().unwrap().to_string(), "gonio 1.2.3");
        let attribute = |name: &str| header.own_attributes.other.get(&text(name)).cloned();
        assert_eq!(attribute("gonio_seed"), Some(exr::AttributeValue::Text(text("18446744073709551615"))));
        assert_eq!(attribute("gonio_render_seconds"), Some(exr::AttributeValue::F64(0.5)));
        assert_eq!(attribute("gonio_scene"), Some(exr::AttributeValue::Text(text("caf?.toml"))));
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn layers_are_channels_with_dotted_names() {
        let sum = |i: usize| [i as f32, 0.5, -1.0];
        let every = || (0..15).map(sum).collect::<Vec<_>>();
        let layers = Layers {
            albedo: every(),
            normal: every(),
            depth: vec![2.5; 15],
            direct: every(),
            indirect: every(),
            variance: None,
            sample_count: vec![(1 << 24) + 1; 15], // f32 cannot hold it
        };
        let bytes = encode_exr(&picture(), Some(&layers), &Metadata::default()).unwrap();
        let read = exr::read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
        let image = read.all_attributes().from_buffered(Cursor::new(bytes)).unwrap();
        let channels = image.layer_data.channel_data.list;
        let names: Vec<_> = channels.iter().map(|c| c.name.to_string()).collect();
        let layer = |name: &str, parts: [&str; 3]| parts.map(|part| format!("{name}.{part}"));
        let rgb = ["B", "G", "R"];
        let expected: Vec<String> = rgb
            .map(str::to_owned)
            .into_iter()
            .chain(layer("albedo", rgb))
            .chain(["depth.Z".to_owned()])
            .chain(layer("direct", rgb))
            .chain(layer("indirect", rgb))
            .chain(layer("normal", ["X", "Y", "Z"]))
            .chain(["sampleCount".to_owned()])
            .collect();
        assert_eq!(names, expected);
        let of = |name: &str| channels.iter().find(|c| c.name.eq(name)).unwrap().sample_data.clone();
        assert_eq!(of("sampleCount"), exr::FlatSamples::U32(layers.sample_count.clone()));
        assert_eq!(of("normal.X").value_by_flat_index(14).to_f32(), 14.0);
        let wrong = Layers { depth: vec![0.0; 3], ..layers };
        assert_eq!(
            encode_exr(&picture(), Some(&wrong), &Metadata::default()).unwrap_err(),
            "the channel depth.Z has 3 pixels"
        );
    }

    #[test]
    fn a_png_has_srgb_values_of_the_exposed_picture() {
        let folder = folder("png");
        let path = folder.join("a.png");
        let rgb = vec![[0.0, 0.25, 0.5], [-1.0, f32::NAN, f32::INFINITY]];
        write_png(&path, &Picture { width: 2, height: 1, rgb }, 1.0).unwrap();
        let read = image::open(&path).unwrap().into_rgb8();
        assert_eq!(read.as_raw().as_slice(), [0, 188, 255, 0, 0, 255]); // 0.25 twice as bright: 0.5 is 187.5 of 255
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn encoding_undoes_decoding() {
        let texture = |byte| crate::texture::Texture::from_srgb8(1, 1, vec![[byte; 3]]).unwrap();
        for byte in 0..=255 {
            assert_eq!(encode_srgb(texture(byte).sample(0.0, 0.0).r), byte);
        }
    }

    #[test]
    fn pictures_of_the_wrong_size_are_refused() {
        let picture = Picture { width: 2, height: 2, rgb: vec![[0.0; 3]; 3] };
        let error = write_exr(Path::new("a.exr"), &picture, None, &Metadata::default()).unwrap_err();
        assert_eq!(error.to_string(), "a.exr: a picture of 2 x 2 cannot have 3 pixels");
        let error = read_exr(Path::new("absent.exr")).unwrap_err().to_string();
        assert!(error.starts_with("absent.exr: cannot be read: "), "{error}");
    }
}
