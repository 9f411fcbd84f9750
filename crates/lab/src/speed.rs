//! How long a call takes: loops over directions that the compiler cannot foresee, the median of several batches.
//!
//! One thread, the lobe's numbers in memory, behind the guard of a closure, 256 directions in the cache: a throughput, not a latency. Lanes count per
//! lane: the time of eight calls over eight.

use crate::probe::{demote, lanes_of};
use crate::random::Random;
use crate::test_bsdf::TestBsdf;
use gonio_kernel::{Closure, F32x8, Lobe, Real, Vec3};
use serde::Serialize;
use std::hint::black_box;
use std::time::Instant;

/// The time of one kind of call.
#[derive(Clone, Debug, Serialize)]
pub struct Speed {
    /// `eval` or `sample`.
    pub call: &'static str,
    /// `f32`, `f64` or `lanes`.
    pub arithmetic: &'static str,
    /// Nanoseconds per call; of lanes per lane.
    pub ns: f64,
}

/// The instructions of one kind of call, as somebody counted them who can: this crate cannot.
#[derive(Clone, Debug, Serialize)]
pub struct Count {
    /// `eval` or `sample`.
    pub call: &'static str,
    /// `f32` or `lanes`.
    pub arithmetic: &'static str,
    /// Instructions per call; of lanes per lane.
    pub instructions: f64,
}

/// A call that is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Call {
    /// A closure made for wo and asked for one wi.
    Eval,
    /// A closure made for wo and one sample drawn.
    Sample,
}

impl Call {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Eval, Self::Sample];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Eval => "eval",
            Self::Sample => "sample",
        }
    }
}

const PAIRS: usize = 256;

/// Pairs of directions above the surface, and numbers.
fn inputs() -> Vec<[Vec3<f32>; 3]> {
    let mut random = Random::new(1);
    let unit = |random: &mut Random| random.coarse() as f32;
    (0..PAIRS)
        .map(|_| {
            let (wo, wi) = (demote(random.above()), demote(random.above()));
            [wo, wi, Vec3::new(unit(&mut random), unit(&mut random), unit(&mut random))]
        })
        .collect()
}

fn promoted<R: Real>(w: Vec3<f32>) -> Vec3<R> {
    Vec3::new(R::lit(f64::from(w.x)), R::lit(f64::from(w.y)), R::lit(f64::from(w.z)))
}

/// One pass over prepared inputs.
fn pass<R: Real, L: Lobe<R>>(lobe: &L, call: Call, inputs: &[[Vec3<R>; 3]]) {
    let lobe = black_box(lobe);
    for [wo, wi, u] in inputs {
        let closure = Closure::new(lobe, *wo);
        match call {
            Call::Eval => drop(black_box(closure.eval(*wi))),
            Call::Sample => drop(black_box(closure.sample([u.x, u.y, u.z]))),
        }
    }
}

fn scalars<R: Real>() -> Vec<[Vec3<R>; 3]> {
    inputs().into_iter().map(|three| three.map(promoted)).collect()
}

fn eights() -> Vec<[Vec3<F32x8>; 3]> {
    let eight = |group: &[[Vec3<f32>; 3]], which: usize| lanes_of(std::array::from_fn(|l| group[l][which]));
    inputs().chunks_exact(8).map(|group| [eight(group, 0), eight(group, 1), eight(group, 2)]).collect()
}

/// Nanoseconds of one of `calls` calls that `pass` makes: the median of eleven batches of about a millisecond.
fn median_ns(calls: usize, mut pass: impl FnMut()) -> f64 {
    let timed = |passes: u32, pass: &mut dyn FnMut()| {
        let start = Instant::now();
        (0..passes).for_each(|_| pass());
        start.elapsed().as_secs_f64()
    };
    let mut passes = 1;
    while timed(passes, &mut pass) < 1e-3 && passes < 1 << 20 {
        passes *= 2;
    }
    let mut batches: Vec<f64> = (0..11).map(|_| timed(passes, &mut pass)).collect();
    batches.sort_by(f64::total_cmp);
    batches[5] * 1e9 / (f64::from(passes) * calls as f64)
}

/// Times of a lobe in each arithmetic.
pub(crate) fn of<'t>(lobe: &impl TestBsdf<'t>) -> Vec<Speed> {
    let (double, lanes) = (lobe.double(), lobe.lanes());
    let (f32s, f64s, eights) = (scalars::<f32>(), scalars::<f64>(), eights());
    let of = |call: Call| {
        let row = |arithmetic, ns| Speed { call: call.name(), arithmetic, ns };
        [
            row("f32", median_ns(PAIRS, || pass(lobe, call, &f32s))),
            row("f64", median_ns(PAIRS, || pass(&double, call, &f64s))),
            row("lanes", median_ns(PAIRS, || pass(&lanes, call, &eights))),
        ]
    };
    Call::ALL.into_iter().flat_map(of).collect()
}

/// Times of a lobe that exists in `f32` only.
pub(crate) fn of_single<L: Lobe<f32>>(lobe: &L) -> Vec<Speed> {
    let inputs = scalars::<f32>();
    let ns = |call| median_ns(PAIRS, || pass(lobe, call, &inputs));
    Call::ALL.into_iter().map(|call| Speed { call: call.name(), arithmetic: "f32", ns: ns(call) }).collect()
}

/// Makes `passes` passes of 256 calls (32 in lanes) and nothing else: for a counter of instructions to look at. Two counts that differ
/// in their passes alone give the cost of one.
pub fn exercise<'t>(lobe: &impl TestBsdf<'t>, call: Call, lanes: bool, passes: u32) -> u32 {
    if lanes {
        let (lobe, eights) = (lobe.lanes(), eights());
        (0..passes).for_each(|_| pass(&lobe, call, &eights));
    } else {
        let inputs = scalars::<f32>();
        (0..passes).for_each(|_| pass(lobe, call, &inputs));
    }
    PAIRS as u32
}
