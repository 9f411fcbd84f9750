//! The statistics of a rendering, as JSON.

use super::origin::Origin;
use gonio_tracer::Rendering;
use serde_json::{Value, json};

/// Everything that is known about a rendering. `x` and `y` are pixels of the whole picture, also with a crop.
pub(super) fn stats(origin: &Origin, rendering: &Rendering) -> Value {
    let Origin { settings, times, backend, intersect, .. } = origin;
    let stats = &rendering.stats;
    let rate = if stats.render_seconds > 0.0 { stats.samples as f64 / stats.render_seconds / 1e6 } else { 0.0 };
    let largest: Vec<Value> = stats
        .largest
        .iter()
        .take(10)
        .map(|l| json!({ "value": l.value, "x": l.x, "y": l.y, "sample": l.sample }))
        .collect();
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "load_seconds": times.load_seconds,
        "build_seconds": times.build_seconds,
        "render_seconds": stats.render_seconds,
        "samples": stats.samples,
        "closest_rays": stats.closest_rays,
        "shadow_rays": stats.shadow_rays,
        "msamples_per_second": rate,
        "lanes_full": stats.lanes_full,
        "largest_samples": largest,
        "dropped_samples": stats.dropped_samples,
        "backend": backend.to_string(),
        "intersect": intersect.to_string(),
        "threads": stats.threads,
        "seed": settings.seed,
        "spp": stats.spp,
        "spp_wanted": settings.spp,
        "width": rendering.picture.width,
        "height": rendering.picture.height,
        "max_depth": settings.max_depth,
        "russian_roulette": settings.russian_roulette,
        "film_hash": stats.film_hash,
        "scene_hash": origin.scene_hash.as_str(),
        "effects": origin.effects.to_string(),
    })
}
