//! Vectors and colours of eight lanes: one per lane, put together and taken apart.

use super::F32x8;
use crate::rgb::Rgb;
use crate::vec3::Vec3;

impl Vec3<F32x8> {
    /// The same vector in every lane.
    #[inline(always)]
    pub fn broadcast(v: Vec3<f32>) -> Self {
        Self::new(F32x8::splat(v.x), F32x8::splat(v.y), F32x8::splat(v.z))
    }
    /// Lane `lane` modulo 8.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Vec3<f32> {
        Vec3::new(self.x.lane(lane), self.y.lane(lane), self.z.lane(lane))
    }
    /// Lane `lane` modulo 8, in every lane.
    #[inline(always)]
    pub fn splat_lane(&self, lane: usize) -> Self {
        Self::broadcast(self.lane(lane))
    }
    /// Lane *i* is `f(i)`; `f` is asked once per component and lane.
    #[inline(always)]
    pub fn from_lanes(f: impl Fn(usize) -> Vec3<f32>) -> Self {
        Self::new(F32x8::from_fn(|i| f(i).x), F32x8::from_fn(|i| f(i).y), F32x8::from_fn(|i| f(i).z))
    }
}

/// ```
/// use gonio_kernel::{Real, Rgb};
/// let greys = Rgb::from_lanes(|i| Rgb::splat(i as f32));
/// assert_eq!((greys.g + Rgb::broadcast(Rgb::splat(1.0)).g).lane(3), 4.0);
/// ```
impl Rgb<F32x8> {
    /// The same colour in every lane.
    #[inline(always)]
    pub fn broadcast(c: Rgb<f32>) -> Self {
        c.map(F32x8::splat)
    }
    /// Lane *i* is `f(i)`; `f` is asked once per channel and lane.
    #[inline(always)]
    pub fn from_lanes(f: impl Fn(usize) -> Rgb<f32>) -> Self {
        Self::new(F32x8::from_fn(|i| f(i).r), F32x8::from_fn(|i| f(i).g), F32x8::from_fn(|i| f(i).b))
    }
}
