//! `gonio accel bench`: how many rays each backend casts per second, side by side.
//!
//! All methods of one ray set take turns in one process, round after round, so that a machine that slows down slows all of
//! them down; what counts is the ratio. Packing, answers and occlusion masks are inside the timing, as a renderer would pay
//! for them. A round before the first warms the caches and is not counted.

mod memory;
mod sets;
mod table;

use super::{backends, check_distinct, not_built, specimen};
use crate::census::specimen::Specimen;
use crate::environment;
use crate::output::{Target, write_text};
use crate::usage::{count, spinner};
use anyhow::{Context, Result};
use gonio_accel::{Accel, Hit8, Intersect, Ray8, RayKind};
use gonio_kernel::Mask8;
use gonio_report::{Environment, json};
use gonio_tracer::Backend;
use serde::Serialize;
use sets::RaySet;
use std::hint::black_box;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

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
    builds: Vec<Build>,
    results: Vec<Measured>,
    /// Backends that this build does not have.
    not_run: Vec<&'static str>,
    environment: Environment,
}

/// How a backend was made ready.
#[derive(Serialize)]
struct Build {
    backend: String,
    intersect: String,
    seconds: f64,
    /// By how much the resident memory of the process grew; `None` where the system does not say.
    resident_bytes: Option<i64>,
}

/// The speed of one method on one ray set.
#[derive(Serialize)]
struct Measured {
    set: RaySet,
    backend: String,
    intersect: String,
    coherent: bool,
    /// Live rays per round.
    rays: u64,
    /// Those of them that hit, or are blocked.
    hits: u64,
    /// Millions of rays per second: the median round, the slowest and the fastest.
    median: f64,
    min: f64,
    max: f64,
    /// Median over that of the set's first row.
    ratio: f64,
}

/// A backend, built.
struct Contender {
    backend: Backend,
    intersect: Intersect,
    accel: Box<dyn Accel>,
}

/// A way of answering a ray set.
struct Method<'a> {
    contender: &'a Contender,
    kind: RayKind,
    rays: &'a [Ray8],
    seconds: Vec<f64>,
    hits: u64,
}

/// Brute gets so few rays that a round stays below this many pairs of packet and triangle.
const BRUTE_PAIRS: u64 = 50_000_000;

/// Runs the subcommand.
pub(super) fn run(args: &Args) -> Result<ExitCode> {
    check_distinct(&args.backends)?;
    let specimen = specimen(&args.scene)?;
    let spinner = spinner("building the backends");
    let (contenders, builds) = build(&backends(&args.backends), &specimen)?;
    let sets = sets::cast(&specimen, &*contenders[0].accel, args.rays, args.seed);
    let mut results = Vec::new();
    for (set, rays) in &sets {
        if let Some(spinner) = &spinner {
            spinner.set_message(format!("{set} rays"));
        }
        results.extend(measure(args, &specimen, &contenders, *set, rays));
    }
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
        builds,
        results,
        not_run: not_built(),
        environment: environment::here(),
    };
    let printed = if args.json {
        json::text(&report).context("the measurement cannot be written as JSON")?
    } else {
        table::text(&report)
    };
    write_text(&Target::Stdout, &printed)?;
    Ok(ExitCode::SUCCESS)
}

/// Builds every backend with each of its triangle tests.
fn build(backends: &[Backend], specimen: &Specimen) -> Result<(Vec<Contender>, Vec<Build>)> {
    let (mut contenders, mut builds) = (Vec::new(), Vec::new());
    for &backend in backends {
        let tests =
            if backend == Backend::Brute { &[Intersect::Robust][..] } else { &[Intersect::Robust, Intersect::Fast] };
        for &intersect in tests {
            let (before, start) = (memory::resident(), Instant::now());
            let accel = backend.build(&specimen.geometry, intersect)?;
            let seconds = start.elapsed().as_secs_f64();
            let grown = before.zip(memory::resident()).map(|(before, after)| after - before);
            let (name, test) = (backend.to_string(), intersect.to_string());
            builds.push(Build { backend: name, intersect: test, seconds, resident_bytes: grown });
            contenders.push(Contender { backend, intersect, accel });
        }
    }
    Ok((contenders, builds))
}

fn measure(args: &Args, specimen: &Specimen, contenders: &[Contender], set: RaySet, rays: &[Ray8]) -> Vec<Measured> {
    let mut methods = Vec::new();
    for contender in contenders {
        let most = BRUTE_PAIRS / u64::from(specimen.count().max(1));
        let part = if contender.backend == Backend::Brute { rays.len().min(most.max(1) as usize) } else { rays.len() };
        for &kind in set.kinds() {
            methods.push(Method { contender, kind, rays: &rays[..part], seconds: Vec::new(), hits: 0 });
        }
    }
    for round in 0..=args.rounds {
        for method in &mut methods {
            let start = Instant::now();
            let hits = cast(method, set, args.threads as usize);
            let seconds = start.elapsed().as_secs_f64();
            if round > 0 {
                method.seconds.push(seconds);
            }
            method.hits = hits;
        }
    }
    let mut measured: Vec<Measured> = methods.into_iter().map(|method| method.measured(set)).collect();
    let first = measured[0].median;
    measured.iter_mut().for_each(|m| m.ratio = m.median / first);
    measured
}

/// Answers all rays once, divided evenly among the threads; how many hit or are blocked.
fn cast(method: &Method, set: RaySet, threads: usize) -> u64 {
    let one = |rays: &[Ray8]| {
        let accel = &*method.contender.accel;
        if set.is_any_hit() {
            let mut blocked = vec![Mask8::first(0); rays.len()];
            accel.occluded(method.kind, rays, None, &mut blocked);
            black_box(&blocked).iter().map(|mask| u64::from(mask.to_bits().count_ones())).sum::<u64>()
        } else {
            let mut hits = vec![Hit8::miss(); rays.len()];
            accel.closest(method.kind, rays, &mut hits);
            let finite = |hit: &Hit8| hit.t.to_array().iter().filter(|t| t.is_finite()).count() as u64;
            black_box(&hits).iter().map(finite).sum()
        }
    };
    if threads == 1 {
        return one(method.rays);
    }
    let share = method.rays.len().div_ceil(threads).max(1);
    std::thread::scope(|scope| {
        let parts: Vec<_> = method.rays.chunks(share).map(|rays| scope.spawn(move || one(rays))).collect();
        parts.into_iter().map(|part| part.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))).sum()
    })
}

impl Method<'_> {
    fn measured(mut self, set: RaySet) -> Measured {
        self.seconds.sort_by(f64::total_cmp);
        let rays: u64 = self.rays.iter().map(|ray| u64::from(ray.mask.to_bits().count_ones())).sum();
        let rate = |seconds: f64| rays as f64 / 1e6 / seconds.max(1e-12);
        let n = self.seconds.len();
        Measured {
            set,
            backend: self.contender.backend.to_string(),
            intersect: self.contender.intersect.to_string(),
            coherent: self.kind == RayKind::Coherent,
            rays,
            hits: self.hits,
            median: rate(0.5 * (self.seconds[(n - 1) / 2] + self.seconds[n / 2])),
            min: rate(self.seconds[n - 1]),
            max: rate(self.seconds[0]),
            ratio: 1.0,
        }
    }
}
