//! Files are read back, and their headers looked at.

use super::*;
use ::exr::meta::attribute::IntegerBounds;
use ::exr::prelude::{self as exr, ReadChannels, ReadLayers};
use gonio_tracer::{Layers, Picture};
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

fn picture() -> Picture {
    let rgb = (0..15).map(|i| [i as f32, 1e-9 * i as f32, 1e9]).collect();
    Picture { width: 5, height: 3, rgb, alpha: None }
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
    write(&path, &picture(), None, &metadata).unwrap();
    let bytes = fs::read(&path).unwrap();
    assert_eq!(read(&path).unwrap(), picture());
    write(&path, &picture(), None, &metadata).unwrap(); // over the old one, with the same bytes
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
    let attribute = |name: &str| header.own_attributes.other.get(&encode::text(name)).cloned();
    assert_eq!(attribute("gonio_seed"), Some(exr::AttributeValue::Text(encode::text("18446744073709551615"))));
    assert_eq!(attribute("gonio_render_seconds"), Some(exr::AttributeValue::F64(0.5)));
    assert_eq!(attribute("gonio_scene"), Some(exr::AttributeValue::Text(encode::text("caf?.toml"))));
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
    let bytes = encode(&picture(), Some(&layers), &Metadata::default()).unwrap();
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
    assert_eq!(encode(&picture(), Some(&wrong), &Metadata::default()).unwrap_err(), "the channel depth.Z has 3 pixels");
}

#[test]
fn pictures_of_the_wrong_size_are_refused() {
    let picture = Picture { width: 2, height: 2, rgb: vec![[0.0; 3]; 3], alpha: None };
    let error = write(Path::new("a.exr"), &picture, None, &Metadata::default()).unwrap_err();
    assert_eq!(error.to_string(), "a.exr: a picture of 2 x 2 cannot have 3 pixels");
    let error = read(Path::new("absent.exr")).unwrap_err().to_string();
    assert!(error.starts_with("absent.exr: cannot be read: "), "{error}");
}
