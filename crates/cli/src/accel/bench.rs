//! `gonio accel bench`: how many rays each backend casts per second, side by side.

use super::args::{backends, check_distinct, not_built, specimen};
use crate::environment;
use crate::output::{Target, write_text};
use crate::usage::{count, spinner};
use anyhow::{Context, Result};
use gonio_report::{Environment, json};
use gonio_tracer::Backend;
use gonio_verify::bench::{Measurement, Settings, Speed, measure};
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Measure how many rays per second each backend casts.
///
/// Ray sets: primary (camera rays in blocks of four by two pixels, tile by tile), diffuse bounces from their hits, rays from
/// anywhere in any direction, shadow rays to the lights (to a wide lamp above everything without lights), and ambient occlusion.
/// Every backend is measured with its robust and its fast triangle test; primary rays are announced once as coherent and once
/// as not.
#[derive(clap::Args)]
pub(super) struct Args {
    /// Scene file (.toml) or OBJ file (.obj)
    scene: PathBuf,
    /// Rays of each set
    #[arg(long, value_name = "N", default_value = "3e5", value_parser = count)]
    rays: u64,
    /// Rounds; the median counts
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    rounds: u32,
    /// Threads that share each set
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: u32,
    /// Where all random choices come from
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Backends, the first of which the others are divided by; all of this build but brute if not given
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    backends: Vec<Backend>,
    /// Print JSON instead of the table
    #[arg(long)]
    json: bool,
}

/// Everything, as data.
#[derive(Serialize)]
struct Report {
    version: &'static str,
    scene: String,
    triangles: u32,
    seed: u64,
    rounds: u32,
    threads: u32,
    #[serde(flatten)]
    measured: Measurement,
    /// Backends that this build does not have.
    not_run: Vec<&'static str>,
    environment: Environment,
}

/// Runs the subcommand.
pub(super) fn run(args: &Args) -> Result<ExitCode> {
    check_distinct(&args.backends)?;
    let specimen = specimen(&args.scene)?;
    let spinner = spinner("building the backends");
    let settings = Settings { rays: args.rays, rounds: args.rounds, threads: args.threads, seed: args.seed };
    let measured = measure(&specimen, &backends(&args.backends), &settings, &mut |set| {
        if let Some(spinner) = &spinner {
            spinner.set_message(format!("{set} rays"));
        }
    })?;
    if let Some(spinner) = spinner {
        spinner.finish_and_clear();
    }
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        scene: specimen.name.clone(),
        triangles: specimen.count(),
        seed: args.seed,
        rounds: args.rounds,
        threads: args.threads,
        measured,
        not_run: not_built(),
        environment: environment::here(),
    };
    let printed = if args.json {
        json::text(&report).context("the measurement cannot be written as JSON")?
    } else {
        text(&report)
    };
    write_text(&Target::Stdout, &printed)?;
    Ok(ExitCode::SUCCESS)
}

/// The benchmark on a terminal.
fn text(report: &Report) -> String {
    let e = &report.environment;
    let mut out = format!(
        "gonio {} accel bench: {}, {} triangles, {} rounds, {} thread{}\n{}; {}, {}\n\n",
        report.version,
        report.scene,
        report.triangles,
        report.rounds,
        report.threads,
        if report.threads == 1 { "" } else { "s" },
        e.processor,
        e.rustc.unwrap_or("compiler not known"),
        e.target_features.join(" "),
    );
    let _ = writeln!(out, "{:8}  {:7}  {:>9}  {:>10}", "backend", "test", "build s", "memory MiB");
    for build in &report.measured.builds {
        let memory = build.resident_bytes.map_or("-".to_owned(), |b| format!("{:.1}", b as f64 / 1_048_576.0));
        let _ = writeln!(out, "{:8}  {:7}  {:9.3}  {memory:>10}", build.backend, build.intersect, build.seconds);
    }
    let _ = writeln!(
        out,
        "\n{:17}  {:8}  {:7}  {:10}  {:>9}  {:>5}  {:>8}  {:>15}  {:>6}",
        "rays", "backend", "test", "said to be", "cast", "hit %", "Mrays/s", "slowest–fastest", "ratio"
    );
    let mut last = None;
    for row in &report.measured.results {
        if last.is_some_and(|set| set != row.set) {
            out.push('\n');
        }
        last = Some(row.set);
        let Speed { set, backend, intersect, rays, median, ratio, .. } = row;
        let kind = if row.coherent { "coherent" } else { "incoherent" };
        let hits = 100.0 * row.hits as f64 / (*rays).max(1) as f64;
        let spread = format!("{:.3}–{:.3}", row.min, row.max);
        let _ = writeln!(
            out,
            "{set:17}  {backend:8}  {intersect:7}  {kind:10}  {rays:9}  {hits:5.1}  {median:8.3}  {spread:>15}  {ratio:6.2}"
        );
    }
    for name in &report.not_run {
        let _ = writeln!(out, "\nnot run  {name}: this build does not have it (feature `{name}`)");
    }
    out
}
