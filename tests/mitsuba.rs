//! Pictures that Mitsuba 3 makes too: the JSON files of `tests/reference`, written by the scripts beside them.
//!
//! Sixteen seeds on each side. The picture's mean per channel must agree within 0.3 % at a standard error of the
//! difference of at most 0.1 %. Blocks of 8 × 8 pixels are compared by Welch's t-test at a family-wise level of 0.01
//! (Šidák over blocks and channels); a block fails only if it is significant and more than 0.5 % off. Blocks with emitter or
//! silhouette pixels, where pixel filters and edge rules show, are counted apart.

use crate::support::{Folder, Moments, cornell_box, data, moments, repository, welch};
use gonio_accel::Intersect;
use gonio_io::exr::{self, Metadata};
use gonio_tracer::normal_map::NormalMap;
use gonio_tracer::scene::{NormalMapSpec, Scene, Sky};
use gonio_tracer::{Backend, Picture, Prepared, RenderSettings, World, render};
use serde::Deserialize;
use std::ops::ControlFlow;
use std::path::Path;

#[derive(Deserialize)]
struct Reference {
    width: u32,
    height: u32,
    seeds: usize,
    block: usize,
    scattering_events: u32,
    image_mean: [f64; 3],
    image_variance: [f64; 3],
    mean: Vec<f64>,
    variance: Vec<f64>,
    excluded: Vec<usize>,
}

/// Reads a reference, renders its scene with as many seeds, and compares; the error says what differs.
fn compare(name: &str, scene: &Scene) -> Result<(), String> {
    let path = repository("tests/reference").join(name).with_extension("json");
    let text = std::fs::read_to_string(path).expect("the reference is shipped");
    let reference: Reference = serde_json::from_str(&text).expect("the reference is JSON");
    assert_eq!((scene.film.width, scene.film.height), (reference.width, reference.height));
    let world = World::new(scene).expect("the scene is sound");
    let prepared = Prepared::new(world, Backend::Obvhs, Intersect::Robust).expect("obvhs needs nothing");
    let (width, block) = (reference.width as usize, reference.block);
    let (per_row, per_column) = (width / block, reference.height as usize / block);

    let mut images: Vec<[f64; 3]> = Vec::new();
    let mut blocks: Vec<Vec<f64>> = Vec::new();
    for seed in 0..reference.seeds as u64 {
        let mut settings = RenderSettings { seed: 1000 + seed, ..RenderSettings::of(scene) };
        settings.max_depth = reference.scattering_events;
        let picture = render(&prepared, &settings, &mut |_| ControlFlow::Continue(())).picture;
        let mut sums = vec![0.0; reference.mean.len()];
        for (i, rgb) in picture.rgb.iter().enumerate() {
            let at = i / width / block * per_row + i % width / block;
            (0..3).for_each(|c| sums[3 * at + c] += f64::from(rgb[c]) / (block * block) as f64);
        }
        let count = (per_row * per_column) as f64;
        images.push(std::array::from_fn(|c| sums.iter().skip(c).step_by(3).sum::<f64>() / count));
        blocks.push(sums);
    }

    let n = reference.seeds as f64;
    for c in 0..3 {
        let ours = moments(images.iter().map(|i| i[c]));
        let difference = ours.mean / reference.image_mean[c] - 1.0;
        let error = ((ours.variance + reference.image_variance[c]) / n).sqrt() / reference.image_mean[c];
        println!("{name}, channel {c}: {:+.4} % ± {:.4} %", 100.0 * difference, 100.0 * error);
        if error > 1e-3 || difference.abs() > 3e-3 {
            return Err(format!("{name}, channel {c}: {difference} ± {error}"));
        }
    }

    let kept: Vec<usize> = (0..per_row * per_column).filter(|b| !reference.excluded.contains(b)).collect();
    let level = 1.0 - 0.99_f64.powf(1.0 / (3 * kept.len()) as f64);
    let compare = |b: usize, c: usize| {
        let i = 3 * b + c;
        let ours = moments(blocks.iter().map(|s| s[i]));
        let theirs = Moments { mean: reference.mean[i], variance: reference.variance[i] };
        (welch(&ours, &theirs, n) < level && (ours.mean / theirs.mean - 1.0).abs() > 5e-3).then(|| {
            format!("block {},{} channel {c}: {} against {}", b % per_row, b / per_row, ours.mean, theirs.mean)
        })
    };
    let differing = |blocks: &[usize]| -> Vec<String> {
        blocks.iter().flat_map(|&b| (0..3).filter_map(move |c| compare(b, c))).collect()
    };
    println!("{} of {} blocks with edges differ", differing(&reference.excluded).len(), reference.excluded.len());
    let failed = differing(&kept);
    if failed.is_empty() { Ok(()) } else { Err(format!("{} of {}: {failed:#?}", failed.len(), 3 * kept.len())) }
}

