//! `gonio accel census`: the same rays through every backend, and every disagreement with the ray that makes it.

use super::args::{backends, check_distinct, not_built, specimen};
use crate::environment;
use crate::output::{Output, Target, write_text};
use crate::usage::{Usage, count, spinner};
use anyhow::{Context, Result};
use gonio_accel::Intersect;
use gonio_report::{Environment, json};
use gonio_tracer::Backend;
use gonio_verify::census::{self, Contender, FAULTS, Fault, Finding, Log, Row, Settings, What};
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Cast the same rays with every backend and list every disagreement.
///
/// Fifteen families of rays at several scales: from the scene's camera, bounced, towards lights, from anywhere, from
/// surfaces; aimed at edges and vertices, along the axes, within planes, ending at a triangle, from far away, and from
/// inside of closed surfaces. Each is asked for its nearest hit and for occlusion. Brute force is the arbiter. It looks at an
/// even part of the rays, as the table says, and at every ray on which the others disagree if that counts against one of
/// them. Exits with 0 if obvhs agrees with brute in every bit and leaks nowhere, and Embree differs on at most 1 in 100,000
/// ordinary rays and does not leak at edges from inside of closed surfaces; with 3 otherwise.
#[derive(clap::Args)]
pub(super) struct Args {
    /// Scene file (.toml) or OBJ file (.obj)
    scene: PathBuf,
    /// Rays of each family at each scale; the families that start inside of closed surfaces get four times as many, the rays
    /// from far away fewer in large scenes, where they cost as much as brute force
    #[arg(long, value_name = "N", default_value = "1e5", value_parser = count)]
    rays: u64,
    /// Where all random choices come from
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Factors on all lengths
    #[arg(long, value_name = "S,...", default_value = "1,1e-4,1e4,1e6", value_delimiter = ',', value_parser = scale)]
    scales: Vec<f64>,
    /// Backends to compare with brute; all of this build if not given
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    backends: Vec<Backend>,
    /// Use the fast triangle tests: disagreements and leaks are counted and listed, but fail nothing
    #[arg(long)]
    fast: bool,
    /// How many thousand million pairs of ray and triangle brute may look at, a few seconds each; disputes that could fail the
    /// census come on top
    #[arg(long, value_name = "N", default_value_t = 0.5)]
    brute_budget: f64,
    /// Write everything as JSON; - for standard output, instead of the table
    #[arg(long, value_name = "FILE")]
    json: Option<Target>,
    /// Makes every backend wrong in this way: proves that a fault reaches the table, the JSON and the exit code
    #[arg(long, hide = true, value_parser = planted)]
    plant_fault: Option<&'static Fault>,
}

fn planted(name: &str) -> Result<&'static Fault, String> {
    let names = || FAULTS.iter().map(|fault| fault.name).collect::<Vec<_>>().join(", ");
    FAULTS.iter().find(|fault| fault.name == name).ok_or_else(|| format!("faults are: {}", names()))
}

fn scale(text: &str) -> Result<f64, String> {
    let good = text.parse().ok().filter(|s: &f64| s.is_finite() && *s > 0.0);
    good.ok_or_else(|| "a scale is a number above 0".to_owned())
}

/// Disagreements that are printed; the rest is in the JSON.
const SHOWN: usize = 20;

/// Everything, as data.
#[derive(Serialize)]
struct Report<'a> {
    version: &'static str,
    scene: &'a str,
    triangles: u32,
    closed_triangles: usize,
    seed: u64,
    rays: u64,
    scales: &'a [f64],
    /// Pairs of ray and triangle that brute may look at, times 10⁹, disputes not counted.
    brute_budget: f64,
    intersect: String,
    backends: Vec<String>,
    /// Backends that this build does not have.
    not_run: Vec<&'static str>,
    passed: bool,
    seconds: f64,
    findings: &'a [Finding],
    #[serde(flatten)]
    log: &'a Log,
    environment: Environment,
}

