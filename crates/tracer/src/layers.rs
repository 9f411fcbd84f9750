//! Layers: what a compositor or a denoiser wants beside the picture.
//!
//! | layer | what a pixel holds |
//! |---|---|
//! | `albedo` | reflectance of the first surface seen along its normal: a metal has its F0, a mirror its R; 0 where nothing is seen |
//! | `normal` | shading normal of the first surface, on the camera's side, in world coordinates; 0 where nothing is seen |
//! | `depth` | distance from the camera's plane (along the view axis) \[m\], averaged over the samples that see a surface; 0 if none does |
//! | `direct` | radiance that scattered at most once: lights seen directly, and lights seen by the first surface |
//! | `indirect` | the rest: `direct` + `indirect` is the picture |
//! | `variance` | estimated variance of the pixel's mean: s²/n |
//! | `sample_count` | n |
//!
//! Sums are integers, as in [`crate::film::pixel`], so threads and order change nothing here either. Squares are summed in 128
//! bits, so that the variance is exact however small it is beside the mean: a sample is below 2⁴³ units, its square below
//! 2⁸⁶, and 2²⁰ of them below 2¹⁰⁶.

use crate::film::pixel::{Dither, Pixel, UNIT, round_to_i64};

/// What a camera ray sees first, by path.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FirstHit {
    pub(crate) albedo: [f32; 3],
    pub(crate) normal: [f32; 3],
    /// 0 for a miss.
    pub(crate) depth: f32,
}

/// The sums of one pixel's layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LayerSums {
    direct: [i64; 3],
    squares: [u128; 3],
    albedo: [i64; 3],
    normal: [i64; 3],
    depth: i64,
    hits: u32,
}

/// The layers of a picture; each list has one entry per pixel, rows from the top. The module's table says what they hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// Reflectance of what is seen, in [0, 1].
    pub albedo: Vec<[f32; 3]>,
    /// Shading normal of what is seen; shorter than 1 where a pixel sees several.
    pub normal: Vec<[f32; 3]>,
    /// Distance from the camera's plane \[m\]; 0 for nothing.
    pub depth: Vec<f32>,
    /// Radiance that scattered at most once.
    pub direct: Vec<[f32; 3]>,
    /// Radiance that scattered more than once.
    pub indirect: Vec<[f32; 3]>,
    /// Variance of the pixel's mean; `None` with less than two samples, which have none.
    pub variance: Option<Vec<[f32; 3]>>,
    /// Samples.
    pub sample_count: Vec<u32>,
}

/// The unit of depths: 2⁻⁴⁰ of a power of two that no depth exceeds, so that planets and watches are equally exact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DepthUnit(f64);

impl DepthUnit {
    /// For depths up to `farthest`.
    pub(crate) fn for_depths_up_to(farthest: f32) -> Self {
        let exponent = f64::from(farthest.max(f32::MIN_POSITIVE)).log2().ceil();
        Self((exponent - 40.0).exp2())
    }
}

impl LayerSums {
    /// Adds a sample that counts: its radiance, the part of it that scattered at most once, and what it saw first.
    #[inline]
    pub(crate) fn add(
        &mut self,
        rgb: [f32; 3],
        direct: [f32; 3],
        first: &FirstHit,
        depth_unit: DepthUnit,
        (pixel, sample): (u32, u32),
    ) {
        // The same dither as the picture's, so that direct never exceeds the whole.
        let dither = Dither::of(pixel, sample);
        for channel in 0..3 {
            self.direct[channel] += dither.units(direct[channel]);
            self.squares[channel] += square(dither.units(rgb[channel]));
            self.albedo[channel] += round_to_i64(f64::from(first.albedo[channel]) * UNIT);
            self.normal[channel] += round_to_i64(f64::from(first.normal[channel]) * UNIT);
        }
        if first.depth > 0.0 {
            self.depth += round_to_i64(f64::from(first.depth) / depth_unit.0);
            self.hits += 1;
        }
    }
}

fn square(x: i64) -> u128 {
    let x = u128::from(x.unsigned_abs());
    x * x
}

