//! `gonio bsdf sample`: sampled directions with everything that belongs to them.

use super::model::load;
use super::precision::Precision;
use super::rows::{BATCH, RowWriter};
use crate::output::Target;
use crate::usage::{count, direction, warn};
use anyhow::Result;
use gonio_lab::random::unit;
use std::path::PathBuf;

const COLUMNS: &[&str] =
    &["wi_x", "wi_y", "wi_z", "f_cos_r", "f_cos_g", "f_cos_b", "pdf", "weight_r", "weight_g", "weight_b", "event"];

/// Sample a material.
///
/// Writes one row per sample: wi, f_cos, pdf, weight = f_cos/pdf, and event, one of reflect, transmit, mirror (a discrete
/// reflection), discrete-transmit, failed. For a delta event pdf is its probability and f_cos its weight times that; a
/// failed sample is a row of zeros. Row i depends on the seed and i alone, and its random numbers are the same in every
/// arithmetic.
#[derive(clap::Args)]
pub(super) struct Args {
    /// Material file (.toml)
    material: PathBuf,
    /// Direction towards the viewer, local
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true)]
    wo: [f64; 3],
    /// Number of samples; 1e6 is understood
    #[arg(short = 'n', long = "samples", value_name = "N", value_parser = count)]
    samples: u64,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Where the samples go; - for standard output
    #[arg(short, long, value_name = "OUT.csv", default_value = "-")]
    output: Target,
    /// Which arithmetic answers
    #[arg(long, value_enum, default_value = "f32")]
    precision: Precision,
    /// Write one JSON object per sample instead of CSV
    #[arg(long)]
    json: bool,
}

/// Runs the subcommand.
pub(super) fn run(args: &Args) -> Result<()> {
    let model = load(&args.material, args.precision)?;
    let length2: f64 = args.wo.iter().map(|x| x * x).sum();
    // A NaN is outside of the range, too.
    if !(0.999..=1.001).contains(&length2) {
        warn(&format!("--wo is not a unit vector (its length is {}): every sample fails", length2.sqrt()));
    }
    let mut rows = RowWriter::create(&args.output, COLUMNS, args.json, args.precision)?;
    let mut first = 0;
    while first < args.samples {
        let last = args.samples.min(first + BATCH as u64);
        for drawn in model.sample(args.wo, &uniform(args.seed, first, last)) {
            let numbers = drawn.wi.into_iter().chain(drawn.answer.f_cos).chain([drawn.answer.pdf]).chain(drawn.weight);
            rows.row(numbers, Some(drawn.happening.name()))?;
        }
        first = last;
    }
    rows.finish()
}

/// The uniform numbers of the samples `first..last`.
pub(super) fn uniform(seed: u64, first: u64, last: u64) -> Vec<[f64; 3]> {
    (first..last).map(|index| std::array::from_fn(|k| unit(seed, index, k as u64))).collect()
}
