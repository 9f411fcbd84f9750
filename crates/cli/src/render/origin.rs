//! Where a rendering comes from: what its pictures and its statistics both say of it.

use gonio_accel::Intersect;
use gonio_tracer::scene::Scene;
use gonio_tracer::{Backend, EffectSet, RenderSettings};
use std::cell::LazyCell;
use std::path::Path;

/// Where a rendering comes from.
pub(super) struct Origin<'a> {
    pub(super) scene_file: &'a Path,
    pub(super) scene: &'a Scene,
    /// The fingerprint of the world: formed when something wants to say it, once.
    pub(super) scene_hash: LazyCell<String, Box<dyn Fn() -> String + 'a>>,
    pub(super) settings: &'a RenderSettings,
    pub(super) effects: EffectSet,
    pub(super) backend: Backend,
    pub(super) intersect: Intersect,
    pub(super) times: Times,
}

/// What the renderer cannot know.
pub(super) struct Times {
    /// Reading the scene and making it ready.
    pub(super) load_seconds: f64,
    /// Building the acceleration structure.
    pub(super) build_seconds: f64,
}
