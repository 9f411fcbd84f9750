//! `gonio bsdf`: one material, asked directly: values, samples and albedo, in any of the kernel's arithmetics.
//!
//! Directions are local: z is the normal, x the tangent; unit vectors that point away from the surface; `wo` comes first.
//! The guarded closure answers, so directions outside of its domain give exact zeros.

mod albedo;
mod eval;
mod model;
mod rows;
mod sample;

use anyhow::{Context, Result, anyhow};
use clap::{Subcommand, ValueEnum};
use gonio_kernel::{F32x8, Parameters};
use gonio_tracer::constant_surface;
use model::Model;
use std::path::Path;
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

/// Which arithmetic answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Precision {
    /// Scalar, single precision
    F32,
    /// Scalar, double precision
    F64,
    /// Eight at a time, single precision: equal to f32 bit for bit
    Lanes,
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

/// Reads a material file and prepares it for the wanted arithmetic.
fn load(path: &Path, precision: Precision) -> Result<Box<dyn Model>> {
    let text = std::fs::read_to_string(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    let material = gonio_io::material_from_toml_str(&text, path)?;
    let surface = constant_surface(&material)
        .ok_or_else(|| anyhow!("{}: a material with images cannot be evaluated by itself", path.display()))?;
    Ok(match precision {
        Precision::F32 => Box::new(surface),
        Precision::F64 => Box::new(surface.to::<f64>()),
        Precision::Lanes => Box::new(surface.to::<F32x8>()),
    })
}

impl Precision {
    /// The shortest decimal that reads back as the same number in this arithmetic.
    fn print(self, x: f64) -> String {
        match self {
            Self::F64 => format!("{x:?}"),
            Self::F32 | Self::Lanes => format!("{:?}", x as f32), // exact: it was an f32
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
            Self::Lanes => "lanes",
        }
    }
}
