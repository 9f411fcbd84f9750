//! Environment maps in whole pictures: what they light, what is seen of them, and that every technique finds the same light.
//!
//! Expectations are integrals of the map in f64, texel by texel, written a second time here.

use crate::support::{Folder, moments, repository, welch};
use gonio_accel::Intersect;
use gonio_tracer::scene::{Environment, Scene, Sky, SkyMap};
use gonio_tracer::{Backend, Picture, Prepared, RenderSettings, Techniques, World, render};
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;
use std::sync::Arc;

/// What a correct tracer may fail by chance, per test (Šidák).
const SIGNIFICANCE: f64 = 0.01;
/// Seeds per mean.
const SEEDS: u64 = 16;

fn level(tests: usize) -> f64 {
    -((-SIGNIFICANCE).ln_1p() / tests as f64).exp_m1()
}

/// A sky with a gradient, a coloured pattern and a small sun; nothing in it is symmetric.
fn sky(rotation: f64) -> SkyMap {
    let texel = |x: i32, y: i32| match (x, y) {
        (12, 4) => [80.0, 70.0, 60.0],
        _ => [(x * 7 + y * 3) % 11, (x * 5 + y) % 7, (x + y * 9) % 13].map(|k| 0.1 * k as f32),
    };
    let rgb = (0..16).flat_map(|y| (0..32).map(move |x| texel(x, y))).collect();
    SkyMap { picture: Arc::new(Picture { width: 32, height: 16, rgb, alpha: None }), rotation, intensity: 0.5 }
}

/// Radiance from (u, v): bilinear between texel centres, columns wrap, the first and last row hold up to the poles.
fn radiance(sky: &SkyMap, u: f64, v: f64) -> [f64; 3] {
    let (width, height) = (i64::from(sky.picture.width), i64::from(sky.picture.height));
    let (x, y) = ((u + sky.rotation / 360.0) * width as f64 - 0.5, v * height as f64 - 0.5);
    let (i, j) = (x.floor() as i64, y.floor() as i64);
    std::array::from_fn(|c| {
        let mut sum = 0.0;
        for (k, l) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let at = (j + l).clamp(0, height - 1) * width + (i + k).rem_euclid(width);
            let weight = (1.0 - (x - (i + k) as f64).abs()) * (1.0 - (y - (j + l) as f64).abs());
            sum += weight * f64::from(sky.picture.rgb[at as usize][c]);
        }
        sum * f64::from(sky.intensity)
    })
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// ∫ L max(n·ω, 0) dω by the midpoint rule, 16 × 16 points to a texel.
fn irradiance(sky: &SkyMap, n: [f64; 3]) -> [f64; 3] {
    let (columns, rows) = (16 * sky.picture.width, 16 * sky.picture.height);
    let mut sum = [0.0; 3];
    for row in 0..rows {
        let v = (f64::from(row) + 0.5) / f64::from(rows);
        let (sin, cos) = (v * PI).sin_cos();
        for column in 0..columns {
            let u = (f64::from(column) + 0.5) / f64::from(columns);
            let (s, c) = (u * TAU).sin_cos();
            let cosine = dot(n, [sin * s, cos, -sin * c]);
            if cosine > 0.0 {
                let weight = cosine * sin * TAU * PI / f64::from(columns * rows);
                let light = radiance(sky, u, v);
                (0..3).for_each(|c| sum[c] += light[c] * weight);
            }
        }
    }
    sum
}

/// A plate at the origin with normal n, filling the picture of a camera that sees it from direction `from`.
fn plate(material: &str, n: [f64; 3], from: [f64; 3], folder: &Folder) -> Scene {
    let axis = if n[1].abs() < 0.9 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let x = cross(axis, n);
    let y = cross(n, x);
    let corner =
        |i: f64, j: f64| format!("v {} {} {}\n", i * x[0] + j * y[0], i * x[1] + j * y[1], i * x[2] + j * y[2]);
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(i, j)| corner(i, j));
    folder.write("plate.obj", corners.concat() + "f 1 2 3 4\n");
    let up = if from[1].abs() < 0.9 { [0, 1, 0] } else { [0, 0, 1] };
    let text = format!(
        "[film]\nwidth = 4\nheight = 4\nspp = 256\n[integrator]\nmax_depth = 1\n\
         [camera]\norigin = {:?}\ntarget = [0, 0, 0]\nup = {up:?}\nvfov = 0.01\n\
         [materials.m]\n{material}\n[[meshes]]\nfile = \"plate.obj\"\nmaterial = \"m\"\n",
        from.map(|c| 4.0 * c)
    );
    gonio_io::load(&folder.write("plate.toml", text)).expect("the scene is sound")
}

