//! Fits for [`gonio_kernel::energy::AlbedoCurve`]: what GGX reflects with Fresnel's reflectance on its facets.
//!
//! At each node µ(α) of the curve: how much less than 1 a white surface reflects, and at which cosine Fresnel's reflectance,
//! Schlick's or a dielectric's, equals its mean over the facets that reflect.

use super::decimals::{number, rounded};
use super::fit::{chebyshev, least_squares, nodes};
use super::ggx::{double_exponential, facets};
use gonio_kernel::energy::albedo::{
    ALPHA_SMOOTH, IN_ALPHA, IN_ALPHA_ETA, IN_ETA, NODES, Node, Stretch, eta_basis, missing_factor,
};
use gonio_kernel::fresnel;
use std::fmt::Write;

/// What a microfacet surface reflects from a cosine µ in (0, 1], α in {0} and [1e-9, 1]: white, by (1 − c)⁵, and by dielectrics.
pub(crate) fn reflected(mu: f64, alpha: f64, etas: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; 2 + etas.len()];
    let mut add = |cos: f64, weight: f64| {
        let (m, m2) = (1.0 - cos, (1.0 - cos) * (1.0 - cos));
        let all = [1.0, m2 * m2 * m].into_iter().chain(etas.iter().map(|&eta| fresnel::dielectric(cos, eta)));
        for (sum, f) in sums.iter_mut().zip(all) {
            *sum += weight * f;
        }
    };
    if alpha > 0.0 {
        facets(mu, alpha, add)
    } else {
        add(mu, 1.0)
    }
    sums
}

/// The static of the kernel as source text.
pub(super) fn text(table: &[Node; NODES]) -> String {
    let row = |x: &[f64]| x.iter().copied().map(number).collect::<Vec<_>>().join(", ");
    let mut text = String::from(
        "\n/// Of [`super::AlbedoCurve`], node by node from µ = 1 downwards.\n\
         #[rustfmt::skip]\npub static ALBEDO: [Node; NODES] = [\n",
    );
    for node in table {
        let _ = writeln!(
            text,
            "    Node {{\n        x: {:?},\n        missing: [{}],\n        schlick: [{}],\n        dielectric: [",
            node.x,
            row(&node.missing),
            row(&node.schlick)
        );
        for part in &node.dielectric {
            let _ = writeln!(text, "            [{}],", row(part));
        }
        let _ = writeln!(text, "        ],\n        weight: [{}],\n    }},", row(&node.weight));
    }
    text.push_str("];\n");
    text
}

/// Fits all of it.
pub(super) fn make() -> [Node; NODES] {
    // As many as determine the polynomials twice, and the ends.
    let parts: Vec<f64> = nodes(18).chain([0.0, 1.0]).collect();
    let etas: Vec<f64> = LOW.into_iter().chain((0..13).map(|i| 1.1 + 1.9 * f64::from(i * i) / 144.0)).collect();
    let xs = chebyshev_nodes();
    let rule = double_exponential(200);
    xs.map(|x| {
        let at: Vec<Sample> = parts.iter().map(|&part| Sample::new(part, x, &etas)).collect();
        Node {
            x,
            missing: missing(&at),
            schlick: schlick(&at),
            dielectric: dielectric(&at, &etas),
            weight: weight(&parts, x, &xs, &rule),
        }
    })
}

/// Indices below 1.1, to which the fit errs upwards.
const LOW: [f64; 5] = [1.02, 1.03, 1.045, 1.06, 1.08];

/// The nodes of the curve, in (−1, 1) downwards: 2 sin² − 1 with the sine's argument from `nodes`.
fn chebyshev_nodes() -> [f64; NODES] {
    let mut xs = [0.0; NODES];
    for (x, node) in xs.iter_mut().zip(nodes(NODES)) {
        *x = format!("{:.15}", 1.0 - 2.0 * node).parse().unwrap_or(0.0);
    }
    xs
}