#[test]
fn the_cornell_box_agrees_with_mitsuba() {
    compare("cornell_box", &cornell_box(256, 16)).unwrap();
}

/// The scene of `tests/reference/environment.py` under a map.
fn under(map: &Path, folder: &Folder) -> Scene {
    let ground = "v -4 0 -4\nv -4 0 4\nv 4 0 4\nv 4 0 -4\nf 1 2 3\nf 1 3 4\n";
    folder.write("ground.obj", ground);
    let mut text = format!(
        "[film]\nwidth = 128\nheight = 96\nspp = 64\n\
         [camera]\norigin = [0.5, 2.0, 5.5]\ntarget = [0, 0.6, 0]\nvfov = 40\n\
         [integrator]\nrussian_roulette = false\n\
         [environment]\nmap = {map:?}\nrotation = 37\nintensity = 0.7\n\
         [materials.ground]\nbase_color = [0.5, 0.45, 0.4]\n\
         [materials.chalk]\nbase_color = [0.8, 0.6, 0.4]\n\
         [materials.gold]\ntype = \"conductor\"\nalpha = 0.2\n\
         eta = [0.143, 0.375, 1.442]\nk = [3.983, 2.386, 1.603]\n\
         [materials.mirror]\ntype = \"mirror\"\nreflectance = 0.9\n\
         [[meshes]]\nfile = \"ground.obj\"\nmaterial = \"ground\"\n"
    );
    for (material, x) in [("chalk", -1.5), ("gold", 0.0), ("mirror", 1.5)] {
        let sphere = repository("scenes/sphere.obj");
        text += &format!(
            "[[meshes]]\nfile = {sphere:?}\nmaterial = \"{material}\"\n\
             transform = [{{ scale = 0.65 }}, {{ translate = [{x}, 0.7, 0] }}]\n"
        );
    }
    let mut scene = gonio_io::load(&folder.write("scene.toml", text)).expect("the scene is sound");
    scene.meshes.iter_mut().for_each(|mesh| mesh.normals = None);
    scene
}

/// The map that the script calls `formula`, as a file.
fn formula(folder: &Folder) -> std::path::PathBuf {
    let texel = |row: usize, column: usize| match (row, column) {
        (3, 17) => [60.0, 50.0, 40.0],
        _ => std::array::from_fn(|channel| ((column * 7 + row * 13 + channel * 5) % 17) as f32 / 16.0),
    };
    let rgb = (0..12).flat_map(|row| (0..24).map(move |column| texel(row, column))).collect();
    let path = folder.path().join("formula.exr");
    exr::write(&path, &Picture { width: 24, height: 12, rgb, alpha: None }, None, &Metadata::default())
        .expect("the folder takes files");
    path
}

