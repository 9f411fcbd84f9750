//! Turns, medians, and whether the answers agree.

use super::contenders::{Method, Side};
use crate::scenes::rays::{Answers, RaySet};
use gonio_kernel::F32x8;
use std::hint::black_box;
use std::time::Instant;

/// Rays that may be answered differently, of one: hits of rays that graze an edge are anybody's, and the triangle tests are not
/// the same.
const DIFFERENT: f64 = 1e-3;
/// Distances that count as the same, relative to themselves and the size of a scene. A ray that starts at a triangle may meet it, at
/// a distance that is nothing but rounding.
const SAME: f32 = 1e-5;
const SIZE: f32 = 10.0;

/// A method's seconds, round by round.
pub(crate) struct Timed {
    pub(crate) method: Method,
    pub(crate) seconds: Vec<f64>,
}

/// Where each live ray's hit lies; 0 for a ray that is only known to be blocked, infinity for a miss.
fn distances<'a>(answers: &'a Answers, set: &'a RaySet) -> impl Iterator<Item = f32> + 'a {
    let lanes = (0..set.packets.len()).flat_map(|packet| (0..F32x8::LANES).map(move |lane| (packet, lane)));
    let live = lanes.filter(|&(packet, lane)| set.packets[packet].mask.lane(lane));
    live.map(|(packet, lane)| match answers.blocked.get(packet) {
        Some(blocked) if blocked.lane(lane) => 0.0,
        Some(_) => f32::INFINITY,
        None => answers.hits[packet].t.lane(lane),
    })
}

/// Answers all rays once; the seconds it took.
pub(crate) fn cast(method: &Method, set: &RaySet, answers: &mut Answers) -> f64 {
    let start = Instant::now();
    answers.ask(&*method.accel, method.kind, set);
    let seconds = start.elapsed().as_secs_f64();
    black_box(&answers);
    seconds
}

/// Lets the methods take turns.
///
/// # Errors
/// If a method's answers are not those of the first.
pub(crate) fn take_turns(methods: Vec<Method>, set: &RaySet, rounds: usize) -> Result<Vec<Timed>, String> {
    let mut answers = Answers::of(set);
    let mut first: Option<Vec<f32>> = None;
    let mut timed: Vec<Timed> = methods.into_iter().map(|method| Timed { method, seconds: Vec::new() }).collect();
    for one in &timed {
        cast(&one.method, set, &mut answers);
        let found = distances(&answers, set);
        match &first {
            None => first = Some(found.collect()),
            Some(first) => agree(first, found).map_err(|e| format!("{} rays, {}: {e}", set.name, one.method.name))?,
        }
    }
    for _ in 0..rounds {
        for one in &mut timed {
            one.seconds.push(cast(&one.method, set, &mut answers));
        }
    }
    Ok(timed)
}

/// Whether hits and misses are the same, and the distances.
fn agree(first: &[f32], found: impl Iterator<Item = f32>) -> Result<(), String> {
    let differs = |(a, b): (&f32, f32)| *a != b && (a - b).abs().is_nan() | ((a - b).abs() > SAME * (a.abs() + SIZE));
    let different = first.iter().zip(found).filter(|&(a, b)| differs((a, b))).count();
    let allowed = 2 + (DIFFERENT * first.len() as f64) as usize;
    if different <= allowed {
        return Ok(());
    }
    Err(format!("{different} of {} rays are answered differently, {allowed} may be", first.len()))
}

/// The least slack: the same program has moved by as much from run to run.
const LEAST_SLACK: f64 = 0.05;
/// The most: however noisy the machine, half of what is asked fails.
const MOST_SLACK: f64 = 0.25;

/// How much the median of these ratios can be off, relative: its standard error, by the distance of the quartiles as if they
/// were of a normal distribution, within limits. A run fails where a number misses what is asked by more than twice its slack.
pub(crate) fn slack(ratios: &[f64]) -> f64 {
    let deviation = (quantile(ratios, 0.75) - quantile(ratios, 0.25)) / 1.349;
    let error = (0.5 * std::f64::consts::PI / ratios.len() as f64).sqrt() * deviation;
    (error / median(ratios)).clamp(LEAST_SLACK, MOST_SLACK)
}

/// Whether a number that should be at least `asked` misses that by more than twice its slack.
pub(crate) fn fails(found: f64, asked: f64, slack: f64) -> bool {
    found < asked * (1.0 - 2.0 * slack)
}

/// The median: of two in the middle, their mean.
pub(crate) fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// A quantile, linear between neighbours.
pub(crate) fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = share * (sorted.len() - 1) as f64;
    let (below, above) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
    below + (above - below) * place.fract()
}

/// The fastest of a side, by its median.
pub(crate) fn best(timed: &[Timed], side: Side) -> Option<&Timed> {
    let of_side = timed.iter().filter(|one| one.method.side == side);
    of_side.min_by(|a, b| median(&a.seconds).total_cmp(&median(&b.seconds)))
}

/// Millions of rays per second in the median round.
pub(crate) fn mrays(timed: &Timed, set: &RaySet) -> f64 {
    set.count as f64 / 1e6 / median(&timed.seconds)
}
