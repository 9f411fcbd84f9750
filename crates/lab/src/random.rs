//! Random numbers for the instruments, by address.
//!
//! [`unit()`] and [`bits`] hash (seed, index, dimension) with no state in between, so that row *i* of a table depends on the seed and *i*
//! alone: asking for more rows never changes those before. Inside of this crate there is one independent stream per test besides,
//! addressed by seed and name.
//!
//! SplitMix64 (Steele, Lea & Flood 2014): a counter through a 64-bit mixer. A stream depends only on the run's seed and
//! the test's name, so neither the order of tests nor the number of threads can change a result.

use gonio_kernel::Vec3;

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// 64 random bits: the finaliser of SplitMix64, once per counter.
pub fn bits(seed: u64, index: u64, dimension: u64) -> u64 {
    let at = mix(mix(seed.wrapping_add(GOLDEN)) ^ index.wrapping_mul(GOLDEN).wrapping_add(1));
    mix(at.wrapping_add(dimension.wrapping_add(1).wrapping_mul(GOLDEN)))
}

/// Uniform in [0, 1), a multiple of 2⁻²⁴: exact in `f32` and in `f64`, so every precision sees the same numbers.
pub fn unit(seed: u64, index: u64, dimension: u64) -> f64 {
    (bits(seed, index, dimension) >> 40) as f64 / 16_777_216.0
}

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub(crate) struct Random {
    state: u64,
}

impl Random {
    /// The stream of a seed.
    pub(crate) fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next 64 bits.
    pub(crate) fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(GOLDEN);
        mix(self.state)
    }

    /// Uniform in [0, 1), a multiple of 2⁻²⁴: every value is exact in `f32` too.
    pub(crate) fn coarse(&mut self) -> f64 {
        (self.bits() >> 40) as f64 * 2.0_f64.powi(-24)
    }

    /// Uniform in [0, 1), a multiple of 2⁻⁵³.
    pub(crate) fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * 2.0_f64.powi(-53)
    }

    /// Three numbers for a sampler: on the lattice of `f32` if its arithmetic is `f32`.
    pub(crate) fn sampler_input(&mut self, single: bool) -> [f64; 3] {
        if single {
            // One draw serves two numbers: half the cost, and the streams that tests use are long.
            let bits = self.bits();
            let unit = 2.0_f64.powi(-24);
            [(bits >> 40) as f64 * unit, ((bits >> 16) & 0xff_ffff) as f64 * unit, self.coarse()]
        } else {
            [self.uniform(), self.uniform(), self.uniform()]
        }
    }

    /// Uniform in [lo, hi).
    pub(crate) fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.uniform()
    }

    /// Uniform in the logarithm.
    pub(crate) fn log_between(&mut self, lo: f64, hi: f64) -> f64 {
        (self.between(lo.ln(), hi.ln())).exp().clamp(lo, hi)
    }

    /// One of the items.
    pub(crate) fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[(self.bits() % items.len() as u64) as usize]
    }

    /// A uniform direction of the upper hemisphere.
    pub(crate) fn above(&mut self) -> Vec3<f64> {
        direction(1.0 - self.uniform(), self.between(0.0, std::f64::consts::TAU))
    }
}

/// The direction of the given cosine and azimuth.
pub(crate) fn direction(cos: f64, phi: f64) -> Vec3<f64> {
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
}

/// A seed from a seed and a name, so that tests of one run do not share numbers. FNV-1a, then mixed.
pub fn seed_for(seed: u64, name: &str) -> u64 {
    let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3));
    mix(hash ^ mix(seed))
}

fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_uniform_and_neighbours_are_uncorrelated() {
        let n = 100_000_u64;
        for neighbour in [|i| (i + 1, 0), |i| (i, 1)] {
            let (mut sum, mut product) = (0.0, 0.0);
            for i in 0..n {
                let (j, dimension) = neighbour(i);
                let (a, b) = (unit(5, i, 0) - 0.5, unit(5, j, dimension) - 0.5);
                sum += a;
                product += a * b;
            }
            // Standard errors √(n/12) and √n/12; five of them.
            assert!(sum.abs() < 5.0 * (n as f64 / 12.0).sqrt());
            assert!(product.abs() < 5.0 * (n as f64).sqrt() / 12.0);
        }
    }
}
