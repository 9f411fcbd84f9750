//! How two pictures of one scene differ, and whether chance explains it.

use crate::blocks::{test_blocks, tests};
use gonio_lab::sidak;
use gonio_report::around_mid_grey;
use gonio_tracer::Picture;

/// Keeps relMSE finite where the reference is black (Rousselle et al. 2011).
const EPSILON: f64 = 0.01;
/// A pixel differs if some channel is off by more than this, relative to the larger of the reference's value and mean.
/// Less is what another order of roundings makes, which differ in nearly every pixel.
const NOTICEABLE: f64 = 1e-3;
/// Means of blocks that differ by less than this of the picture's mean differ by rounding: of the film, of f32, of the tests
/// that a backend makes.
const ROUNDING: f64 = 1e-6;

/// How B differs from A, by channel.
#[derive(Clone, Debug)]
pub struct Difference {
    /// B − A.
    pub picture: Picture,
    /// Of A, and of B.
    pub means: [[f64; 3]; 2],
    /// Root mean square of B − A.
    pub rmse: [f64; 3],
    /// Mean of (B − A)²/(A² + ε).
    pub rel_mse: [f64; 3],
    /// Pixels with any difference, to the last bit.
    pub unequal: usize,
    /// Pixels with a noticeable difference.
    pub differing: usize,
    /// Those of them none of whose eight neighbours has one.
    pub isolated: usize,
    /// Pixels of either picture with a channel that is not finite.
    pub not_numbers: usize,
    /// The largest difference of any channel.
    pub largest: Largest,
    /// How many tests the block test made.
    pub tests: usize,
    /// How many of them failed.
    pub failed: usize,
    /// At which level each.
    pub level: f64,
    /// The least p-value.
    pub worst_p: f64,
    /// Where it was found, and what was measured there.
    pub worst_place: String,
}

/// The largest difference of any channel, and its pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Largest {
    /// Its size.
    pub value: f64,
    /// The pixel's column.
    pub x: usize,
    /// The pixel's row, from the top.
    pub y: usize,
}

impl Difference {
    /// Whether no test found a difference.
    pub fn explained_by_chance(&self) -> bool {
        self.failed == 0
    }
}

/// Measures how B differs from A, which has the same size.
pub fn difference(a: &Picture, b: &Picture, significance: f64) -> Difference {
    let n = a.rgb.len() as f64;
    let pairs = || a.rgb.iter().zip(&b.rgb);
    let mean_of = |value: &dyn Fn(f64, f64) -> f64| {
        [0, 1, 2].map(|c| pairs().map(|(a, b)| value(f64::from(a[c]), f64::from(b[c]))).sum::<f64>() / n)
    };
    let rgb = pairs().map(|(a, b)| [b[0] - a[0], b[1] - a[1], b[2] - a[2]]).collect();
    let picture = Picture { width: a.width, height: a.height, rgb, alpha: None };
    let means = [mean_of(&|a, _| a), mean_of(&|_, b| b)];
    let close = |a: f32, b: f32, mean: f64| f64::from((b - a).abs()) <= NOTICEABLE * f64::from(a.abs()).max(mean.abs());
    let differs: Vec<bool> =
        pairs().map(|(a, b)| !(0..3).all(|c| a[c] == b[c] || close(a[c], b[c], means[0][c]))).collect();
    let width = a.width as usize;

    let tests = tests(a.width, a.height);
    let level = sidak(significance, tests);
    let (mut failed, mut worst_p, mut worst_place) = (0, f64::INFINITY, String::new());
    let slack = means[0].map(|mean| ROUNDING * mean.abs());
    for tested in test_blocks(&picture, [0.0; 3], slack) {
        failed += usize::from(tested.p < level);
        if tested.p < worst_p {
            worst_p = tested.p;
            worst_place = format!("{}: {:.3e} ± {:.1e}", tested.place(a), tested.mean, tested.error);
        }
    }
    let mut largest = Largest::default();
    for (i, rgb) in picture.rgb.iter().enumerate() {
        let value = rgb.iter().map(|x| f64::from(x.abs())).fold(0.0, f64::max);
        if value > largest.value {
            largest = Largest { value, x: i % width, y: i / width };
        }
    }
    Difference {
        means,
        rmse: mean_of(&|a, b| (b - a) * (b - a)).map(f64::sqrt),
        rel_mse: mean_of(&|a, b| (b - a) * (b - a) / (a * a + EPSILON)),
        unequal: pairs().filter(|(a, b)| a.map(f32::to_bits) != b.map(f32::to_bits)).count(),
        differing: differs.iter().filter(|d| **d).count(),
        isolated: isolated(&differs, width),
        not_numbers: pairs().filter(|(a, b)| !a.iter().chain(*b).all(|x| x.is_finite())).count(),
        largest,
        tests,
        failed,
        level,
        worst_p,
        worst_place,
        picture,
    }
}

