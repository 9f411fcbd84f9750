//! Elementary functions against `f64` of the standard library (of statrs for erf and its inverse).
//!
//! **Limit of sine and cosine of turns.** As the kernel promises: 2 ulp, or 2⁻²⁴ absolute (2⁻⁵³ in `f64`) near a zero. The
//! `f64` form is compared with `f64` of std, whose own error and reduction (an exact difference to the nearest quarter)
//! add one more ulp: 3.
//!
//! **Limit of the others.** The bound that the kernel states, at every bit pattern of `f32` (a full run), eight at a time;
//! shorter runs visit every eleventh. Where the function has no value the result is NaN,
//! where it exceeds `f32` infinite, and where [`Function::flushes`] less than the least normal number exactly 0.

use crate::finding::{Finding, Run};
use gonio_kernel::{F32x8, math};

/// Sine and cosine of a number of turns.
pub(crate) type SinCos = fn(f64) -> (f64, f64);

/// The kernel in `f32`; u must be an `f32`.
pub(crate) fn single(u: f64) -> (f64, f64) {
    let (sin, cos) = math::sin_cos_turns(u as f32);
    (f64::from(sin), f64::from(cos))
}

/// The kernel in `f64`.
pub(crate) fn double(u: f64) -> (f64, f64) {
    math::sin_cos_turns(u)
}

/// The worst error in ulp.
pub(crate) fn measure(f: SinCos, is_single: bool, run: &Run) -> Finding {
    let mut random = run.random();
    let (eps, limit) = if is_single { (f64::from(f32::EPSILON), 2.0) } else { (f64::EPSILON, 3.0) };
    let mut finding = Finding::at_most(limit, "max error in ulp, absolute below half ≤");
    for _ in 0..run.by_effort(200_000, 2_000_000, 20_000_000) {
        let u = match random.bits() % 4 {
            0 => random.between(-1.0, 1.0),
            1 => random.between(-1000.0, 1000.0),
            2 => random.pick(&[0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0]) + random.log_between(1e-9, 1e-2),
            _ => random.uniform(),
        };
        let u = if is_single { f64::from(u as f32) } else { u };
        // Reduce by whole turns and quarters, exactly, so that std sees |x| ≤ π/4.
        let quarters = (4.0 * u).round();
        let x = (u - 0.25 * quarters) * std::f64::consts::TAU;
        let (s, c) = x.sin_cos();
        let right = match (quarters as i64).rem_euclid(4) {
            0 => (s, c),
            1 => (c, -s),
            2 => (-s, -c),
            _ => (-c, s),
        };
        let got = f(u);
        for (got, right) in [(got.0, right.0), (got.1, right.1)] {
            // One unit in the last place of `right`; never less than what makes 2 of them half an eps.
            let ulp = (eps * binade(right)).max(0.25 * eps);
            finding.raise((got - right).abs() / ulp, || format!("{got} instead of {right} at {u} turns"));
        }
    }
    finding
}

/// An elementary function of one number.
#[derive(Clone, Copy)]
pub(crate) struct Function {
    /// Its name.
    pub(crate) name: &'static str,
    /// The kernel's.
    pub(crate) lanes: fn(F32x8) -> F32x8,
    /// What it should be.
    pub(crate) exact: fn(f64) -> f64,
    /// The kernel's bound \[ulp\].
    pub(crate) bound: f64,
    /// Whether results below the least normal number are 0.
    pub(crate) flushes: bool,
    /// Arguments beyond this in size are not promised anything.
    pub(crate) within: f64,
}

/// What most of them have in common.
const ORDINARY: Function =
    Function { name: "", lanes: |x| x, exact: |x| x, bound: 0.0, flushes: false, within: f64::INFINITY };

