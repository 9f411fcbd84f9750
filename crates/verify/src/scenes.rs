//! Furnace scenes: pictures whose every pixel is known, rendered through the whole tracer.
//!
//! **scene-furnace.** In a closed room whose walls emit L and reflect the part a of what arrives, whatever the shape of the
//! reflection, radiance is the same everywhere: L·(1 + a + a² + …). With max_depth d the sum ends with aᵈ, so the answer is
//! L·(1 − a^(d+1))/(1 − a) exactly. A white convex object under a uniform sky vanishes, and a grey one shows the sky times
//! its albedo, because no light comes back to it. Every block of pixels is tested against that number (see
//! [`crate::blocks`]).
//!
//! **scene-hash.** Number of threads and the pruning of effects never change a bit of the film, nor does the backend if it
//! finds the same bits as brute force ([`Backend::is_exact`]).
//!
//! **scene-mean.** A backend that finds the same hits up to rounding has the same mean picture, within [`SAME_MEAN`].
//!
//! **scene-samples.** No sample was dropped as not finite or out of range.

mod furnace;

use crate::blocks::{Worst, tests, worst_block};
use crate::error::Error;
use crate::outcome::outcome;
use furnace::{FURNACES, Furnace, Shot};
use gonio_io::png;
use gonio_lab::{Check, Effort, Options, sidak};
use gonio_report::{Exhibit, Speed};
use gonio_tracer::{Backend, Picture};
use std::path::Path;
use std::time::Instant;

/// Name and meaning of the instruments in this file.
pub(crate) const INSTRUMENTS: [(&str, &str); 4] = [
    ("scene-furnace", "rendered furnaces have their analytic radiance in every block of pixels, with every backend"),
    ("scene-hash", "exact backends, number of threads and pruning of effects do not change a bit of a picture"),
    ("scene-mean", "backends that are exact up to rounding render the same mean picture, within 0.01 %"),
    ("scene-samples", "rendering drops no sample as not finite or out of range"),
];

/// How far, as a part of it, the mean of a picture may change with the backend: 0.01 %. Samples are the same but for the
/// paths of those rays that meet an edge.
const SAME_MEAN: f64 = 1e-4;

/// Renders all furnaces and hands their checks to `sink`.
pub(crate) fn run(options: &Options, out: &Path, sink: &mut dyn FnMut(Check)) -> Result<Vec<Exhibit>, Error> {
    let folder = out.join("scenes");
    let tests: usize = FURNACES.iter().map(|f| f.shots().len() * tests(f.size, f.size)).sum();
    let level = sidak(options.significance, tests);
    let mut exhibits = Vec::new();
    for furnace in &FURNACES {
        let instruments = INSTRUMENTS.iter().map(|(name, _)| *name).chain(["planted-faults"]);
        if instruments.into_iter().any(|instrument| may_want(options, instrument, furnace.name)) {
            exhibits.push(measure(furnace, options, level, &folder, out, sink)?);
        }
    }
    Ok(exhibits)
}

fn measure(
    furnace: &Furnace,
    options: &Options,
    level: f64,
    folder: &Path,
    out: &Path,
    sink: &mut dyn FnMut(Check),
) -> Result<Exhibit, Error> {
    let scene = furnace.unpack(folder)?;
    let mut send = |check: Check| {
        if options.want(&check.instrument, &check.subject) {
            sink(check);
        }
    };
    let spp = match options.effort {
        Effort::Quick => 16,
        Effort::Standard => 64,
        Effort::Full => 1024,
    };
    let mut dropped = 0;
    let mut samples = 0;
    let mut pictures: Vec<(Shot, Picture, String)> = Vec::new();
    let mut speeds: Vec<Speed> = Vec::new();
    for shot in furnace.shots() {
        let start = Instant::now();
        let rendering = furnace.render(&scene, &shot, spp, options.seed)?;
        let backend = shot.backend.to_string();
        if speeds.iter().all(|speed| speed.backend != backend) {
            let seconds = rendering.stats.render_seconds.max(1e-9);
            speeds.push(Speed { backend, msamples_per_second: rendering.stats.samples as f64 / seconds / 1e6 });
        }
        let picture = rendering.picture;
        let worst = worst_block(&picture, furnace.answer(&scene), furnace.slack(&scene));
        dropped += rendering.stats.dropped_samples;
        samples += rendering.stats.samples;
        send(p_value(furnace, &shot, &worst, level, spp, start));
        pictures.push((shot, picture, rendering.stats.film_hash));
    }
    let picture = pictures[0].1.clone();
    planted_faults(furnace, &scene, &picture, level, &mut send);
    hashes(furnace, &scene, options, &pictures, &mut send)?;
    means(furnace, &pictures, &mut send);
    send(Check {
        instrument: "scene-samples".to_owned(),
        subject: furnace.name.to_owned(),
        outcome: outcome(dropped == 0),
        measured: dropped as f64,
        limit: 0.0,
        meaning: "samples dropped ≤".to_owned(),
        detail: format!("of {samples} samples"),
        seconds: 0.0,
    });
    exhibit(furnace, &scene, &picture, speeds, out)
}

