//! `gonio certify`: one material under every instrument: what it claims, what was measured, where its numbers are safe, and
//! what a call costs.

mod count;

use crate::environment;
use crate::output::{Target, probe, write_text};
use crate::usage::{seed, spinner};
use anyhow::{Context, Result, anyhow};
use count::count;
use gonio_lab::{Certificate, Count, Effort, Options, certify};
use gonio_report::json;
use gonio_tracer::{MaterialSurface, constant_surface};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Measure one material with every instrument.
///
/// Reciprocity and energy as the material's lobes claim them, densities, samples, the largest weight, the range over which
/// each number is safe without a guard (found by a sweep, in f32 and f64), f32 against f64, eight lanes against f32, the white
/// furnace over roughness and angle, and the time of a call. Exits with 0 if every check that ran passed, with 3 otherwise.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Material file (.toml): the keys of a scene's [materials.NAME] table
    material: PathBuf,
    /// Write the certificate as JSON; - for standard output, instead of the text
    #[arg(long, value_name = "FILE|-")]
    json: Option<Target>,
    /// Write the certificate with plots as a self-contained page
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
    /// Seconds: fewer samples
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// The sample counts that find the smallest faults: minutes
    #[arg(long)]
    full: bool,
    /// Where all random numbers come from: a number, or "random"
    #[arg(long, value_name = "N|random", default_value = "1", value_parser = seed)]
    seed: u64,
    /// Count the instructions of a call as well; needs valgrind
    #[arg(long)]
    instructions: bool,
    /// Only calls, as often as said, for the counter of instructions to look at
    #[arg(long, hide = true, value_name = "CALL:ARITHMETIC:PASSES")]
    exercise: Option<count::Exercise>,
}

/// What `--json` writes.
#[derive(Serialize)]
struct Document<'a> {
    version: &'static str,
    effort: Effort,
    seed: u64,
    holds: bool,
    #[serde(flatten)]
    certificate: &'a Certificate,
    instructions: &'a Result<Vec<Count>, String>,
}

/// Runs the subcommand.
pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let (name, surface) = load(&args.material)?;
    if let Some(exercise) = args.exercise {
        exercise.run(&surface);
        return Ok(ExitCode::SUCCESS);
    }
    // Fail before the work, not after it.
    let json = args.json.iter().filter_map(|target| match target {
        Target::File(path) => Some(path),
        Target::Stdout => None,
    });
    json.chain(&args.report).try_for_each(|path| probe(path))?;
    let effort = match (args.quick, args.full) {
        (true, _) => Effort::Quick,
        (_, true) => Effort::Full,
        _ => Effort::Standard,
    };
    let options = Options { seed: args.seed, ..Options::new(effort) };
    let spinner = spinner("measuring the material");
    let certificate = certify(&name, &surface, &options);
    let instructions = if args.instructions { count(&args.material) } else { Err("not asked for".to_owned()) };
    if let Some(path) = &args.report {
        let plots = gonio_lab::plots::of(&name, &surface, &options);
        let page = certificate.page(&options, &instructions, &plots, &environment::here());
        write_text(&Target::File(path.clone()), &page)?;
    }
    if let Some(spinner) = spinner {
        spinner.finish_and_clear();
    }
    if let Some(target) = &args.json {
        let holds = certificate.holds();
        let version = env!("CARGO_PKG_VERSION");
        let document = Document {
            version,
            effort,
            seed: args.seed,
            holds,
            certificate: &certificate,
            instructions: &instructions,
        };
        write_text(target, &json::text(&document).context("the certificate cannot be written as JSON")?)?;
    }
    if args.json != Some(Target::Stdout) {
        write_text(&Target::Stdout, &format!("{certificate}{}", count::text(&instructions)))?;
    }
    Ok(ExitCode::from(if certificate.holds() { 0 } else { 3 }))
}

/// Name and surface of a material file.
fn load(path: &Path) -> Result<(String, MaterialSurface<f32>)> {
    let text = std::fs::read_to_string(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    let material = gonio_io::material_from_toml_str(&text, path)?;
    let surface = constant_surface(&material)
        .ok_or_else(|| anyhow!("{}: a material with images cannot be certified by itself", path.display()))?;
    Ok((material.name, surface))
}
