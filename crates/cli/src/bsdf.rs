//! `gonio bsdf`: one material, asked directly: values, samples and albedo, in any of the kernel's arithmetics.
//!
//! Directions are local: z is the normal, x the tangent; unit vectors that point away from the surface; `wo` comes first.
//! The guarded closure answers, so directions outside of its domain give exact zeros.

mod albedo;
mod eval;
mod model;
mod precision;
mod rows;
mod sample;

use anyhow::Result;
use clap::Subcommand;
use std::process::ExitCode;

/// Evaluate, sample or measure one material.
///
/// A material file holds the keys of a scene's [materials.NAME] table. Directions are local unit vectors: z is the
/// normal, x the tangent; they point away from the surface. What lies outside of the domain gives exact zeros.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Eval(eval::Args),
    Sample(sample::Args),
    Albedo(albedo::Args),
}

/// Runs the subcommand.
pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    match &args.command {
        Command::Eval(args) => eval::run(args),
        Command::Sample(args) => sample::run(args),
        Command::Albedo(args) => albedo::run(args),
    }?;
    Ok(ExitCode::SUCCESS)
}
