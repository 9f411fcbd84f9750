//! The range of each number of a lobe over which its formulas can be trusted, found by trying.
//!
//! One number moves over its whole domain and far beyond while the others stay. At each value pairs of directions of every
//! difficult kind go through the unguarded lobe. What comes back must be finite and not negative: the safe range is the
//! longest unbroken run of such values about the lobe's own, and it must cover the domain. Zero and what lies beyond may
//! fail: that is what the guard is for. In `f32` there is a second, narrower run: over it results are also as near to `f64` as
//! the precision instrument demands. It must cover the domain too, but for alphas below 10⁻⁴: there the rounding of directions
//! is coarser than the lobe.

use crate::directions::show;
use crate::finding::{Finding, Run};
use crate::precision;
use crate::probe::{Dir, Kind};
use crate::test_bsdf::{DynBsdf, Number};
use crate::under_test::{NARROWEST, UnderTest, View};
use gonio_kernel::model::{Quantity, Role};
use serde::Serialize;

/// Over which values of one number a surface was found safe, in one float type.
#[derive(Clone, Debug, Serialize)]
pub struct SafeRange {
    /// The number, as in a material file; that of a later lobe with its place in front.
    pub number: String,
    /// `f32` (eight lanes give the same bits) or `f64`.
    pub precision: &'static str,
    /// Its value in this lobe.
    pub value: f64,
    /// Its domain.
    pub domain: [f64; 2],
    /// The least and the largest value of the unbroken run of those that give finite, non-negative results; none if its own does not.
    pub safe: Option<[f64; 2]>,
    /// The same for results that are precise as well; none in `f64`, for lack of anything better to compare with.
    pub precise: Option<[f64; 2]>,
    /// What went wrong just below the narrower run, if anything was tried there.
    pub below: Option<String>,
    /// What went wrong just above.
    pub above: Option<String>,
    /// How many values were tried.
    pub tried: usize,
}

/// Values to try: the domain's ends and between, powers of ten far beyond, zero, and negative ones.
fn values(quantity: &Quantity, own: f32) -> Vec<f32> {
    let (lo, hi) = (quantity.lo, quantity.hi);
    let mut values = vec![lo as f32, hi as f32, own, 0.0, -1e-6, -1e-3, -0.1, -1.0];
    let steps = 12;
    match quantity.log_from {
        Some(from) => {
            values.extend((-40..=38).map(|decade| 10.0_f64.powi(decade) as f32));
            let (lo, hi) = (from.ln(), hi.ln());
            values.extend((0..=steps).map(|i| (lo + (hi - lo) * f64::from(i) / f64::from(steps)).exp() as f32));
        }
        None => {
            values.extend((0..=steps).map(|i| (lo + (hi - lo) * f64::from(i) / f64::from(steps)) as f32));
            values.extend([-8, -6, -4, -3, -2].map(|decade| 10.0_f64.powi(decade) as f32));
            values.extend([1.0 + 1e-6, 1.001, 1.1, 2.0, 10.0, 1e3, 1e6, 1e20, 1e38].map(|x| hi as f32 * x));
        }
    }
    // The last interior values may round across the end of the domain by an ulp; those are ends already.
    values.retain(|x| x.is_finite());
    values.sort_by(f32::total_cmp);
    values.dedup();
    values
}

/// What went wrong at one value.
#[derive(Default)]
struct Wrong {
    unsound: Option<String>,
    imprecise: Option<String>,
}

/// Indices of the first and the last of the good ones about `start`.
fn run_about(start: usize, count: usize, good: impl Fn(usize) -> bool) -> Option<(usize, usize)> {
    let (mut lo, mut hi) = (start, start);
    while lo > 0 && good(lo - 1) {
        lo -= 1;
    }
    while hi + 1 < count && good(hi + 1) {
        hi += 1;
    }
    good(start).then_some((lo, hi))
}