impl Layers {
    /// Means and variances of all pixels.
    pub(crate) fn develop(pixels: &[Pixel], sums: &[LayerSums], depth_unit: DepthUnit) -> Self {
        let both = || pixels.iter().zip(sums);
        let indirect = |(p, s): (&Pixel, &LayerSums)| {
            let (all, direct) = (p.sum(), s.direct);
            p.mean_of([all[0] - direct[0], all[1] - direct[1], all[2] - direct[2]])
        };
        let depth = |s: &LayerSums| match s.hits {
            0 => 0.0,
            n => (s.depth as f64 * depth_unit.0 / f64::from(n)) as f32,
        };
        Self {
            albedo: both().map(|(p, s)| p.mean_of(s.albedo)).collect(),
            normal: both().map(|(p, s)| p.mean_of(s.normal)).collect(),
            depth: sums.iter().map(depth).collect(),
            direct: both().map(|(p, s)| p.mean_of(s.direct)).collect(),
            indirect: both().map(indirect).collect(),
            variance: both().map(|(p, s)| variance(p, s)).collect(),
            sample_count: pixels.iter().map(Pixel::count).collect(),
        }
    }
}

/// (n·Σx² − (Σx)²)/(n²·(n − 1)): the difference is exact in integers. Dropped samples count as black, as in the mean.
fn variance(pixel: &Pixel, sums: &LayerSums) -> Option<[f32; 3]> {
    let n = pixel.count();
    if n < 2 {
        return None;
    }
    let spread = |channel: usize| {
        let difference = u128::from(n) * sums.squares[channel] - square(pixel.sum()[channel]);
        let n = f64::from(n);
        (difference as f64 / (UNIT * UNIT * n * n * (n - 1.0))) as f32
    };
    Some([spread(0), spread(1), spread(2)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sums_of(samples: &[([f32; 3], FirstHit)], unit: DepthUnit) -> (Pixel, LayerSums) {
        let (mut pixel, mut sums) = (Pixel::default(), LayerSums::default());
        for (i, (rgb, first)) in samples.iter().enumerate() {
            let place = (7, i as u32);
            if pixel.add(*rgb, place.0, place.1, true) {
                sums.add(*rgb, rgb.map(|x| 0.25 * x), first, unit, place);
            }
        }
        (pixel, sums)
    }

    #[test]
    fn the_variance_is_that_of_the_mean_even_on_a_bright_ground() {
        // 1000 ± 0.5: in f32, and in f64 as a difference of two sums, most digits would cancel.
        let samples: Vec<_> = (0..4096).map(|i| ([1000.0 + (i % 2) as f32; 3], FirstHit::default())).collect();
        let unit = DepthUnit::for_depths_up_to(1.0);
        let (pixel, sums) = sums_of(&samples, unit);
        let layers = Layers::develop(&[pixel], &[sums], unit);
        let expected = 0.25 * 4096.0 / 4095.0 / 4096.0; // s² = n/4/(n − 1)
        let got = f64::from(layers.variance.unwrap()[0][0]);
        assert!((got / expected - 1.0).abs() < 1e-5, "{got} and {expected}");
        let one = sums_of(&samples[..1], unit);
        assert!(Layers::develop(&[one.0], &[one.1], unit).variance.is_none());
    }

    #[test]
    fn direct_and_indirect_add_up_and_depth_is_a_mean_over_hits() {
        let first = FirstHit { albedo: [0.5, 0.25, 1.0], normal: [0.0, -1.0, 0.0], depth: 3e6 };
        let samples = [([4.0, 2.0, 1e-6], first), ([0.0; 3], FirstHit::default())];
        let unit = DepthUnit::for_depths_up_to(1e7);
        let (pixel, sums) = sums_of(&samples, unit);
        let layers = Layers::develop(&[pixel], &[sums], unit);
        assert_eq!(layers.depth, [3e6]);
        assert_eq!((layers.albedo[0], layers.normal[0]), ([0.25, 0.125, 0.5], [0.0, -0.5, 0.0]));
        assert_eq!((layers.direct[0][0], layers.indirect[0][0]), (0.5, 1.5));
        let whole = pixel.mean();
        for ((direct, indirect), whole) in layers.direct[0].into_iter().zip(layers.indirect[0]).zip(whole) {
            assert!((direct + indirect - whole).abs() <= 1e-6 * whole && indirect >= 0.0);
        }
        assert_eq!(layers.sample_count, [2]);
    }
}
