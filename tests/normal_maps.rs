//! Normal maps in scene files: which way a bump points, what light is lost, and which files are refused.

use crate::support::{Folder, repository};
use gonio_accel::{Intersect, Sharing};
use gonio_kernel::Vec3;
use gonio_tracer::normal_map::NormalMap;
use gonio_tracer::scene::Scene;
use gonio_tracer::{Backend, Effect, Prepared, RenderSettings, Rendering, World, render};
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

/// A square in the plane y = 0, its front upwards: u along x, v along −z.
const SQUARE: &str =
    "v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";

/// The square with this material under a white sky, seen from above or below.
fn scene(folder: &Folder, square: &str, height: f64, material: &str, place: &str) -> Scene {
    folder.write("square.obj", square);
    fs::copy(repository("tests/corpus/texture/rgb8.png"), folder.path().join("map.png"))
        .expect("the corpus is shipped");
    let text = format!(
        "[film]\nwidth = 8\nheight = 8\nspp = 64\n\
         [camera]\norigin = [0.1, {height}, 0.2]\ntarget = [0, 0, 0]\nup = [0, 0, -1]\nvfov = 5\n\
         [integrator]\nmax_depth = 1\n[environment]\nradiance = 1\n\
         [materials.m]\nnormal_map = \"map.png\"\n{material}\n\
         [[meshes]]\nfile = \"square.obj\"\nmaterial = \"m\"\n{place}\n"
    );
    gonio_io::load(&folder.write("scene.toml", text)).expect("the scene is sound")
}

/// A map that is the same normal everywhere.
fn constant(n: [f32; 3]) -> NormalMap {
    let texel = n.map(|x| ((x * 0.5 + 0.5) * 65_535.0).round() as u16);
    NormalMap::from_linear16(1, 1, vec![texel]).expect("one texel")
}

fn rendered(scene: &Scene, change: impl Fn(&mut RenderSettings)) -> Rendering {
    rendered_by(Sharing::Never, scene, change)
}

fn rendered_by(sharing: Sharing, scene: &Scene, change: impl Fn(&mut RenderSettings)) -> Rendering {
    let world = World::by(scene, sharing).expect("the scene is sound");
    let mut settings = RenderSettings { layers: true, ..RenderSettings::of(scene) };
    change(&mut settings);
    let prepared = Prepared::new(world, Backend::Obvhs, Intersect::Robust).expect("obvhs needs nothing");
    render(&prepared, &settings, &mut |_| ControlFlow::Continue(()))
}

/// Each map of one normal must give its normal of the world.
fn assert_normals(scene: &mut Scene, pairs: [([f32; 3], [f32; 3]); 2]) {
    for (n, world) in pairs {
        scene.normal_maps = vec![constant(n)];
        assert_normal(scene, world);
    }
}

/// The normal that every pixel sees, whether the mesh is laid out or kept once.
#[track_caller]
fn assert_normal(scene: &Scene, expected: [f32; 3]) {
    for sharing in [Sharing::Never, Sharing::Always] {
        for normal in rendered_by(sharing, scene, |_| ()).layers.expect("asked for").normal {
            let off = (Vec3::from(normal) - Vec3::from(expected)).length();
            assert!(off < 1e-4, "{normal:?}, not {expected:?}, {sharing:?}");
        }
    }
}

#[test]
fn red_leans_along_u_and_green_along_v() {
    let folder = Folder::new();
    let mut scene = scene(&folder, SQUARE, 5.0, "", "");
    assert_normals(&mut scene, [([0.6, 0.0, 0.8], [0.6, 0.8, 0.0]), ([0.0, 0.6, 0.8], [0.0, 0.8, -0.6])]);
}

#[test]
fn a_mirrored_texture_keeps_the_directions_of_its_own_axes() {
    let folder = Folder::new();
    // u runs along −x.
    let mirrored = SQUARE.replace("vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1", "vt 1 0\nvt 0 0\nvt 0 1\nvt 1 1");
    let mut scene = scene(&folder, &mirrored, 5.0, "", "");
    assert_normals(&mut scene, [([0.6, 0.0, 0.8], [-0.6, 0.8, 0.0]), ([0.0, 0.6, 0.8], [0.0, 0.8, -0.6])]);
}

#[test]
fn a_mirrored_mesh_mirrors_its_bumps() {
    let folder = Folder::new();
    let mut scene = scene(&folder, SQUARE, 5.0, "", "transform = [{ scale = [-1, 1, 1] }]");
    assert_normals(&mut scene, [([0.6, 0.0, 0.8], [-0.6, 0.8, 0.0]), ([0.0, 0.6, 0.8], [0.0, 0.8, -0.6])]);
}

#[test]
fn seen_from_behind_a_bump_is_a_dent() {
    let folder = Folder::new();
    let mut scene = scene(&folder, SQUARE, -5.0, "", "");
    assert_normals(&mut scene, [([0.6, 0.0, 0.8], [-0.6, -0.8, 0.0]), ([0.0, 0.6, 0.8], [0.0, -0.8, 0.6])]);
}

