//! Files of both formats, whole, damaged and lying.

use super::*;
use crate::exr::{Metadata, write};
use ::exr::prelude::{self as exr_files, WritableImage};
use std::path::PathBuf;

/// A folder of its own for one test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("gonio-hdr-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn read(&self, bytes: &[u8]) -> Result<(Picture, Vec<String>), String> {
        let path = self.0.join("a.hdr");
        fs::write(&path, bytes).unwrap();
        read(&path).map_err(|error| error.message)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn radiance(header: &str, width: usize, height: usize, pixels: &[u8]) -> Vec<u8> {
    [format!("#?RADIANCE\n{header}\n-Y {height} +X {width}\n").as_bytes(), pixels].concat()
}

const RGBE: &str = "# a comment\nFORMAT=32-bit_rle_rgbe\n";

#[test]
fn flat_pixels_old_runs_and_new_runs_are_the_same_picture() {
    let folder = Folder::new("radiance");
    // 128 · 2^(129 − 136) = 1, and a quarter and half of that; then black; then 255 · 2^(140 − 136).
    let (red, black, bright) = ([128, 32, 64, 129], [0, 0, 0, 0], [255, 0, 1, 140]);
    let row: Vec<[u8; 4]> = [red; 7].into_iter().chain([black, bright]).collect();
    let flat: Vec<u8> = row.concat();
    let old = [red, [1, 1, 1, 6], black, bright].concat();
    let mut new = vec![2, 2, 0, 9];
    for channel in 0..4 {
        new.extend([128 + 7, red[channel], 2, black[channel], bright[channel]]);
    }
    let right = Picture {
        width: 9,
        height: 1,
        rgb: [[[1.0, 0.25, 0.5]; 7].as_slice(), &[[0.0; 3], [4080.0, 0.0, 16.0]]].concat(),
        alpha: None,
    };
    for pixels in [&flat, &old, &new] {
        assert_eq!(folder.read(&radiance(RGBE, 9, 1, pixels)).unwrap(), (right.clone(), vec![]));
    }
    let (_, warnings) = folder.read(&radiance(&format!("{RGBE}EXPOSURE=2\n"), 9, 1, &flat)).unwrap();
    assert!(warnings.len() == 1 && warnings[0].ends_with("the pixels are used as they are"), "{warnings:?}");
    let rgbe = [b"#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 9\n".as_slice(), &flat].concat();
    assert_eq!(folder.read(&rgbe).unwrap().0, right, "the other signature in use");
}

#[test]
fn damaged_and_foreign_radiance_files_are_refused_in_words() {
    let folder = Folder::new("damaged");
    let flat = [128, 32, 64, 129].repeat(8);
    let cases: [(Vec<u8>, &str); 8] = [
        (radiance(RGBE, 4, 2, &flat[..29]), "is truncated: it ends before its last pixel"),
        (radiance(RGBE, 9, 1, &[2, 2, 0, 9, 137, 1, 137]), "is truncated: it ends before its last pixel"),
        (radiance(RGBE, 0, 2, &[]), "has no pixels: 0 x 2"),
        (
            radiance(RGBE, 60_000, 60_000, &flat),
            "is too large: 60000 x 60000; at most 65536 along an edge and 268435456 pixels",
        ),
        (radiance(RGBE, 16_384, 16_384, &flat), " bytes cannot hold 16384 x 16384 pixels"),
        (
            radiance("FORMAT=32-bit_rle_xyze\n", 4, 2, &flat),
            "holds XYZ colours (FORMAT=32-bit_rle_xyze); convert it to RGB first (ra_xyze -r)",
        ),
        (b"\x89PNG\r\n\x1a\n".to_vec(), "Radiance (.hdr) or OpenEXR (.exr) is needed"),
        (b"P6 1 1 255".to_vec(), "is neither Radiance (.hdr) nor OpenEXR (.exr)"),
    ];
    for (bytes, expected) in cases {
        let message = folder.read(&bytes).unwrap_err();
        assert!(message.ends_with(expected), "{message}");
    }
    let whole = radiance(RGBE, 4, 2, &flat);
    for length in 0..whole.len() {
        assert!(folder.read(&whole[..length]).is_err(), "{length} of {} bytes", whole.len());
    }
}

/// A file of one layer of these channels.
fn open_exr(path: &Path, size: (usize, usize), names: [&str; 3], sample: impl Fn(usize) -> exr_files::FlatSamples) {
    let channel = |k: usize| exr_files::AnyChannel::new(names[k], sample(k));
    let channels = exr_files::AnyChannels::sort([channel(0), channel(1), channel(2)].into_iter().collect());
    exr_files::Image::from_channels(size, channels).write().to_file(path).unwrap();
}

#[test]
fn half_and_float_are_read_and_other_channels_are_named() {
    let folder = Folder::new("exr");
    let path = folder.0.join("a.exr");
    let half =
        |k: usize| exr_files::FlatSamples::F16((0..6).map(|i| exr_files::f16::from_f32((i + k) as f32)).collect());
    open_exr(&path, (3, 2), ["R", "G", "B"], half);
    let (picture, _) = read(&path).unwrap();
    assert_eq!((picture.width, picture.height, picture.rgb[5]), (3, 2, [5.0, 6.0, 7.0]));
    open_exr(&path, (3, 2), ["X", "Y", "Z"], half);
    let message = read(&path).unwrap_err().message;
    assert_eq!(message, "has no layer with channels R, G and B; its channels are X, Y, Z");
}

#[test]
fn every_open_exr_that_is_cut_or_changed_is_read_or_refused_without_panic() {
    let folder = Folder::new("changed");
    let path = folder.0.join("a.exr");
    let rgb = (0..64 * 40).map(|i| [i as f32, 0.5, 1.0 / (1 + i) as f32]).collect();
    write(&path, &Picture { width: 64, height: 40, rgb, alpha: None }, None, &Metadata::default()).unwrap();
    let whole = fs::read(&path).unwrap();
    for length in (0..whole.len()).step_by(61) {
        fs::write(&path, &whole[..length]).unwrap();
        assert!(read(&path).is_err(), "{length} of {} bytes", whole.len());
    }
    for at in (0..whole.len().min(2000)).chain((2000..whole.len()).step_by(97)) {
        for value in [0, 1, 0x7f, 0xff] {
            let mut changed = whole.clone();
            changed[at] = value;
            fs::write(&path, &changed).unwrap();
            let _ = read(&path);
        }
    }
}

#[test]
fn an_open_exr_that_promises_too_much_is_refused_before_anything_is_allocated() {
    let folder = Folder::new("lies");
    let path = folder.0.join("a.exr");
    write(&path, &Picture { width: 2, height: 2, rgb: vec![[1.0; 3]; 4], alpha: None }, None, &Metadata::default())
        .unwrap();
    let mut bytes = fs::read(&path).unwrap();
    // Both windows: name, 0, type, 0, size, then x and y of the first and of the last pixel.
    for name in ["dataWindow\0box2i\0", "displayWindow\0box2i\0"] {
        let at = bytes.windows(name.len()).position(|window| window == name.as_bytes()).unwrap();
        let last = at + name.len() + 4 + 8;
        bytes[last..last + 4].copy_from_slice(&30_000_i32.to_le_bytes());
        bytes[last + 4..last + 8].copy_from_slice(&8_000_i32.to_le_bytes());
    }
    fs::write(&path, &bytes).unwrap();
    let message = read(&path).unwrap_err().message;
    assert!(message.ends_with(" bytes cannot hold 30001 x 8001 pixels"), "{message}");
}
