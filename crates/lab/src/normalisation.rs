//! Normalisation: ∫pdf dω + Σ p(delta) + P(failed) = 1 at every wo.
//!
//! Failures are part of the law: a visible normal may mirror wo below the horizon. Their frequency is counted and compared
//! with what quadrature leaves for them, by an exact Poisson test where failures are rare and a z-test where they are not.

use crate::finding::{Finding, Run};
use crate::probe::Kind;
use crate::statistics::{mean_p, poisson_p};
use crate::under_test::{Prepared, View};

/// The worst of the four views.
pub(crate) fn measure(view: View, run: &Run) -> Finding {
    let mut random = run.random();
    let mut finding = Finding::p_value(run.level);
    let n = run.by_effort(50_000, 500_000, 1_000_000);
    for Prepared { name, wo, total: integral, .. } in view.prepared() {
        let (mut failed, mut delta) = (0, Vec::new());
        let (mut u, mut draws) = (Vec::new(), Vec::new());
        for batch in batches(n) {
            u.clear();
            draws.clear();
            u.extend((0..batch).map(|_| random.sampler_input(view.probe.single())));
            view.probe.sample_all(*wo, &u, &mut draws);
            for draw in &draws {
                match draw.kind {
                    Kind::Failed => failed += 1,
                    Kind::Delta(value, label) if delta.iter().all(|(seen, _)| *seen != label) => {
                        delta.push((label, value.pdf));
                    }
                    _ => {}
                }
            }
        }
        let some: f64 = integral.value[3] + delta.iter().map(|d| d.1).sum::<f64>();
        let left = 1.0 - some;
        // The quadrature aims at 10⁻⁹ in all; its own estimate may be more or, at kinks, too little. And a wo that is exact in
        // f32 is only unit to that precision, which moves ∫pdf as much.
        let aim = if view.has_single { f64::from(f32::EPSILON) } else { 1e-9 };
        let slack =
            integral.error.max(aim) + 4.0 * view.probe.epsilon() + if view.reference.single() { 1e-5 } else { 0.0 };
        let count = n as f64;
        let p = if left < -slack || !left.is_finite() {
            0.0
        } else if left < 0.05 {
            poisson_p(failed, count * (left - slack), count * (left + slack))
        } else {
            let error = (left * (1.0 - left) / count).sqrt();
            mean_p((failed as f64 / count - left).abs() - slack, error)
        };
        finding.lower(p, || format!("{name}: ∫pdf + Σ p(delta) = {some:.8}, {failed} of {n} samples failed"));
    }
    finding.note(format!("{n} samples per view"));
    finding
}

/// n in parts that fit a cache.
fn batches(n: usize) -> impl Iterator<Item = usize> {
    const BATCH: usize = 4096;
    (0..n).step_by(BATCH).map(move |start| BATCH.min(n - start))
}
