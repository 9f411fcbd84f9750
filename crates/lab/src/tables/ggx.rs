//! What white GGX loses, by quadrature: 1 − E(μ, α), without forming E.
//!
//! With the facet's slope r in the direction φ from wo's azimuth, m ∝ (r cosφ, r sinφ, 1), visible slopes are distributed as
//! G₁(wo) (μ + r sinθ cosφ)₊/μ · α²/(π(α² + r²)²). A facet with r < r₁(φ) sends light up, and of that 1 − G₂/G₁ is lost;
//! beyond r₁ all is lost. wi_z = μ(r₁ − r)(r + 1/r₁)/(1 + r²) is a product, so nothing cancels anywhere. r₁ solves
//! μr² − 2 sinθ cosφ r − μ = 0. Both integrals are done by the double exponential rule of Takahasi & Mori 1974, which
//! follows their end points over many decades. Relative error about 1e-6.

use std::sync::OnceLock;

/// 1 − E for μ in (0, 1], α in [1e-9, 1].
pub(crate) fn missing(mu: f64, alpha: f64) -> f64 {
    static RULES: OnceLock<[Vec<Node>; 2]> = OnceLock::new();
    let [slopes, azimuths] = RULES.get_or_init(|| [double_exponential(48), double_exponential(48)]);
    let a2 = alpha * alpha;
    let sin = ((1.0 - mu) * (1.0 + mu)).sqrt();
    let s_o = (mu * mu + a2 * sin * sin).sqrt();
    let mut sum = 0.0;
    for Node { x: tau, weight, .. } in azimuths {
        // τ = tan(ψ/2) with φ = π/2 ∓ ψ: the facets that lean to wo, and those that lean away.
        let stretch = 1.0 + tau * tau;
        let lean = sin * 2.0 * tau / stretch;
        let weight = weight * 2.0 / stretch;
        let root = (lean * lean + mu * mu).sqrt();
        sum += weight * of_azimuth(mu, a2, s_o, lean, (lean + root) / mu, slopes);
        sum += weight * of_azimuth(mu, a2, s_o, -lean, mu / (lean + root), slopes);
    }
    // φ and −φ alike; G₁/μ = 2/(μ + s).
    2.0 * 2.0 / (mu + s_o) * sum
}

/// Visits the facets that send light up: the cosine at which they meet it, and the part of the light that they see and reflect
/// if white (µ in (0, 1], α in [1e-9, 1]); the parts add up to E.
pub(crate) fn facets(mu: f64, alpha: f64, mut visit: impl FnMut(f64, f64)) {
    static RULE: OnceLock<Vec<Node>> = OnceLock::new();
    let rule = RULE.get_or_init(|| double_exponential(24));
    let a2 = alpha * alpha;
    let sin = ((1.0 - mu) * (1.0 + mu)).sqrt();
    let s_o = (mu * mu + a2 * sin * sin).sqrt();
    for Node { x: tau, weight, .. } in rule {
        // As in `missing`.
        let stretch = 1.0 + tau * tau;
        let lean = sin * 2.0 * tau / stretch;
        let root = (lean * lean + mu * mu).sqrt();
        let of_azimuth = weight * 2.0 / stretch * 4.0 / (mu + s_o) / std::f64::consts::TAU;
        for (lean, r1) in [(lean, (lean + root) / mu), (-lean, mu / (lean + root))] {
            let end = a2 + r1 * r1;
            let p1 = r1 * r1 / end;
            for Node { x, rest, weight } in rule {
                let p_left = p1 * rest;
                let one_minus_p = a2 / end + p_left;
                let r = (a2 * p1 * x / one_minus_p).sqrt();
                let r_left = p_left * end / one_minus_p / (r1 + r);
                let cos_i = mu * r_left * (r + 1.0 / r1) / (1.0 + r * r);
                let lost = a2 * ((1.0 - cos_i) * (1.0 + cos_i)).max(0.0);
                let s_i = (cos_i * cos_i + lost).sqrt();
                let shadowed = mu * lost / ((s_i + cos_i) * (cos_i * s_o + mu * s_i));
                let visible = (lean * r + mu).max(0.0);
                visit((visible / (1.0 + r * r).sqrt()).min(1.0), of_azimuth * weight * p1 * visible * (1.0 - shadowed));
            }
        }
    }
}

