//! Precision: the `f32` result against the `f64` result of exactly the same numbers.
//!
//! **Limit.** The error must not exceed 8 · max(eps · f, s), or as many times as the model admits (`Properties::units`), where
//! s is the largest change of f when one component of one direction, or one parameter, moves by one unit in the last place
//! of `f32`, by differences in `f64`. A formula that subtracts what it should not is wrong by hundreds.

use crate::directions::show;
use crate::finding::{Finding, Run};
use crate::probe::{Dir, Probe, demote};
use crate::under_test::View;
use gonio_kernel::Vec3;

/// The four numbers in `f32` and in `f64`, and the errors in units of max(eps f, s).
pub(crate) fn errors(single: View, wo: Dir, wi: Dir) -> [[f64; 4]; 3] {
    let (rough, exact) = (single.probe.eval(wo, wi).numbers(), single.reference.eval(wo, wi).numbers());
    let moves = sensitivity(single.reference, single.nudged, wo, wi);
    // Towards the end of f32's range rounding is absolute: exponentials have been flushed, and Schlick's fifth power is 1e-36
    // where a cosine rounds to 1 on one side alone.
    let unit = |i: usize| (f64::from(f32::EPSILON) * exact[i]).max(moves[i]).max(1e-30);
    [rough, exact, std::array::from_fn(|i| (rough[i] - exact[i]).abs() / unit(i))]
}

/// The largest error in units of max(eps f, s).
pub(crate) fn measure(single: View, run: &Run) -> Finding {
    let mut random = run.random();
    let limit = f64::from(single.claims.properties.units);
    let mut finding = Finding::at_most(limit, "max |f32 − f64| / max(eps·f, largest change by one ulp of an input) ≤");
    let mut relative = 0.0_f64;
    for _ in 0..run.by_effort(3_000, 30_000, 100_000) {
        let Some((wo, wi)) = single.pair(&mut random) else { continue };
        let [rough, exact, errors] = errors(single, wo, wi);
        for (i, error) in errors.into_iter().enumerate() {
            if exact[i] > 1e-6 {
                relative = relative.max((rough[i] - exact[i]).abs() / exact[i]);
            }
            finding.raise(error, || {
                let what = ["f_cos red", "f_cos green", "f_cos blue", "pdf"][i];
                format!("{what}: {:.9e} instead of {:.9e}, wo {}, wi {}", rough[i], exact[i], show(wo), show(wi))
            });
        }
    }
    finding.note(format!("largest relative error where f > 1e-6: {relative:.2e}"));
    finding
}

/// The largest change of each of the four numbers when one component of wo or wi, or one parameter (as in `nudged`), moves by
/// one ulp of `f32`, either way.
pub(crate) fn sensitivity<'a>(probe: &dyn Probe, nudged: &[Box<dyn Probe + 'a>], wo: Dir, wi: Dir) -> [f64; 4] {
    let moved = nudged.iter().map(|probe| probe.eval(wo, wi).numbers());
    largest_change(|wo, wi| probe.eval(wo, wi).numbers(), moved, wo, wi)
}

/// The largest change of each number of `eval` when one component of wo or wi moves by one ulp of `f32`, either way, and of
/// those in `others` from those here.
pub(crate) fn largest_change<const N: usize>(
    eval: impl Fn(Dir, Dir) -> [f64; N],
    others: impl Iterator<Item = [f64; N]>,
    wo: Dir,
    wi: Dir,
) -> [f64; N] {
    let here = eval(wo, wi);
    let mut largest = [0.0_f64; N];
    let mut compare = |there: [f64; N]| {
        for (largest, (a, b)) in largest.iter_mut().zip(here.iter().zip(there)) {
            *largest = largest.max((a - b).abs());
        }
    };
    others.for_each(&mut compare);
    for axis in 0..3 {
        for up in [false, true] {
            compare(eval(moved(wo, axis, up), wi));
            compare(eval(wo, moved(wi, axis, up)));
        }
    }
    largest
}

/// w with one component moved to the next `f32`. The cosine keeps its sign.
fn moved(w: Dir, axis: usize, up: bool) -> Dir {
    let mut c: [f32; 3] = demote(w).into();
    let next = if up { c[axis].next_up() } else { c[axis].next_down() };
    if axis < 2 || next * c[2] > 0.0 {
        c[axis] = next;
    }
    Vec3::from(c.map(f64::from))
}
