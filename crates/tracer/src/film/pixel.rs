//! The film: sums of samples that do not depend on the order in which they arrive.
//!
//! Each channel is summed as a 64-bit integer in units of 2⁻²². A sample must be finite and below 2²¹ in magnitude, and a
//! pixel takes at most 2²⁰ samples, so a sum stays below 2⁶³ and integer addition stays associative: no saturation, which
//! would depend on the order. Rounding to the unit is dithered by a hash of (pixel, sample), because plain truncation
//! loses half a unit per sample: 10 % at radiance 1e-6. What is not finite or too large is dropped and counted.

use crate::fingerprint::Fingerprint;
use crate::sampler::hash2;

/// Units per 1.0 of radiance.
pub(crate) const UNIT: f64 = (1_u64 << 22) as f64;
/// Samples must be smaller than this in magnitude.
const LARGEST: f32 = (1_u32 << 21) as f32;

/// The sums of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Pixel {
    sum: [i64; 3],
    count: u32,
    dropped: u32,
    /// Samples whose camera ray met a surface.
    met: u32,
}

impl Pixel {
    /// Adds a sample; `pixel` and `sample` address its dither, `met` says whether its camera ray met a surface. Whether it
    /// counts, or was dropped.
    #[inline]
    pub(crate) fn add(&mut self, rgb: [f32; 3], pixel: u32, sample: u32, met: bool) -> bool {
        self.count += 1;
        self.met += u32::from(met);
        // A NaN fails the comparison.
        let counts = rgb.iter().all(|x| x.abs() < LARGEST);
        if counts {
            let dither = Dither::of(pixel, sample);
            for (sum, x) in self.sum.iter_mut().zip(rgb) {
                *sum += dither.units(x);
            }
        } else {
            self.dropped += 1;
        }
        counts
    }

    /// The mean of the samples, dropped ones counting as black; black if there are none.
    pub(crate) fn mean(&self) -> [f32; 3] {
        self.mean_of(self.sum)
    }

    /// The mean over this pixel's samples of a sum of [`Dither::units`].
    pub(crate) fn mean_of(&self, sum: [i64; 3]) -> [f32; 3] {
        let scale = if self.count > 0 { 1.0 / (UNIT * f64::from(self.count)) } else { 0.0 };
        sum.map(|s| (s as f64 * scale) as f32)
    }

    /// The share of the samples whose camera ray met a surface; 0 if there are none.
    pub(crate) fn alpha(&self) -> f32 {
        if self.count > 0 { (f64::from(self.met) / f64::from(self.count)) as f32 } else { 0.0 }
    }

    /// Σx over the samples, in units.
    pub(crate) fn sum(&self) -> [i64; 3] {
        self.sum
    }

    /// How many samples there are, dropped ones included.
    pub(crate) fn count(&self) -> u32 {
        self.count
    }

    /// How many samples were not finite or too large.
    pub(crate) fn dropped(&self) -> u32 {
        self.dropped
    }
}

/// How a sample is rounded: the same for all its values, so that what is no larger stays no larger.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dither(f64);

impl Dither {
    /// That of a sample, in [−0.5, 0.5).
    #[inline]
    pub(crate) fn of(pixel: u32, sample: u32) -> Self {
        Self(f64::from(hash2(pixel, sample)) / 4_294_967_296.0 - 0.5)
    }

    /// A radiance in units.
    #[inline]
    pub(crate) fn units(self, x: f32) -> i64 {
        round_to_i64(f64::from(x).mul_add(UNIT, self.0))
    }
}

/// The nearest integer of |x| < 2⁵¹: adding 1.5·2⁵² leaves it in the low bits, with no cast that could hide a NaN.
pub(crate) fn round_to_i64(x: f64) -> i64 {
    const MAGIC: f64 = 6_755_399_441_055_744.0;
    (x + MAGIC).to_bits().wrapping_sub(MAGIC.to_bits()).cast_signed()
}

/// A hash of the radiance's sums and of the counts, in pixel order: equal pictures have equal hashes, to the last bit.
pub(crate) fn hash<'a>(pixels: impl Iterator<Item = &'a Pixel>) -> String {
    let mut fingerprint = Fingerprint::new();
    for p in pixels {
        p.sum.iter().for_each(|s| fingerprint.bytes(&s.to_le_bytes()));
        fingerprint.bytes(&(u64::from(p.count) << 32 | u64::from(p.dropped)).to_le_bytes());
    }
    fingerprint.text()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_do_not_depend_on_the_order() {
        let samples: Vec<[f32; 3]> = (0..1000).map(|i| [0.1 * i as f32, 1e-6 * i as f32, 2e6 - i as f32]).collect();
        let (mut forward, mut backward) = (Pixel::default(), Pixel::default());
        for (i, s) in samples.iter().enumerate() {
            forward.add(*s, 9, i as u32, i % 2 == 0);
        }
        for (i, s) in samples.iter().enumerate().rev() {
            backward.add(*s, 9, i as u32, i % 2 == 0);
        }
        assert_eq!(forward, backward);
    }

    #[test]
    fn the_mean_of_faint_samples_is_not_biased() {
        // 1e-6 is about four units; rounding noise of n samples has a standard error of half a unit over √n.
        let n = 200_000;
        let mut p = Pixel::default();
        assert!((0..n).all(|i| p.add([1e-6; 3], 1, i, true)));
        assert!((f64::from(p.mean()[0]) - 1e-6).abs() < 5.0 * 0.5 / UNIT / f64::from(n).sqrt());
    }

    #[test]
    fn what_is_not_finite_or_too_large_is_dropped_and_counted() {
        let mut p = Pixel::default();
        for x in [f32::NAN, f32::INFINITY, -f32::INFINITY, LARGEST] {
            assert!(!p.add([x, 0.0, 0.0], 0, 0, false));
        }
        assert!(p.add([4.0, 0.0, LARGEST.next_down()], 0, 0, true));
        assert_eq!(p.dropped(), 4);
        assert_eq!(p.alpha(), 0.2);
        assert!((p.mean()[0] - 0.8).abs() < 1e-6);
    }
}
