//! The weight bound: no sample weighs more than its lobe promises, and f_cos never exceeds that multiple of the density.
//!
//! What is promised is `Lobe::largest_weight`. A mixture trades between lobes: its bound is the largest of their bounds over their
//! probabilities. Both the samples themselves and random pairs of directions are tried: a density that vanishes where f does not is an infinite weight.
//! Of a lobe that promises nothing only infinite weights fail; the largest is reported.

use crate::directions::show;
use crate::finding::{Finding, Run};
use crate::probe::{BsdfValue, Dir, Kind};
use crate::under_test::View;

/// The largest ratio of weight to bound.
pub(crate) fn measure(view: View, run: &Run) -> Finding {
    let mut random = run.random();
    // f_cos and pdf share D and G₁; what is left, G₂/G₁ and F and the mixture's sums, takes about 16 roundings, each half
    // an eps: 16 eps is twice what they can add up to.
    let slack = 16.0 * view.probe.epsilon();
    let promises = view.probe.largest_weight(Dir::unit_z()).is_finite();
    let mut finding = match promises {
        true => Finding::at_most(1.0 + slack, "max f_cos/(pdf · bound) ≤"),
        false => Finding::at_most(f64::MAX, "max f_cos/pdf is finite ≤"),
    };
    for _ in 0..run.by_effort(4_000, 40_000, 200_000) {
        let Some((wo, wi)) = view.pair(&mut random) else { continue };
        let bound = if promises { view.probe.largest_weight(wo) } else { 1.0 };
        let mut judge = |value: BsdfValue, wi: Dir, what: &str| {
            // Below the range of normal numbers a quotient means nothing: f32 denormals carry few bits.
            let largest = value.f_cos.into_iter().fold(0.0, f64::max);
            if largest < if view.probe.single() { 1e-30 } else { 1e-280 } {
                return;
            }
            finding.raise(largest / value.pdf / bound, || {
                format!(
                    "{what}: f_cos {largest:.6e}, pdf {:.6e}, bound {bound:.6}, wo {}, wi {}",
                    value.pdf,
                    show(wo),
                    show(wi)
                )
            });
        };
        let draw = view.probe.sample(wo, random.sampler_input(view.probe.single()));
        match draw.kind {
            Kind::Continuous => judge(view.probe.eval(wo, draw.wi), draw.wi, "sample"),
            Kind::Delta(value, _) => judge(value, draw.wi, "delta"),
            Kind::Failed => {}
        }
        judge(view.probe.eval(wo, wi), wi, "pair");
    }
    finding
}
