//! Threads, crops, pruning, backends, scale and place never change a picture; light neither leaks in nor gets lost.

mod furnaces; // What absorbs nothing cannot be seen under a white sky.

use crate::support::{Random, cornell_box, repository};
use glam::{DAffine3, DVec3};
use gonio_accel::{Accel, Intersect, Obvhs, ObvhsOptions, Sharing};
use gonio_kernel::Rgb;
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::{AnyLobe, Conductor, Lambert, Layer, Layering, Mirror};
use gonio_kernel::microfacet::Ggx;
use gonio_tracer::scene::{Environment, LobeSpec, Material, Scene, Sky, SkyMap};
use gonio_tracer::{Backend, Crop, CustomLobe, Picture, Prepared, RenderSettings, Rendering, World, render};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::Arc;

fn rendered(scene: &Scene, backend: Backend, change: impl Fn(&mut RenderSettings)) -> Rendering {
    let world = World::new(scene).expect("the scene is sound");
    let mut settings = RenderSettings::of(scene);
    change(&mut settings);
    let prepared = Prepared::new(world, backend, Intersect::Robust).expect("the backend builds");
    render(&prepared, &settings, &mut |_| ControlFlow::Continue(()))
}

fn mean(rendering: &Rendering) -> [f64; 3] {
    let n = rendering.picture.rgb.len() as f64;
    std::array::from_fn(|c| rendering.picture.rgb.iter().map(|p| f64::from(p[c])).sum::<f64>() / n)
}

/// A Cornell box with one of everything: a mirror, a rough metal, a mixture, a sky seen through the open front.
fn varied() -> Scene {
    let mut scene = cornell_box(48, 8);
    scene.environment = Environment::constant(Rgb::new(0.2, 0.3, 0.5));
    let named = |scene: &mut Scene, name: &str, lobes: Vec<LobeSpec>| {
        scene.materials.iter_mut().find(|m| m.name == name).expect("a material of the shipped scene").lobes = lobes;
    };
    let mirror = Mirror::new(Rgb::new(0.9, 0.8, 0.7));
    let copper = Fresnel::Conductor { eta: Rgb::new(0.2, 0.9, 1.1), k: Rgb::new(3.9, 2.4, 2.3) };
    let metal = Conductor::new(Ggx { alpha_x: 0.1, alpha_y: 0.3 }, copper);
    let gloss = Conductor::new(Ggx::isotropic(0.2), Fresnel::Schlick { f0: Rgb::splat(0.05) });
    let paint = Lambert::new(Rgb::new(0.5, 0.4, 0.3));
    named(&mut scene, "red", vec![LobeSpec::new(mirror)]);
    named(&mut scene, "green", vec![LobeSpec::new(metal)]);
    let weak = LobeSpec { weight: Rgb::splat(0.8), ..LobeSpec::new(gloss) };
    named(&mut scene, "white", vec![LobeSpec::new(paint), weak]);
    scene
}

/// The same under a panorama of random texels.
fn under_a_map() -> Scene {
    let mut scene = varied();
    let mut random = Random(9);
    let rgb = (0..32 * 16).map(|_| [random.unit(), random.unit(), random.unit().powi(8) * 20.0]).collect();
    let picture = Arc::new(Picture { width: 32, height: 16, rgb, alpha: None });
    scene.environment.sky = Sky::Map(SkyMap { picture, rotation: 100.0, intensity: 0.5 });
    scene
}

#[test]
fn threads_backends_and_pruning_never_change_a_picture() {
    for scene in [cornell_box(48, 8), varied(), under_a_map()] {
        let expected = rendered(&scene, Backend::Obvhs, |s| s.threads = 1).stats.film_hash;
        for backend in Backend::ALL.into_iter().filter(|backend| backend.is_exact()) {
            for threads in [1, 2, 3] {
                let hash = rendered(&scene, backend, |s| s.threads = threads).stats.film_hash;
                assert_eq!(hash, expected, "{backend}, {threads} threads");
            }
            let hash = rendered(&scene, backend, |s| s.every_effect = true).stats.film_hash;
            assert_eq!(hash, expected, "{backend}, every effect");
        }
        assert_ne!(rendered(&scene, Backend::Obvhs, |s| s.seed = 1).stats.film_hash, expected, "another seed");
    }
}