fn lit(mut scene: Scene, sky: SkyMap) -> Scene {
    scene.environment = Environment { sky: Sky::Map(sky), camera_visible: true, illuminates: true };
    scene
}

/// The mean of the picture for each seed.
fn means(scene: &Scene, change: impl Fn(&mut RenderSettings)) -> Vec<[f64; 3]> {
    let world = World::new(scene).expect("the scene is sound");
    let prepared = Prepared::new(world, Backend::Obvhs, Intersect::Robust).expect("obvhs needs nothing");
    let one = |seed| {
        let mut settings = RenderSettings { seed, ..RenderSettings::of(scene) };
        change(&mut settings);
        let rgb = render(&prepared, &settings, &mut |_| ControlFlow::Continue(())).picture.rgb;
        std::array::from_fn(|c| rgb.iter().map(|p| f64::from(p[c])).sum::<f64>() / rgb.len() as f64)
    };
    (0..SEEDS).map(one).collect()
}

/// The smallest p-value over channels that two lists of means, or a list and a number, are the same.
fn p_value(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let channel = |c: usize| welch(&moments(a.iter().map(|m| m[c])), &moments(b.iter().map(|m| m[c])), SEEDS as f64);
    (0..3).map(channel).fold(1.0, f64::min)
}

const NORMALS: [[f64; 3]; 6] =
    [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.6, 0.64, 0.48], [-0.36, -0.48, -0.8]];

#[test]
fn a_white_plate_shows_the_irradiance_of_the_map() {
    let folder = Folder::new();
    let level = level(3 * 2 * NORMALS.len());
    for rotation in [0.0, 90.0] {
        for n in NORMALS {
            let scene = lit(plate("base_color = 1", n, n, &folder), sky(rotation));
            let got = means(&scene, |_| ());
            let right = irradiance(&sky(rotation), n).map(|e| e / PI);
            // The quadrature is off by about 1e-4 of the whole; a two-sided test against that number.
            let p = |scale: f64| {
                let p = |c: usize| {
                    let ours = moments(got.iter().map(|m| m[c]));
                    let beyond = ((ours.mean - scale * right[c]).abs() - 2e-4 * right[c]).max(0.0);
                    let t = beyond / (ours.variance / SEEDS as f64).sqrt();
                    crate::support::student(t, SEEDS as f64 - 1.0)
                };
                (0..3).map(p).fold(1.0, f64::min)
            };
            assert!(p(1.0) >= level, "{n:?} at {rotation}: {:?} instead of {right:?}", got[0]);
            assert!(p(1.02) < level, "a fault of 2 % is not seen at {n:?}");
        }
    }
}

#[test]
fn a_mirror_shows_the_right_texel_and_another_one_when_the_map_turns() {
    let folder = Folder::new();
    let from = [0.48, 0.6, 0.64];
    for n in NORMALS.into_iter().filter(|n| dot(*n, from) > 0.1) {
        let seen =
            |rotation: f64| means(&lit(plate("type = \"mirror\"", n, from, &folder), sky(rotation)), |s| s.spp = 1)[0];
        let cos = dot(n, from);
        let [x, y, z] = std::array::from_fn(|i| 2.0 * cos * n[i] - from[i]);
        let (u, v) = (x.atan2(-z) / TAU, y.acos() / PI);
        for rotation in [0.0, 90.0] {
            let right = radiance(&sky(rotation), u, v);
            let got = seen(rotation);
            // A picture of 0.01 degrees is 1e-3 texels wide, and texels differ by 0.6 but at the sun.
            assert!(
                (0..3).all(|c| (got[c] - right[c]).abs() < 2e-3),
                "{n:?} at {rotation}: {got:?} instead of {right:?}"
            );
            assert!((0..3).any(|c| (got[c] - seen(rotation + 90.0)[c]).abs() > 2e-3), "{n:?}: turning does nothing");
        }
    }
}

