//! Random numbers by address: (seed, index, dimension) → 64 bits, with no state in between.
//!
//! So row *i* of a table depends on the seed and *i* alone: asking for more rows never changes those before. The hash is the
//! finaliser of SplitMix64 (Steele, Lea & Flood 2014), once per counter.

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// 64 random bits.
pub(crate) fn bits(seed: u64, index: u64, dimension: u64) -> u64 {
    let at = mix(mix(seed.wrapping_add(GOLDEN)) ^ index.wrapping_mul(GOLDEN).wrapping_add(1));
    mix(at.wrapping_add(dimension.wrapping_add(1).wrapping_mul(GOLDEN)))
}

/// Uniform in [0, 1), a multiple of 2⁻²⁴: exact in `f32` and in `f64`, so every precision sees the same numbers.
pub(crate) fn unit(seed: u64, index: u64, dimension: u64) -> f64 {
    (bits(seed, index, dimension) >> 40) as f64 / 16_777_216.0
}

/// A seed for a name, so that tests of one run do not share numbers. FNV-1a, then mixed.
pub(crate) fn seed_for(seed: u64, name: &str) -> u64 {
    let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3));
    mix(hash ^ mix(seed))
}

/// A seed that nobody chose, from the clock and the process.
pub(crate) fn fresh_seed() -> u64 {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).map_or(0, |d| d.as_nanos() as u64);
    // Short enough to be typed again.
    mix(now ^ u64::from(std::process::id())) >> 32
}

/// Reads a seed from the command line.
pub(crate) fn seed(text: &str) -> Result<u64, String> {
    if text == "random" {
        return Ok(fresh_seed());
    }
    text.parse().map_err(|_| "a seed is a number from 0 to 2^64 - 1, or \"random\"".to_owned())
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