#[test]
fn a_scene_under_a_map_agrees_with_mitsuba() {
    let folder = Folder::new();
    let mut scene = under(&formula(&folder), &folder);
    scene.film.spp = 32;
    compare("environment_formula", &scene).unwrap();
    // One degree more, and the map a hundredth brighter: both are seen.
    let Sky::Map(map) = &mut scene.environment.sky else { panic!("the scene has a map") };
    map.rotation += 1.0;
    println!("as it should be: {}", compare("environment_formula", &scene).unwrap_err());
    let Sky::Map(map) = &mut scene.environment.sky else { panic!("the scene has a map") };
    (map.rotation, map.intensity) = (map.rotation - 1.0, map.intensity * 1.01);
    println!("as it should be: {}", compare("environment_formula", &scene).unwrap_err());
}

#[test]
fn scenes_under_panoramas_agree_with_mitsuba() {
    for name in ["brown_photostudio_02_1k", "noon_grass_1k"] {
        if let Some(map) = data(&format!("hdri/{name}.hdr")) {
            let folder = Folder::new();
            let map = map.canonicalize().expect("it is there");
            compare(&format!("environment_{name}"), &under(&map, &folder)).unwrap();
        }
    }
}

#[test]
fn normal_maps_agree_with_mitsuba() {
    let load = || gonio_io::load(&repository("tests/reference/normal_map.toml")).expect("the scene is shipped");
    compare("normal_map", &load()).unwrap();
    // Green downwards, or slopes a twentieth too steep: both are seen.
    let mut green = load();
    let map = &green.normal_maps[0];
    green.normal_maps = vec![turned_over(map)];
    println!("as it should be: {}", compare("normal_map", &green).unwrap_err());
    let mut steep = load();
    for material in &mut steep.materials {
        material.normal_map = material.normal_map.map(|spec| NormalMapSpec { scale: 1.05, ..spec });
    }
    println!("as it should be: {}", compare("normal_map", &steep).unwrap_err());
}

/// The scene of `tests/reference/lights.py`.
fn lights() -> Scene {
    gonio_io::load(&repository("tests/reference/lights.toml")).expect("the scene is shipped")
}

#[test]
fn point_spot_and_distant_lights_agree_with_mitsuba() {
    compare("lights", &lights()).unwrap();
    // Each light a fiftieth brighter, and the spot's edge a degree sharper: all are seen.
    let text = std::fs::read_to_string(repository("tests/reference/lights.toml")).expect("the scene is shipped");
    for (is, would_be) in [
        ("[6, 8, 10]", "[6.12, 8.16, 10.2]"),
        ("[60, 45, 30]", "[61.2, 45.9, 30.6]"),
        ("[0.9, 1.0, 1.2]", "[0.918, 1.02, 1.224]"),
        ("beam_width = 9", "beam_width = 10"),
    ] {
        assert!(text.contains(is));
        let wrong = text.replace(is, would_be);
        let scene = gonio_io::scene_from_toml_str(&wrong, &repository("tests/reference/lights.toml"));
        println!("as it should be: {}", compare("lights", &scene.expect("it is sound")).unwrap_err());
    }
}

#[test]
fn a_thin_lens_agrees_with_mitsuba() {
    let mut scene = lights();
    (scene.camera.aperture, scene.camera.focus_distance) = (0.3, 4.0);
    compare("lens", &scene).unwrap();
    // The lens twice as wide (its radius taken for its diameter), or focused elsewhere: both are seen.
    scene.camera.aperture = 0.6;
    println!("as it should be: {}", compare("lens", &scene).unwrap_err());
    (scene.camera.aperture, scene.camera.focus_distance) = (0.3, 8.0);
    println!("as it should be: {}", compare("lens", &scene).unwrap_err());
}

/// The 8 × 8 map with its green channel pointing down the image.
fn turned_over(map: &NormalMap) -> NormalMap {
    let at = |i: u32| (i as f32 + 0.5) / 8.0;
    let texel = |row: u32, column: u32| {
        let n = map.sample(at(column), 1.0 - at(row), 1.0);
        [n.x, -n.y, n.z].map(|x| ((x * 0.5 + 0.5) * 65_535.0).round() as u16)
    };
    let texels = (0..8).flat_map(|row| (0..8).map(move |column| texel(row, column))).collect();
    NormalMap::from_linear16(8, 8, texels).expect("eight times eight")
}
