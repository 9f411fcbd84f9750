//! `certify`: the instruments pointed at one lobe, and everything that they find about it in one place.
//!
//! [`certify`] takes any lobe made of declared parameters: a model of the kernel or of the user, a mixture, a layer, a surface. It
//! measures it in `f32`, `f64` and eight lanes: reciprocity and energy, each as the lobe claims them
//! ([`gonio_kernel::Properties`]); ∫pdf with failures; χ²; the largest weight; totality; the range over which each number is safe; the
//! white furnace over roughness and angle; times. [`certify_single`] takes a lobe that is implemented for `f32` only. What such a lobe
//! cannot be asked says so.

mod certificate;
mod page;
#[cfg(test)]
mod tests;

pub use certificate::Certificate;

use crate::finding::Finding;
use crate::lanes;
use crate::run::{execute, tasks_of};
use crate::speed::{self, Speed};
use crate::sweep::{self, SafeRange};
use crate::task::{Options, Task};
use crate::test_bsdf::{DynBsdf, TestBsdf};
use crate::totality;
use crate::under_test::UnderTest;
use crate::white::{self, FurnaceMap};
use gonio_kernel::{Lobe, Properties};
use gonio_report::Check;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Measures a lobe in `f32`, `f64` and eight lanes, and how far its numbers may move.
///
/// ```
/// use gonio_kernel::{Rgb, lobe::{Lambert, Mirror}, Lobe};
/// use gonio_lab::{Effort, Options, certify};
/// let chalk = Lambert::new(Rgb::splat(0.5_f32)).plus(Mirror::new(Rgb::splat(0.5)));
/// assert!(certify("chalk", &chalk, &Options::new(Effort::Quick)).holds());
/// ```
pub fn certify<'t>(name: &str, lobe: &impl TestBsdf<'t>, options: &Options) -> Certificate {
    // From here on without the lobe's type, so that all this is compiled once.
    let (properties, checks, ranges, furnace) = measured(name, lobe, options);
    certificate(name, properties, checks, ranges, furnace, speed::of(lobe))
}

fn measured(
    name: &str,
    bsdf: &dyn DynBsdf,
    options: &Options,
) -> (Properties<f64>, Vec<Check>, Vec<SafeRange>, FurnaceMap) {
    let under_test = UnderTest::of(name, bsdf);
    let claims = under_test.claims;
    let (furnace, ranges) = (white::map(bsdf), Mutex::new(BTreeMap::new()));
    let mut tasks = general_tasks(&under_test);
    if under_test.single.is_none() {
        let reason = "narrower than the lattice of f32 directions: a mirror there, and sound over the ranges below";
        tasks.push(Task::new("f32", name, 0, move |_| Finding::not_run(reason)));
    }
    tasks.push(Task::new("lanes", name, 0, |run| lanes::measure(bsdf, true, run)));
    tasks.push(Task::new("white-furnace", name, 0, |run| white::measure(bsdf, &furnace, claims, run)));
    for (index, number) in bsdf.numbers().iter().enumerate() {
        for single in [true, false] {
            let precision = if single { "f32" } else { "f64" };
            let place = if number.lobe == 0 { String::new() } else { format!("lobe {} ", number.lobe + 1) };
            let ranges = &ranges;
            tasks.push(Task::new(
                "parameters",
                format!("{name} {place}{} {precision}", number.name()),
                0,
                move |run| {
                    let (finding, range) = sweep::measure(bsdf, index, single, run);
                    ranges.lock().unwrap_or_else(|e| e.into_inner()).insert((index, !single), range);
                    finding
                },
            ));
        }
    }
    let checks = run(tasks, options);
    let ranges = ranges.into_inner().unwrap_or_else(|e| e.into_inner()).into_values().collect();
    (claims.properties, checks, ranges, furnace)
}

/// Measures a lobe that exists in `f32` only: everything that this can answer. What needs more says that it did not run.
pub fn certify_single<L: Lobe<f32> + Sync>(name: &str, lobe: &L, options: &Options) -> Certificate {
    let under_test = UnderTest::of_single(name, lobe);
    let mut tasks = general_tasks(&under_test);
    for (instrument, needs) in MISSING {
        tasks.push(Task::new(instrument, name, 0, move |_| Finding::not_run(needs)));
    }
    let checks = run(tasks, options);
    let probe = under_test.views().next().map(|view| white::of_probe(view.probe));
    let furnace = probe.unwrap_or_else(FurnaceMap::empty);
    certificate(name, under_test.claims.properties, checks, Vec::new(), furnace, speed::of_single(lobe))
}

fn certificate(
    name: &str,
    properties: Properties<f64>,
    checks: Vec<Check>,
    ranges: Vec<SafeRange>,
    furnace: FurnaceMap,
    speeds: Vec<Speed>,
) -> Certificate {
    let Properties { reciprocal, conserving, excess, .. } = properties;
    Certificate { name: name.to_owned(), reciprocal, conserving, excess, checks, ranges, furnace, speeds }
}

/// What is asked of any lobe.
fn general_tasks<'a>(under_test: &'a UnderTest) -> Vec<Task<'a>> {
    let mut tasks = tasks_of(under_test);
    for view in under_test.views() {
        let name = format!("{} {}", under_test.name, view.precision());
        tasks.push(Task::new("totality", name, 0, move |run| totality::measure_probe(view, run)));
    }
    tasks
}

fn run(tasks: Vec<Task>, options: &Options) -> Vec<Check> {
    let mut checks = Vec::new();
    execute(tasks, options, &mut |check| checks.push(check));
    checks
}

/// What an `f32` implementation alone cannot answer.
const MISSING: [(&str, &str); 4] = [
    ("precision", "needs an f64 form of the lobe"),
    ("jacobian", "needs an f64 form of the lobe"),
    ("lanes", "not offered: the lobe has no eight-lane form"),
    ("parameters", "the lobe has no declared parameters that could be varied: it is certified as it is"),
];
