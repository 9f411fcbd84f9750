//! Environment maps: every key, odd texels, refusals.

use super::TRIANGLE;
use crate::support::Folder;
use gonio_io::exr::{self, Metadata};
use gonio_io::png;
use gonio_tracer::Picture;
use gonio_tracer::scene::Sky;

/// A scene of one triangle under `[environment]` with these lines, which begin at line 4.
fn under(lines: &str) -> String {
    format!("[[meshes]]\nfile = \"tri.obj\"\n[environment]\n{lines}")
}

#[test]
fn every_key_of_an_environment_map_arrives_and_odd_texels_are_dealt_with() {
    let folder = Folder::new();
    folder.write("tri.obj", TRIANGLE);
    let rgb = vec![[1.0, 2.0, 3.0], [0.5, -1.0, 0.0], [0.0; 3], [-0.0, -2.0, 1.0], [4.0; 3], [5.0; 3]];
    let map = Picture { width: 3, height: 2, rgb, alpha: None };
    exr::write(&folder.path().join("sky.exr"), &map, None, &Metadata::default()).unwrap();
    let text =
        under("map = \"sky.exr\"\nrotation = -30\nintensity = 0.25\ncamera_visible = false\nilluminates = true\n");
    let scene = gonio_io::load(&folder.write("scene.toml", text)).unwrap();
    let Sky::Map(sky) = &scene.environment.sky else { panic!("{:?}", scene.environment) };
    assert_eq!((sky.rotation, sky.intensity), (-30.0, 0.25));
    assert_eq!((scene.environment.camera_visible, scene.environment.illuminates), (false, true));
    assert_eq!(sky.picture.rgb[..4], [[1.0, 2.0, 3.0], [0.5, 0.0, 0.0], [0.0; 3], [0.0, 0.0, 1.0]]);
    let warnings = folder.warnings(&scene);
    assert!(
        warnings.contains(&"sky.exr: 2 pixels with negative channels, which count as 0".to_owned()),
        "{warnings:?}"
    );

    let black = Picture { width: 1, height: 1, rgb: vec![[0.0; 3]], alpha: None };
    exr::write(&folder.path().join("sky.exr"), &black, None, &Metadata::default()).unwrap();
    let scene = gonio_io::load(&folder.write("scene.toml", under("map = \"sky.exr\"\n"))).unwrap();
    assert!(folder.warnings(&scene).contains(&"the scene has no light: the picture will be black".to_owned()));
    assert!(!gonio_tracer::World::new(&scene).unwrap().effects().set().has(gonio_tracer::Effect::Environment));
}

#[test]
fn environments_that_cannot_be_used_are_refused_in_words() {
    let folder = Folder::new();
    folder.write("tri.obj", TRIANGLE);
    let texels = |name: &str, texel: [f32; 3]| {
        let picture = Picture { width: 2, height: 2, rgb: vec![[1.0; 3], [1.0; 3], [1.0; 3], texel], alpha: None };
        exr::write(&folder.path().join(name), &picture, None, &Metadata::default()).unwrap();
    };
    texels("sky.exr", [2e6, 1.0, 1.0]);
    texels("nan.exr", [f32::NAN, 1.0, 1.0]);
    texels("inf.exr", [1.0, 1.0, f32::INFINITY]);
    folder.write("cut.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n@`p\u{7f}@`p");
    png::write(&folder.path().join("sky.png"), &Picture { width: 1, height: 1, rgb: vec![[1.0; 3]], alpha: None }, 0.0)
        .unwrap();
    let cases = [
        ("map = \"none.hdr\"", "scene.toml:4: the file \"none.hdr\" does not exist"),
        (
            "radiance = 1\nmap = \"sky.exr\"",
            "scene.toml:5: an environment has either \"radiance\" or \"map\", not both",
        ),
        ("radiance = 1\nintensity = 2", "scene.toml:5: \"intensity\" is for an environment with a \"map\""),
        ("map = \"sky.exr\"\nintensity = -1", "scene.toml:5: \"intensity\" must be a number from 0 to 1000000, not -1"),
        (
            "radiance = 1\ncamera_visible = false\nilluminates = false",
            "scene.toml:3: an environment that neither lights nor is visible to the camera does nothing",
        ),
        (
            "map = \"sky.exr\"",
            "scene.toml:4: \"sky.exr\" has a radiance of 2e6, which times \"intensity\" 1 is more than 1e6: an \"intensity\" \
             of at most 5.000e-1 is possible",
        ),
        ("map = \"nan.exr\"", "nan.exr: pixel (1, 1), counted from the top left, is not finite: [NaN, 1.0, 1.0]"),
        ("map = \"inf.exr\"", "inf.exr: pixel (1, 1), counted from the top left, is not finite: [1.0, 1.0, inf]"),
        ("map = \"cut.hdr\"", "cut.hdr: is truncated: it ends before its last pixel"),
        (
            "map = \"sky.png\"",
            "sky.png: has eight or sixteen bits per channel, which cannot hold the radiance of an environment: Radiance (.hdr) \
             or OpenEXR (.exr) is needed",
        ),
    ];
    for (lines, expected) in cases {
        assert_eq!(folder.refusal(&folder.write("scene.toml", under(lines))), expected);
    }
}
