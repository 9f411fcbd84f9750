//! `gonio validate`: every physical check, one table, one report, one exit code.
//!
//! What is measured belongs to `gonio-verify`, what the report looks like to `gonio-report`.

mod table;

use crate::environment;
use crate::output::{Target, write_text};
use crate::usage::{Usage, seed, spinner};
use anyhow::{Context, Result};
use gonio_lab::{Check, Effort, Options, Outcome};
use gonio_report::{Header, Instrument, Validation, json};
use gonio_verify::{census, instruments, validate};
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// What all tests of the furnace scenes together may fail by chance, per run, and likewise all tests of the kernel:
/// half of 0.01 each.
const SIGNIFICANCE: f64 = 0.005;

/// Run every physical check and write a report.
///
/// Measures the kernel's lobes with every instrument, renders furnace scenes whose answer is known, and casts the same rays
/// with every backend. Prints one line per instrument and what failed; writes report.html, report.json and
/// summary.json (by instrument) to the output folder. With a correct build, all tests of a run together fail by chance with
/// probability 0.01 at most, at any seed.
/// Exits with 0 if everything that ran passed, with 3 otherwise.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// A minute or two: every instrument and row, small samples
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// Samples that find a density off by 2 % over 5 % of the directions, every bit pattern of elementary functions: most of an hour
    #[arg(long)]
    full: bool,
    /// Only the instrument of this name, or checks whose subject contains this text
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// Where all random numbers come from: a number, or "random"
    #[arg(long, value_name = "N|random", default_value = "1", value_parser = seed)]
    seed: u64,
    /// Folder for reports and rendered pictures; it is made if it does not exist
    #[arg(long, value_name = "DIR", default_value = "target/validate")]
    out: PathBuf,
    /// Print the report to standard output as JSON instead of the table
    #[arg(long)]
    json: bool,
    /// Print what each instrument proves, and run nothing
    #[arg(long)]
    list: bool,
    /// Adds one check that fails: proves that a failure reaches the table, the report and the exit code
    #[arg(long, hide = true)]
    plant_failure: bool,
}

/// Runs the subcommand.
pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    if args.list {
        let width = instruments().iter().map(|(name, _)| name.len()).max().unwrap_or(0);
        let lines: Vec<_> = instruments().iter().map(|(name, proves)| format!("{name:width$}  {proves}\n")).collect();
        write_text(&Target::Stdout, &lines.concat())?;
        return Ok(ExitCode::SUCCESS);
    }
    let effort = match (args.quick, args.full) {
        (true, _) => Effort::Quick,
        (_, true) => Effort::Full,
        _ => Effort::Standard,
    };
    let options =
        Options { seed: args.seed, only: args.only.clone(), significance: SIGNIFICANCE, ..Options::new(effort) };
    // Fail before the work, not after it.
    std::fs::create_dir_all(&args.out).with_context(|| format!("{}: cannot be made", args.out.display()))?;
    crate::output::probe(&args.out.join("report.json"))?;

    let start = Instant::now();
    let mut checks = Vec::new();
    let spinner = spinner("measuring the kernel");
    let mut sink = |check: Check| {
        if let Some(spinner) = &spinner {
            spinner.set_message(format!("{}: {}", check.instrument, check.subject));
        }
        checks.push(check);
    };
    let found = validate(&options, &args.out, &mut sink)?;
    if args.plant_failure {
        sink(planted_failure());
    }
    let plots = if args.only.is_none() { gonio_lab::plots::plots(&options) } else { Vec::new() };
    if let Some(spinner) = spinner {
        spinner.finish_and_clear();
    }
    if let (true, Some(only)) = (checks.is_empty(), &args.only) {
        let names: Vec<_> = instruments().iter().map(|(name, _)| *name).collect();
        return Err(Usage(format!("--only {only} matches nothing; instruments are {}", names.join(", "))).into());
    }

    let header = Header::new(
        env!("CARGO_PKG_VERSION"),
        options.effort.name(),
        options.seed,
        options.only.clone(),
        &checks,
        start.elapsed().as_secs_f64(),
        environment::here(),
    );
    let instruments = instruments().into_iter().map(|(name, proves)| Instrument { name, proves }).collect();
    let report = Validation { header, instruments, checks, census: found.census };
    let json = json_text(&report)?;
    write_text(&Target::File(args.out.join("report.json")), &json)?;
    write_text(&Target::File(args.out.join("summary.json")), &json_text(&report.totals())?)?;
    write_text(
        &Target::File(args.out.join("report.html")),
        &report.page(&found.exhibits, census::table(&report.census).as_ref(), &plots),
    )?;
    let printed = if args.json {
        json
    } else {
        format!("{}\nreport: {}\n", table::text(&report), args.out.join("report.html").display())
    };
    write_text(&Target::Stdout, &printed)?;
    Ok(ExitCode::from(if report.header.failed == 0 { 0 } else { 3 }))
}

fn json_text(report: &impl Serialize) -> Result<String> {
    json::text(report).context("the report cannot be written as JSON")
}

fn planted_failure() -> Check {
    Check {
        instrument: "planted-failure".to_owned(),
        subject: "asked for by --plant-failure".to_owned(),
        outcome: Outcome::Failed,
        measured: 2.0,
        limit: 1.0,
        meaning: "failures ≤".to_owned(),
        detail: "not a measurement".to_owned(),
        seconds: 0.0,
    }
}
