//! The kinds of lights that scene files can name.

use super::delta::LightSource;
use super::distant::DistantLight;
use super::point::PointLight;
use super::spot::SpotLight;
use crate::scene::fields::{Fields, Refusal};
use std::sync::Arc;

/// Reads a light from the fields that describe it.
pub type ReadLight = fn(&mut dyn Fields) -> Result<Arc<dyn LightSource>, Refusal>;

/// The kinds of lights that scene files can name, by their `type`.
pub const KINDS: &[(&str, ReadLight)] =
    &[("point", PointLight::read), ("spot", SpotLight::read), ("distant", DistantLight::read)];
