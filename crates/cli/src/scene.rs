//! A scene file as a world, with its warnings on standard error.

use crate::usage::warn;
use anyhow::{Context, Result};
use gonio_tracer::World;
use gonio_tracer::scene::Scene;
use std::path::Path;

/// Reads and places a scene, and says what was noticed.
///
/// # Errors
/// The scene cannot be read or placed.
pub(crate) fn load(path: &Path) -> Result<World> {
    let mut scene = gonio_io::load(path)?;
    let world = World::take(&mut scene, &mut |_| ()).context("scene")?;
    warn_of(&scene, &world);
    Ok(world)
}

/// Says what was noticed in reading and in placing a scene, each thing once.
pub(crate) fn warn_of(scene: &Scene, world: &World) {
    let mut said: Vec<&str> = Vec::new();
    for warning in scene.warnings.iter().chain(world.warnings()) {
        if !said.contains(&warning.as_str()) {
            warn(warning);
            said.push(warning);
        }
    }
}
