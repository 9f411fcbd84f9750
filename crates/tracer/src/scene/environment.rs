//! Light from infinitely far away, the same from everywhere or a picture by latitude and longitude.

use std::sync::Arc;

use gonio_kernel::Rgb;

use crate::effects::{Effect, EffectSet};
use crate::picture::Picture;

/// Light from infinitely far away, and who sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// What is there.
    pub sky: Sky,
    /// Whether camera rays that meet nothing see it; otherwise they see black.
    pub camera_visible: bool,
    /// Whether it lights the scene; otherwise only the camera sees it.
    pub illuminates: bool,
}

/// Radiance by direction.
#[derive(Clone, Debug, PartialEq)]
pub enum Sky {
    /// The same from everywhere, linear Rec. 709, at least 0; 0 means there is none.
    Constant(Rgb<f32>),
    /// A picture.
    Map(SkyMap),
}

/// A picture of the whole sphere by latitude and longitude. The top row is +y; at rotation 0 the centre column is +z, and
/// columns run from −z by +x to +z and by −x back, as in Mitsuba 3.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyMap {
    /// Radiance, finite and at least 0; at most 10⁶ when multiplied by the intensity.
    pub picture: Arc<Picture>,
    /// Degrees about +y by the right hand: 90 brings the centre column to +x.
    pub rotation: f64,
    /// Factor on the radiance, at least 0.
    pub intensity: f32,
}

impl Environment {
    /// The same radiance from everywhere.
    pub fn constant(radiance: Rgb<f32>) -> Self {
        Self { sky: Sky::Constant(radiance), camera_visible: true, illuminates: true }
    }

    /// What it calls for.
    pub(crate) fn effects(&self) -> EffectSet {
        EffectSet::when(!self.is_dark() && (self.camera_visible || self.illuminates), Effect::Environment)
    }

    /// Whether no light comes from it at all.
    pub fn is_dark(&self) -> bool {
        match &self.sky {
            Sky::Constant(radiance) => radiance.largest() <= 0.0,
            Sky::Map(map) => {
                map.intensity <= 0.0 || map.picture.rgb.iter().all(|texel| texel.iter().all(|&x| x <= 0.0))
            }
        }
    }
}

impl Default for Environment {
    /// None.
    fn default() -> Self {
        Self::constant(Rgb::splat(0.0))
    }
}