/// Which pixels differ by more than rounding: by 1 part in 1000, as when a path of 16 takes another turn.
fn differing(a: &Rendering, b: &Rendering) -> Vec<bool> {
    let differs = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).any(|c| (a[c] - b[c]).abs() > 1e-3 * (a[c] + b[c]));
    a.picture.rgb.iter().zip(&b.picture.rgb).map(differs).collect()
}

/// Fails if more than isolated pixels, or the means, differ by more than rounding.
fn same_but_for_isolated_pixels(name: &str, expected: &Rendering, found: &Rendering) {
    let (a, b) = (mean(expected), mean(found));
    let off = (0..3).map(|c| (b[c] / a[c] - 1.0).abs()).fold(0.0, f64::max);
    let pixels = differing(expected, found);
    let count = count(&pixels);
    println!("{name}: mean off by {off:.1e}, {count} of {} pixels differ", pixels.len());
    assert!(off <= 1e-4, "{name}: {b:?} against {a:?}");
    assert!(count * 1000 <= pixels.len(), "{name}: {count} pixels differ");
    let width = expected.picture.width as usize;
    let at = |i: usize| pixels.get(i).copied().unwrap_or(false);
    let touch = (0..pixels.len()).find(|&i| at(i) && (at(i + width) || (i + 1) % width != 0 && at(i + 1)));
    assert_eq!(touch, None, "{name}: two differing pixels touch");
}

fn count(pixels: &[bool]) -> usize {
    pixels.iter().filter(|differs| **differs).count()
}

/// The shipped spheres, in little.
fn spheres() -> Scene {
    let mut scene = gonio_io::load(&repository("scenes/spheres.toml")).expect("the shipped scene loads");
    (scene.film.width, scene.film.height, scene.film.spp) = (96, 64, 16);
    scene
}

#[test]
fn backends_that_are_exact_up_to_rounding_render_the_same_picture_but_for_isolated_pixels() {
    for (name, scene) in [("Cornell box", cornell_box(64, 16)), ("varied", varied()), ("spheres", spheres())] {
        let expected = rendered(&scene, Backend::Obvhs, |_| ());
        let other = differing(&expected, &rendered(&scene, Backend::Obvhs, |s| s.seed = 1));
        assert!(count(&other) * 3 > other.len(), "{name}: {} pixels differ with another seed", count(&other));
        for backend in Backend::ALL.into_iter().filter(|backend| !backend.is_exact()) {
            same_but_for_isolated_pixels(&format!("{name}, {backend}"), &expected, &rendered(&scene, backend, |_| ()));
        }
    }
}

#[test]
fn meshes_that_are_kept_once_look_as_if_they_were_laid_out() {
    let mut mirrored = spheres();
    for instance in &mut mirrored.instances[1..4] {
        instance.transform.matrix3.x_axis *= -1.0;
    }
    let rendered = |scene: &Scene, world: Sharing, tree: Sharing| {
        let world = World::by(scene, world).expect("the scene is sound");
        let settings = RenderSettings::of(scene);
        let options = ObvhsOptions { sharing: tree, ..Default::default() };
        let prepared = Prepared::by(world, |geometry| -> Result<Box<dyn Accel>, Infallible> {
            Ok(Box::new(Obvhs::always_tree(geometry, options)))
        });
        let Ok(prepared) = prepared;
        render(&prepared, &settings, &mut |_| ControlFlow::Continue(()))
    };
    for (name, scene) in [("varied", varied()), ("spheres", spheres()), ("mirrored spheres", mirrored)] {
        let laid_out = rendered(&scene, Sharing::Never, Sharing::Never);
        let kept = rendered(&scene, Sharing::Always, Sharing::Always);
        same_but_for_isolated_pixels(name, &laid_out, &kept);
        let hash = rendered(&scene, Sharing::Always, Sharing::Never).stats.film_hash;
        assert_eq!(kept.stats.film_hash, hash, "{name}: by a tree that is laid out");
    }
}

#[test]
fn scenes_have_the_same_fingerprint_exactly_if_they_look_the_same() {
    let print = |scene: &Scene| World::new(scene).expect("the scene is sound").fingerprint();
    let scene = varied();
    assert_eq!(print(&scene), print(&scene.clone()));
    let changed = |change: &dyn Fn(&mut Scene)| {
        let mut other = scene.clone();
        change(&mut other);
        print(&other)
    };
    let prints = [
        print(&scene),
        changed(&|s| s.meshes[0].positions[3][1] += 1e-3),
        changed(&|s| s.materials[0].two_sided ^= true),
        changed(&|s| s.camera.vfov += 1.0),
        changed(&|s| s.environment = Environment::constant(Rgb::splat(0.25))),
        changed(&|s| s.film.width += 1),
    ];
    for (i, print) in prints.iter().enumerate() {
        assert!(!prints[..i].contains(print), "change {i} does not show");
    }
}

