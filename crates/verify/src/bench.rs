//! The benchmark: how many rays each backend casts per second, side by side.
//!
//! All methods of one ray set take turns in one process, round after round, so that a machine that slows down slows all of
//! them down; what counts is the ratio. Packing, answers and occlusion masks are inside the timing, as a renderer would pay
//! for them. A round before the first warms the caches and is not counted.

mod memory;
mod sets;

pub use sets::RaySet;

use crate::census::Specimen;
use crate::error::Error;
use gonio_accel::{Accel, Hit8, Intersect, Ray8, RayKind};
use gonio_kernel::Mask8;
use gonio_tracer::Backend;
use serde::Serialize;
use std::hint::black_box;
use std::time::Instant;

/// What is measured, and how often.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Rays of each set.
    pub rays: u64,
    /// Rounds; the median counts.
    pub rounds: u32,
    /// Threads that share each set.
    pub threads: u32,
    /// Where all random choices come from.
    pub seed: u64,
}

/// What was measured.
#[derive(Clone, Debug, Serialize)]
pub struct Measurement {
    /// How each backend was made ready.
    pub builds: Vec<Build>,
    /// The speed of each method on each ray set.
    pub results: Vec<Speed>,
}

/// How a backend was made ready.
#[derive(Clone, Debug, Serialize)]
pub struct Build {
    /// Its name.
    pub backend: String,
    /// Its triangle test.
    pub intersect: String,
    /// How long it took \[s\].
    pub seconds: f64,
    /// By how much the resident memory of the process grew; `None` where the system does not say.
    pub resident_bytes: Option<i64>,
}

/// The speed of one method on one ray set.
#[derive(Clone, Debug, Serialize)]
pub struct Speed {
    /// The rays.
    pub set: RaySet,
    /// Who cast them.
    pub backend: String,
    /// With which triangle test.
    pub intersect: String,
    /// Whether they were announced as coherent.
    pub coherent: bool,
    /// Live rays per round.
    pub rays: u64,
    /// Those of them that hit, or are blocked.
    pub hits: u64,
    /// Millions of rays per second: the median round.
    pub median: f64,
    /// The slowest round.
    pub min: f64,
    /// The fastest round.
    pub max: f64,
    /// Median over that of the set's first row.
    pub ratio: f64,
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

/// Measures every backend with its robust and its fast triangle test; the others are divided by the first. `progress` hears of
/// every ray set before it is cast.
///
/// # Errors
/// If a backend cannot be built.
pub fn measure(
    specimen: &Specimen,
    backends: &[Backend],
    settings: &Settings,
    progress: &mut dyn FnMut(RaySet),
) -> Result<Measurement, Error> {
    let (contenders, builds) = build(backends, specimen)?;
    let mut results = Vec::new();
    let Some(first) = contenders.first() else { return Ok(Measurement { builds, results }) };
    for (set, rays) in &sets::cast(specimen, &*first.accel, settings.rays, settings.seed) {
        progress(*set);
        results.extend(measure_set(settings, specimen, &contenders, *set, rays));
    }
    Ok(Measurement { builds, results })
}

/// Builds every backend with each of its triangle tests.
fn build(backends: &[Backend], specimen: &Specimen) -> Result<(Vec<Contender>, Vec<Build>), Error> {
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

fn measure_set(
    settings: &Settings,
    specimen: &Specimen,
    contenders: &[Contender],
    set: RaySet,
    rays: &[Ray8],
) -> Vec<Speed> {
    let mut methods = Vec::new();
    for contender in contenders {
        let most = BRUTE_PAIRS / u64::from(specimen.count().max(1));
        let part = if contender.backend == Backend::Brute { rays.len().min(most.max(1) as usize) } else { rays.len() };
        for &kind in set.kinds() {
            methods.push(Method { contender, kind, rays: &rays[..part], seconds: Vec::new(), hits: 0 });
        }
    }
    for round in 0..=settings.rounds {
        for method in &mut methods {
            let start = Instant::now();
            let hits = cast(method, set, settings.threads as usize);
            let seconds = start.elapsed().as_secs_f64();
            if round > 0 {
                method.seconds.push(seconds);
            }
            method.hits = hits;
        }
    }
    let mut measured: Vec<Speed> = methods.into_iter().map(|method| method.measured(set)).collect();
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
    fn measured(mut self, set: RaySet) -> Speed {
        self.seconds.sort_by(f64::total_cmp);
        let rays: u64 = self.rays.iter().map(|ray| u64::from(ray.mask.to_bits().count_ones())).sum();
        let rate = |seconds: f64| rays as f64 / 1e6 / seconds.max(1e-12);
        let n = self.seconds.len();
        Speed {
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
