//! Adaptive quadrature over a rectangle, of several integrands at once.
//!
//! A tensor of 7-point Gauss–Legendre rules (exact to degree 13 in either variable). A rectangle is halved across the
//! direction in which its highest Legendre coefficient is larger; the part whose halves agree worst with the whole is
//! halved next, until all disagreements add up to less than the tolerance.

/// Values of the integrands at a point.
pub(crate) type Integrands = [f64; 7];

/// An integral, the sum of the differences that were left, and how many points it took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Integral {
    /// The integrals.
    pub(crate) value: Integrands,
    /// An estimate of the error of the worst of them; pessimistic where the integrand is smooth.
    pub(crate) error: f64,
    /// Evaluations.
    pub(crate) points: usize,
}

impl Integral {
    /// Adds another.
    pub(crate) fn add(&mut self, other: &Integral) {
        for (a, b) in self.value.iter_mut().zip(other.value) {
            *a += b;
        }
        self.error += other.error;
        self.points += other.points;
    }
}

/// lo and hi of either variable.
pub(crate) type Rectangle = [[f64; 2]; 2];

// Abramowitz & Stegun, table 25.4, n = 7, on [−1, 1].
const NODES: [f64; 7] = [
    -0.949_107_912_342_758_5,
    -0.741_531_185_599_394_4,
    -0.405_845_151_377_397_2,
    0.0,
    0.405_845_151_377_397_2,
    0.741_531_185_599_394_4,
    0.949_107_912_342_758_5,
];
const WEIGHTS: [f64; 7] = [
    0.129_484_966_168_869_7,
    0.279_705_391_489_276_7,
    0.381_830_050_505_118_9,
    0.417_959_183_673_469_4,
    0.381_830_050_505_118_9,
    0.279_705_391_489_276_7,
    0.129_484_966_168_869_7,
];

/// ∫∫ f over the rectangle, to the absolute tolerance, with at most about `budget` evaluations.
pub(crate) fn integrate(
    f: &dyn Fn(f64, f64) -> Integrands,
    area: Rectangle,
    tolerance: f64,
    budget: usize,
) -> Integral {
    // Four to begin with: an edge so near to the border that neither a whole nor its halves see it must hide from all of them.
    let quarters = halves(area, 0).into_iter().flat_map(|half| halves(half, 1));
    let mut parts: Vec<Part> = quarters.map(|quarter| Part::new(f, quarter, rule(f, quarter))).collect();
    let mut points = 12 * POINTS;
    loop {
        let error: f64 = parts.iter().map(|part| part.error).sum();
        let worst = (0..parts.len()).max_by(|&i, &j| parts[i].error.total_cmp(&parts[j].error));
        let worth_refining = error > tolerance && error.is_finite() && points < budget;
        let Some(worst) = worst.filter(|_| worth_refining) else {
            let mut sum = Integral { error, points, ..Integral::default() };
            for half in parts.iter().flat_map(|part| &part.halves) {
                for (sum, value) in sum.value.iter_mut().zip(half.1.0) {
                    *sum += value;
                }
            }
            return sum;
        };
        let [first, second] = parts.swap_remove(worst).halves;
        parts.push(Part::new(f, first.0, first.1));
        parts.push(Part::new(f, second.0, second.1));
        points += 4 * POINTS;
    }
}

/// Points of the rule.
const POINTS: usize = 49;

/// A rectangle, halved: the halves with the rule's value and rougher variable, and how far their sum is from the whole.
struct Part {
    halves: [(Rectangle, (Integrands, usize)); 2],
    error: f64,
}

impl Part {
    fn new(f: &dyn Fn(f64, f64) -> Integrands, area: Rectangle, (whole, axis): (Integrands, usize)) -> Self {
        let halves = halves(area, axis).map(|half| (half, rule(f, half)));
        let [a, b] = [halves[0].1.0, halves[1].1.0];
        let error = (0..whole.len()).fold(0.0, |worst, i| {
            let difference = (a[i] + b[i] - whole[i]).abs();
            // A NaN must not hide behind a comparison.
            if difference.is_nan() || difference > worst { difference } else { worst }
        });
        Self { halves, error }
    }
}

/// Both halves of a rectangle across a direction.
fn halves(area: Rectangle, axis: usize) -> [Rectangle; 2] {
    let [lo, hi] = area[axis];
    let middle = 0.5 * (lo + hi);
    [[lo, middle], [middle, hi]].map(|side| {
        let mut half = area;
        half[axis] = side;
        half
    })
}

/// The value of the rule, and along which variable the integrand is rougher.
fn rule(f: &dyn Fn(f64, f64) -> Integrands, area: Rectangle) -> (Integrands, usize) {
    let [center, half] = [0.5, -0.5].map(|s| area.map(|[lo, hi]| s * lo + 0.5 * hi));
    let mut grid = [[0.0; 7]; 7];
    let mut sum = [0.0; 7];
    for (i, row) in grid.iter_mut().enumerate() {
        for (j, total) in row.iter_mut().enumerate() {
            let value = f(center[0] + half[0] * NODES[i], center[1] + half[1] * NODES[j]);
            let weight = WEIGHTS[i] * WEIGHTS[j];
            for (s, v) in sum.iter_mut().zip(value) {
                *s += weight * v;
            }
            *total = value.iter().sum();
        }
    }
    let p6 = NODES.map(legendre6);
    let roughness = |at: &dyn Fn(usize, usize) -> f64| -> f64 {
        (0..7).map(|j| WEIGHTS[j] * (0..7).map(|i| WEIGHTS[i] * p6[i] * at(i, j)).sum::<f64>().abs()).sum()
    };
    let rough = [roughness(&|i, j| grid[i][j]), roughness(&|i, j| grid[j][i])];
    let scale = half[0] * half[1];
    (sum.map(|s| s * scale), usize::from(rough[1] > rough[0]))
}

fn legendre6(x: f64) -> f64 {
    let x2 = x * x;
    (((231.0 * x2 - 315.0) * x2 + 105.0) * x2 - 5.0) / 16.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrates_what_has_a_closed_form() {
        // ∫∫ cos x · e^y, and a peak of width 1e-3: atan in either variable.
        let peak = |x: f64| 1e-3 / (1e-6 + x * x);
        let f = |x: f64, y: f64| [x.cos() * y.exp(), peak(x - 0.3) * peak(y - 0.6), 1.0, 0.0, 0.0, 0.0, 0.0];
        let got = integrate(&f, [[0.0, 1.0], [0.0, 1.0]], 1e-9, 1_000_000);
        let line = |c: f64| (c / 1e-3).atan() + ((1.0 - c) / 1e-3).atan();
        assert!((got.value[0] - 1.0_f64.sin() * (1.0_f64.exp() - 1.0)).abs() < 1e-11);
        assert!((got.value[1] - line(0.3) * line(0.6)).abs() < 1e-8, "{:?}", got);
        assert!((got.value[2] - 1.0).abs() < 1e-14);
    }
}
