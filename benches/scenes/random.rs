//! Random numbers that repeat, and noise that is smooth between them.

use gonio_kernel::Vec3;

/// SplitMix64 (Steele, Lea & Flood 2014), as 24-bit numbers in [0, 1).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// The next number.
    pub(crate) fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / 16_777_216.0
    }
}

/// The number that belongs to a point of the lattice.
#[allow(dead_code, reason = "a bench that only needs random numbers includes this file alone")]
pub(crate) fn at_lattice([x, y, z]: [i32; 3]) -> f32 {
    let part = |n: i32, odd: u64| u64::from(n as u32).wrapping_mul(odd);
    Random(part(x, 0x8da6_b343) ^ part(y, 0xd816_3841_0001) ^ part(z, 0xcb1a_b31f_0000_0001)).next()
}

/// Several octaves of value noise (Perlin & Hoffert 1989 call the sum a fractal): each has twice the frequency of the one
/// before and half of its height. In [0, 2).
#[allow(dead_code, reason = "a bench that only needs random numbers includes this file alone")]
pub(crate) fn fractal(mut p: Vec3<f32>, octaves: u32) -> f32 {
    let (mut sum, mut height) = (0.0, 1.0);
    for _ in 0..octaves {
        sum += height * smooth(p);
        // The offset keeps the lattices of the octaves from sharing their points.
        (p, height) = (p * 2.0 + Vec3::new(17.3, 5.1, 11.7), height * 0.5);
    }
    sum
}

/// The lattice's numbers, interpolated with a slope of zero at its points. In [0, 1).
fn smooth(p: Vec3<f32>) -> f32 {
    let floor = [p.x, p.y, p.z].map(f32::floor);
    let [u, v, w] = [p.x - floor[0], p.y - floor[1], p.z - floor[2]].map(|t| t * t * (3.0 - 2.0 * t));
    let cell = floor.map(|x| x as i32);
    let at = |x, y, z| at_lattice([cell[0] + x, cell[1] + y, cell[2] + z]);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let along_x = |y, z| mix(at(0, y, z), at(1, y, z), u);
    mix(mix(along_x(0, 0), along_x(1, 0), v), mix(along_x(0, 1), along_x(1, 1), v), w)
}
