//! A point light: the same intensity in all directions from one point.

use super::delta::{Bounds, Light, LightSource};
use super::sample::{LightSample, Reference};
use crate::effects::{Effect, EffectSet};
use crate::scene::MAX_INTENSITY;
use crate::scene::fields::{Fields, Refusal};
use glam::DVec3;
use gonio_kernel::{F32x8, Rgb, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// A point light: E = I cosθ/d² at a distance d.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Where it is \[m\].
    pub position: DVec3,
    /// Intensity in every direction \[W/sr\], linear Rec. 709, from 0 to 10¹².
    pub intensity: Rgb<f32>,
}

impl PointLight {
    /// What `[[lights]]` says of it.
    pub(super) fn read(fields: &mut dyn Fields) -> Result<Arc<dyn LightSource>, Refusal> {
        let position = fields.required_vector("position")?;
        let intensity = fields.required_color("intensity", 0.0..=MAX_INTENSITY)?;
        Ok(Arc::new(Self { position, intensity }))
    }
}

impl LightSource for PointLight {
    fn prepare(&self, bounds: &Bounds) -> Result<Arc<dyn Light>, String> {
        Ok(Arc::new(Prepared { position: bounds.to_world(self.position), intensity: self.intensity }))
    }
    fn effects(&self) -> EffectSet {
        EffectSet::of(Effect::PointLights)
    }
}

#[derive(Clone, Copy, Debug)]
struct Prepared {
    position: Vec3<f32>,
    intensity: Rgb<f32>,
}

impl Light for Prepared {
    fn sample(&self, at: &Reference, _u: [F32x8; 2]) -> LightSample {
        LightSample::of_point(at, self.position, |_| Rgb::broadcast(self.intensity))
    }
    fn power(&self) -> f64 {
        4.0 * PI * f64::from(self.intensity.luminance())
    }
    fn numbers(&self) -> Vec<f32> {
        [<[f32; 3]>::from(self.position), self.intensity.into()].concat()
    }
}
