//! The block test: every block of pixels, and the picture as a whole, against a known mean.
//!
//! The pixels of a furnace picture all have the same expectation; so have the differences of two pictures of one scene,
//! which is zero. Means over many samples are independent from pixel to pixel and nearly normal. So the mean of a block is
//! compared with what is expected by Student's t, its error estimated from the spread of its own pixels. The blocks find a
//! fault in one corner, the whole finds a small one everywhere.

use gonio_tracer::Picture;
use statrs::function::beta::beta_reg;

/// Pixels along the edge of a block.
const BLOCK: u32 = 8;

/// How many tests [`worst_block`] makes of a picture: three channels of each block and of the whole.
pub(crate) fn tests(width: u32, height: u32) -> usize {
    3 * ((width.div_ceil(BLOCK) * height.div_ceil(BLOCK)) as usize + 1)
}

/// The smallest p-value of a picture, and where it was found.
#[derive(Clone, Debug)]
pub(crate) struct Worst {
    pub(crate) p: f64,
    pub(crate) place: String,
}

/// One test: the mean of one channel over an area.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tested {
    /// First and one past the last column, first and one past the last row.
    pub(crate) area: [u32; 4],
    pub(crate) channel: usize,
    pub(crate) mean: f64,
    /// Standard error of the mean.
    pub(crate) error: f64,
    pub(crate) p: f64,
}

/// Tests the whole picture and then each block, by channel. `slack` is the difference from what is expected that is rounding
/// and not chance.
pub(crate) fn test_blocks(picture: &Picture, expected: [f64; 3], slack: [f64; 3]) -> impl Iterator<Item = Tested> {
    let whole = [0, picture.width, 0, picture.height];
    let columns = (0..picture.width).step_by(BLOCK as usize);
    let blocks = columns.flat_map(|x| (0..picture.height).step_by(BLOCK as usize).map(move |y| [x, y]));
    let blocks = blocks.map(|[x, y]| [x, (x + BLOCK).min(picture.width), y, (y + BLOCK).min(picture.height)]);
    std::iter::once(whole).chain(blocks).flat_map(move |area| {
        [0, 1, 2].map(|channel| {
            let [mean, error, n] = mean_and_error(picture, area, channel);
            let deviation = (mean - expected[channel]).abs() - slack[channel];
            Tested { area, channel, mean, error, p: student_p(deviation, error, n - 1.0) }
        })
    })
}

/// Compares a picture with the radiance that all its pixels should have; `slack` is relative to that.
pub(crate) fn worst_block(picture: &Picture, expected: [f64; 3], slack: f64) -> Worst {
    let all = test_blocks(picture, expected, expected.map(|x| slack * x));
    // The first of equals: the whole picture.
    let worst = all.reduce(|a, b| if b.p < a.p { b } else { a }).expect("a picture has pixels");
    let Tested { channel, mean, error, p, .. } = worst;
    let (place, expected) = (worst.place(picture), expected[channel]);
    Worst { p, place: format!("{place}: {mean:.6} ± {error:.1e}, should be {expected:.6}") }
}

impl Tested {
    /// Where it is, in words.
    pub(crate) fn place(&self, picture: &Picture) -> String {
        let [x0, x1, y0, y1] = self.area;
        let channel = ["red", "green", "blue"][self.channel];
        if [x0, y0] == [0, 0] && [x1, y1] == [picture.width, picture.height] {
            format!("whole picture, {channel}")
        } else {
            format!("pixels {x0}..{x1} x {y0}..{y1}, {channel}")
        }
    }
}

fn mean_and_error(picture: &Picture, [x0, x1, y0, y1]: [u32; 4], channel: usize) -> [f64; 3] {
    let rows = (y0..y1).map(|y| (y * picture.width) as usize);
    let pixels =
        rows.flat_map(|row| &picture.rgb[row + x0 as usize..row + x1 as usize]).map(|rgb| f64::from(rgb[channel]));
    let n = f64::from((x1 - x0) * (y1 - y0));
    let mean = pixels.clone().sum::<f64>() / n;
    let variance = pixels.map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0).max(1.0);
    [mean, (variance / n).sqrt(), n]
}

/// Two-sided p-value of a deviation in standard errors, with so many degrees of freedom. A NaN is evidence of a fault.
fn student_p(deviation: f64, error: f64, freedom: f64) -> f64 {
    if deviation <= 0.0 {
        return 1.0;
    }
    let t = deviation / error;
    if !t.is_finite() || freedom < 1.0 {
        return 0.0;
    }
    beta_reg(0.5 * freedom, 0.5, freedom / (freedom + t * t))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p_values_match_the_printed_tables() {
        // Abramowitz & Stegun, table 26.10: t(0.05; 10) = 2.228, t(0.01; 60) = 2.660.
        assert!((student_p(2.228, 1.0, 10.0) - 0.05).abs() < 1e-4);
        assert!((student_p(2.660, 1.0, 60.0) - 0.01).abs() < 1e-4);
        assert_eq!(student_p(f64::NAN, 1.0, 10.0), 0.0);
        assert_eq!(student_p(1e-9, 0.0, 10.0), 0.0);
        assert_eq!(student_p(-1e-9, 0.0, 10.0), 1.0);
    }

    #[test]
    fn noise_passes_and_a_wrong_corner_does_not() {
        let noise = |i: usize, k: usize| (gonio_lab::random::unit(1, i as u64, k as u64) - 0.5) as f32;
        let mut picture = Picture {
            width: 20,
            height: 20,
            rgb: (0..400).map(|i| std::array::from_fn(|k| 1.0 + 0.1 * noise(i, k))).collect(),
            alpha: None,
        };
        let limit = gonio_lab::sidak(0.005, tests(20, 20));
        assert!(worst_block(&picture, [1.0; 3], 0.0).p > limit);
        for y in 0..8 {
            for x in 0..8 {
                picture.rgb[y * 20 + x][1] *= 1.05;
            }
        }
        let worst = worst_block(&picture, [1.0; 3], 0.0);
        assert!(worst.p < limit);
        assert!(worst.place.contains("0..8 x 0..8, green"), "{}", worst.place);
        picture.rgb[399][2] = f32::NAN;
        assert_eq!(worst_block(&picture, [1.0; 3], 0.0).p, 0.0);
    }
}