#[test]
fn which_instance_shows_which_of_two_meshes_that_are_kept_once_is_in_the_fingerprint() {
    let mut scene = spheres();
    let mesh = scene.instances[1].mesh;
    let mut other = scene.meshes[mesh].clone();
    other.positions[0][1] *= 1.5;
    scene.meshes.push(other);
    let other = scene.meshes.len() - 1;
    let print = |which: [usize; 4]| {
        let mut scene = scene.clone();
        let first = scene.instances[1].clone();
        let all = which.iter().enumerate().map(|(i, &mesh)| {
            let mut instance = first.clone();
            instance.mesh = mesh;
            instance.transform.translation.x += i as f64;
            instance
        });
        scene.instances.extend(all);
        World::by(&scene, Sharing::Always).expect("the scene is sound").fingerprint()
    };
    assert_eq!(print([mesh, mesh, other, other]), print([mesh, mesh, other, other]));
    assert_ne!(print([mesh, mesh, other, other]), print([mesh, other, mesh, other]));
}

#[test]
fn a_crop_has_the_pixels_of_the_whole_picture() {
    let scene = cornell_box(40, 3);
    let whole = rendered(&scene, Backend::Obvhs, |_| ()).picture;
    let crop = Crop { x0: 5, x1: 31, y0: 11, y1: 29 };
    let part = rendered(&scene, Backend::Obvhs, |s| s.crop = Some(crop)).picture;
    assert_eq!((part.width, part.height), (26, 18));
    for y in 0..part.height {
        for x in 0..part.width {
            let at = |w: u32, x: u32, y: u32| (y * w + x) as usize;
            assert_eq!(part.rgb[at(part.width, x, y)], whole.rgb[at(whole.width, x + crop.x0, y + crop.y0)]);
        }
    }
}

/// The scene scaled about its origin and then moved.
fn moved(scene: &Scene, scale: f64, by: DVec3) -> Scene {
    let mut scene = scene.clone();
    let map = DAffine3::from_scale_rotation_translation(DVec3::splat(scale), glam::DQuat::IDENTITY, by);
    for instance in &mut scene.instances {
        instance.transform = map * instance.transform;
    }
    scene.camera.origin = map.transform_point3(scene.camera.origin);
    scene.camera.target = map.transform_point3(scene.camera.target);
    scene
}

#[test]
fn scale_and_place_do_not_change_the_mean() {
    let scene = cornell_box(64, 16);
    let original = mean(&rendered(&scene, Backend::Obvhs, |_| ()));
    let far = DVec3::new(1e5, -1e5, 1e5);
    for (scale, by) in [1e-4, 1e-2, 1e2, 1e5].map(|s| (s, DVec3::ZERO)).into_iter().chain([(1.0, far)]) {
        let got = mean(&rendered(&moved(&scene, scale, by), Backend::Obvhs, |_| ()));
        for c in 0..3 {
            let off = got[c] / original[c] - 1.0;
            assert!(off.abs() < 1e-3, "scale {scale}, moved by {by}: channel {c} is off by {off:e}");
        }
    }
}

#[test]
fn no_light_leaks_into_a_closed_black_box() {
    // The camera sits inside a closed box under a bright sky. All albedos are 1, so paths live long and touch every edge.
    let mut scene = cornell_box(32, 64);
    let room = scene.meshes[0].clone();
    let (mut mesh, first) = (room.clone(), room.positions.len() as u32);
    // A front wall closes the room; the lamp goes dark.
    mesh.positions.extend([[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]]);
    mesh.triangles.extend([[first, first + 2, first + 1], [first, first + 3, first + 2]]);
    mesh.materials.extend([0, 0]);
    scene.meshes[0] = mesh;
    scene.camera.origin = DVec3::new(0.0, 0.0, 0.9);
    scene.environment = Environment::constant(Rgb::splat(1.0));
    scene.integrator.max_depth = 16;
    scene.integrator.russian_roulette = false;
    for m in &mut scene.materials {
        m.emission = Rgb::zero();
        m.two_sided = true;
        m.lobes = vec![LobeSpec::new(Lambert::new(Rgb::splat(1.0)))];
    }
    for (scale, by) in [(1.0, DVec3::ZERO), (1e-4, DVec3::ZERO), (1e5, DVec3::ZERO), (1.0, DVec3::splat(1e5))] {
        let rendering = rendered(&moved(&scene, scale, by), Backend::Obvhs, |_| ());
        let bright = rendering.stats.largest.len();
        assert_eq!(bright, 0, "at scale {scale}, moved by {by}: {:?}", rendering.stats.largest);
    }
}

