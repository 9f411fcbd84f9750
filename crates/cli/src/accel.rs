//! `gonio accel`: the ray-casting backends by themselves, on a scene of the user's.

mod args;
mod bench;
mod census;

use anyhow::Result;
use clap::Subcommand;
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