/// All functions of one number.
pub(crate) const FUNCTIONS: [Function; 6] = [
    Function { name: "exp", lanes: math::exp, exact: f64::exp, bound: 2.0, flushes: true, ..ORDINARY },
    Function { name: "exp_m1", lanes: math::exp_m1, exact: f64::exp_m1, bound: 2.0, ..ORDINARY },
    Function { name: "ln", lanes: math::ln, exact: f64::ln, bound: 2.0, ..ORDINARY },
    Function { name: "ln_1p", lanes: math::ln_1p, exact: f64::ln_1p, bound: 2.0, ..ORDINARY },
    Function { name: "erf", lanes: math::erf, exact: statrs::function::erf::erf, bound: 2.0, ..ORDINARY },
    Function {
        name: "erf_inv",
        lanes: math::erf_inv,
        exact: statrs::function::erf::erf_inv,
        bound: 6.0,
        within: 1.0 - 0.5 * f32::EPSILON as f64,
        ..ORDINARY
    },
];

/// Every bit pattern in a full run, every eleventh in others.
pub(crate) fn stride(run: &Run) -> usize {
    run.by_effort(11, 11, 1)
}

/// The worst error in ulp over every `stride`th bit pattern of `f32`; odd, so that low bits vary too.
pub(crate) fn measure_function(function: &Function, stride: usize) -> Finding {
    let mut finding = Finding::at_most(function.bound, "max error in ulp ≤");
    let stride = stride as u64;
    let patterns = (1_u64 << 32).div_ceil(stride);
    let pattern = |i: u64| f32::from_bits((i * stride) as u32);
    for first in (0..patterns).step_by(8) {
        let x = std::array::from_fn(|l| pattern(first + l as u64));
        let y = (function.lanes)(F32x8::new(x)).to_array();
        for (x, y) in x.into_iter().zip(y) {
            if !x.is_nan() && f64::from(x).abs() > function.within {
                continue;
            }
            let exact = if x.is_nan() { f64::NAN } else { (function.exact)(x.into()) };
            let error = error_in_ulps(y, exact, function.bound, function.flushes);
            finding.raise(error, || format!("{y:e} instead of {exact:e} at {x:e}"));
        }
    }
    finding.note(format!("{patterns} of 2³² arguments"));
    finding
}

/// The kernel's bound of xʸ \[ulp\].
const POW: f64 = 8.0;

/// xʸ over positive x of any exponent, with exponents that use the whole range of results.
pub(crate) fn measure_pow(pow: fn(f32, f32) -> f32, run: &Run) -> Finding {
    let mut random = run.random();
    let mut finding = Finding::at_most(POW, "max error in ulp ≤");
    for _ in 0..run.by_effort(500_000, 5_000_000, 100_000_000) {
        let x = match random.bits() % 2 {
            0 => f32::from_bits((random.bits() % u64::from(f32::INFINITY.to_bits())) as u32),
            _ => random.between(0.25, 4.0) as f32,
        };
        let y = (random.between(-90.0, 90.0) / f64::from(x).ln()) as f32;
        if x > 0.0 && y.is_finite() {
            let exact = f64::from(x).powf(y.into());
            finding.raise(error_in_ulps(pow(x, y), exact, POW, true), || {
                format!("{} for {exact:e}: {x:e}^{y:e}", pow(x, y))
            });
        }
    }
    finding
}

/// |got − exact| in units of the last place of `exact` as an `f32`; infinite where a limit is not met.
fn error_in_ulps(got: f32, exact: f64, bound: f64, flushes: bool) -> f64 {
    let least = f64::from(f32::MIN_POSITIVE);
    let broken = |ok: bool| if ok { 0.0 } else { f64::INFINITY };
    if exact.is_nan() {
        return broken(got.is_nan());
    }
    // Where the exact result lies within the bound of an end, either side will do.
    let near = 1.0 + bound * f64::from(f32::EPSILON);
    if got.is_infinite() {
        return broken(got.is_sign_positive() == (exact > 0.0) && exact.abs() * near > f64::from(f32::MAX));
    }
    if flushes && (got == 0.0 || got.is_subnormal()) {
        return broken(got == 0.0 && exact < least * near);
    }
    (f64::from(got) - exact).abs() / ulp(exact)
}

/// The distance of neighbouring `f32` at x, that of denormal ones below the normal.
fn ulp(x: f64) -> f64 {
    f64::from(f32::EPSILON) * binade(x).max(f64::from(f32::MIN_POSITIVE))
}

/// 2^⌊log₂|x|⌋: x with an empty fraction.
fn binade(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & f64::INFINITY.to_bits())
}
