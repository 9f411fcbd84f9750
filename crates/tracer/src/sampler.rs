//! Random numbers by address: (pixel, sample, dimension) → number, with nothing in between.
//!
//! A counter-based generator has no state, so threads, tiles, crops and the order of work cannot change a number. The hash
//! is PCG4D of Jarzynski & Olano 2020, "Hash Functions for GPU Rendering": four 32-bit counters to four numbers.
//!
//! The dimension table is fixed and covers all effects, used or not: that an effect is absent never moves another one's
//! numbers. A block is four numbers.
//!
//! | block | purpose |
//! |---|---|
//! | 0 | camera: place in the pixel (2), lens (2) |
//! | 1 | camera: time (1), free (3) |
//! | 8 + 8·bounce + 0 | scattering: choice of lobe (1), direction (2), Russian roulette (1) |
//! | 8 + 8·bounce + 1 | light: strategy and emitter (2), place (2); for an environment map strategy (1), alias (2) |
//! | 8 + 8·bounce + 2 | environment map: row and cell (2), place (2) |
//! | 8 + 8·bounce + 3 … 7 | free |

use gonio_kernel::{F32x8, U32x8};

/// What four random numbers are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// Where in the pixel and on the lens a path starts.
    Camera,
    /// How a path scatters, and whether it goes on.
    Scatter,
    /// Which point of which light is asked.
    Light,
    /// Which direction of an environment map is asked.
    Environment,
}

/// The numbers of one seed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sampler {
    seed: [u32; 2],
}

/// Four random numbers for each of eight paths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Random4(pub(crate) [U32x8; 4]);

impl Sampler {
    /// The generator of a seed.
    pub(crate) fn new(seed: u64) -> Self {
        Self { seed: [seed as u32, (seed >> 32) as u32] }
    }

    /// Four numbers for each of eight paths, addressed by pixel (x + 65536·y), sample, bounce and purpose.
    #[inline(always)]
    pub(crate) fn draw(&self, pixel: U32x8, sample: U32x8, bounce: u32, purpose: Purpose) -> Random4 {
        let block = match purpose {
            Purpose::Camera => 0,
            Purpose::Scatter => 8 + 8 * bounce,
            Purpose::Light => 9 + 8 * bounce,
            Purpose::Environment => 10 + 8 * bounce,
        };
        // The high half of the seed moves the sample counter by a hash of itself, so that every seed is its own sequence.
        let shift = self.seed[1].wrapping_mul(0x9e37_79b9) ^ (self.seed[1] >> 15);
        Random4(pcg4d([pixel, sample ^ U32x8::splat(shift), U32x8::splat(block), U32x8::splat(self.seed[0])]))
    }
}

impl Random4 {
    /// The i-th number as a real in [0, 1 − 2⁻²⁴].
    #[inline(always)]
    pub(crate) fn unit(&self, i: usize) -> F32x8 {
        (self.0[i] >> 8).to_real() * F32x8::splat(1.0 / 16_777_216.0)
    }
}

#[inline(always)]
fn pcg4d(v: [U32x8; 4]) -> [U32x8; 4] {
    let [mut x, mut y, mut z, mut w] = v.map(|c| c * U32x8::splat(1_664_525) + U32x8::splat(1_013_904_223));
    let mix = |x: &mut U32x8, y: &mut U32x8, z: &mut U32x8, w: &mut U32x8| {
        *x = *x + *y * *w;
        *y = *y + *z * *x;
        *z = *z + *x * *y;
        *w = *w + *y * *z;
    };
    mix(&mut x, &mut y, &mut z, &mut w);
    [x, y, z, w] = [x, y, z, w].map(|c| c ^ (c >> 16));
    mix(&mut x, &mut y, &mut z, &mut w);
    [x, y, z, w]
}

/// A hash of two counters: the dither of the film.
pub(crate) fn hash2(a: u32, b: u32) -> u32 {
    // Two rounds of the finaliser of MurmurHash3 (Appleby), which is a bijection of 32 bits.
    let finalize = |mut h: u32| {
        h ^= h >> 16;
        h = h.wrapping_mul(0x85eb_ca6b);
        h ^= h >> 13;
        h = h.wrapping_mul(0xc2b2_ae35);
        h ^ (h >> 16)
    };
    finalize(finalize(a).wrapping_add(b).wrapping_mul(0x9e37_79b9))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_kernel::Real;

    #[test]
    fn numbers_are_uniform_and_uncorrelated_across_every_counter() {
        let sampler = Sampler::new(7);
        let n = 1 << 15;
        let mut sums = [0.0_f64; 4];
        let mut products = [0.0_f64; 4];
        for i in 0..n / 8 {
            let lane = U32x8::new(std::array::from_fn(|l| (i * 8 + l) as u32));
            for (k, (pixel, sample, bounce)) in
                [(lane, U32x8::splat(3), 0), (U32x8::splat(5), lane, 1), (lane, lane, 2)].into_iter().enumerate()
            {
                let r = sampler.draw(pixel, sample, bounce, Purpose::Scatter);
                let [a, b] = [r.unit(0).to_array(), r.unit(1).to_array()];
                for l in 0..8 {
                    assert!((0.0..1.0).contains(&a[l]));
                    sums[k] += f64::from(a[l]) - 0.5;
                    products[k] += (f64::from(a[l]) - 0.5) * (f64::from(b[l]) - 0.5);
                }
            }
        }
        // Standard errors: √(n/12) and √n/12; five of them is one in two million.
        let n = n as f64;
        assert!(sums.iter().all(|s| s.abs() < 5.0 * (n / 12.0).sqrt()), "{sums:?}");
        assert!(products.iter().all(|p| p.abs() < 5.0 * n.sqrt() / 12.0), "{products:?}");
    }

    #[test]
    fn the_largest_number_is_below_one() {
        let all = Random4([U32x8::splat(u32::MAX); 4]);
        assert!(all.unit(0).lt(F32x8::ONE).to_bits() == 0xff);
    }
}
