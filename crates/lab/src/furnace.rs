//! The furnace: under a uniform sky of radiance 1 a surface returns its directional albedo ∫ f cosθ dω, by two ways.
//!
//! Quadrature of `eval` plus the values of the delta events, and the mean weight of samples (failures weigh 0), must
//! agree. Weights are bounded and their true variance ∫ f²/pdf − albedo² is known by quadrature as well, so Bennett's
//! inequality gives a p-value that holds even where nearly all weights are equal. Besides, no albedo may exceed 1 (or what a
//! fitted model admits); and where the albedo is known exactly (white Lambert and mirror return everything) it must be that.

use crate::finding::{Finding, Run};
use crate::probe::{BsdfValue, Dir, Kind};
use crate::random::Random;
use crate::statistics::bennett_p;
use crate::under_test::{Prepared, View};
use gonio_kernel::Properties;

/// Agreement of quadrature and sampling.
pub(crate) fn measure(view: View, run: &Run) -> Finding {
    let mut random = run.random();
    let mut finding = Finding::p_value(run.level);
    let n = run.by_effort(20_000, 100_000, 300_000);
    for at in view.prepared() {
        let sampled = sample(view, at.wo, n, &mut random);
        // Where no bound is promised, the largest weight of the sample must do.
        let bound = Some(view.probe.largest_weight(at.wo)).filter(|bound| bound.is_finite());
        let reach = bound.map_or(sampled.largest, |bound| bound.max(sampled.largest));
        for c in 0..3 {
            let albedo = at.total.value[c] + sampled.delta.iter().map(|d| d.1.f_cos[c]).sum::<f64>();
            let square =
                at.total.value[4 + c] + sampled.delta.iter().map(|d| d.1.f_cos[c] * d.1.weight()[c]).sum::<f64>();
            let mean = sampled.sum[c] / n as f64;
            // Not chance: the quadrature's error, and rounding, of weights and of their sum, which may all go one way.
            let slack = at.total.error + rounding(view) + f64::EPSILON * n as f64;
            let p = bennett_p((mean - albedo).abs() - slack, n as f64, square - albedo * albedo, reach);
            // Three channels at one level: Bonferroni.
            finding.lower((3.0 * p).min(1.0), || {
                format!("{}, channel {c}: quadrature {albedo:.7}, sampling {mean:.7}", at.name)
            });
        }
    }
    finding.note(format!("{n} samples per view"));
    finding
}

/// Quadrature against 1, and against the known albedo.
pub(crate) fn measure_bound(view: View, run: &Run) -> Finding {
    let mut random = run.random();
    let Properties { conserving, excess, .. } = view.claims.properties;
    let mut finding = match conserving {
        true => Finding::at_most(
            1.0,
            "excess over 1 or error of a known albedo, in units of quadrature error, rounding and what the model admits ≤",
        ),
        false => {
            Finding::at_least(1.0, "gains energy by design: excess over 1 in units of quadrature error and rounding ≥")
        }
    };
    let mut largest = (0.0_f64, "");
    for Prepared { name, wo, total, .. } in view.prepared() {
        let sampled = sample(view, *wo, 1000, &mut random);
        let unit = total.error + rounding(view) + f64::from(view.claims.properties.albedo_error) + f64::from(excess);
        for c in 0..3 {
            let albedo = total.value[c] + sampled.delta.iter().map(|d| d.1.f_cos[c]).sum::<f64>();
            if albedo > largest.0 {
                largest = (albedo, name);
            }
            finding.raise((albedo - 1.0) / unit, || format!("{name}, channel {c}: albedo {albedo}"));
            let Some(known) = view.claims.properties.albedo.map(<[f64; 3]>::from) else { continue };
            finding.raise((albedo - known[c]).abs() / unit, || {
                format!("{name}, channel {c}: albedo {albedo} instead of {}", known[c])
            });
            // A single event has no noise: what one sample weighs is what all weigh.
            if view.claims.one_event {
                let mean = sampled.sum[c] / 1000.0;
                finding.raise((mean - known[c]).abs() / unit, || {
                    format!("{name}, channel {c}: every sample weighs {mean}, not {}", known[c])
                });
            }
        }
    }
    finding.note(format!("largest albedo {:.9} at {}", largest.0, largest.1));
    finding
}

/// How far rounding may move a mean weight or an albedo. The values of a lobe are good to a few eps (16 here), those of a
/// narrow one in `f32` are moved by the rounding of directions too, up and down alike: 10⁻⁵ is a tenth of the smallest
/// difference that matters in a picture of 8 bits after ten bounces.
fn rounding(view: View) -> f64 {
    if view.reference.single() || view.probe.single() { 1e-5 } else { 16.0 * f64::EPSILON }
}

/// Weights of samples, added up.
struct Sampled {
    sum: [f64; 3],
    largest: f64,
    delta: Vec<((u32, bool), BsdfValue)>,
}

fn sample(view: View, wo: Dir, n: usize, random: &mut Random) -> Sampled {
    let u: Vec<[f64; 3]> = (0..n).map(|_| random.sampler_input(view.probe.single())).collect();
    let mut draws = Vec::with_capacity(n);
    view.probe.sample_all(wo, &u, &mut draws);
    let mut sampled = Sampled { sum: [0.0; 3], largest: 0.0, delta: Vec::new() };
    for draw in draws {
        let weight = match draw.kind {
            Kind::Failed => continue,
            Kind::Continuous => view.probe.eval(wo, draw.wi).weight(),
            Kind::Delta(value, label) => {
                if sampled.delta.iter().all(|(seen, _)| *seen != label) {
                    sampled.delta.push((label, value));
                }
                value.weight()
            }
        };
        for (sum, weight) in sampled.sum.iter_mut().zip(weight) {
            *sum += weight;
            sampled.largest = sampled.largest.max(weight);
        }
    }
    sampled
}
