//! How many rays are cast per second, beside Embree at its best.
//!
//! ```text
//! cargo bench --bench accel --features embree               criterion's rows: every scene, kind of ray and backend
//! cargo xtask rays --ratio   [--rounds N] [--json FILE]     speed over Embree's, with what is asked of it
//! cargo xtask rays --build   [--rounds N] [--json FILE]     time and memory of building, and after how many rays a tree has paid
//! cargo xtask rays --threads [--rounds N] [--json FILE]     two threads against two processes
//! cargo xtask rays --sizes   [--most N] [--svg FILE] [--json FILE]     cost of a ray from 1000 triangles to ten million
//! cargo xtask rays --instances [--rounds N] [--json FILE]   speed of a tree that instances share over one that is laid out
//! ```
//!
//! All but criterion's rows take `--scene NAME` (atrium, terrain, hair, scans), `--rays K` (camera rays per scene; other sets
//! follow from them), `--intersect robust|fast`, and `--triangles N` for scenes of another size. `cargo xtask rays` builds with
//! Embree where it is there, and keeps the process on one core; `cargo bench --bench accel -- --ratio` does neither.
//!
//! **How.** All methods of a ray set take turns in one process, round after round, so that a machine that slows down slows all of
//! them; a round before the first warms the caches and is not counted; the median counts. Every method reads the same
//! packets and writes the same hits, packing for Embree included. Embree is the best of three widths, both flags of coherence
//! and both qualities of its tree; obvhs is told what a renderer would tell it. In the round that is not counted, every answer is
//! compared: a method that is fast because it is wrong ends the run. See `ratio` for what fails.

mod scenes;
mod accel {
    pub(crate) mod build;
    pub(crate) mod contenders;
    pub(crate) mod instances;
    pub(crate) mod measure;
    pub(crate) mod options;
    pub(crate) mod plot;
    pub(crate) mod ratio;
    pub(crate) mod rows;
    pub(crate) mod sizes;
    pub(crate) mod threads;
}

use accel::options::{Mode, Options};
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let options = match Options::parse(&arguments) {
        Ok(options) => options,
        Err(error) => {
            eprintln!("accel: {error}");
            return ExitCode::from(2);
        }
    };
    let outcome = match &options.mode {
        Mode::Rows => {
            accel::rows::run();
            Ok(true)
        }
        Mode::Ratio => accel::ratio::run(&options),
        Mode::Build => accel::build::run(&options),
        Mode::Threads => accel::threads::run(&options),
        Mode::Sizes => accel::sizes::run(&options),
        Mode::Instances => accel::instances::run(&options),
        Mode::Memory(builder) => accel::build::tell_memory(&options, *builder),
        Mode::Trace => accel::threads::trace_on_demand(&options),
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("accel: {error}");
            ExitCode::FAILURE
        }
    }
}
