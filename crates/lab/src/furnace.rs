//! The furnace: under a uniform sky of radiance 1 a surface returns its directional albedo ∫ f cosθ dω, by two ways.
//!
//! Quadrature of `eval` plus the strengths of the discrete events, and the mean weight of samples (failures weigh 0), must
//! agree; neither may exceed 1; and where the albedo is known exactly (white Lambert and mirror return everything) both
//! must be that. The first comparison is a z-test per channel at one level for all three.

use crate::cells::Cells;
use crate::directions::views;
use crate::finding::{Finding, Run};
use crate::probe::{Dir, Kind, Worth};
use crate::random::Random;
use crate::statistics::mean_p;
use crate::subject::View;

/// Agreement of quadrature and sampling.
pub(crate) fn measure(view: View, run: &Run) -> Finding {
    let mut random = run.random();
    let mut finding = Finding::p_value(run.level);
    let n = run.by_effort(20_000, 200_000, 2_000_000);
    for (name, wo) in views() {
        let wo = view.probe.snap(wo);
        let (sampled, discrete) = sample(view, wo, n, &mut random);
        let (quadrature, error) = quadrature(view, wo, &discrete, &mut random);
        for c in 0..3 {
            let (mean, deviation) = sampled[c];
            // Not chance: the quadrature's error, and rounding, which can push every weight the same way.
            let slack = error + 8.0 * view.probe.epsilon() * (1.0 + quadrature[c]) + rounding(view, wo);
            let p = mean_p((mean - quadrature[c]).abs() - slack, deviation);
            // Three channels at one level: Bonferroni.
            finding.lower((3.0 * p).min(1.0), || {
                format!("{name}, channel {c}: quadrature {:.7}, sampling {mean:.7} ± {deviation:.1e}", quadrature[c])
            });
        }
    }
    finding.note(format!("{n} samples per view"));
    finding
}

/// Quadrature against 1, and against the known albedo.
pub(crate) fn measure_bound(view: View, run: &Run) -> Finding {
    let mut random = run.random();
    let mut finding = Finding::at_most(1.0, "excess over energy or error of a known albedo, in units of quadrature error + 8 eps ≤");
    for (name, wo) in views() {
        let wo = view.probe.snap(wo);
        let (sampled, discrete) = sample(view, wo, 1000, &mut random);
        let (albedo, error) = quadrature(view, wo, &discrete, &mut random);
        let unit = error + 8.0 * view.probe.epsilon() + rounding(view, wo);
        for c in 0..3 {
            finding.raise((albedo[c] - 1.0) / unit, || format!("{name}, channel {c}: albedo {}", albedo[c]));
            let Some(known) = view.claims.albedo else { continue };
            finding.raise((albedo[c] - known[c]).abs() / unit, || {
                format!("{name}, channel {c}: albedo {} instead of {}", albedo[c], known[c])
            });
            // A purely discrete lobe has no noise unless it chooses: what one event weighs is what all weigh.
            if view.claims.discrete && discrete.len() == 1 {
                finding.raise((sampled[c].0 - known[c]).abs() / unit, || {
                    format!("{name}, channel {c}: every sample weighs {}, not {}", sampled[c].0, known[c])
                });
            }
        }
    }
    finding
}

/// How far a mean weight may be off because f32 arithmetic moves directions and so values: one part in 10⁵, for a probe
/// whose reference is more precise than itself or no more precise than f32; nothing in f64.
fn rounding(view: View, _wo: Dir) -> f64 {
    if view.probe.single() { 1e-5 } else { 0.0 }
}

/// Mean weight and its standard error per channel, and the discrete events that were met.
fn sample(view: View, wo: Dir, n: usize, random: &mut Random) -> ([(f64, f64); 3], Vec<((u32, bool), Worth)>) {
    let u: Vec<[f64; 3]> = (0..n).map(|_| random.sampler_input(view.probe.single())).collect();
    let mut draws = Vec::with_capacity(n);
    view.probe.sample_all(wo, &u, &mut draws);
    let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
    let mut discrete = Vec::new();
    for draw in draws {
        let weight = match draw.kind {
            Kind::Failed => continue,
            Kind::Continuous => view.probe.eval(wo, draw.wi).weight(),
            Kind::Discrete(worth, label) => {
                if discrete.iter().all(|(seen, _)| *seen != label) {
                    discrete.push((label, worth));
                }
                worth.weight()
            }
        };
        for c in 0..3 {
            sum[c] += weight[c];
            squares[c] += weight[c] * weight[c];
        }
    }
    let n = n as f64;
    let statistics = std::array::from_fn(|c| {
        let mean = sum[c] / n;
        (mean, ((squares[c] / n - mean * mean).max(0.0) / n).sqrt())
    });
    (statistics, discrete)
}

/// The albedo by quadrature, discrete events included, and the error of the quadrature.
fn quadrature(view: View, wo: Dir, discrete: &[((u32, bool), Worth)], random: &mut Random) -> ([f64; 3], f64) {
    let cells = Cells::following(view.probe, wo, random);
    let total = Cells::total(&cells.integrate(view.reference, wo));
    let albedo = std::array::from_fn(|c| total.value[c] + discrete.iter().map(|d| d.1.f_cos[c]).sum::<f64>());
    (albedo, total.error)
}
