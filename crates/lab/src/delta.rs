//! Mirror and smooth interface, against the laws of reflection, ω_i = 2n(n·ω_o) − ω_o, and refraction, η_o sinθ_o = η_i sinθ_i:
//! a mirror weighs R with probability 1, and there is nothing besides.

use crate::directions::{partner, show};
use crate::finding::{Finding, Run};
use crate::probe::{Dir, Kind};
use crate::under_test::View;
use gonio_kernel::Vec3;

/// The largest departure from the law; only for lobes that are all delta.
pub(crate) fn measure(view: View, run: &Run) -> Finding {
    let mut random = run.random();
    let mut finding = Finding::at_most(4.0 * view.probe.epsilon(), "max |wi − mirrored wo|, |weight − R| ≤");
    let n = Vec3::new(0.0, 0.0, 1.0);
    for _ in 0..run.by_effort(5_000, 50_000, 500_000) {
        let wo = view.any_wo(&mut random);
        let wi = view.probe.snap(partner(&mut random, wo));
        let mirrored = n * (2.0 * n.dot(wo)) - wo;
        for wi in [wi, mirrored] {
            let value = view.probe.eval(wo, wi);
            if value.numbers() != [0.0; 4] {
                finding.broken(|| format!("a density over directions: {value:?}, wo {}, wi {}", show(wo), show(wi)));
            }
        }
        let draw = view.probe.sample(wo, random.sampler_input(view.probe.single()));
        let Kind::Delta(value, _) = draw.kind else {
            finding.broken(|| format!("sampled {:?} at wo {}", draw.kind, show(wo)));
            continue;
        };
        if draw.transmitted {
            let eta = view.probe.radiance_scale(wo).sqrt();
            let refracted = refracted(wo, eta);
            // One ulp of the sine is η of them on the other side, and more the closer that is to grazing.
            let ill = (1.0 / eta).max(1.0).powi(2) / refracted.z.abs().max(view.probe.epsilon().sqrt());
            finding.raise((draw.wi - refracted).length() / ill, || format!("wi {} for wo {}", show(draw.wi), show(wo)));
            continue;
        }
        finding.raise((draw.wi - mirrored).length(), || format!("wi {} for wo {}", show(draw.wi), show(wo)));
        // A single mirror reflects with probability 1, and weighs its albedo where that is known.
        if view.claims.one_event {
            finding.raise((value.pdf - 1.0).abs(), || format!("probability {} at wo {}", value.pdf, show(wo)));
            let known = view.claims.properties.albedo.map(<[f64; 3]>::from);
            for (weight, known) in value.weight().into_iter().zip(known.into_iter().flatten()) {
                finding
                    .raise((weight - known).abs(), || format!("weight {weight} instead of {known} at wo {}", show(wo)));
            }
        }
        // From below there is nothing.
        let below = view.probe.sample(-wo, random.sampler_input(view.probe.single()));
        if below.kind != Kind::Failed && !view.claims.properties.transmits {
            finding.broken(|| format!("reflects from below: {:?} at wo {}", below.kind, show(-wo)));
        }
    }
    finding
}

/// wo refracted by Snell's law, with η_t/η_i seen from wo.
fn refracted(wo: Dir, eta: f64) -> Dir {
    let sin2 = (wo.x * wo.x + wo.y * wo.y) / (eta * eta);
    Vec3::new(-wo.x / eta, -wo.y / eta, -(1.0 - sin2).max(0.0).sqrt().copysign(wo.z))
}