#[test]
fn a_map_can_be_only_seen_or_only_light() {
    let folder = Folder::new();
    let mut scene = lit(plate("base_color = 1", NORMALS[4], NORMALS[4], &folder), sky(0.0));
    scene.camera.vfov = 60.0; // the plate in the middle, the sky around it
    (scene.film.width, scene.film.height) = (16, 16);
    let mut picture = |camera_visible, illuminates| {
        (scene.environment.camera_visible, scene.environment.illuminates) = (camera_visible, illuminates);
        let world = World::new(&scene).expect("the scene is sound");
        let prepared = Prepared::new(world, Backend::Obvhs, Intersect::Robust).expect("obvhs needs nothing");
        render(&prepared, &RenderSettings::of(&scene), &mut |_| ControlFlow::Continue(())).picture.rgb
    };
    let (both, light, background) = (picture(true, true), picture(false, true), picture(true, false));
    let (corner, middle) = (0, 8 * 16 + 8);
    assert!(both[corner][0] > 0.0 && both[middle][0] > 0.0);
    assert_eq!((light[corner], light[middle]), ([0.0; 3], both[middle]));
    assert_eq!((background[corner], background[middle]), (both[corner], [0.0; 3]));
}

/// A ground, a lamp, and a diffuse, a rough and a mirror sphere; small.
fn objects(folder: &Folder) -> Scene {
    folder.write("ground.obj", "v -3 0 -3\nv -3 0 3\nv 3 0 3\nv 3 0 -3\nf 1 2 3 4\n");
    folder.write("lamp.obj", "v -1 2.4 -1\nv 1 2.4 -1\nv 1 2.4 0\nv -1 2.4 0\nf 1 2 3 4\n");
    let mut text = "[film]\nwidth = 32\nheight = 24\nspp = 64\n[integrator]\nmax_depth = 3\n\
                    [camera]\norigin = [0, 2, 5]\ntarget = [0, 0.6, 0]\n\
                    [materials.chalk]\nbase_color = 0.7\n[materials.lamp]\nbase_color = 0\nemission = 4\n\
                    [materials.gold]\ntype = \"conductor\"\nf0 = [0.9, 0.7, 0.3]\nalpha = 0.3\n\
                    [[meshes]]\nfile = \"ground.obj\"\nmaterial = \"chalk\"\n\
                    [[meshes]]\nfile = \"lamp.obj\"\nmaterial = \"lamp\"\n"
        .to_owned();
    for (material, x) in [("chalk", -0.8), ("gold", 0.8)] {
        let sphere = repository("scenes/sphere.obj");
        text += &format!(
            "[[meshes]]\nfile = {sphere:?}\nmaterial = \"{material}\"\n\
             transform = [{{ scale = 0.65 }}, {{ translate = [{x}, 0.7, 0] }}]\n"
        );
    }
    gonio_io::load(&folder.write("scene.toml", text)).expect("the scene is sound")
}

#[test]
fn asking_lights_scattering_and_both_find_the_same_light() {
    let folder = Folder::new();
    let scene = lit(objects(&folder), sky(20.0));
    let by = |scene: &Scene, techniques| means(scene, |s| s.techniques = techniques);
    let both = by(&scene, Techniques::Both);
    let level = level(3 * 2);
    for alone in [Techniques::Lights, Techniques::Scattering] {
        let p = p_value(&both, &by(&scene, alone));
        assert!(p >= level, "{alone:?}: p = {p:e}");
    }
    let mut brighter = scene.clone();
    if let Sky::Map(map) = &mut brighter.environment.sky {
        map.intensity *= 1.03;
    }
    let p = p_value(&both, &by(&brighter, Techniques::Lights));
    assert!(p < level, "a fault of 3 % is not seen: p = {p:e}");
}
