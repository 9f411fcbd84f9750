//! Statistics: p-values, the significance that all tests of a run share, and the number of samples a test needs.
//!
//! **Family.** With n tests of one run, each at level 1 − (1 − 0.01)^(1/n) (Šidák), a correct kernel fails a run by
//! chance with probability at most 0.01, whatever n is and however the tests depend on each other in the positive sense.
//!
//! **Power.** A density that is off by ε over a part ρ of its mass, and normalised again, moves the cell probabilities p
//! by Δp with Σ Δp²/p = ρε²/(1 − ρ): the part itself gives ρε², the rest is shifted by −ερ/(1 − ρ) and gives (ερ)²/(1 − ρ).
//! N samples then make Pearson's statistic a non-central χ² of non-centrality λ = N η ρε²/(1 − ρ). η < 1 is lost to cells
//! that the part covers only partly. The cells are a grid of 16 slabs by 8; a part of mass ρ = 0.05 is √0.05 wide in either
//! direction, 3.58 slabs by 1.79 cells. At the worst offset a width of 3.58 covers ¾-cells at its rim, (2·0.79² + 2)/3.58 =
//! 0.89 along slabs at most and 3.17/3.58 = 0.885 at least; a width of 1.79 leaves (1 + 2·0.395²)/1.79 = 0.73.
//! η = 0.885·0.73 = 0.65. N follows from λ, and λ from the power by bisection.

use statrs::function::{
    erf::erfc,
    gamma::{gamma_lr, gamma_ur},
};

/// What a correct kernel may fail by chance, per run.
pub(crate) const FAMILY_SIGNIFICANCE: f64 = 0.01;

/// The power at which the stated fault is found.
pub(crate) const POWER: f64 = 0.99;

/// The part of the mass that the stated fault covers, and its relative size.
pub(crate) const FAULT_MASS: f64 = 0.05;
/// See [`FAULT_MASS`].
pub(crate) const FAULT_SIZE: f64 = 0.01;

/// What is left of the non-centrality when cells do not line up with the fault: see the head of this file.
const ALIGNMENT: f64 = 0.65;

/// The level of each of n tests that together fail by chance with probability `significance` at most (Šidák).
pub fn sidak(significance: f64, tests: usize) -> f64 {
    // 1 − (1 − s)^(1/n) without cancellation.
    -((-significance).ln_1p() / tests.max(1) as f64).exp_m1()
}

/// P(χ²_df ≥ statistic).
pub(crate) fn chi2_p(statistic: f64, df: f64) -> f64 {
    if statistic <= 0.0 { 1.0 } else { gamma_ur(0.5 * df, 0.5 * statistic) }
}

/// Two-sided p-value of a standard normal deviate.
pub(crate) fn normal_p(z: f64) -> f64 {
    erfc(z.abs() * std::f64::consts::FRAC_1_SQRT_2)
}

/// Two-sided p-value of `count` events where between `low` and `high` are expected (the expectation's own uncertainty).
/// Poisson: for a binomial it errs to the side of caution.
pub(crate) fn poisson_p(count: u64, low: f64, high: f64) -> f64 {
    let k = count as f64;
    let (low, high) = (low.max(0.0), high.max(0.0));
    let tail = if k > high {
        // P(X ≥ k) = P(k, mean), the regularised lower gamma function.
        if high == 0.0 { 0.0 } else { gamma_lr(k, high) }
    } else if k < low {
        gamma_ur(k + 1.0, low)
    } else {
        return 1.0;
    };
    (2.0 * tail).min(1.0)
}

/// p-value of a mean: `distance` is how far it lies from the truth beyond all that is not chance, `error` its standard error.
pub(crate) fn mean_p(distance: f64, error: f64) -> f64 {
    if !distance.is_finite() {
        0.0
    } else if distance <= 0.0 {
        1.0
    } else {
        normal_p(distance / error)
    }
}