/// The truth at one node and α.
struct Sample {
    part: f64,
    alpha: f64,
    mu: f64,
    /// White, by (1 − c)⁵, by dielectrics.
    reflected: Vec<f64>,
}

impl Sample {
    fn new(part: f64, x: f64, etas: &[f64]) -> Self {
        let alpha = alpha_of(part);
        let mu = Stretch::new(alpha).cos(x);
        Self { part, alpha, mu, reflected: reflected(mu, alpha, etas) }
    }
    /// Wide lobes are asked for more accuracy, and have it to give.
    fn importance(&self) -> f64 {
        if self.alpha > 0.05 { 4.0 } else { 1.0 }
    }
    /// Of the squared cosine of a mean facet, in units of α² beyond µ².
    fn excess(&self, cos: f64) -> f64 {
        (cos * cos - self.mu * self.mu) / (self.alpha * self.alpha)
    }
    /// How E follows [`Self::excess`], from its derivative by the cosine.
    fn per_excess(&self, slope: f64, cos: f64) -> f64 {
        slope * self.reflected[0] * self.alpha * self.alpha / (2.0 * cos) + 1e-6
    }
}

/// The inverse of α ↦ the eighth root of α, stretched from [`ALPHA_SMOOTH`] … 1 to 0 … 1.
fn alpha_of(part: f64) -> f64 {
    let least = ALPHA_SMOOTH.sqrt().sqrt().sqrt();
    let root = least + (1.0 - least) * part;
    (0..3).fold(root, |power, _| power * power)
}

fn array<const N: usize>(solution: &[f64]) -> [f64; N] {
    let mut all = [0.0; N];
    for (to, &from) in all.iter_mut().zip(solution) {
        *to = rounded(from);
    }
    all
}

/// Solves for the coefficients of polynomials of `part`, of rows weighted and given (weight, value).
fn polynomial<const N: usize>(at: &[Sample], value: impl Fn(&Sample) -> (f64, f64)) -> [f64; N] {
    let (mut rows, mut right) = (Vec::new(), Vec::new());
    for sample in at {
        let (weight, value) = value(sample);
        rows.push(chebyshev(2.0 * sample.part - 1.0, N).into_iter().map(|t| weight * t).collect());
        right.push(weight * value);
    }
    array(&least_squares(rows, right, 0.0))
}

fn missing(at: &[Sample]) -> [f64; IN_ALPHA] {
    polynomial(at, |sample| {
        let factor = missing_factor(sample.mu, sample.alpha);
        ((factor + 1e-3) * sample.importance(), (1.0 - sample.reflected[0]) / factor)
    })
}

fn schlick(at: &[Sample]) -> [f64; IN_ALPHA] {
    polynomial(at, |sample| {
        let fifth = sample.reflected[1] / sample.reflected[0];
        // Its fifth root by Newton's method from above.
        let root = (0..80).fold(1.0_f64, |r, _| r - (r - fifth / (r * r * r * r)) / 5.0);
        let cos = 1.0 - root;
        let slope = 5.0 * root * root * root * root;
        (sample.per_excess(slope, cos) * sample.importance(), sample.excess(cos))
    })
}

