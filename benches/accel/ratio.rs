//! Speed over Embree's, scene by ray set, and what is asked of it.
//!
//! **Asked**: the geometric mean over the scenes with the fast tests at least 0.95 for primary rays and 1.05 for each other
//! set; with the robust tests at least 1.0 over everything; no cell below 0.8. **Hoped for**: 1.1 in every cell.
//!
//! **What fails.** Every number below what is asked is marked, but a busy machine must not fail a run by itself: the run fails
//! where a number misses what is asked by more than twice its slack, which is the standard error of its median over the rounds
//! and no less than 5 %; see [`slack`]. A mean's slack is the mean of its cells'.

use super::contenders::{Builder, Side, warn_if_alone};
use super::measure::{Timed, best, fails, median, mrays, slack, take_turns};
use super::options::Options;
use crate::scenes::rays::{self, RaySet};
use gonio_accel::Intersect;
use serde::Serialize;

/// The least mean of each set's ratios, fast.
const MEANS: [f64; 5] = [0.95, 1.05, 1.05, 1.05, 1.05];
/// The least mean of all ratios, robust.
const ROBUST: f64 = 1.0;
/// The least ratio of a cell.
const CELL: f64 = 0.8;
/// What is hoped for in a cell.
const GOAL: f64 = 1.1;

/// One ray set on one scene.
#[derive(Serialize)]
struct Cell {
    intersect: String,
    scene: String,
    set: &'static str,
    rays: usize,
    /// Millions of rays per second.
    ours: f64,
    embree: Option<f64>,
    /// Embree's best way.
    way: Option<String>,
    ratio: Option<f64>,
    /// Of the ratio, relative.
    slack: f64,
    /// Every way that took part, with its millions of rays per second.
    methods: Vec<(String, f64)>,
}

/// Something asked, and whether it is met.
#[derive(Serialize)]
struct Verdict {
    what: String,
    asked: f64,
    found: f64,
    slack: f64,
    met: bool,
    failed: bool,
}

#[derive(Serialize)]
struct Report {
    rounds: usize,
    cells: Vec<Cell>,
    verdicts: Vec<Verdict>,
}

pub(crate) fn run(options: &Options) -> Result<bool, String> {
    let mut cells = Vec::new();
    for &character in &options.scenes {
        let scene = options.scene(character);
        eprintln!("{}: {} triangles", scene.name, scene.geometry.triangle_count());
        // Fast or robust, the rays are the same.
        let scout = Builder::all()[0].build(&scene.geometry, Intersect::Robust)?;
        let sets = rays::sets(&scene, scout.as_a_renderer_does(), options.rays);
        drop(scout);
        for &test in &options.tests {
            let built = Builder::compared().into_iter().map(|builder| builder.build(&scene.geometry, test));
            let built = built.collect::<Result<Vec<_>, _>>()?;
            for set in &sets {
                let methods = built.iter().flat_map(|contender| contender.methods(set.kind)).collect();
                let timed = take_turns(methods, set, options.rounds).map_err(|e| format!("{}: {e}", scene.name))?;
                cells.push(Cell::new(test, &scene.name, set, &timed));
            }
        }
    }
    let verdicts: Vec<Verdict> = options.tests.iter().flat_map(|&test| judge(test, &cells)).collect();
    options.tests.iter().for_each(|&test| print(test, &cells));
    for verdict in &verdicts {
        let Verdict { what, asked, found, slack, met, failed } = verdict;
        let word = if *failed { "FAILED" } else { ["not met", "met"][usize::from(*met)] };
        println!("{what:42}  {found:5.2}  asked {asked:4.2}  slack {slack:4.2}  {word}");
    }
    warn_if_alone();
    let passed = !verdicts.iter().any(|verdict| verdict.failed);
    options.write_json(&Report { rounds: options.rounds, cells, verdicts })?;
    Ok(passed)
}

