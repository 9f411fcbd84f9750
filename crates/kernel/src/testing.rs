//! What the unit tests share: repeatable random numbers, the numbers that break things, and comparisons.

mod builds;
mod equations;
mod mixed_lanes;
pub(crate) mod results;

#[allow(unused_imports)] // for the tests of lobes and closures
pub(crate) use mixed_lanes::MixedLanes;

use crate::lobe::{Lobe, Sample, Transport, Value};
use crate::real::Real;
use crate::vec3::Vec3;
use std::vec::Vec;

/// SplitMix64 (Steele, Lea & Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// In [0, 1), a multiple of 2⁻²⁴.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / 16_777_216.0
    }
    /// Uniform over the sphere.
    pub(crate) fn direction(&mut self) -> Vec3<f32> {
        crate::warp::sample_uniform_sphere([self.unit(), self.unit()])
    }
    /// Uniform over the upper hemisphere.
    pub(crate) fn above(&mut self) -> Vec3<f32> {
        let w = self.direction();
        Vec3::new(w.x, w.y, w.z.abs())
    }
}

/// Zeros, denormals, extremes, infinities and NaN, each with both signs.
pub(crate) fn special_values() -> Vec<f32> {
    let positive = [0.0, 1e-45, 1e-40, f32::MIN_POSITIVE, 0.5, 1.0 - f32::EPSILON / 2.0, 1.0, 1.5, 3e9, f32::MAX];
    let positive = positive.into_iter().chain([f32::INFINITY, f32::NAN]);
    positive.flat_map(|x| [x, -x]).collect()
}

/// The same bits, or both NaN.
pub(crate) fn same_bits(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// |a − b| ≤ tolerance, false for NaN.
pub(crate) fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

/// A lobe without a closure, for radiance, prepared anew for each call.
pub(crate) trait Bare<R: Real>: Lobe<R> {
    fn value(&self, wo: Vec3<R>, wi: Vec3<R>) -> Value<R> {
        self.eval(wo, &self.prepare(wo, Transport::Radiance), wi)
    }
    fn draw(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R> {
        self.sample(wo, &self.prepare(wo, Transport::Radiance), u)
    }
    fn delta_of(&self, wo: Vec3<R>, sample: &Sample<R>) -> Value<R> {
        self.delta(wo, &self.prepare(wo, Transport::Radiance), sample)
    }
}
impl<R: Real, L: Lobe<R>> Bare<R> for L {}
