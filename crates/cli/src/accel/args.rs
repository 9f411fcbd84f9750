//! What the arguments that both subcommands take stand for: a scene to cast at, and the backends that cast.

use crate::scene::load;
use crate::usage::Usage;
use anyhow::Result;
use gonio_tracer::Backend;
use gonio_verify::census::Specimen;
use std::path::Path;

/// Loads a scene to cast at.
pub(super) fn specimen(path: &Path) -> Result<Specimen> {
    Ok(Specimen::of_world(&path.display().to_string(), &load(path)?))
}

/// The backends that were asked for, or all that this build has but brute.
pub(super) fn backends(asked: &[Backend]) -> Vec<Backend> {
    let all = Backend::ALL.into_iter().filter(|backend| *backend != Backend::Brute).collect();
    if asked.is_empty() { all } else { asked.to_vec() }
}

/// Names of what this build cannot compare with.
pub(super) fn not_built() -> Vec<&'static str> {
    let has = |name: &str| Backend::ALL.iter().any(|backend| backend.to_string() == name);
    ["embree"].into_iter().filter(|name| !has(name)).collect()
}

/// Refuses a list that names a backend twice.
pub(super) fn check_distinct(backends: &[Backend]) -> Result<()> {
    match backends.iter().enumerate().find(|(i, backend)| backends[..*i].contains(backend)) {
        Some((_, twice)) => Err(Usage(format!("--backends names {twice} twice")).into()),
        None => Ok(()),
    }
}
