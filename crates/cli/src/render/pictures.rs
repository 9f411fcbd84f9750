//! Pictures and what they say of themselves: where a rendering goes.

use super::origin::Origin;
use crate::output::{Target, extension, write_all};
use anyhow::{Result, anyhow};
use gonio_io::exr::{self, Metadata, Window};
use gonio_io::png;
use gonio_tracer::Rendering;
use std::path::Path;

/// Writes the picture to every target.
///
/// # Errors
/// One of them cannot be written; those before it are.
pub(super) fn write(targets: &[Target], origin: &Origin, rendering: &Rendering) -> Result<()> {
    targets.iter().try_for_each(|target| write_one(target, origin, rendering))
}

/// Writes the picture to every target. If one cannot be written, the work is not lost for that: an EXR file is put into the
/// system's folder for temporary files, if that is possible.
///
/// # Errors
/// One of the targets cannot be written. The message says where the picture is instead.
pub(super) fn write_or_rescue(targets: &[Target], origin: &Origin, rendering: &Rendering) -> Result<()> {
    let failures: Vec<_> = targets.iter().filter_map(|t| write_one(t, origin, rendering).err()).collect();
    let Some(first) = failures.into_iter().next() else { return Ok(()) };
    if targets == [Target::Stdout] {
        return Err(first); // a reader that has gone wants no more
    }
    let refuge = Target::File(std::env::temp_dir().join(format!("gonio-rescued-{}.exr", std::process::id())));
    Err(match write_one(&refuge, origin, rendering) {
        Ok(()) => anyhow!("{first:#}; the picture is in {refuge} instead"),
        Err(_) => first,
    })
}

fn write_one(target: &Target, origin: &Origin, rendering: &Rendering) -> Result<()> {
    let encoded = match target {
        Target::File(path) if extension(path) == "png" => png::encode(&rendering.picture, origin.scene.film.exposure),
        _ => exr::encode(&rendering.picture, rendering.layers.as_ref(), &metadata(origin, rendering)),
    };
    write_all(target, &encoded.map_err(|why| anyhow!("{target}: {why}"))?)
}

fn metadata(origin: &Origin, rendering: &Rendering) -> Metadata {
    let Origin { scene, settings, times, .. } = origin;
    let (film, stats) = (scene.film, &rendering.stats);
    let aspect = f64::from(film.width) / f64::from(film.height);
    let other = vec![
        ("scene".to_owned(), origin.scene_file.display().to_string()),
        ("scene_hash".to_owned(), origin.scene_hash.to_string()),
        ("intersect".to_owned(), origin.intersect.to_string()),
        ("effects".to_owned(), origin.effects.to_string()),
        ("russian_roulette".to_owned(), settings.russian_roulette.to_string()),
        ("sample_range".to_owned(), format!("0..{}", stats.spp)),
        ("spp_wanted".to_owned(), settings.spp.to_string()),
        ("instruction_set".to_owned(), instruction_set().to_owned()),
    ];
    Metadata {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        seed: settings.seed,
        spp: stats.spp,
        max_depth: settings.max_depth,
        backend: origin.backend.to_string(),
        samples: stats.samples,
        load_seconds: times.load_seconds,
        build_seconds: times.build_seconds,
        render_seconds: stats.render_seconds,
        film_hash: stats.film_hash.clone(),
        window: settings.crop.map(|c| Window { at: [c.x0, c.y0], of: [film.width, film.height] }),
        matrices: Some(scene.camera.matrices(aspect)),
        other,
    }
}

/// What the build was made for; pictures are equal to the last bit only within one.
fn instruction_set() -> &'static str {
    if cfg!(target_feature = "avx512f") {
        "x86-64-v4"
    } else if cfg!(target_feature = "avx2") {
        "x86-64-v3"
    } else {
        std::env::consts::ARCH
    }
}

/// Whether the name is that of a picture.
pub(super) fn is_picture(path: &Path) -> bool {
    matches!(extension(path).as_str(), "exr" | "png")
}
