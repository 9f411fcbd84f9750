//! `gonio bsdf eval`: f_cos and pdf for a table of directions.

use super::model::load;
use super::precision::Precision;
use super::rows::{RowWriter, read_rows};
use crate::output::Target;
use anyhow::Result;
use std::path::PathBuf;

const COLUMNS: &[&str] = &["f_cos_r", "f_cos_g", "f_cos_b", "pdf"];

/// Evaluate a material for a table of directions.
///
/// Reads rows wo_x,wo_y,wo_z,wi_x,wi_y,wi_z (a header with these names is optional) and writes a row
/// f_cos_r,f_cos_g,f_cos_b,pdf for each: the continuous part, f times |cos_i| and density per solid angle in 1/sr. Numbers
/// are printed so that they read back exactly. Directions are used as given: what is not a unit vector gives zeros.
#[derive(clap::Args)]
pub(super) struct Args {
    /// Material file (.toml)
    material: PathBuf,
    /// Table of directions (.csv); - for standard input
    #[arg(long, value_name = "IN.csv")]
    directions: Target,
    /// Where the values go; - for standard output
    #[arg(short, long, value_name = "OUT.csv", default_value = "-")]
    output: Target,
    /// Which arithmetic answers
    #[arg(long, value_enum, default_value = "f32")]
    precision: Precision,
    /// Write one JSON object per row instead of CSV
    #[arg(long)]
    json: bool,
}

/// Runs the subcommand.
pub(super) fn run(args: &Args) -> Result<()> {
    let model = load(&args.material, args.precision)?;
    let mut rows = RowWriter::create(&args.output, COLUMNS, args.json, args.precision)?;
    let columns = ["wo_x", "wo_y", "wo_z", "wi_x", "wi_y", "wi_z"];
    read_rows(&args.directions, columns, |batch| {
        let pairs: Vec<_> = batch.iter().map(|&[a, b, c, d, e, f]| [[a, b, c], [d, e, f]]).collect();
        for answer in model.eval(&pairs) {
            rows.row(answer.f_cos.into_iter().chain([answer.pdf]), None)?;
        }
        Ok(())
    })?;
    rows.finish()
}
