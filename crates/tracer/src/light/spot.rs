//! A spot light: a point that shines into a cone with a soft edge.
//!
//! Within `beam_width` of the axis the intensity is I; from there it falls linearly with the angle to 0 at `cutoff_angle`, as
//! Mitsuba's `spot` does. Both are measured from the axis. The flux, with beam b and cutoff c, is
//! Φ = 2πI·(1 − (sin c − sin b)/(c − b)), or 2πI·(1 − cos c) if the edge is sharp.

use super::delta::{Bounds, Light, LightSource};
use super::sample::{LightSample, Reference};
use crate::effects::{Effect, EffectSet};
use crate::scene::MAX_INTENSITY;
use crate::scene::fields::{Fields, Refusal};
use glam::DVec3;
use gonio_kernel::math::atan2_turns;
use gonio_kernel::{F32x8, Real, Rgb, Vec3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A spot light: E = I cosθ/d² within the beam, less towards the edge, nothing outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotLight {
    /// Where it is \[m\].
    pub position: DVec3,
    /// A point that it shines at, on its axis \[m\]; not `position`.
    pub target: DVec3,
    /// Intensity on the axis \[W/sr\], linear Rec. 709, from 0 to 10¹².
    pub intensity: Rgb<f32>,
    /// From the axis to where it is dark, in degrees, above 0 and at most 180.
    pub cutoff_angle: f64,
    /// From the axis to where it begins to fall off, in degrees, from 0 to `cutoff_angle`.
    pub beam_width: f64,
}

impl SpotLight {
    /// What `[[lights]]` says of it.
    pub(super) fn read(fields: &mut dyn Fields) -> Result<Arc<dyn LightSource>, Refusal> {
        let position = fields.required_vector("position")?;
        let target = fields.required_vector("target")?;
        let intensity = fields.required_color("intensity", 0.0..=MAX_INTENSITY)?;
        let cutoff_angle = fields.number("cutoff_angle", 0.01..=180.0)?.unwrap_or(20.0);
        let beam_width = fields.number("beam_width", 0.0..=180.0)?.unwrap_or(0.75 * cutoff_angle);
        let light = Self { position, target, intensity, cutoff_angle, beam_width };
        match light.fault() {
            Some((key, why)) => Err(fields.refuse(key, why.to_owned())),
            None => Ok(Arc::new(light)),
        }
    }

    /// The flux \[W\] by channel, over the whole cone.
    pub fn flux(&self) -> Rgb<f64> {
        let (b, c) = (self.beam_width.to_radians(), self.cutoff_angle.to_radians());
        let mean_cos = if c - b > 1e-6 { (c.sin() - b.sin()) / (c - b) } else { c.cos() };
        self.intensity.map(f64::from) * (TAU * (1.0 - mean_cos))
    }

    /// What is wrong with it, by key.
    fn fault(&self) -> Option<(&'static str, &'static str)> {
        if self.beam_width > self.cutoff_angle {
            return Some(("beam_width", "\"beam_width\" is at most \"cutoff_angle\""));
        }
        (self.target - self.position)
            .try_normalize()
            .is_none()
            .then_some(("target", "\"target\" is where the light is"))
    }
}

impl LightSource for SpotLight {
    fn prepare(&self, bounds: &Bounds) -> Result<Arc<dyn Light>, String> {
        match self.fault() {
            Some((_, why)) => Err(why.to_owned()),
            None => Ok(Arc::new(Prepared {
                position: bounds.to_world(self.position),
                axis: (self.target - self.position).normalize().as_vec3().to_array().into(),
                intensity: self.intensity,
                cutoff: (self.cutoff_angle / 360.0) as f32,
                per_turn: (360.0 / (self.cutoff_angle - self.beam_width).max(1e-6)) as f32,
                power: self.flux().luminance(),
            })),
        }
    }
    fn effects(&self) -> EffectSet {
        EffectSet::of(Effect::SpotLights)
    }
}

#[derive(Clone, Copy, Debug)]
struct Prepared {
    position: Vec3<f32>,
    /// Unit.
    axis: Vec3<f32>,
    intensity: Rgb<f32>,
    /// In turns.
    cutoff: f32,
    /// How fast the intensity rises inwards from the cutoff, per turn.
    per_turn: f32,
    power: f64,
}

impl Light for Prepared {
    fn sample(&self, at: &Reference, _u: [F32x8; 2]) -> LightSample {
        LightSample::of_point(at, self.position, |away| {
            let axis = Vec3::broadcast(self.axis);
            let angle = atan2_turns(axis.cross(away).length(), axis.dot(away));
            let rise = (F32x8::splat(self.cutoff) - angle) * F32x8::splat(self.per_turn);
            Rgb::broadcast(self.intensity) * rise.clamp(0.0, 1.0)
        })
    }
    fn power(&self) -> f64 {
        self.power
    }
    fn numbers(&self) -> Vec<f32> {
        let vectors = [<[f32; 3]>::from(self.position), self.axis.into(), self.intensity.into()].concat();
        [vectors, vec![self.cutoff, self.per_turn]].concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flux_is_the_integral_of_the_intensity() {
        for (cutoff_angle, beam_width) in [(20.0, 15.0), (60.0, 0.0), (180.0, 180.0), (90.0, 45.0)] {
            let light = SpotLight {
                position: DVec3::ZERO,
                target: DVec3::X,
                intensity: Rgb::splat(2.0),
                cutoff_angle,
                beam_width,
            };
            // The midpoint rule over the angle from the axis.
            let (n, c) = (100_000, f64::to_radians(cutoff_angle));
            let sum: f64 = (0..n)
                .map(|i| {
                    let theta = (f64::from(i) + 0.5) / f64::from(n) * c;
                    let fall = (c - theta) / (c - f64::to_radians(beam_width)).max(1e-9);
                    2.0 * fall.clamp(0.0, 1.0) * theta.sin() * TAU * c / f64::from(n)
                })
                .sum();
            assert!((light.flux().g / sum - 1.0).abs() < 1e-6, "{cutoff_angle} {beam_width}: {} {sum}", light.flux().g);
        }
    }
}
