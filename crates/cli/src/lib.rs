//! The command line of Gonio: `gonio render`, `compare`, `bsdf`, `certify`, `effects`, `accel` and `validate`.
//!
//! One file per subcommand, arguments in, text out: scenes and pictures belong to `gonio-tracer`, their files to `gonio-io`,
//! scattering to `gonio-kernel`, its instruments to `gonio-lab`, what needs both to `gonio-verify`, pages and JSON to
//! `gonio-report`. What is here reads arguments, hands them on, and writes what comes back.
//!
//! Results go to files or standard output, everything else (warnings, progress, errors) to standard error. A file appears
//! whole or not at all. Exit codes: 0 success; 1 an error; 2 wrong usage; 3 a check failed (validate, certify, accel census); 75 a render
//! was stopped and its picture is good; 130 a run was interrupted and quit at once.
#![forbid(unsafe_code)]

mod accel;
mod bsdf;
mod certify;
mod compare;
mod cpu;
mod effects;
mod environment;
mod output;
mod render;
mod scene;
mod signals;
mod tables;
mod usage;
mod validate;

pub use cpu::processor_suffices;

use anyhow::Result;
use clap::{Parser, Subcommand};
use std::ffi::OsString;
use std::io;
use std::process::ExitCode;

const EXIT_CODES: &str = "Exit codes: 0 success; 1 an error; 2 wrong usage; 3 a check failed (validate, certify, accel census); \
                          75 a render was stopped early, its picture is written; 130 interrupted.";

/// A reflectance kernel that can be trusted, and the eight-wide path tracer that proves it.
#[derive(Parser)]
#[command(name = "gonio", version, after_help = EXIT_CODES, subcommand_required = true, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Render(render::Args),
    Bsdf(bsdf::Args),
    Accel(accel::Args),
    Compare(compare::Args),
    Certify(certify::Args),
    Effects(effects::Args),
    Validate(validate::Args),
    #[command(hide = true)]
    Tables(tables::Args),
}

impl Command {
    fn run(&self) -> Result<ExitCode> {
        match self {
            Self::Render(args) => render::run(args),
            Self::Bsdf(args) => bsdf::run(args),
            Self::Accel(args) => accel::run(args),
            Self::Compare(args) => compare::run(args),
            Self::Certify(args) => certify::run(args),
            Self::Effects(args) => effects::run(args),
            Self::Validate(args) => validate::run(args),
            Self::Tables(args) => tables::run(args),
        }
    }
}

/// Does what a command line says, the program's name first, without a process of its own: signals are not listened to, and
/// an error is returned instead of printed. Fuzzing goes this way.
///
/// # Errors
/// Wrong usage, or what the subcommand says.
pub fn execute<T: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = T>) -> Result<ExitCode> {
    Cli::try_parse_from(arguments)?.command.run()
}

/// Runs the command line of this process.
#[inline(never)] // its instructions must not move before the check of the processor
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version also come this way, with exit code 0. If they cannot be printed, nothing can.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    if let Err(error) = signals::listen() {
        usage::warn(&format!("signals are left to the system: {error}"));
    }
    cli.command.run().unwrap_or_else(|error| {
        if is_closed_pipe(&error) {
            return ExitCode::SUCCESS; // the reader has seen enough, as in `gonio bsdf sample … | head`
        }
        eprintln!("error: {error:#}");
        ExitCode::from(if error.is::<usage::Usage>() { 2 } else { 1 })
    })
}

fn is_closed_pipe(error: &anyhow::Error) -> bool {
    error.chain().filter_map(|cause| cause.downcast_ref::<io::Error>()).any(|e| e.kind() == io::ErrorKind::BrokenPipe)
}

/// Runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