/// How many marked pixels have no marked neighbour.
fn isolated(marked: &[bool], width: usize) -> usize {
    let height = marked.len() / width;
    let alone = |x: usize, y: usize| {
        let columns = x.saturating_sub(1)..(x + 2).min(width);
        let around = columns.flat_map(|i| (y.saturating_sub(1)..(y + 2).min(height)).map(move |j| (i, j)));
        around.filter(|&(i, j)| marked[j * width + i]).count() == 1
    };
    (0..marked.len()).filter(|&i| marked[i] && alone(i % width, i / width)).count()
}

/// The difference relative to the mean of A, magnified so that all but the largest percent fits between black and twice mid
/// grey, and by how much.
pub fn magnified(a: &Picture, difference: &Picture) -> (Picture, f64) {
    let mean = a.rgb.iter().flatten().map(|&x| f64::from(x)).filter(|x| x.is_finite()).sum::<f64>();
    let mean = (mean / (3 * a.rgb.len()) as f64).abs().max(f64::MIN_POSITIVE);
    let mut sizes: Vec<f32> = difference.rgb.iter().flatten().map(|x| x.abs()).filter(|x| x.is_finite()).collect();
    sizes.sort_unstable_by(f32::total_cmp);
    let most = sizes.get(sizes.len().saturating_sub(1 + sizes.len() / 100)).map_or(0.0, |&x| f64::from(x));
    let most = if most > 0.0 { most } else { sizes.last().map_or(0.0, |&x| f64::from(x)) };
    let gain = if most > 0.0 { mean / most } else { 1.0 };
    let show = |x: f32| around_mid_grey(gain * f64::from(x) / mean);
    (Picture { rgb: difference.rgb.iter().map(|rgb| rgb.map(show)).collect(), alpha: None, ..*difference }, gain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_lab::random::unit;

    fn noisy(seed: u64) -> Picture {
        let pixel = |i: u64| [0, 1, 2].map(|c| (1.0 + 0.2 * (unit(seed, i, c) - 0.5)) as f32);
        Picture { width: 40, height: 24, rgb: (0..960).map(pixel).collect(), alpha: None }
    }

    #[test]
    fn noise_is_chance_and_a_tint_of_one_block_is_not() {
        let (a, mut b) = (noisy(1), noisy(2));
        assert!(difference(&a, &b, 0.01).explained_by_chance());
        let rounded =
            Picture { rgb: a.rgb.iter().map(|rgb| rgb.map(|x| x * (1.0 + 5e-7))).collect(), alpha: None, ..a };
        let found = difference(&a, &rounded, 0.01);
        assert!(found.explained_by_chance() && found.unequal > 900 && found.differing == 0);
        for y in 8..16 {
            for x in 16..24 {
                b.rgb[y * 40 + x][1] *= 1.1;
            }
        }
        let found = difference(&a, &b, 0.01);
        assert!(!found.explained_by_chance());
        assert!(found.worst_place.starts_with("pixels 16..24 x 8..16, green"), "{}", found.worst_place);
    }

    #[test]
    fn the_errors_are_what_they_are_called() {
        let flat = |x: f32| Picture { width: 8, height: 8, rgb: vec![[x, 0.0, 2.0]; 64], alpha: None };
        let found = difference(&flat(1.0), &flat(1.5), 0.01);
        assert_eq!((found.means[0][0], found.means[1][0]), (1.0, 1.5));
        assert_eq!((found.rmse, found.differing, found.isolated), ([0.5, 0.0, 0.0], 64, 0));
        assert!((found.rel_mse[0] - 0.25 / 1.01).abs() < 1e-12);
        assert_eq!(found.worst_p, 0.0); // a constant offset has no spread that could explain it
    }

    #[test]
    fn lonely_pixels_are_counted() {
        let a = noisy(1);
        let mut b = a.clone();
        for at in [0, 5 * 40 + 5, 5 * 40 + 6, 20 * 40 + 39] {
            b.rgb[at][2] += 0.5;
        }
        b.rgb[300][0] = f32::NAN;
        let found = difference(&a, &b, 0.01);
        assert_eq!((found.differing, found.isolated, found.not_numbers), (5, 3, 1));
        assert!(!found.explained_by_chance(), "a pixel that is not a number is never chance");
        assert_eq!((found.largest.x, found.largest.y), (0, 0));
    }

    #[test]
    fn magnifying_keeps_grey_where_nothing_differs() {
        let a = noisy(1);
        let (picture, _) = magnified(&a, &difference(&a, &a, 0.01).picture);
        assert!(picture.rgb.iter().flatten().all(|x| (x - 0.214).abs() < 1e-6));
    }
}
