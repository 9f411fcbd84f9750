//! `gonio bsdf albedo`: how much of the light from one direction is reflected and transmitted, with standard errors.
//!
//! The estimate is the mean weight f_cos/pdf over samples of the closure. It carries the radiance scale; a material that
//! transmits into another medium will need the importance form here.

use super::model::{Drawn, Happening, load};
use super::precision::Precision;
use super::rows::BATCH;
use super::sample::uniform;
use crate::output::{Target, write_text};
use crate::usage::count;
use anyhow::Result;
use gonio_lab::random::seed_for;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Measure the albedo of a material at given angles.
///
/// For each cosine, the mean weight of samples: reflected (R), transmitted (T) and their sum, per channel, each with its
/// standard error, and the part of the samples that failed. Prints JSON; with --json on a single line.
#[derive(clap::Args)]
pub(super) struct Args {
    /// Material file (.toml)
    material: PathBuf,
    /// Cosines of the angles between wo and the normal, from -1 to 1
    #[arg(long, value_name = "C,…", value_delimiter = ',', required = true, value_parser = cosine, allow_hyphen_values = true)]
    cos: Vec<f64>,
    /// Number of samples for each cosine; 1e6 is understood
    #[arg(short = 'n', long, value_name = "N", default_value = "1e6", value_parser = count)]
    samples: u64,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Where the result goes; - for standard output
    #[arg(short, long, value_name = "OUT.json", default_value = "-")]
    output: Target,
    /// Which arithmetic answers
    #[arg(long, value_enum, default_value = "f32")]
    precision: Precision,
    /// Print the JSON on a single line
    #[arg(long)]
    json: bool,
}

fn cosine(text: &str) -> Result<f64, String> {
    let parsed = text.trim().parse().ok().filter(|cos| (-1.0..=1.0).contains(cos));
    parsed.ok_or_else(|| "a cosine is a number from -1 to 1".to_owned())
}

/// Runs the subcommand.
pub(super) fn run(args: &Args) -> Result<()> {
    let model = load(&args.material, args.precision)?;
    let mut results = Vec::new();
    for &cos in &args.cos {
        let wo = [((1.0 - cos) * (1.0 + cos)).sqrt(), 0.0, cos];
        let seed = seed_for(args.seed, &format!("albedo {cos}"));
        let mut sums = Sums::default();
        let mut first = 0;
        while first < args.samples {
            let last = args.samples.min(first + BATCH as u64);
            model.sample(wo, &uniform(seed, first, last)).iter().for_each(|drawn| sums.add(drawn));
            first = last;
        }
        results.push(sums.report(cos, args.samples));
    }
    let whole = json!({
        "material": args.material.display().to_string(),
        "precision": args.precision.name(),
        "samples": args.samples,
        "seed": args.seed,
        "results": results,
    });
    let text = if args.json { whole.to_string() } else { format!("{whole:#}") };
    write_text(&args.output, &(text + "\n"))
}

/// Σ x and Σ x² per channel.
#[derive(Clone, Copy, Debug, Default)]
struct Moments([[f64; 2]; 3]);

impl Moments {
    fn add(&mut self, weight: [f64; 3]) {
        for (sums, x) in self.0.iter_mut().zip(weight) {
            sums[0] += x;
            sums[1] += x * x;
        }
    }

    /// Mean and standard error over n samples.
    fn report(&self, n: f64) -> Value {
        let mean = self.0.map(|[sum, _]| sum / n);
        let error = self.0.map(|[sum, squares]| {
            // A variance of exactly 0 may come out as a rounding error below it. One sample has no error to state.
            let variance = (squares / n - (sum / n) * (sum / n)).max(0.0);
            (n > 1.0).then(|| (variance / (n - 1.0)).sqrt())
        });
        json!({ "mean": mean, "standard_error": error })
    }
}

#[derive(Debug, Default)]
struct Sums {
    reflected: Moments,
    transmitted: Moments,
    sum: Moments,
    failed: u64,
}

impl Sums {
    fn add(&mut self, drawn: &Drawn) {
        match drawn.happening {
            Happening::Reflect | Happening::Mirror => self.reflected.add(drawn.weight),
            Happening::Transmit | Happening::DiscreteTransmit => self.transmitted.add(drawn.weight),
            Happening::Failed => self.failed += 1,
        }
        self.sum.add(drawn.weight);
    }

    fn report(&self, cos: f64, samples: u64) -> Value {
        let n = samples as f64;
        json!({
            "cos": cos,
            "R": self.reflected.report(n),
            "T": self.transmitted.report(n),
            "sum": self.sum.report(n),
            "failed": self.failed as f64 / n,
        })
    }
}