#[test]
fn the_scale_is_a_factor_on_the_slope_and_zero_is_flat() {
    let folder = Folder::new();
    for (scale, world) in [("0", [0.0, 1.0, 0.0]), ("0.5", [0.3 / 0.73_f32.sqrt(), 0.8 / 0.73_f32.sqrt(), 0.0])] {
        let mut scene = scene(&folder, SQUARE, 5.0, &format!("normal_scale = {scale}"), "");
        scene.normal_maps = vec![constant([0.6, 0.0, 0.8])];
        assert_normal(&scene, world);
    }
}

#[test]
fn white_lambert_tilted_by_beta_returns_half_of_one_plus_its_cosine() {
    let folder = Folder::new();
    let mut scene = scene(&folder, SQUARE, 5.0, "base_color = 1", "");
    scene.film.spp = 4096;
    for degrees in [0.0_f32, 20.0, 40.0, 60.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        scene.normal_maps = vec![constant([sin, 0.0, cos])];
        let picture = rendered(&scene, |_| ()).picture;
        let n = picture.rgb.len() as f64;
        let values = || picture.rgb.iter().map(|rgb| f64::from(rgb[1]));
        let mean = values().sum::<f64>() / n;
        let error = (values().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
        let exact = 0.5 + 0.5 * f64::from(cos);
        println!("{degrees}°: {mean} ± {error}, exactly {exact}");
        // 4.5 standard errors: one chance in 10⁵; and the map's 16 bits.
        assert!((mean - exact).abs() < 4.5 * error + 2e-5, "{degrees}°: {mean} ± {error}, not {exact}");
    }
}

#[test]
fn every_effect_renders_the_same_picture_and_the_scene_knows_its_own() {
    let mut scene = gonio_io::load(&repository("tests/reference/normal_map.toml")).expect("the scene is shipped");
    scene.film.spp = 4;
    let world = World::new(&scene).expect("the scene is sound");
    let needed = world.effects().set();
    assert!(needed.has(Effect::NormalMaps) && !needed.has(Effect::Textures) && !needed.has(Effect::Tangents));
    let by = ["material \"chalk\"", "material \"gold\"", "material \"mirror\""];
    assert_eq!(world.effects().needed_by(Effect::NormalMaps), by);
    let expected = rendered(&scene, |_| ()).stats.film_hash;
    assert_eq!(rendered(&scene, |s| s.every_effect = true).stats.film_hash, expected);
}

/// The refusal of the square with these lines about its material.
fn refusal(folder: &Folder, square: &str, material: &str) -> String {
    folder.write("square.obj", square);
    for (name, to) in [("rgb8.png", "map.png"), ("grey16.png", "grey.png"), ("not-an-image", "text.png")] {
        fs::copy(repository("tests/corpus/texture").join(name), folder.path().join(to)).expect("the corpus is shipped");
    }
    let text = format!("[materials.m]\n{material}\n[[meshes]]\nfile = \"square.obj\"\nmaterial = \"m\"\n");
    folder.refusal(&folder.write("scene.toml", text))
}

#[test]
fn what_is_wrong_with_a_normal_map_is_said_with_its_line() {
    let folder = Folder::new();
    let bare = "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n";
    for (square, material, expected) in [
        (
            bare,
            "normal_map = \"map.png\"",
            "scene.toml:4: \"square.obj\" has faces without texture coordinates (vt), which the normal map of \"m\" needs",
        ),
        (SQUARE, "normal_map = \"none.png\"", "scene.toml:2: the image \"none.png\" does not exist"),
        (
            SQUARE,
            "normal_map = \"grey.png\"",
            "scene.toml:2: grey.png: the image is grey: a normal map has three channels, and a height map is no normal map",
        ),
        (SQUARE, "normal_map = 3", "scene.toml:2: \"normal_map\" must be a string, not 3"),
        (SQUARE, "normal_scale = 1", "scene.toml:2: \"normal_scale\" needs a \"normal_map\""),
        (
            SQUARE,
            "normal_map = \"map.png\"\nnormal_scale = 11",
            "scene.toml:3: \"normal_scale\" must be a number from 0 to 10, not 11",
        ),
    ] {
        assert_eq!(refusal(&folder, square, material), expected);
    }
    let broken = refusal(&folder, SQUARE, "normal_map = \"text.png\"");
    assert!(broken.starts_with("scene.toml:2: text.png: the image cannot be "), "{broken}");
    let in_a_lobe = "type = \"mix\"\nlobes = [{ base_color = 0.5, normal_map = \"map.png\" }]";
    let refused = refusal(&folder, SQUARE, in_a_lobe);
    assert!(refused.starts_with("scene.toml:3: unknown key \"normal_map\""), "{refused}");
    let alone =
        gonio_io::material_from_toml_str("normal_map = \"map.png\"", Path::new("m.toml")).unwrap_err().to_string();
    assert_eq!(alone, "m.toml:1: an image is only possible in a scene file");
}