fn p_value(furnace: &Furnace, shot: &Shot, worst: &Worst, level: f64, spp: u32, start: Instant) -> Check {
    Check {
        instrument: "scene-furnace".to_owned(),
        subject: format!("{}, {shot}", furnace.name),
        outcome: outcome(worst.p >= level),
        measured: worst.p,
        limit: level,
        meaning: "p ≥".to_owned(),
        detail: format!("{}; {spp} samples per pixel", worst.place),
        seconds: start.elapsed().as_secs_f64(),
    }
}

/// Pictures that are wrong on purpose: the test must reject each.
fn planted_faults(
    furnace: &Furnace,
    scene: &gonio_tracer::scene::Scene,
    picture: &Picture,
    level: f64,
    send: &mut dyn FnMut(Check),
) {
    type Fault = (&'static str, fn(usize, usize, [f32; 3]) -> [f32; 3]);
    let faults: [Fault; 3] = [
        ("everything 2 % too bright", |_, _, rgb| rgb.map(|x| x * 1.02)),
        ("one block 20 % too dark", |x, y, rgb| if x / 8 == 3 && y / 8 == 2 { rgb.map(|x| x * 0.8) } else { rgb }),
        ("one pixel not a number", |x, y, rgb| if (x, y) == (40, 9) { [f32::NAN; 3] } else { rgb }),
    ];
    for (name, fault) in faults {
        let start = Instant::now();
        let mut wrong = picture.clone();
        let width = wrong.width as usize;
        wrong.rgb.iter_mut().enumerate().for_each(|(i, rgb)| *rgb = fault(i % width, i / width, *rgb));
        let worst = worst_block(&wrong, furnace.answer(scene), furnace.slack(scene));
        send(Check {
            instrument: "planted-faults".to_owned(),
            subject: format!("scene-furnace: {}, {name}", furnace.name),
            outcome: outcome(worst.p < level),
            measured: worst.p,
            limit: level,
            meaning: "p of the fault <".to_owned(),
            detail: worst.place,
            seconds: start.elapsed().as_secs_f64(),
        });
    }
}

/// Everything that may not change a bit, and one thing that must.
fn hashes(
    furnace: &Furnace,
    scene: &gonio_tracer::scene::Scene,
    options: &Options,
    pictures: &[(Shot, Picture, String)],
    send: &mut dyn FnMut(Check),
) -> Result<(), Error> {
    const SPP: u32 = 4; // a bit is as easily wrong in few samples as in many
    let start = Instant::now();
    let base =
        Shot { backend: Backend::Obvhs, threads: 1, every_effect: false, roulette: scene.integrator.russian_roulette };
    let mut variants = Vec::new();
    for backend in Backend::ALL {
        for threads in [1, 2] {
            variants.push(Shot { backend, threads, ..base });
        }
        variants.push(Shot { backend, every_effect: true, ..base });
    }
    let expected = furnace.render(scene, &base, SPP, options.seed)?.stats.film_hash;
    let mut differing = Vec::new();
    let mut own: Vec<(Backend, String)> = Vec::new(); // what a backend that is not exact must repeat
    for shot in &variants {
        let hash = furnace.render(scene, shot, SPP, options.seed)?.stats.film_hash;
        let first = own.iter().find(|(backend, _)| *backend == shot.backend).map(|(_, hash)| hash.clone());
        let expected = if shot.backend.is_exact() { &expected } else { first.as_ref().unwrap_or(&hash) };
        if hash != *expected {
            differing.push(format!("{shot}: {hash}"));
        }
        own.push((shot.backend, hash));
    }
    // The long renderings as well, among those that differ in the backend alone.
    for (shot, _, hash) in pictures.iter().filter(|(shot, ..)| shot.backend.is_exact()) {
        let twin = pictures.iter().find(|(other, ..)| other.roulette == shot.roulette).map(|(.., hash)| hash);
        if twin != Some(hash) {
            differing.push(format!("{shot}: {hash}"));
        }
    }
    let compared = variants.len() + pictures.len();
    send(Check {
        instrument: "scene-hash".to_owned(),
        subject: format!("{}: backends, threads, plans", furnace.name),
        outcome: outcome(differing.is_empty()),
        measured: differing.len() as f64,
        limit: 0.0,
        meaning: "film hashes that differ ≤".to_owned(),
        detail: if differing.is_empty() { format!("{compared} renderings, {expected}") } else { differing.join("; ") },
        seconds: start.elapsed().as_secs_f64(),
    });
    if furnace.noisy {
        let start = Instant::now();
        let other = furnace.render(scene, &base, SPP, options.seed ^ 1)?.stats.film_hash;
        send(Check {
            instrument: "planted-faults".to_owned(),
            subject: format!("scene-hash: {}, another seed", furnace.name),
            outcome: outcome(other != expected),
            measured: f64::from(u8::from(other != expected)),
            limit: 1.0,
            meaning: "differences noticed ≥".to_owned(),
            detail: String::new(),
            seconds: start.elapsed().as_secs_f64(),
        });
    }
    Ok(())
}

/// The means of backends that are not exact, against those of obvhs.
fn means(furnace: &Furnace, pictures: &[(Shot, Picture, String)], send: &mut dyn FnMut(Check)) {
    let mean = |picture: &Picture| -> [f64; 3] {
        let n = picture.rgb.len() as f64;
        std::array::from_fn(|c| picture.rgb.iter().map(|rgb| f64::from(rgb[c])).sum::<f64>() / n)
    };
    for (shot, picture, _) in pictures.iter().filter(|(shot, ..)| !shot.backend.is_exact()) {
        let twin = pictures.iter().find(|(other, ..)| other.roulette == shot.roulette);
        let (_, expected, _) = twin.expect("every way to render is also that of obvhs");
        let (got, expected) = (mean(picture), mean(expected));
        let off = (0..3).map(|c| (got[c] / expected[c] - 1.0).abs()).fold(0.0, f64::max);
        send(Check {
            instrument: "scene-mean".to_owned(),
            subject: format!("{}, {shot}", furnace.name),
            outcome: outcome(off <= SAME_MEAN),
            measured: off,
            limit: SAME_MEAN,
            meaning: "off the mean of obvhs ≤".to_owned(),
            detail: format!("{got:?} against {expected:?}"),
            seconds: 0.0,
        });
    }
}

fn exhibit(
    furnace: &Furnace,
    scene: &gonio_tracer::scene::Scene,
    picture: &Picture,
    speeds: Vec<Speed>,
    out: &Path,
) -> Result<Exhibit, Error> {
    let expected = furnace.answer(scene);
    let mut deviation = picture.clone();
    for rgb in &mut deviation.rgb {
        for (x, expected) in rgb.iter_mut().zip(expected) {
            *x = Exhibit::shade((*x).into(), expected);
        }
    }
    let save = |name: String, picture: &Picture, exposure: f32| -> Result<Vec<u8>, Error> {
        let path = out.join(name);
        png::write(&path, picture, exposure)?;
        std::fs::read(&path).map_err(Error::file(&path, "read"))
    };
    let [r, g, b] = expected;
    Ok(Exhibit {
        name: furnace.name.to_owned(),
        answer: format!("{}: {r:.5}, {g:.5}, {b:.5}", furnace.law()),
        rendered: save(format!("{}.png", furnace.name), picture, scene.film.exposure)?,
        deviation: save(format!("{}-deviation.png", furnace.name), &deviation, 0.0)?,
        speeds,
    })
}

/// Whether `--only` may ask for something of this scene: subjects begin with its name or contain it.
fn may_want(options: &Options, instrument: &str, scene: &str) -> bool {
    options.only.as_ref().is_none_or(|only| only == instrument || only.contains(scene) || scene.contains(only.as_str()))
}