/// The cosine at which a dielectric reflects a part, which lies between its least and 1.
fn cosine_of(part: f64, eta: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if fresnel::dielectric(middle, eta) > part { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

fn dielectric(at: &[Sample], etas: &[f64]) -> [[f64; IN_ALPHA_ETA]; IN_ETA] {
    const ORDINARY: usize = IN_ETA - 1;
    let bases: Vec<[f64; IN_ETA]> = etas.iter().map(|&eta| eta_basis(eta)).collect();
    let excess = |sample: &Sample, j: usize| {
        let cos = cosine_of(sample.reflected[2 + j] / sample.reflected[0], etas[j]);
        (cos, sample.excess(cos))
    };
    // Indices from 1.1 on.
    let (mut rows, mut right) = (Vec::new(), Vec::new());
    for sample in at {
        let ts = chebyshev(2.0 * sample.part - 1.0, IN_ALPHA_ETA);
        for j in LOW.len()..etas.len() {
            let (cos, excess) = excess(sample, j);
            let f = |cos: f64| fresnel::dielectric(cos, etas[j]);
            let slope = (f(cos - 1e-4) - f((cos + 1e-4).min(1.0))) / 2e-4;
            let weight = sample.per_excess(slope.abs(), cos) * sample.importance();
            rows.push(bases[j][..ORDINARY].iter().flat_map(|b| ts.iter().map(move |t| weight * b * t)).collect());
            right.push(weight * excess);
        }
    }
    let solution = least_squares(rows, right, 0.0);
    let mut table = [[0.0; IN_ALPHA_ETA]; IN_ETA];
    for (row, solution) in table.iter_mut().zip(solution.chunks(IN_ALPHA_ETA)) {
        *row = array(solution);
    }
    // Below: the least that a ramp must add, so that cosines err downwards and reflectances upwards.
    let ordinary = table;
    table[ORDINARY] = polynomial(at, |sample| {
        let ts = chebyshev(2.0 * sample.part - 1.0, IN_ALPHA_ETA);
        let least = (0..LOW.len()).map(|j| {
            let of_row = |row: &[f64; IN_ALPHA_ETA]| row.iter().zip(&ts).map(|(c, t)| c * t).sum::<f64>();
            let known: f64 = ordinary.iter().zip(bases[j]).take(ORDINARY).map(|(row, b)| b * of_row(row)).sum();
            (excess(sample, j).1 - known) / bases[j][ORDINARY]
        });
        let least = least.fold(f64::INFINITY, f64::min);
        let (a2, mu2) = (sample.alpha * sample.alpha, sample.mu * sample.mu);
        (a2 / (a2 + mu2), least - 0.02 * least.abs())
    });
    table
}

/// 2∫ℓ(µ)µ dµ of the node's Lagrange polynomial ℓ.
fn weight(parts: &[f64], x: f64, xs: &[f64], rule: &[super::ggx::Node]) -> [f64; IN_ALPHA] {
    let lagrange =
        |at: f64| xs.iter().filter(|&&other| other != x).map(|other| (at - other) / (x - other)).product::<f64>();
    let (mut rows, mut right) = (Vec::new(), Vec::new());
    for &part in parts {
        let grid = Stretch::new(alpha_of(part));
        rows.push(chebyshev(2.0 * part - 1.0, IN_ALPHA));
        right.push(2.0 * rule.iter().map(|n| n.weight * n.x * lagrange(grid.x(n.x))).sum::<f64>());
    }
    array(&least_squares(rows, right, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_kernel::Rgb;
    use gonio_kernel::energy::AlbedoCurve;

    /// Cosines between the nodes: below 0.02 and from there on.
    fn cosines() -> (Vec<f64>, Vec<f64>) {
        let low = (0..30).map(|i| 1e-7 + 0.0199 * (f64::from(i) / 29.0).powi(4)).collect();
        let ordinary = (0..40).map(|i| 0.02 + 0.98 * (f64::from(i) / 39.0).powf(1.7)).collect();
        (low, ordinary)
    }

    /// The least and the largest of fit − truth, the least over all cosines.
    #[derive(Clone, Copy)]
    struct Range {
        least: f64,
        largest: f64,
        least_low: f64,
        largest_low: f64,
    }

    impl Range {
        const NOTHING: Self = Self {
            least: f64::INFINITY,
            largest: f64::NEG_INFINITY,
            least_low: f64::INFINITY,
            largest_low: f64::NEG_INFINITY,
        };
        fn add(&mut self, low: bool, error: f64) {
            if low {
                self.least_low = self.least_low.min(error);
                self.largest_low = self.largest_low.max(error);
            } else {
                self.least = self.least.min(error);
                self.largest = self.largest.max(error);
            }
        }
    }

    impl std::fmt::Display for Range {
        fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            let [a, b, c, d] = [self.least, self.largest, self.least_low, self.largest_low].map(|x| 1e5 * x);
            write!(f, "{a:5.1} {b:5.1} ({c:6.1} {d:6.0})")
        }
    }

    const ALPHAS: [f64; 29] = [
        0.0, 1e-4, 0.0005, 0.001, 0.0018, 0.0025, 0.0027, 0.003, 0.0035, 0.004, 0.005, 0.006, 0.008, 0.01, 0.014, 0.02,
        0.03, 0.05, 0.07, 0.09, 0.12, 0.16, 0.2, 0.25, 0.32, 0.45, 0.6, 0.8, 1.0,
    ];
    const NEAR_ONE: [f64; 9] = [1.0, 1.0005, 1.003, 1.01, 1.025, 1.035, 1.05, 1.07, 1.09];
    const ORDINARY: [f64; 11] = [1.1, 1.12, 1.17, 1.25, 1.35, 1.5, 1.65, 1.85, 2.1, 2.3, 2.5];
    const HIGH: [f64; 3] = [2.6, 2.8, 3.0];

    #[test]
    fn a_coat_over_a_white_base_returns_all_light_and_no_more() {
        let (low, ordinary) = cosines();
        let etas: Vec<f64> = NEAR_ONE.into_iter().chain(ORDINARY).chain(HIGH).collect();
        println!("E_fit − E_true in 1e-5 for µ ≥ 0.02 (and below): η < 1.1, η to 2.5, η > 2.5, Schlick");
        for alpha in ALPHAS {
            let single = alpha as f32;
            let curves: Vec<_> = etas.iter().map(|&eta| AlbedoCurve::dielectric(alpha, eta)).collect();
            let curves32: Vec<_> = etas.iter().map(|&eta| AlbedoCurve::dielectric(single, eta as f32)).collect();
            let f0 = Rgb::new(0.0, 0.4, 1.0);
            let (schlick, schlick32) =
                (AlbedoCurve::schlick(alpha, f0), AlbedoCurve::schlick(single, f0.map(|x| x as f32)));
            let mut ranges = [Range::NOTHING; 4];
            for (&mu, low) in low.iter().map(|mu| (mu, true)).chain(ordinary.iter().map(|mu| (mu, false))) {
                let mu32 = mu as f32;
                let truth = reflected(mu, alpha, &etas);
                for (j, &eta) in etas.iter().enumerate() {
                    let range = &mut ranges[usize::from(eta >= 1.1) + usize::from(eta > 2.5)];
                    range.add(low, curves[j].at(mu).r - truth[2 + j]);
                    range.add(low, f64::from(curves32[j].at(mu32).r) - truth[2 + j]);
                }
                let (fit, fit32) = (schlick.at(mu), schlick32.at(mu32).map(f64::from));
                for (f0, fit) in
                    [(f0.r, fit.r), (f0.g, fit.g), (f0.b, fit.b), (f0.r, fit32.r), (f0.g, fit32.g), (f0.b, fit32.b)]
                {
                    ranges[3].add(low, fit - f0 * truth[0] - (1.0 - f0) * truth[1]);
                }
            }
            let [a, b, c, d] = ranges;
            println!("α {alpha:6}: {a} | {b} | {c} | {d}");
            for range in ranges {
                assert!(range.least > -5e-5 && range.least_low > -1e-4, "α {alpha}: {range}");
            }
            for range in [b, d] {
                assert!(range.largest < if alpha >= 0.09 { 1e-3 } else { 3e-3 }, "α {alpha}: {range}");
            }
        }
    }

    #[test]
    fn also_where_no_table_looks() {
        // Additive recurrences fill the square of α and η and the cosines.
        let part = |i: u32, step: f64| (f64::from(i) * step).fract();
        let mut ranges = [Range::NOTHING; 6];
        for i in 1..=600 {
            let alpha = part(i, 0.754_877_666_246_692_8).powi(3);
            let (eta, f0) = (1.0 + 2.0 * part(i, 0.569_840_290_998_053_2), part(i, 0.414_213_562_373_095));
            let (single, grey) = (alpha as f32, Rgb::splat(f0));
            let (curve, curve32) = (AlbedoCurve::dielectric(alpha, eta), AlbedoCurve::dielectric(single, eta as f32));
            let (schlick, schlick32) =
                (AlbedoCurve::schlick(alpha, grey), AlbedoCurve::schlick(single, grey.map(|x| x as f32)));
            let width = usize::from(alpha >= 0.0025) + usize::from(alpha >= 0.09);
            let of_dielectric = if (1.1..=2.5).contains(&eta) { width } else { 5 };
            for j in 0..40 {
                let mu = part(i * 40 + j, 0.618_033_988_749_894_9).powi(2).max(1e-7);
                let (low, mu32, truth) = (mu < 0.02, mu as f32, reflected(mu, alpha, &[eta]));
                ranges[of_dielectric].add(low, curve.at(mu).r - truth[2]);
                ranges[of_dielectric].add(low, f64::from(curve32.at(mu32).r) - truth[2]);
                let e = f0 * truth[0] + (1.0 - f0) * truth[1];
                let of_schlick = [0, 3, 4][width];
                ranges[of_schlick].add(low, schlick.at(mu).r - e);
                ranges[of_schlick].add(low, f64::from(schlick32.at(mu32).r) - e);
            }
        }
        let [smooth, narrow, wide, narrow_schlick, wide_schlick, others] = ranges;
        println!("1e-5: {smooth} | {narrow} | {wide} | Schlick {narrow_schlick} | {wide_schlick} | other η {others}");
        for range in ranges {
            assert!(range.least > -5e-5 && range.least_low > -1e-4, "{range}");
        }
        assert!(narrow.largest < 3e-3 && narrow_schlick.largest < 3e-3, "{narrow} {narrow_schlick}");
        assert!(wide.largest < 1e-3 && wide_schlick.largest < 1e-3, "{wide} {wide_schlick}");
    }

    #[test]
    fn a_coat_that_lets_next_to_nothing_through_returns_no_more_than_all_light() {
        // There the margin exceeds 1 − E, which is cut off at 0, and E_avg must know.
        let rule = double_exponential(60);
        let (low, ordinary) = cosines();
        let (mut range, mut ordinary_f0) = (Range::NOTHING, Range::NOTHING);
        for f0 in
            [0.8, 0.9, 0.95, 0.97, 0.98, 0.99, 0.993, 0.995, 0.996, 0.997, 0.998, 0.9985, 0.999, 0.9993, 0.9997, 1.0]
        {
            for alpha in ALPHAS {
                let curve = AlbedoCurve::schlick(alpha, Rgb::splat(f0));
                let t = |mu: f64| 1.0 - curve.at(mu).r;
                let kept = 2.0 * rule.iter().map(|n| n.weight * n.x * t(n.x)).sum::<f64>() / (1.0 - curve.avg().r);
                assert!(kept.is_finite(), "{f0} {alpha}");
                for (mu, low) in low.iter().map(|mu| (*mu, true)).chain(ordinary.iter().map(|mu| (*mu, false))) {
                    let truth = reflected(mu, alpha, &[]);
                    let e = f0 * truth[0] + (1.0 - f0) * truth[1];
                    let error = 1.0 - e - t(mu) * kept;
                    range.add(low, error);
                    if f0 < 0.99 {
                        ordinary_f0.add(low, error);
                    }
                }
            }
        }
        println!("1e-5: {range}, f0 below 0.99 {ordinary_f0}");
        assert!(range.least > -1e-4 && range.least_low > -1e-4, "{range}");
    }
}
