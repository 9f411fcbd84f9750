//! `gonio accel`: the ray-casting backends by themselves, on a scene of the user's.

mod bench;
mod census;

use crate::usage::{Usage, warn};
use anyhow::{Context, Result};
use clap::Subcommand;
use gonio_tracer::{Backend, World};
use gonio_verify::census::Specimen;
use std::path::Path;
use std::process::ExitCode;

/// Compare the ray-casting backends.
///
/// The census casts the same rays with every backend and lists every disagreement; the benchmark measures how many rays each
/// casts per second.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Census(census::Args),
    Bench(bench::Args),
}

/// Runs the subcommand.
pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    match &args.command {
        Command::Census(args) => census::run(args),
        Command::Bench(args) => bench::run(args),
    }
}

/// Loads a scene to cast at.
fn specimen(path: &Path) -> Result<Specimen> {
    let scene = gonio_io::load(path)?;
    let world = World::new(&scene).context("scene")?;
    scene.warnings.iter().chain(world.warnings()).for_each(|warning| warn(warning));
    Ok(Specimen::of_world(&path.display().to_string(), &world))
}

/// The backends that were asked for, or all that this build has but brute.
fn backends(asked: &[Backend]) -> Vec<Backend> {
    let all = Backend::ALL.into_iter().filter(|backend| *backend != Backend::Brute).collect();
    if asked.is_empty() { all } else { asked.to_vec() }
}

/// Names of what this build cannot compare with.
fn not_built() -> Vec<&'static str> {
    let has = |name: &str| Backend::ALL.iter().any(|backend| backend.to_string() == name);
    ["embree"].into_iter().filter(|name| !has(name)).collect()
}

/// Refuses a list that names a backend twice.
fn check_distinct(backends: &[Backend]) -> Result<()> {
    match backends.iter().enumerate().find(|(i, backend)| backends[..*i].contains(backend)) {
        Some((_, twice)) => Err(Usage(format!("--backends names {twice} twice")).into()),
        None => Ok(()),
    }
}
