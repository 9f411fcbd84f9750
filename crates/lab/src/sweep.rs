//! The range of each number of a surface over which its formulas can be trusted, found by trying.
//!
//! One number moves over its whole domain and far beyond while the others stay. At each value pairs of directions of every
//! difficult kind go through the unguarded mixture: what comes back must be finite and not negative, and in `f32` as near
//! to `f64` as the precision instrument demands. The safe range is the longest unbroken run of good values about the
//! surface's own; it must cover the domain. Zero and what lies beyond the domain may fail: that is what the guard is for.

use crate::anatomy::{self, Dial};
use crate::directions::show;
use crate::finding::Finding;
use crate::finding::Run;
use crate::precision;
use crate::probe::{Dir, Kind};
use crate::subject::{Subject, View};
use crate::zoo::Parameter;
use gonio_kernel::Surface;
use serde::Serialize;

/// Over which values of one number a surface was found safe, in one float type.
#[derive(Clone, Debug, Serialize)]
pub struct SafeRange {
    /// The number, as in a material file; that of a later lobe with its place in front.
    pub number: String,
    /// `f32` (eight lanes give the same bits) or `f64`.
    pub precision: &'static str,
    /// Its value in this surface.
    pub value: f64,
    /// Its domain.
    pub domain: [f64; 2],
    /// The least and the largest value of the unbroken run of good ones.
    pub safe: [f64; 2],
    /// What went wrong just below, if anything was tried there.
    pub below: Option<String>,
    /// What went wrong just above.
    pub above: Option<String>,
    /// How many values were tried.
    pub tried: usize,
}

/// Values to try: the domain's ends and between, powers of ten far beyond, zero, and negative ones.
fn values(range: &Parameter, own: f32) -> Vec<f32> {
    let mut values = vec![range.lo, range.hi, own, 0.0, -1e-6, -1e-3, -0.1, -1.0];
    let steps = 12;
    match range.log_from {
        Some(from) => {
            values.extend((-40..=38).map(|decade| 10.0_f64.powi(decade) as f32));
            let (lo, hi) = (f64::from(from).ln(), f64::from(range.hi).ln());
            values.extend((0..=steps).map(|i| (lo + (hi - lo) * f64::from(i) / f64::from(steps)).exp() as f32));
        }
        None => {
            let (lo, hi) = (f64::from(range.lo), f64::from(range.hi));
            values.extend((0..=steps).map(|i| (lo + (hi - lo) * f64::from(i) / f64::from(steps)) as f32));
            values.extend([-8, -6, -4, -3, -2].map(|decade| 10.0_f64.powi(decade) as f32));
            values.extend([1.0 + 1e-6, 1.001, 1.1, 2.0, 10.0, 1e3, 1e6, 1e20, 1e38].map(|x| range.hi * x));
        }
    }
    // The last interior values may round across the end of the domain by an ulp; those are ends already.
    values.retain(|x| x.is_finite());
    values.sort_by(f32::total_cmp);
    values.dedup();
    values
}

/// The safe range of number `index`, in `f32` or `f64`, and whether it covers the domain.
pub(crate) fn measure(surface: &Surface<f32>, index: usize, single: bool, run: &Run) -> (Finding, SafeRange) {
    let (dial, own) = anatomy::dials(surface)[index];
    let Dial { lobe, name, range, .. } = dial;
    let values = values(&range, own);
    let verdicts: Vec<Option<String>> = values.iter().map(|&x| wrong_at(surface, index, x, single, run)).collect();
    let good = |at: usize| verdicts[at].is_none();
    // Around its own value; a surface that is not safe where it is has no safe range.
    let start = values.iter().position(|&x| x == own).unwrap_or(0);
    let (mut lo, mut hi) = (start, start);
    while good(start) && lo > 0 && good(lo - 1) {
        lo -= 1;
    }
    while good(start) && hi + 1 < values.len() && good(hi + 1) {
        hi += 1;
    }
    let number = if lobe == 0 { name.to_owned() } else { format!("lobe {}: {name}", lobe + 1) };
    let wide = |x: f32| f64::from(x);
    let why = |at: Option<usize>| at.and_then(|at| verdicts[at].as_ref().map(|why| format!("{:e}: {why}", values[at])));
    let found = SafeRange {
        number,
        precision: if single { "f32" } else { "f64" },
        value: wide(own),
        domain: [wide(range.lo), wide(range.hi)],
        safe: if good(start) { [wide(values[lo]), wide(values[hi])] } else { [f64::MAX, -f64::MAX] },
        below: why(if good(start) { lo.checked_sub(1) } else { Some(start) }),
        above: why(if good(start) { (hi + 1 < values.len()).then_some(hi + 1) } else { Some(start) }),
        tried: values.len(),
    };
    let mut finding = Finding::at_most(0.0, "unsafe values of the number inside its domain ≤");
    let inside = |x: f32| range.lo <= x && x <= range.hi;
    let bad: Vec<usize> = (0..values.len()).filter(|&at| inside(values[at]) && !good(at)).collect();
    finding.raise(bad.len() as f64, || why(bad.first().copied()).unwrap_or_default());
    let [from, to] = found.safe;
    finding.note(format!("safe over [{from:e}, {to:e}], domain [{:e}, {:e}]", range.lo, range.hi));
    (finding, found)
}

/// What is wrong with the surface whose number `index` is x.
fn wrong_at(surface: &Surface<f32>, index: usize, x: f32, single: bool, run: &Run) -> Option<String> {
    let moved: Surface<f32> = anatomy::with_number(surface, index, x);
    let subject = Subject::of_surface_at_any_width("", &moved);
    let view = subject.views().find(|view| view.probe.single() == single)?;
    let mut random = run.random();
    for _ in 0..run.by_effort(150, 1_000, 10_000) {
        let Some((wo, wi)) = view.pair(&mut random) else { continue };
        let u = random.sampler_input(view.probe.single());
        if let Some(wrong) = judge(view, wo, wi, u) {
            return Some(wrong);
        }
    }
    None
}

fn judge(view: View, wo: Dir, wi: Dir, u: [f64; 3]) -> Option<String> {
    let value = view.probe.eval(wo, wi);
    if !value.is_sound() {
        return Some(format!("{:?} at wo {}, wi {}", value.numbers(), show(wo), show(wi)));
    }
    let draw = view.probe.sample(wo, u);
    let length2 = draw.wi.length2();
    if !length2.is_finite() || (length2 - 1.0).abs() > 2e-3 {
        return Some(format!("samples {} for wo {}, u {u:?}", show(draw.wi), show(wo)));
    }
    match draw.kind {
        Kind::Discrete(worth, _) if !worth.is_sound() => {
            return Some(format!("a discrete event of {:?} at wo {}", worth.numbers(), show(wo)));
        }
        _ => {}
    }
    if view.probe.single() && !view.reference.single() {
        let errors = precision::errors(view, wo, wi);
        let worst = errors.into_iter().fold(0.0, f64::max);
        if worst > precision::LIMIT || errors.iter().any(|e| e.is_nan()) {
            let rough = value.numbers();
            let exact = view.reference.eval(wo, wi).numbers();
            return Some(format!("f32 gives {rough:?}, f64 {exact:?} at wo {}, wi {}", show(wo), show(wi)));
        }
    }
    None
}