/// Runs the subcommand.
pub(super) fn run(args: &Args) -> Result<ExitCode> {
    check_distinct(&args.backends)?;
    if args.backends.contains(&Backend::Brute) {
        return Err(Usage("--backends: brute is what the others are compared with".to_owned()).into());
    }
    if let Some(target @ Target::File(_)) = &args.json {
        drop(Output::create(target)?); // fail before the work, not after it
    }
    let start = Instant::now();
    let specimen = specimen(&args.scene)?;
    let intersect = if args.fast { Intersect::Fast } else { Intersect::Robust };
    let asked = backends(&args.backends);
    let contenders: Vec<Contender> = asked
        .iter()
        .map(|&backend| {
            let right = Contender::of_backend(backend, intersect);
            match args.plant_fault {
                Some(fault) => right.with_fault(fault),
                None => right,
            }
        })
        .collect();
    let settings = Settings {
        rays: args.rays,
        scales: args.scales.clone(),
        seed: args.seed,
        brute_pairs: args.brute_budget * 1e9,
    };
    let spinner = spinner("building the backends");
    let census = census::of(&specimen, &contenders, &settings, &mut |scale, family| {
        if let Some(spinner) = &spinner {
            spinner.set_message(format!("scale {scale}: {family} rays"));
        }
    })?;
    if let Some(spinner) = spinner {
        spinner.finish_and_clear();
    }

    let passed = census.passed();
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        scene: &census.scene,
        triangles: census.triangles,
        closed_triangles: census.closed_triangles,
        seed: args.seed,
        rays: args.rays,
        scales: &args.scales,
        brute_budget: args.brute_budget,
        intersect: intersect.to_string(),
        backends: asked.iter().map(Backend::to_string).collect(),
        not_run: not_built(),
        passed,
        seconds: start.elapsed().as_secs_f64(),
        findings: &census.findings,
        log: &census.log,
        environment: environment::here(),
    };
    if let Some(target) = &args.json {
        let json = json::text(&report).context("the census cannot be written as JSON")?;
        write_text(target, &json)?;
    }
    if args.json != Some(Target::Stdout) {
        write_text(&Target::Stdout, &text(&report))?;
    }
    Ok(ExitCode::from(if passed { 0 } else { 3 }))
}

/// The census on a terminal.
fn text(report: &Report) -> String {
    let mut out = format!(
        "gonio {} accel census: {}, {} triangles ({} in closed surfaces), {} tests, seed {}\n\n",
        report.version, report.scene, report.triangles, report.closed_triangles, report.intersect, report.seed
    );
    let _ = writeln!(
        out,
        "{:>6}  {:18}  {:7}  {:>9}  {:>9}  {:>9}  {:>9}  {:>7}  {:>8}  {:>6}  {:>6}  {:>6}  {:>6}",
        "scale",
        "rays",
        "backend",
        "cast",
        "hit",
        "by brute",
        "must hit",
        "leaks",
        "hit/miss",
        "prim",
        "t",
        "bary",
        "shadow"
    );
    for row in &report.log.rows {
        let Row { scale, family, backend, .. } = row;
        let _ = writeln!(
            out,
            "{scale:>6e}  {family:18}  {backend:7}  {:9}  {:9}  {:9}  {:9}  {:7}  {:8}  {:6}  {:6}  {:6}  {:6}",
            row.rays,
            row.hits,
            row.seen_by_brute,
            row.must_hit,
            row.leaks,
            row.hit_or_miss,
            row.prim,
            row.t,
            row.bary,
            row.shadow
        );
    }
    let listed = &report.log.disagreements;
    if !listed.is_empty() {
        out += "\nDecimals are the shortest that read back as the same number; their bits are beside them.\n";
    }
    for disagreement in listed.iter().take(SHOWN) {
        let _ = writeln!(out, "\n{disagreement}");
    }
    let more = (listed.len().saturating_sub(SHOWN)) as u64 + report.log.left_out;
    if more > 0 {
        let _ = writeln!(out, "\n… and {more} more; --json FILE has {} of them", listed.len());
    }
    out.push('\n');
    for f in report.findings {
        let what = match f.what {
            What::Disagreements => "rays that disagree with brute",
            What::Leaks => "rays that pass a surface which must stop them",
        };
        let result = if f.passed() { "pass" } else { "FAIL" };
        let Finding { backend, scale, count, rays, limit, .. } = f;
        let _ = writeln!(out, "{result}  {backend} at scale {scale:e}: {what}: {count} of {rays}, at most {limit}");
    }
    for name in &report.not_run {
        let _ = writeln!(out, "not run  {name}: this build does not have it (feature `{name}`)");
    }
    if !report.log.rows.iter().any(|row| row.family.is_inside()) {
        out += "not run  rays from inside: no closed surface with room inside was found\n";
    }
    let verdict = if report.passed { "passed" } else { "failed" };
    out + &format!("{verdict}, {:.1} s\n", report.seconds)
}
