//! Elementary functions: the kernel's sine and cosine of turns against `f64` of the standard library.
//!
//! **Limit.** As the kernel promises: 2 ulp, or 2⁻²⁴ absolute (2⁻⁵³ in `f64`) near a zero. The `f64` form is compared with
//! `f64` of std, whose own error and reduction (an exact difference to the nearest quarter) add one more ulp: 3.

use crate::finding::{Finding, Run};

/// Sine and cosine of a number of turns.
pub(crate) type SinCos = fn(f64) -> (f64, f64);

/// The kernel in `f32`; u must be an `f32`.
pub(crate) fn single(u: f64) -> (f64, f64) {
    let (sin, cos) = gonio_kernel::math::sin_cos_turns(u as f32);
    (f64::from(sin), f64::from(cos))
}

/// The kernel in `f64`.
pub(crate) fn double(u: f64) -> (f64, f64) {
    gonio_kernel::math::sin_cos_turns(u)
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
            let ulp = (eps * f64::abs(right).log2().floor().exp2()).max(0.25 * eps);
            finding.raise((got - right).abs() / ulp, || format!("{got} instead of {right} at {u} turns"));
        }
    }
    finding
}
