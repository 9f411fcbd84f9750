//! Reciprocity: f(wo, wi) = f(wi, wo) for reflection (Helmholtz); as importance, f(wo, wi) η_o² = f(wi, wo) η_i² through an
//! interface (Veach 1997, section 5.2).
//!
//! **Limit.** The kernel's lobes are written so that exchanging the directions exchanges the operands of commutative
//! operations only (h = wo + wi, one sum in the visibility term). What differs is the rounding of cos_i s(wo) + cos_o s(wi)
//! (fused on one side), of the product with cos_i, and the division by it here: at most 4 roundings of half an eps on
//! either side and as many again for each lobe of a mixture, so 16 eps bounds it with room. Of a lobe that does
//! not claim it (`Properties::symmetric`) no such thing is known: either way may be off by as much as its precision allows, 8 times the change that moving one input by one unit in
//! the last place makes, or 8 eps.
//!
//! A model that says it is not reciprocal must be caught being so, beyond that limit: else its claim is stale.

use crate::directions::show;
use crate::finding::{Finding, Run};
use crate::precision::sensitivity;
use crate::under_test::View;

/// The largest relative difference, in units of its limit.
pub(crate) fn measure(view: View, run: &Run) -> Finding {
    let mut random = run.random();
    let eps = view.probe.epsilon();
    let mut finding = match view.claims.properties.reciprocal {
        true => Finding::at_most(1.0, "max |f(wo,wi) − f(wi,wo)| in units of its rounding limit ≤"),
        false => Finding::at_least(1.0, "not reciprocal by design: max |f(wo,wi) − f(wi,wo)| in rounding limits ≥"),
    };
    let mut residual = 0.0_f64;
    for _ in 0..run.by_effort(5_000, 50_000, 200_000) {
        let Some((wo, wi)) = view.pair(&mut random) else { continue };
        // Importance on its way through: f(wo, wi) η_o² = f(wi, wo) η_i².
        let through = if wo.z * wi.z < 0.0 { view.probe.radiance_scale(wo) } else { 1.0 };
        let there = view.probe.eval(wo, wi).f_cos;
        let back = view.probe.eval(wi, wo).f_cos.map(|f| f * through);
        let moves =
            if view.claims.properties.symmetric { [0.0; 4] } else { sensitivity(view.reference, view.nudged, wo, wi) };
        for c in 0..3 {
            // Denormal f32 results carry few bits: nothing to compare below.
            let floor = if view.probe.single() { 1e-30 } else { 1e-280 };
            let (a, b) = (there[c] / wi.z.abs(), back[c] / wo.z.abs());
            if there[c].max(back[c]) < floor {
                continue;
            }
            let limit = if view.claims.properties.symmetric {
                16.0 * eps * a.max(b)
            } else {
                // Either way may be off by the units that its model allows.
                2.0 * f64::from(view.claims.properties.units) * (eps * a.max(b)).max(moves[c] / wi.z.abs())
            };
            residual = residual.max((a - b).abs() / a.max(b));
            finding.raise((a - b).abs() / limit, || {
                format!("{a:.9e} against {b:.9e}, channel {c}, wo {}, wi {}", show(wo), show(wi))
            });
        }
    }
    finding.note(format!("largest relative residual {residual:.2e}"));
    finding
}
