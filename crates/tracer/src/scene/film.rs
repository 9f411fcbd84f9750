//! `[film]`: the size of the picture and the number of samples.

use super::fields::{Fields, Refusal};

/// Size of the picture and number of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSettings {
    /// Pixels per row, 1 to 65536.
    pub width: u32,
    /// Rows, 1 to 65536.
    pub height: u32,
    /// Samples per pixel, 1 to 2²⁰.
    pub spp: u32,
    /// Exposure in stops (factor 2ˣ), applied to the PNG only.
    pub exposure: f32,
}

impl Default for FilmSettings {
    fn default() -> Self {
        Self { width: 800, height: 600, spp: 64, exposure: 0.0 }
    }
}

impl FilmSettings {
    /// What a scene says of it.
    ///
    /// # Errors
    /// What the fields refuse.
    pub fn read(fields: &mut dyn Fields) -> Result<Self, Refusal> {
        let default = Self::default();
        let mut whole = |key, most: u64, or: u32| -> Result<u32, Refusal> {
            Ok(fields.integer(key, 1..=most)?.map_or(or, |number| number as u32))
        };
        let (width, height) = (whole("width", 65_536, default.width)?, whole("height", 65_536, default.height)?);
        let spp = whole("spp", 1 << 20, default.spp)?;
        let exposure = fields.number("exposure", -100.0..=100.0)?.map_or(default.exposure, |stops| stops as f32);
        Ok(Self { width, height, spp, exposure })
    }
}