/// The safe range of number `index`, in `f32` or `f64`, and whether it covers the domain.
pub(crate) fn measure(bsdf: &dyn DynBsdf, index: usize, single: bool, run: &Run) -> (Finding, SafeRange) {
    let numbers = bsdf.numbers();
    let number = numbers[index];
    let (own, Quantity { lo, hi, .. }) = (number.value, number.parameter.quantity);
    let [lo, hi] = [lo, hi].map(|end| f64::from(end as f32));
    let values = values(&number.parameter.quantity, own);
    let wrongs: Vec<Wrong> = values.iter().map(|&x| wrong_at(bsdf, (&numbers, index), x, single, run)).collect();
    let start = values.iter().position(|&x| x == own).unwrap_or(0);
    let is_precise = |at: usize| wrongs[at].unsound.is_none() && wrongs[at].imprecise.is_none();
    let sound = run_about(start, values.len(), |at| wrongs[at].unsound.is_none());
    let precise = run_about(start, values.len(), is_precise);
    let ends = |run: Option<(usize, usize)>| run.map(|(lo, hi)| [lo, hi].map(|at| f64::from(values[at])));
    let why = |at: usize| {
        let wrong = wrongs.get(at)?;
        Some(format!("{:e}: {}", values[at], wrong.unsound.as_ref().or(wrong.imprecise.as_ref())?))
    };
    let (first, last) = precise.unwrap_or((start + 1, start.wrapping_sub(1)));
    let found = SafeRange {
        number: if number.lobe == 0 { number.name() } else { format!("lobe {}: {}", number.lobe + 1, number.name()) },
        precision: if single { "f32" } else { "f64" },
        value: f64::from(own),
        domain: [lo, hi],
        safe: ends(sound),
        precise: ends(precise).filter(|_| single),
        below: first.checked_sub(1).and_then(why),
        above: why(last.wrapping_add(1)),
        tried: values.len(),
    };
    let mut finding = Finding::at_most(0.0, "values of the number that are not safe inside its domain ≤");
    let has_shape = |x: f32| !number.is(Role::Alpha) || x >= NARROWEST;
    let is_bad = |at: &usize| {
        let x = values[*at];
        let inside = lo <= f64::from(x) && f64::from(x) <= hi;
        inside && (wrongs[*at].unsound.is_some() || (wrongs[*at].imprecise.is_some() && has_shape(x)))
    };
    let bad: Vec<usize> = (0..values.len()).filter(is_bad).collect();
    finding.raise(bad.len() as f64, || bad.first().and_then(|&at| why(at)).unwrap_or_default());
    finding.note(format!("{} values", values.len()));
    (finding, found)
}

/// What is wrong with the lobe whose number of that index is x.
fn wrong_at(bsdf: &dyn DynBsdf, (numbers, index): (&[Number], usize), x: f32, single: bool, run: &Run) -> Wrong {
    let mut values: Vec<f32> = numbers.iter().map(|number| number.value).collect();
    values[index] = x;
    let under_test = UnderTest::at("", bsdf, numbers, &values);
    let mut wrong = Wrong::default();
    let Some(view) = under_test.views().find(|view| view.probe.single() == single) else { return wrong };
    let mut random = run.random();
    for _ in 0..run.by_effort(150, 1_000, 10_000) {
        let Some((wo, wi)) = view.pair(&mut random) else { continue };
        let u = random.sampler_input(view.probe.single());
        wrong.unsound = unsound(view, wo, wi, u);
        if wrong.unsound.is_some() {
            break;
        }
        if single && wrong.imprecise.is_none() {
            wrong.imprecise = imprecise(view, wo, wi);
        }
    }
    wrong
}

fn unsound(view: View, wo: Dir, wi: Dir, u: [f64; 3]) -> Option<String> {
    let value = view.probe.eval(wo, wi);
    if !value.is_sound() {
        return Some(format!("{} at wo {}, wi {}", numbers(value.numbers()), show(wo), show(wi)));
    }
    let draw = view.probe.sample(wo, u);
    let length2 = draw.wi.length2();
    if !length2.is_finite() || (length2 - 1.0).abs() > 2e-3 {
        return Some(format!("samples {} for wo {}, u {u:?}", show(draw.wi), show(wo)));
    }
    match draw.kind {
        Kind::Delta(value, _) if !value.is_sound() => {
            Some(format!("a delta event of {} at wo {}", numbers(value.numbers()), show(wo)))
        }
        _ => None,
    }
}

fn imprecise(view: View, wo: Dir, wi: Dir) -> Option<String> {
    let limit = f64::from(view.claims.properties.units);
    let [rough, exact, errors] = precision::errors(view, wo, wi);
    let fine = errors.into_iter().all(|error| error <= limit);
    (!fine).then(|| format!("f32 gives {}, f64 {} at wo {}, wi {}", numbers(rough), numbers(exact), show(wo), show(wi)))
}

/// f_cos and pdf.
fn numbers([r, g, b, pdf]: [f64; 4]) -> String {
    format!("f_cos ({r:.3e}, {g:.3e}, {b:.3e}), pdf {pdf:.3e}")
}