/// Bound on the two-sided p-value of a mean of n numbers, none farther than `reach` from their expectation, of the given
/// true variance (Bennett 1962). It holds without a central limit: weights that are 1 but for one in a million are common
/// here, and their sample variance is worthless. In the Gaussian range it costs a factor of a few in p.
pub(crate) fn bennett_p(distance: f64, n: f64, variance: f64, reach: f64) -> f64 {
    if !(distance.is_finite() && variance.is_finite()) {
        return 0.0;
    }
    if distance <= 0.0 {
        return 1.0;
    }
    if variance <= 0.0 || reach <= 0.0 {
        return 0.0;
    }
    let u = reach * distance / variance;
    let h = (1.0 + u) * u.ln_1p() - u;
    (2.0 * (-n * variance / (reach * reach) * h).exp()).min(1.0)
}

/// P(non-central χ²_df(λ) ≥ critical): a Poisson mixture of central ones.
fn noncentral_tail(critical: f64, df: f64, lambda: f64) -> f64 {
    let half = 0.5 * lambda;
    let last = (half + 12.0 * half.sqrt() + 30.0) as usize;
    let mut log_weight = -half;
    let mut sum = 0.0;
    for j in 0..last {
        sum += log_weight.exp() * chi2_p(critical, df + 2.0 * j as f64);
        log_weight += half.ln() - ((j + 1) as f64).ln();
    }
    sum
}

/// The statistic that a χ² with df degrees of freedom exceeds with probability `level`.
fn chi2_critical(level: f64, df: f64) -> f64 {
    bisect(df, df + 20.0 * (2.0 * df).sqrt() + 400.0, |x| chi2_p(x, df) < level)
}

/// The non-centrality that a χ² test of this level needs for this power.
pub(crate) fn noncentrality(level: f64, df: f64, power: f64) -> f64 {
    let critical = chi2_critical(level, df);
    bisect(1e-3, 10.0 * critical + 1000.0, |lambda| noncentral_tail(critical, df, lambda) > power)
}

/// How many samples find a fault of relative size `size` over [`FAULT_MASS`] of the mass with this power.
pub(crate) fn samples_for(size: f64, level: f64, df: f64, power: f64) -> u64 {
    (noncentrality(level, df, power) / noncentrality_per_sample(size)).ceil() as u64
}

/// The relative size of the fault over [`FAULT_MASS`] that `samples` find with probability [`POWER`].
pub(crate) fn size_found(samples: u64, level: f64, df: f64) -> f64 {
    (noncentrality(level, df, POWER) / (samples as f64 * noncentrality_per_sample(1.0))).sqrt()
}

fn noncentrality_per_sample(size: f64) -> f64 {
    ALIGNMENT * FAULT_MASS * size * size / (1.0 - FAULT_MASS)
}

/// The least x in [lo, hi] for which `above` holds, to 1 in 10⁶.
fn bisect(mut lo: f64, mut hi: f64, above: impl Fn(f64) -> bool) -> f64 {
    while hi - lo > 1e-6 * hi {
        let mid = 0.5 * (lo + hi);
        if above(mid) { hi = mid } else { lo = mid }
    }
    hi
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn critical_values_match_the_printed_tables() {
        // Abramowitz & Stegun, table 26.8: χ²(0.01; 10) = 23.2093; table 26.1: P(|Z| > 1.959964) = 0.05.
        assert!((chi2_critical(0.01, 10.0) - 23.2093).abs() < 1e-3);
        assert!((normal_p(1.959_964) - 0.05).abs() < 1e-6);
    }

    #[test]
    fn power_matches_the_printed_noncentralities() {
        // Cohen 1988, tables 12.3: df = 1, α = 0.05, power 0.90 needs λ = 10.51; df = 10, power 0.99 at 0.01 needs 41.6.
        assert!((noncentrality(0.05, 1.0, 0.90) - 10.51).abs() < 0.02);
        assert!((noncentrality(0.05, 1.0, 0.99) - 18.37).abs() < 0.02);
    }

    #[test]
    fn poisson_tails_are_exact() {
        // P(X ≥ 3 | 1) = 1 − 2.5/e.
        assert!((poisson_p(3, 1.0, 1.0) - 2.0 * (1.0 - 2.5 / std::f64::consts::E)).abs() < 1e-12);
        assert_eq!(poisson_p(1, 0.0, 0.0), 0.0);
        assert_eq!(poisson_p(0, 0.0, 0.0), 1.0);
    }

    #[test]
    fn sidak_shares_the_significance() {
        assert!((1.0 - (1.0 - sidak(0.01, 300)).powi(300) - 0.01).abs() < 1e-12);
    }
}
