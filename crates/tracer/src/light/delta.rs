//! Lights that no ray meets: delta lights, and whatever a user adds. Only light samples find them, so their weight is 1.
//!
//! Half of their samples are shared out by power, half evenly: power says nothing of distance, and a weak lamp near a surface
//! must not be starved by a bright sun.
//!
//! A new kind is a type with [`LightSource`], which describes it in the scene, and one with [`Light`], which is sampled.

use super::sample::{LightSample, Reference};
use crate::alias::{alias_table, pick};
use crate::effects::EffectSet;
use crate::fingerprint::Fingerprint;
use glam::DVec3;
use gonio_kernel::{F32x8, Mask8, U32x8, Vec3, each_lane};
use std::fmt::Debug;
use std::sync::Arc;

/// Where a world lies in its scene.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// What the scene's coordinates of the world's origin are \[m\].
    pub center: DVec3,
    /// No corner of a triangle is farther from it \[m\].
    pub radius: f64,
}

impl Bounds {
    /// A point of the scene in the coordinates of the world.
    pub fn to_world(&self, p: DVec3) -> Vec3<f32> {
        (p - self.center).as_vec3().to_array().into()
    }
}

/// A light as a scene describes it.
pub trait LightSource: Debug + Send + Sync {
    /// The light in a world.
    ///
    /// # Errors
    /// A sentence that says what is wrong with it.
    fn prepare(&self, bounds: &Bounds) -> Result<Arc<dyn Light>, String>;

    /// Which effects it calls for.
    fn effects(&self) -> EffectSet;
}

/// A light of a world that no ray meets.
pub trait Light: Debug + Send + Sync {
    /// One sample at each of eight points; `u` are numbers in [0, 1).
    fn sample(&self, at: &Reference, u: [F32x8; 2]) -> LightSample;

    /// About how much light it sends into the world, finite and positive \[W\], by luminance: its share of the samples.
    fn power(&self) -> f64;

    /// All numbers that it depends on, for the fingerprint of the world.
    fn numbers(&self) -> Vec<f32>;
}

/// All such lights of a world.
#[derive(Clone, Debug, Default)]
pub(crate) struct DeltaLights {
    lights: Vec<Arc<dyn Light>>,
    alias: Vec<(f32, u32)>,
    /// Each one's share of their samples, and once the share of all is set, of all light samples.
    probability: Vec<f32>,
}

impl DeltaLights {
    /// Lights of positive power; the others are left out.
    pub(crate) fn new(mut lights: Vec<Arc<dyn Light>>) -> Self {
        lights.retain(|light| light.power() > 0.0);
        let sum: f64 = lights.iter().map(|light| light.power()).sum();
        let even = 1.0 / lights.len() as f64;
        let shares: Vec<f64> = lights.iter().map(|light| 0.5 * (light.power() / sum + even)).collect();
        let probability = shares.iter().map(|&share| share as f32).collect();
        Self { alias: alias_table(&shares), lights, probability }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// Says which share of all light samples is theirs.
    pub(crate) fn set_share(&mut self, share: f32) {
        self.probability.iter_mut().for_each(|p| *p *= share);
    }

    /// A sample of the light that each of the wanted lanes chooses: `slot` is a random word, the rest are numbers in [0, 1).
    pub(crate) fn sample(
        &self,
        at: &Reference,
        wanted: Mask8,
        slot: U32x8,
        u_select: F32x8,
        u: [F32x8; 2],
    ) -> LightSample {
        let chosen = each_lane(|lane| pick(&self.alias, slot.lane(lane), u_select.lane(lane)));
        let mut sample = LightSample::none();
        let mut open = wanted.to_bits();
        while open != 0 {
            let light = chosen[open.trailing_zeros() as usize % F32x8::LANES];
            let lanes = (0..F32x8::LANES).fold(0, |bits, l| bits | u32::from(chosen[l] == light) << l);
            let of = self.lights[light].sample(at, u);
            let pdf = of.pdf * F32x8::splat(self.probability[light]);
            sample = LightSample::select(Mask8::from_bits(lanes), LightSample { pdf, ..of }, sample);
            open &= !lanes;
        }
        sample
    }

    /// Takes them into a fingerprint.
    pub(crate) fn describe(&self, print: &mut Fingerprint) {
        self.lights.iter().for_each(|light| print.numbers(light.numbers()));
    }
}