/// The integral over slopes at one azimuth; lean = sinθ cosφ.
fn of_azimuth(mu: f64, a2: f64, s_o: f64, lean: f64, r1: f64, rule: &[Node]) -> f64 {
    let end = a2 + r1 * r1;
    // p = r²/(α² + r²) from 0 to p₁, so that dp/2π = α² r dr/(π(α² + r²)²).
    let p1 = r1 * r1 / end;
    // Beyond r₁ in q = 1/r, down to 0 or to where the facet turns its back.
    let (q1, q0) = (1.0 / r1, (-lean / mu).max(0.0));
    let mut sum = 0.0;
    for Node { x, rest, weight } in rule {
        let p_left = p1 * rest;
        let one_minus_p = a2 / end + p_left;
        let r = (a2 * p1 * x / one_minus_p).sqrt();
        let r_left = p_left * end / one_minus_p / (r1 + r);
        let cos_i = mu * r_left * (r + 1.0 / r1) / (1.0 + r * r);
        let lost = a2 * ((1.0 - cos_i) * (1.0 + cos_i)).max(0.0); // s_i² − cos_i²
        let s_i = (cos_i * cos_i + lost).sqrt();
        let one_minus_g = mu * lost / ((s_i + cos_i) * (cos_i * s_o + mu * s_i));
        sum += weight * p1 / std::f64::consts::TAU * (lean * r + mu).max(0.0) * one_minus_g;
        let q = q0 + (q1 - q0) * x;
        let visible = if lean < 0.0 { mu * (q1 - q0) * x } else { mu * q + lean };
        let tail = 1.0 + a2 * q * q;
        sum += weight * (q1 - q0) * a2 * visible / (std::f64::consts::PI * tail * tail);
    }
    sum
}

/// A node of a rule for (0, 1): x, 1 − x without cancellation, and its weight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) x: f64,
    rest: f64,
    pub(super) weight: f64,
}

/// x = 1/(1 + exp(−π sinh t)) at 2n + 1 even steps of t from −3 to 3.
pub(super) fn double_exponential(n: i32) -> Vec<Node> {
    let step = 3.0 / f64::from(n);
    let node = |k: i32| {
        let (up, down) = (exp(step * f64::from(k)), exp(-step * f64::from(k)));
        let e = exp(std::f64::consts::FRAC_PI_2 * (up - down));
        let (x, rest) = (e / (1.0 + e), 1.0 / (1.0 + e));
        Node { x, rest, weight: step * std::f64::consts::FRAC_PI_2 * (up + down) * x * rest }
    };
    (-n..=n).map(node).collect()
}

/// e^x for |x| ≤ 40 to 1e-13, by the series for x/2048 and eleven squarings. Not std's: that differs between machines.
fn exp(x: f64) -> f64 {
    let z = x / 2048.0;
    let series = 1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0 * (1.0 + z / 5.0 * (1.0 + z / 6.0)))));
    (0..11).fold(series, |power, _| power * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_facets_reflect_is_what_is_not_missing() {
        for (mu, alpha) in [(1.0, 1.0), (0.3, 0.5), (0.02, 0.0025), (1e-4, 0.01)] {
            let mut sum = 0.0;
            facets(mu, alpha, |_, weight| sum += weight);
            assert!((1.0 - missing(mu, alpha) - sum).abs() < 1e-7, "{mu} {alpha}: {sum}");
        }
    }

    #[test]
    fn a_surface_of_width_one_seen_along_its_normal_loses_the_logarithm_of_two() {
        assert!((missing(1.0, 1.0) - std::f64::consts::LN_2).abs() < 1e-9);
    }

    #[test]
    fn a_narrow_surface_seen_along_its_normal_loses_alpha_squared() {
        assert!((missing(1.0, 1e-4) * 1e8 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn at_grazing_nothing_is_lost() {
        assert!(missing(1e-12, 1e-3) < 1e-8 && missing(1e-12, 1.0) < 1e-8);
    }
}
