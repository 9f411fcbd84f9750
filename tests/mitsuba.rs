//! The Cornell box is the picture that Mitsuba 3 makes: `tests/reference/cornell_box.json`, written by the script beside it.
//!
//! Sixteen seeds on each side. The picture's mean per channel must agree within 0.3 % at a standard error of the
//! difference of at most 0.1 %. Blocks of 8 × 8 pixels are compared by Welch's t-test at a family-wise level of 0.01
//! (Šidák over blocks and channels); a block fails only if it is significant and more than 0.5 % off. Blocks with emitter or
//! silhouette pixels, where pixel filters and edge rules show, are counted apart.

use crate::support::{cornell_box, repository};
use gonio_accel::Intersect;
use gonio_tracer::{Backend, RenderSettings, World, render};
use serde::Deserialize;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::ops::ControlFlow;

#[derive(Deserialize)]
struct Reference {
    width: u32,
    seeds: usize,
    block: usize,
    scattering_events: u32,
    image_mean: [f64; 3],
    image_variance: [f64; 3],
    mean: Vec<f64>,
    variance: Vec<f64>,
    excluded: Vec<usize>,
}

/// Mean and variance (n − 1) of the same quantity over seeds.
struct Moments {
    mean: f64,
    variance: f64,
}

fn moments(values: impl Iterator<Item = f64> + Clone) -> Moments {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    Moments { mean, variance: values.map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0) }
}

/// Two-sided p-value of Welch's t-test for two samples of n.
fn welch(a: &Moments, b: &Moments, n: f64) -> f64 {
    let (va, vb) = (a.variance / n, b.variance / n);
    if va + vb == 0.0 {
        return if a.mean == b.mean { 1.0 } else { 0.0 };
    }
    let freedom = (va + vb).powi(2) / ((va * va + vb * vb) / (n - 1.0));
    let t = (a.mean - b.mean).abs() / (va + vb).sqrt();
    2.0 * StudentsT::new(0.0, 1.0, freedom).expect("positive degrees of freedom").sf(t)
}

#[test]
fn the_cornell_box_agrees_with_mitsuba() {
    let text =
        std::fs::read_to_string(repository("tests/reference/cornell_box.json")).expect("the reference is shipped");
    let reference: Reference = serde_json::from_str(&text).expect("the reference is JSON");
    let scene = cornell_box(reference.width, 16);
    let world = World::new(&scene).expect("the shipped scene is sound");
    let accel = Backend::Obvhs.build(world.geometry(), Intersect::Robust).expect("obvhs needs nothing");
    let (size, block) = (reference.width as usize, reference.block);
    let per_row = size / block;

    let mut images: Vec<[f64; 3]> = Vec::new();
    let mut blocks: Vec<Vec<f64>> = Vec::new();
    for seed in 0..reference.seeds as u64 {
        let mut settings = RenderSettings { seed: 1000 + seed, ..RenderSettings::of(&scene, &world) };
        settings.max_depth = reference.scattering_events;
        let picture = render(&world, &*accel, &settings, &mut |_| ControlFlow::Continue(())).picture;
        let mut sums = vec![0.0; reference.mean.len()];
        for (i, rgb) in picture.rgb.iter().enumerate() {
            let at = i / size / block * per_row + i % size / block;
            (0..3).for_each(|c| sums[3 * at + c] += f64::from(rgb[c]) / (block * block) as f64);
        }
        let count = (per_row * per_row) as f64;
        images.push(std::array::from_fn(|c| sums.iter().skip(c).step_by(3).sum::<f64>() / count));
        blocks.push(sums);
    }

    let n = reference.seeds as f64;
    for c in 0..3 {
        let ours = moments(images.iter().map(|i| i[c]));
        let difference = ours.mean / reference.image_mean[c] - 1.0;
        let error = ((ours.variance + reference.image_variance[c]) / n).sqrt() / reference.image_mean[c];
        println!("channel {c}: {:+.4} % ± {:.4} %", 100.0 * difference, 100.0 * error);
        assert!(error <= 1e-3 && difference.abs() <= 3e-3, "channel {c}: {difference} ± {error}");
    }

    let kept: Vec<usize> = (0..per_row * per_row).filter(|b| !reference.excluded.contains(b)).collect();
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
    assert!(failed.is_empty(), "{} of {}: {failed:#?}", failed.len(), 3 * kept.len());
}
