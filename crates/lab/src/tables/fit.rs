//! Linear least squares and Chebyshev polynomials, in plain arithmetic.

/// T₀(t) … T_{n−1}(t).
pub(super) fn chebyshev(t: f64, n: usize) -> Vec<f64> {
    let mut values = vec![1.0, t];
    for k in 2..n {
        values.push(2.0 * t * values[k - 1] - values[k - 2]);
    }
    values.truncate(n);
    values
}

/// n Chebyshev nodes of (0, 1): sin² of odd multiples of π/4n.
pub(super) fn nodes(n: usize) -> impl Iterator<Item = f64> {
    // By the addition theorem from one angle, whose half-angle tangent a short series gives.
    let angle = std::f64::consts::FRAC_PI_4 / n as f64;
    let z = angle * angle;
    let sin = angle * (1.0 - z / 6.0 * (1.0 - z / 20.0 * (1.0 - z / 42.0 * (1.0 - z / 72.0 * (1.0 - z / 110.0)))));
    let cos = (1.0 - sin * sin).sqrt();
    let (sin2, cos2) = (2.0 * sin * cos, 1.0 - 2.0 * sin * sin);
    (0..n).scan((sin, cos), move |(s, c), _| {
        let node = *s * *s;
        (*s, *c) = (*s * cos2 + *c * sin2, *c * cos2 - *s * sin2);
        Some(node)
    })
}

/// The x for which |rows·x − right|² + λ²|x|² is least, by Householder's reflections.
pub(super) fn least_squares(mut rows: Vec<Vec<f64>>, mut right: Vec<f64>, lambda: f64) -> Vec<f64> {
    let n = rows.first().map_or(0, Vec::len);
    for i in 0..n {
        rows.push((0..n).map(|j| if i == j { lambda } else { 0.0 }).collect());
        right.push(0.0);
    }
    for k in 0..n {
        let norm = rows[k..].iter().map(|row| row[k] * row[k]).sum::<f64>().sqrt();
        let head = if rows[k][k] > 0.0 { rows[k][k] + norm } else { rows[k][k] - norm };
        // v = column − (±norm, 0, …); v·v = 2·norm·|head|.
        let scale = norm * head.abs();
        let mut v: Vec<f64> = rows[k..].iter().map(|row| row[k]).collect();
        v[0] = head;
        for j in k..n {
            let s = v.iter().zip(&rows[k..]).map(|(v, row)| v * row[j]).sum::<f64>() / scale;
            for (v, row) in v.iter().zip(&mut rows[k..]) {
                row[j] -= s * v;
            }
        }
        let s = v.iter().zip(&right[k..]).map(|(v, b)| v * b).sum::<f64>() / scale;
        for (v, b) in v.iter().zip(&mut right[k..]) {
            *b -= s * v;
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| rows[k][j] * x[j]).sum();
        x[k] = (right[k] - known) / rows[k][k];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_its_own_fit() {
        let points: Vec<f64> = nodes(9).collect();
        let rows = points.iter().map(|&x| chebyshev(2.0 * x - 1.0, 4)).collect();
        let right = points.iter().map(|x| 3.0 - x + 8.0 * x * x * x).collect();
        // 8x³ − x + 3 with x = (t + 1)/2, in Chebyshev polynomials.
        for (got, want) in least_squares(rows, right, 0.0).iter().zip([5.0, 3.25, 1.5, 0.25]) {
            assert!((got - want).abs() < 1e-13, "{got} {want}");
        }
    }

    #[test]
    fn the_nodes_are_those_of_the_book() {
        for (k, node) in nodes(30).enumerate() {
            let right = (0.5 * std::f64::consts::PI * (k as f64 + 0.5) / 30.0).sin().powi(2);
            assert!((node - right).abs() < 1e-14, "{k}: {node} {right}");
        }
    }
}
