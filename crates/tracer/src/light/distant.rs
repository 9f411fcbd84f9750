//! A distant light: parallel rays, as from the sun without its disk.

use super::delta::{Bounds, Light, LightSource};
use super::sample::{LightSample, Reference};
use crate::effects::{Effect, EffectSet};
use crate::scene::MAX_INTENSITY;
use crate::scene::fields::{Fields, Refusal};
use glam::DVec3;
use gonio_kernel::{F32x8, Mask, Mask8, Real, Rgb, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// A distant light: E = irradiance · cosθ everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistantLight {
    /// In which direction its light travels; any length above 0.
    pub direction: DVec3,
    /// Irradiance of a surface that faces it \[W/m²\], linear Rec. 709, from 0 to 10¹².
    pub irradiance: Rgb<f32>,
}

impl DistantLight {
    /// What `[[lights]]` says of it.
    pub(super) fn read(fields: &mut dyn Fields) -> Result<Arc<dyn LightSource>, Refusal> {
        let direction = fields.required_vector("direction")?;
        let irradiance = fields.required_color("irradiance", 0.0..=MAX_INTENSITY)?;
        if direction.try_normalize().is_none() {
            return Err(fields.refuse("direction", NO_DIRECTION.to_owned()));
        }
        Ok(Arc::new(Self { direction, irradiance }))
    }
}

const NO_DIRECTION: &str = "\"direction\" has no length";

impl LightSource for DistantLight {
    fn prepare(&self, bounds: &Bounds) -> Result<Arc<dyn Light>, String> {
        let direction = self.direction.try_normalize().ok_or(NO_DIRECTION)?;
        // What falls on the disk that the world is seen as from there.
        let power = f64::from(self.irradiance.luminance()) * PI * bounds.radius.powi(2);
        Ok(Arc::new(Prepared { wi: (-direction).as_vec3().to_array().into(), irradiance: self.irradiance, power }))
    }
    fn effects(&self) -> EffectSet {
        EffectSet::of(Effect::DistantLights)
    }
}

#[derive(Clone, Copy, Debug)]
struct Prepared {
    /// Towards the light, unit.
    wi: Vec3<f32>,
    irradiance: Rgb<f32>,
    power: f64,
}

impl Light for Prepared {
    fn sample(&self, _at: &Reference, _u: [F32x8; 2]) -> LightSample {
        LightSample {
            wi: Vec3::broadcast(self.wi),
            pdf: F32x8::ONE,
            radiance: Rgb::broadcast(self.irradiance),
            distance: F32x8::splat(f32::INFINITY),
            possible: Mask8::splat(true),
        }
    }
    fn power(&self) -> f64 {
        self.power
    }
    fn numbers(&self) -> Vec<f32> {
        [<[f32; 3]>::from(self.wi), self.irradiance.into()].concat()
    }
}
