//! `gonio compare`: how two pictures of one scene differ, and whether chance explains it.

#[cfg(feature = "flip")]
mod flip;

use crate::output::{Target, extension, write_text};
use crate::usage::Usage;
use anyhow::{Context, Result};
use gonio_io::exr::{self, Metadata};
use gonio_io::{png, read_picture};
use gonio_report::json;
use gonio_tracer::Picture;
use gonio_verify::difference::{Difference, difference, magnified};
use serde_json::json as object;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Compare two pictures of one scene.
///
/// Prints the means, the root mean square error, relMSE = mean of (B − A)²/(A² + 0.01), how many pixels differ by more than
/// a thousandth and how many of those have no such neighbour, and a test: in blocks of 8 × 8 pixels and as a whole, is the mean of B − A
/// zero, as far as the spread of the pixels can tell? With the feature `flip`, also the mean of FLIP (Andersson et al. 2020)
/// between the pictures as they look on a screen. The test holds for pixels with independent noise (a box filter, other
/// seeds or other renderers); its significance covers all blocks and channels together. A is the reference.
///
/// Reads OpenEXR (linear), PNG and JPEG (sRGB).
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The reference
    a: PathBuf,
    /// The picture to judge
    b: PathBuf,
    /// Write the difference B − A: .exr as it is, .png magnified around mid grey
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
    /// The probability with which pictures that differ by chance alone fail the test
    #[arg(long, value_name = "P", default_value_t = 0.01, value_parser = significance)]
    significance: f64,
    /// Exit with 3 if the test finds a difference
    #[arg(long)]
    test: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Runs the subcommand.
pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let (a, b) = (read_picture(&args.a)?, read_picture(&args.b)?);
    if (a.width, a.height) != (b.width, b.height) {
        let text = format!(
            "{} has {} x {} pixels, but {} has {} x {}",
            args.a.display(),
            a.width,
            a.height,
            args.b.display(),
            b.width,
            b.height
        );
        return Err(Usage(text).into());
    }
    let found = difference(&a, &b, args.significance);
    if let Some(path) = &args.output {
        write_difference(path, &a, &found)?;
    }
    let flip = flip(&a, &b);
    let text = if args.json {
        json::text(&as_json(args, &found, flip)).context("the comparison cannot be written as JSON")?
    } else {
        as_text(&a, &found, flip)
    };
    write_text(&Target::Stdout, &text)?;
    Ok(ExitCode::from(if args.test && !found.explained_by_chance() { 3 } else { 0 }))
}

#[cfg(feature = "flip")]
fn flip(a: &Picture, b: &Picture) -> Option<f64> {
    Some(flip::mean(a, b))
}

#[cfg(not(feature = "flip"))]
fn flip(_: &Picture, _: &Picture) -> Option<f64> {
    None
}

fn write_difference(path: &Path, a: &Picture, found: &Difference) -> Result<()> {
    match extension(path).as_str() {
        "exr" => {
            let version = env!("CARGO_PKG_VERSION").to_owned();
            let metadata = Metadata { version, ..Metadata::default() };
            Ok(exr::write(path, &found.picture, None, &metadata)?)
        }
        "png" => {
            let (picture, gain) = magnified(a, &found.picture);
            png::write(path, &picture, 0.0)?;
            eprintln!("{}: B − A over the mean of A, times {gain:.3}, around mid grey", path.display());
            Ok(())
        }
        _ => Err(Usage("a difference is written as .exr or .png".to_owned()).into()),
    }
}

fn as_text(a: &Picture, found: &Difference, flip: Option<f64>) -> String {
    let mut text = format!("{:24}{:>14}{:>14}{:>14}\n", "", "red", "green", "blue");
    let mut row = |name: &str, values: [f64; 3], show: fn(f64) -> String| {
        let [r, g, b] = values.map(show);
        let _ = writeln!(text, "{name:24}{r:>14}{g:>14}{b:>14}");
    };
    let plain = |x: f64| format!("{x:.7}");
    let percent = |x: f64| format!("{:+.4} %", 100.0 * x);
    row("mean of A", found.means[0], plain);
    row("mean of B", found.means[1], plain);
    row("B over A", [0, 1, 2].map(|c| found.means[1][c] / found.means[0][c] - 1.0), percent);
    row("root mean square error", found.rmse, plain);
    row("relMSE", found.rel_mse, plain);
    if let Some(flip) = flip {
        let _ = writeln!(text, "{:24}{flip:>14.7}", "mean FLIP");
    }
    let (pixels, largest) = (a.rgb.len(), found.largest);
    let _ = writeln!(
        text,
        "\n{} of {pixels} pixels differ in some bit, {} by more than a thousandth, {} of these without such a neighbour; {} \
         are not numbers\n\
         largest difference {:.4e} at pixel {},{}\n\
         block test: {} of {} fail at {:.2e} each; least p {:.3e} in {}\n{}",
        found.unequal,
        found.differing,
        found.isolated,
        found.not_numbers,
        largest.value,
        largest.x,
        largest.y,
        found.failed,
        found.tests,
        found.level,
        found.worst_p,
        found.worst_place,
        if found.explained_by_chance() {
            "chance explains the difference"
        } else {
            "chance does not explain the difference"
        },
    );
    text
}

fn as_json(args: &Args, found: &Difference, flip: Option<f64>) -> serde_json::Value {
    object!({
        "a": args.a.display().to_string(),
        "b": args.b.display().to_string(),
        "mean_a": found.means[0],
        "mean_b": found.means[1],
        "rmse": found.rmse,
        "rel_mse": found.rel_mse,
        "flip": flip,
        "unequal_pixels": found.unequal,
        "differing_pixels": found.differing,
        "isolated_pixels": found.isolated,
        "pixels_not_numbers": found.not_numbers,
        "largest": { "value": found.largest.value, "x": found.largest.x, "y": found.largest.y },
        "block_test": {
            "tests": found.tests,
            "failed": found.failed,
            "significance": args.significance,
            "level": found.level,
            "worst_p": found.worst_p,
            "worst": found.worst_place,
            "explained_by_chance": found.explained_by_chance(),
        },
    })
}

fn significance(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|p| *p > 0.0 && *p < 1.0);
    value.ok_or_else(|| "a significance is a number between 0 and 1".to_owned())
}
