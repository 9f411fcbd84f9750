//! χ²: are samples distributed as the density says?
//!
//! Samples fall into cells of about equal probability that follow the lobe, one bin per delta event, and one for
//! failures. Expected counts are N∫pdf over the cells, by adaptive quadrature of the reference; N times the probability of
//! each delta event; and what is left of N for failures, so that ∫pdf + Σ p(delta) + P(failed) = 1 is part of the
//! test. Pearson's statistic; bins that expect fewer than 25 are pooled, and a pool too small for Pearson gets an exact
//! Poisson test. How N follows from the fault that is to be found: `statistics.rs`.

use crate::cells::{Cells, USUAL_BINS};
use crate::directions::VIEWS;
use crate::effort::Effort;
use crate::finding::{Finding, Run};
use crate::probe::{BsdfValue, Dir, Kind};
use crate::random::Random;
use crate::statistics::{FAULT_MASS, FAULT_SIZE, POWER, chi2_p, poisson_p, samples_for, size_found};
use crate::under_test::{Prepared, View};

/// Pearson's approximation is used for bins that expect this many: below, its tail at 10⁻⁵ is too thin.
const LEAST_EXPECTED: f64 = 25.0;

/// Cells narrower than this \[rad\] are not measured in `f32`: 32 steps of the lattice of directions near 1 (2⁻²⁴). The
/// sampler rounds several times to that lattice, each by up to half a step, and below this width that is seen.
const LEAST_WIDTH: f64 = 32.0 / 16_777_216.0;

/// How many samples a run takes per test: at full effort as many as find twice the planted fault, in each of four views.
fn samples(run: &Run) -> u64 {
    match run.effort {
        Effort::Quick => 250_000,
        Effort::Standard => 3_000_000,
        Effort::Full => samples_for(2.0 * FAULT_SIZE, run.level, DEGREES, POWER),
    }
}

/// The usual degrees of freedom.
pub(crate) const DEGREES: f64 = (USUAL_BINS - 1) as f64;

/// What is sampled in `f32` in full may be sampled in `f64` by an eighth: it is the same program, one draw costs eight times
/// as much, and its density is also held to its sampler point by point (`jacobian`).
const SHARE_OF_DOUBLE: u64 = 8;

/// The worst of the four views.
pub(crate) fn measure(view: View, run: &Run) -> Finding {
    measure_with(view, run, samples(run), VIEWS.len())
}

/// As [`measure`], with given numbers of samples and views. A lobe with a form in `f32` spends them there.
pub(crate) fn measure_with(view: View, run: &Run, n: u64, views: usize) -> Finding {
    let mut random = run.random();
    let mut finding = Finding::p_value(run.level);
    let mut too_fine = String::new();
    for at in view.prepared().take(views) {
        if view.probe.single() && at.cells.width() < LEAST_WIDTH {
            too_fine += &format!("; {} left to f64, its cells are {:.0e} rad wide", at.name, at.cells.width());
            continue;
        }
        let elsewhere = !view.probe.single() && view.has_single && at.cells.width() >= LEAST_WIDTH;
        let n = if elsewhere { n / SHARE_OF_DOUBLE } else { n };
        let (p, detail) = test(view, at, n, &mut random);
        finding.lower(p, || format!("{}: {detail}", at.name));
    }
    let share = if !view.probe.single() && view.has_single { SHARE_OF_DOUBLE } else { 1 };
    let n = n / share;
    let found = size_found(n, run.level, DEGREES);
    finding.note(format!(
        "{n} samples: finds an error of {:.2} % over {:.0} % of the mass with probability {POWER}{too_fine}",
        100.0 * found,
        100.0 * FAULT_MASS
    ));
    finding
}

/// Samples, counted.
struct Counts {
    cells: Vec<u64>,
    delta: Vec<((u32, bool), BsdfValue, u64)>,
    failed: u64,
    /// Draws without a finite direction.
    lost: u64,
}

