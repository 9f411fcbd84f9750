//! `validate_kernel`: every instrument over the whole zoo.

use crate::check::{Check, Effort};

/// What to run, and how thoroughly.
#[derive(Clone, Debug)]
pub struct Options {
    /// How many rows and samples.
    pub effort: Effort,
    /// Where all random numbers of a run come from. A correct kernel passes with any seed.
    pub seed: u64,
    /// Only checks whose instrument has this name, or whose subject contains this text.
    pub only: Option<String>,
}

impl Options {
    /// Everything, at the given effort, with the usual seed.
    pub fn new(effort: Effort) -> Self {
        Self { effort, seed: 1, only: None }
    }
}

/// The instruments: name, and what it proves in one sentence.
pub fn instruments() -> &'static [(&'static str, &'static str)] {
    &[]
}

/// Runs every instrument over the zoo and hands each check to `sink`, in an order that never depends on timing.
pub fn validate_kernel(options: &Options, sink: &mut dyn FnMut(Check)) {
    let _ = (options, sink);
}
