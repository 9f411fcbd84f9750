//! Sample and eval tell one story.
//!
//! [`measure`]: a continuous sample is a unit direction on the side it claims, with a positive density and a finite value;
//! a failed one still carries a finite unit direction; the same numbers give the same sample.
//!
//! [`measure_jacobian`]: where the sampler maps (u₁, u₂) to directions one to one, the density is the inverse of the
//! stretching: pdf · |∂ω/∂u₁ × ∂ω/∂u₂| = 1 at every point, with no statistics at all. Derivatives are five-point
//! differences in `f64`. This finds a forgotten Jacobian, a missing π or a 1 % error wherever they hide.

use crate::directions::{any_above, show};
use crate::finding::{Finding, Run};
use crate::probe::{Dir, Kind};
use crate::random::Random;
use crate::under_test::View;

/// Broken laws of samples, and how far from unit length they are.
pub(crate) fn measure(view: View, run: &Run) -> Finding {
    let mut random = run.random();
    // wo is unit to 2 eps in |w|². Mirrored by 2m(wo·m)/|m|² − wo its length changes by the error of the factor: at most 7
    // roundings of half an eps, doubled by the square and by the 2, so 14 eps.
    let mut finding = Finding::at_most(16.0 * view.probe.epsilon(), "max | |wi|² − 1 | ≤");
    for _ in 0..run.by_effort(10_000, 100_000, 300_000) {
        let wo = view.any_wo(&mut random);
        let u = extreme_input(&mut random, view.probe.single());
        let draw = view.probe.sample(wo, u);
        let wi = draw.wi;
        let here = || format!("wo {}, u {u:?}, wi {}", show(wo), show(wi));
        finding.raise((wi.length2() - 1.0).abs(), here);
        if view.probe.sample(wo, u).wi != wi {
            finding.broken(|| format!("the same numbers give another sample: {}", here()));
        }
        if draw.kind == Kind::Failed {
            continue;
        }
        if draw.transmitted != (wi.z * wo.z < 0.0) || wi.z == 0.0 {
            finding.broken(|| format!("on the wrong side of the surface: {}", here()));
        }
        match draw.kind {
            Kind::Continuous => {
                let value = view.probe.eval(wo, wi);
                if !value.is_sound() || value.pdf <= 0.0 {
                    finding.broken(|| format!("sampled, but its value is {value:?}: {}", here()));
                }
            }
            Kind::Delta(value, _) => {
                if !value.is_sound() || value.pdf <= 0.0 || value.pdf > 1.0 + 4.0 * view.probe.epsilon() {
                    finding.broken(|| format!("delta event, but its value is {value:?}: {}", here()));
                }
            }
            Kind::Failed => {}
        }
    }
    finding
}

/// Uniform numbers, sometimes at the ends of their range.
fn extreme_input(random: &mut Random, single: bool) -> [f64; 3] {
    let last = if single { 1.0 - 2.0_f64.powi(-24) } else { 1.0 - 2.0_f64.powi(-53) };
    random.sampler_input(single).map(|u| match random.bits() % 32 {
        0 => 0.0,
        1 => last,
        2 => random.pick(&[0.25, 0.5, 0.75]),
        _ => u,
    })
}

/// |pdf · stretching − 1|.
pub(crate) fn measure_jacobian(view: View, run: &Run) -> Finding {
    if view.probe.single() || !view.claims.properties.one_to_one {
        return Finding::not_run("needs an f64 form whose sampler is one to one");
    }
    let mut random = run.random();
    // Truncation of the five-point rule at steps of 1e-4 is about 1e-11 where the warp is smooth on that scale: a million times
    // that leaves room for where it is not, and is a thousandth of the fault to be found. What the rounding of the differences
    // explains, two units of 1 in steps of 1e-4 on either side of the parallelogram, is taken off first.
    let mut finding = Finding::at_most(1e-5, "max |pdf · |∂ω/∂u| − 1| beyond rounding ≤");
    for _ in 0..run.by_effort(2_000, 20_000, 200_000) {
        let wo = any_above(&mut random);
        // Away from the ends of the range, where the warp's derivative is unbounded.
        let u: [f64; 3] = std::array::from_fn(|_| random.between(0.02, 0.98));
        let center = view.probe.sample(wo, u);
        if center.kind != Kind::Continuous || wo.z < 1e-3 {
            continue;
        }
        const STEP: f64 = 1e-4;
        let along = |axis: usize| -> Option<Dir> {
            let at = |steps: f64| {
                let mut moved = u;
                moved[axis] += steps * STEP;
                let draw = view.probe.sample(wo, moved);
                (draw.kind == Kind::Continuous).then_some(draw.wi)
            };
            let slope = (at(1.0)? - at(-1.0)?) * (8.0 / 12.0) - (at(2.0)? - at(-2.0)?) * (1.0 / 12.0);
            Some(slope * (1.0 / STEP))
        };
        let (Some(a), Some(b)) = (along(1), along(2)) else { continue };
        let pdf = view.probe.eval(wo, center.wi).pdf;
        let area = a.cross(b).length();
        let rounding = 2.0 * f64::EPSILON / STEP * (a.length() + b.length()) / area;
        finding.raise(((pdf * area - 1.0).abs() - rounding).max(0.0), || {
            format!("pdf {pdf:.6e}, stretching {area:.6e}, wo {}, u {u:?}", show(wo))
        });
    }
    finding
}