impl Cell {
    fn new(test: Intersect, scene: &str, set: &RaySet, timed: &[Timed]) -> Self {
        let ours = best(timed, Side::Ours).expect("ours takes part");
        let embree = best(timed, Side::Embree);
        let ratio = embree.map(|embree| median(&embree.seconds) / median(&ours.seconds));
        let slack = embree.map_or(0.0, |embree| {
            let rounds: Vec<f64> = embree.seconds.iter().zip(&ours.seconds).map(|(e, o)| e / o).collect();
            slack(&rounds)
        });
        Self {
            intersect: test.to_string(),
            scene: scene.to_owned(),
            set: set.name,
            rays: set.count,
            ours: mrays(ours, set),
            embree: embree.map(|embree| mrays(embree, set)),
            way: embree.map(|embree| embree.method.name.clone()),
            ratio,
            slack,
            methods: timed.iter().map(|one| (one.method.name.clone(), mrays(one, set))).collect(),
        }
    }
}

/// Geometric mean and mean slack of the cells that have a ratio; `None` without any.
fn mean<'a>(cells: impl Iterator<Item = &'a Cell>) -> Option<(f64, f64)> {
    let parts: Vec<(f64, f64)> = cells.filter_map(|cell| Some((cell.ratio?.ln(), cell.slack))).collect();
    let n = parts.len() as f64;
    let sum = |of: fn(&(f64, f64)) -> f64| parts.iter().map(of).sum::<f64>() / n;
    (!parts.is_empty()).then(|| (sum(|p| p.0).exp(), sum(|p| p.1)))
}

/// Everything that is asked of a test's ratios.
fn judge(test: Intersect, cells: &[Cell]) -> Vec<Verdict> {
    let of_test = || cells.iter().filter(move |cell| cell.intersect == test.to_string());
    let mut verdicts = Vec::new();
    let mut ask = |what: String, asked: f64, (found, slack): (f64, f64)| {
        let (met, failed) = (found >= asked, fails(found, asked, slack));
        verdicts.push(Verdict { what, asked, found, slack, met, failed });
    };
    match test {
        Intersect::Fast => {
            for (set, asked) in rays::NAMES.into_iter().zip(MEANS) {
                if let Some(found) = mean(of_test().filter(|cell| cell.set == set)) {
                    ask(format!("{test}, {set}, mean"), asked, found);
                }
            }
        }
        Intersect::Robust => {
            if let Some(found) = mean(of_test()) {
                ask(format!("{test}, mean of all"), ROBUST, found);
            }
        }
    }
    for cell in of_test() {
        if let Some(ratio) = cell.ratio.filter(|ratio| *ratio < CELL) {
            ask(format!("{test}, {}, {}", cell.set, cell.scene), CELL, (ratio, cell.slack));
        }
    }
    verdicts
}

/// The table of a test: millions of rays per second, ours and Embree's, and their ratio; ! below the least, + where the goal is
/// reached.
fn print(test: Intersect, cells: &[Cell]) {
    let of_test =
        |set: &'static str| cells.iter().filter(move |cell| cell.intersect == test.to_string() && cell.set == set);
    println!("\n{test}: Mrays/s, ours and Embree's, and the ratio (! below {CELL}, + from {GOAL} on)");
    print!("{:10}", "");
    of_test(rays::NAMES[0]).for_each(|cell| print!("  {:>23}", cell.scene));
    println!("  {:>5}", "mean");
    for set in rays::NAMES {
        print!("{set:10}");
        for cell in of_test(set) {
            match (cell.embree, cell.ratio) {
                (Some(embree), Some(ratio)) => {
                    let mark = if ratio < CELL { '!' } else { [' ', '+'][usize::from(ratio >= GOAL)] };
                    print!("  {:7.2} {embree:8.2} {ratio:5.2}{mark}", cell.ours);
                }
                _ => print!("  {:7.2} {:>8} {:>5} ", cell.ours, "-", "-"),
            }
        }
        println!("  {}", mean(of_test(set)).map_or("-".to_owned(), |(mean, _)| format!("{mean:5.2}")));
    }
    println!("Embree's best ways:");
    for set in rays::NAMES {
        let ways: Vec<&str> = of_test(set).filter_map(|cell| cell.way.as_deref()).collect();
        println!("{set:10}  {}", ways.join(", "));
    }
    println!();
}