fn count(view: View, wo: Dir, cells: &Cells, n: u64, random: &mut Random) -> Counts {
    const BATCH: u64 = 512; // draws of 100 bytes: stays in the first two caches
    let mut counts = Counts { cells: vec![0; cells.len()], delta: Vec::new(), failed: 0, lost: 0 };
    let (mut u, mut draws) = (Vec::new(), Vec::new());
    let mut left = n;
    while left > 0 {
        let batch = left.min(BATCH);
        left -= batch;
        u.clear();
        draws.clear();
        u.extend((0..batch).map(|_| random.sampler_input(view.probe.single())));
        view.probe.sample_all(wo, &u, &mut draws);
        for draw in &draws {
            match draw.kind {
                Kind::Failed => counts.failed += 1,
                Kind::Continuous => match cells.index(dither(view, draw.wi, random)) {
                    Some(cell) => counts.cells[cell] += 1,
                    None => counts.lost += 1,
                },
                Kind::Delta(value, label) => match counts.delta.iter_mut().find(|d| d.0 == label) {
                    Some(seen) => seen.2 += 1,
                    None => counts.delta.push((label, value, 1)),
                },
            }
        }
    }
    counts
}

/// A direction of `f32` moved at random within half a unit in the last place of each component. Samples of a narrow lobe
/// lie on few points of the lattice (at alpha = 1e-4 and 89° a cell is eight of them wide), and borders between points
/// would count points, not area. Spread over the area that was rounded to it, a point stands for what it came from; the
/// density is blurred by (ulp/width)²/24, below 10⁻⁴ at worst.
fn dither(view: View, w: Dir, random: &mut Random) -> Dir {
    if !view.probe.single() {
        return w;
    }
    let bits = random.bits();
    let blur = |x: f64, shift: u32| {
        let unit = ((bits >> shift) & 0x1f_ffff) as f64 * 2.0_f64.powi(-21) - 0.5;
        let ulp = f64::from(f32::from_bits((x as f32).to_bits() & 0x7f80_0000)) * f64::from(f32::EPSILON);
        x + unit * ulp
    };
    Dir::new(blur(w.x, 0), blur(w.y, 21), blur(w.z, 42))
}

/// Observed and expected counts of the cells at one wo.
pub(crate) fn observed_and_expected(view: View, at: &Prepared, n: u64, random: &mut Random) -> Vec<(u64, f64)> {
    let counts = count(view, at.wo, &at.cells, n, random);
    counts.cells.into_iter().zip(at.integrals.iter().map(|i| n as f64 * i.value[3])).collect()
}

/// The p-value at one wo, and what it rests on.
fn test(view: View, at: &Prepared, n: u64, random: &mut Random) -> (f64, String) {
    let Prepared { wo, cells, integrals, total, .. } = at;
    let counts = count(view, *wo, cells, n, random);
    if counts.lost > 0 {
        return (0.0, format!("{} samples without a finite direction", counts.lost));
    }
    let delta: f64 = counts.delta.iter().map(|d| d.1.pdf).sum();
    let failed = 1.0 - total.value[3] - delta;
    // What is not chance: the quadrature's error, and the rounding of the probe's own probabilities.
    let slack = total.error + 4.0 * view.probe.epsilon();
    if !(failed >= -1e-3 && total.value[3].is_finite()) {
        return (0.0, format!("∫pdf + Σ p(delta) = {}", 1.0 - failed));
    }

    let n = n as f64;
    let bins = counts.cells.iter().copied().zip(integrals.iter().map(|i| i.value[3]));
    let bins = bins.chain(counts.delta.iter().map(|d| (d.2, d.1.pdf))).chain([(counts.failed, failed.max(0.0))]);
    let (mut statistic, mut used) = (0.0, 0);
    let mut worst = (0.0, 0.0, 0.0);
    let mut pool = (0, 0.0);
    let mut pearson = |observed: f64, expected: f64| {
        let term = (observed - expected).powi(2) / expected;
        statistic += term;
        used += 1;
        if term > worst.0 {
            worst = (term, observed, expected);
        }
    };
    for (observed, probability) in bins {
        if n * probability >= LEAST_EXPECTED {
            pearson(observed as f64, n * probability);
        } else {
            pool = (pool.0 + observed, pool.1 + n * probability);
        }
    }
    let mut p_pool = 1.0;
    if pool.1 >= LEAST_EXPECTED {
        pearson(pool.0 as f64, pool.1);
    } else {
        p_pool = poisson_p(pool.0, pool.1 - n * slack, pool.1 + n * slack);
    }
    let p = chi2_p(statistic, f64::from((used - 1).max(1)));
    let detail = format!(
        "χ² = {statistic:.1} in {used} bins; worst bin has {} for {:.1}; pool has {} for {:.2}; quadrature is off by {:.1e}",
        worst.1, worst.2, pool.0, pool.1, total.error
    );
    // Two tests at one level: Bonferroni.
    ((2.0 * p.min(p_pool)).min(1.0), detail)
}
