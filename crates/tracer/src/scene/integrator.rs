//! `[integrator]`: how long paths are, and where their random numbers come from.

use super::fields::{Fields, Refusal};

/// Path length and random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntegratorSettings {
    /// Number of scattering events after which a path ends; emission seen directly is depth 0.
    pub max_depth: u32,
    /// Whether paths that carry little end early by chance (unbiased).
    pub russian_roulette: bool,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Default for IntegratorSettings {
    fn default() -> Self {
        Self { max_depth: 8, russian_roulette: true, seed: 0 }
    }
}

impl IntegratorSettings {
    /// What a scene says of it.
    ///
    /// # Errors
    /// What the fields refuse.
    pub fn read(fields: &mut dyn Fields) -> Result<Self, Refusal> {
        let default = Self::default();
        Ok(Self {
            max_depth: fields.integer("max_depth", 0..=1024)?.map_or(default.max_depth, |number| number as u32),
            russian_roulette: fields.boolean("russian_roulette")?.unwrap_or(default.russian_roulette),
            seed: fields.integer("seed", 0..=u64::MAX)?.unwrap_or(default.seed),
        })
    }
}