/// The shipped white furnace with an object of another material.
fn furnace_of(lobe: impl Into<AnyLobe<'static, f32>>) -> Scene {
    let lobe = lobe.into();
    let mut scene = gonio_io::load(&repository("scenes/furnace-white.toml")).expect("the shipped scene loads");
    (scene.film.width, scene.film.height, scene.film.spp) = (32, 32, 64);
    scene.integrator.max_depth = 256;
    scene.integrator.russian_roulette = false;
    for material in &mut scene.materials {
        material.lobes = vec![LobeSpec::new(lobe)];
    }
    scene
}

#[test]
fn russian_roulette_is_unbiased() {
    let mut scene = cornell_box(32, 64);
    scene.integrator.max_depth = 32;
    let run = |russian_roulette| -> Vec<[f64; 3]> {
        let one = |seed| {
            mean(&rendered(&scene, Backend::Obvhs, |s| {
                s.seed = seed;
                s.russian_roulette = russian_roulette;
            }))
        };
        (0..16).map(one).collect()
    };
    let (with, without) = (run(true), run(false));
    for c in 0..3 {
        let moments = |runs: &[[f64; 3]]| {
            let m = runs.iter().map(|r| r[c]).sum::<f64>() / 16.0;
            (m, runs.iter().map(|r| (r[c] - m).powi(2)).sum::<f64>() / 15.0 / 16.0)
        };
        let ((a, va), (b, vb)) = (moments(&with), moments(&without));
        // Three channels at 0.01 in all, two-sided, 30 degrees of freedom: t = 3.2.
        assert!((a - b).abs() < 3.2 * (va + vb).sqrt(), "channel {c}: {a} against {b}");
    }
}

#[test]
fn a_sample_that_is_dropped_is_counted() {
    let rendering = rendered(&cornell_box(16, 4), Backend::Obvhs, |_| ());
    assert_eq!(rendering.stats.dropped_samples, 0);
    assert_eq!(rendering.stats.samples, 16 * 16 * 4);
    assert!(rendering.stats.lanes_full > 0.9, "{}", rendering.stats.lanes_full);
    assert!(rendering.stats.largest.is_sorted_by(|a, b| a.value >= b.value));
}

#[test]
fn a_lobe_of_ones_own_renders_as_the_same_lobe_of_a_file() {
    let chalk = Lambert::new(Rgb::new(0.8, 0.5, 0.2));
    let from_file = furnace_of(chalk);
    let mut own = from_file.clone();
    for material in &mut own.materials {
        *material = Material::of_lobe("own", CustomLobe::new(chalk));
    }
    let (a, b) = (rendered(&from_file, Backend::Obvhs, |_| ()), rendered(&own, Backend::Obvhs, |_| ()));
    assert_eq!(a.stats.film_hash, b.stats.film_hash);
    // Two materials may share a lobe, and differ in all else.
    let shared = CustomLobe::new(chalk);
    for (i, material) in own.materials.iter_mut().enumerate() {
        *material = Material { emission: Rgb::splat(0.0), ..Material::of_lobe("own", shared.clone()) };
        material.two_sided = i % 2 == 0;
    }
    own.materials.push(Material { two_sided: false, ..Material::of_lobe("other", shared) });
    let other = own.materials.len() as u32 - 1;
    for mesh in &mut own.meshes {
        mesh.materials.iter_mut().step_by(2).for_each(|m| *m = other);
    }
    let c = rendered(&own, Backend::Obvhs, |_| ());
    assert_eq!(a.stats.film_hash, c.stats.film_hash);
    // A layer, which no single lobe of the kernel is.
    let coat = Conductor::new(Ggx::isotropic(0.2), Fresnel::Dielectric { eta: 1.5 });
    let layer = Layer::new(coat, Lambert::new(Rgb::splat(1.0)), Layering::Reciprocal).expect("a coat");
    for material in &mut own.materials {
        *material = Material::of_lobe("own", CustomLobe::new(layer));
    }
    let [r, ..] = mean(&rendered(&own, Backend::Obvhs, |_| ()));
    assert!((r - 1.0).abs() < 2e-3, "{r}");
}
