//! One run of every physical check.
//!
//! Three groups of instruments: those of `gonio-lab` on the kernel's lobes, furnace scenes and lit floors through the whole tracer, and the
//! census of the ray-casting backends. Checks that are not statistical are exact. The statistical ones of the kernel share the
//! significance of the options, and those of the furnaces share as much again, and so do those of the floors. What cannot run is named and never counted as
//! passed.

use crate::census::Log;
use crate::error::Error;
use crate::{backends, lights, scenes};
use gonio_lab::{Check, Options, validate_kernel};
use gonio_report::Exhibit;
use std::path::Path;

/// What a run leaves behind besides its checks.
#[derive(Debug)]
pub struct Found {
    /// The furnaces as they were rendered.
    pub exhibits: Vec<Exhibit>,
    /// The counts behind the checks of the census.
    pub census: Log,
}

/// Name of every instrument and what it proves.
pub fn instruments() -> Vec<(&'static str, &'static str)> {
    let own =
        [scenes::INSTRUMENTS.as_slice(), lights::INSTRUMENTS.as_slice(), backends::INSTRUMENTS.as_slice()].concat();
    gonio_lab::instruments().iter().copied().chain(own).collect()
}

/// Runs every check that the options ask for and hands each to `sink` as it ends. Scenes and pictures are written to the folder
/// `out`, where what fails can be rendered again by hand.
///
/// # Errors
/// If the folder cannot be written to, or a backend cannot be built.
pub fn validate(options: &Options, out: &Path, sink: &mut dyn FnMut(Check)) -> Result<Found, Error> {
    validate_kernel(options, sink);
    let exhibits = scenes::run(options, out, sink)?;
    lights::run(options, sink)?;
    let census = backends::run(options, out, sink)?;
    Ok(Found { exhibits, census })
}
