//! The report: all checks, their sums, and the circumstances under which they were made.

use crate::census::record::Log;
use crate::environment::Environment;
use gonio_lab::{Check, Effort, Options, Outcome};
use serde::Serialize;

/// What `report.json` holds.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    pub(super) version: &'static str,
    pub(super) effort: Effort,
    pub(super) seed: u64,
    pub(super) only: Option<String>,
    pub(super) passed: usize,
    pub(super) failed: usize,
    pub(super) not_run: usize,
    pub(super) seconds: f64,
    pub(super) environment: Environment,
    pub(super) instruments: Vec<Instrument>,
    pub(super) checks: Vec<Check>,
    /// The counts behind the checks of the census, and every disagreement.
    pub(super) census: Log,
}

/// An instrument and what it proves.
#[derive(Debug, Serialize)]
pub(super) struct Instrument {
    pub(super) name: &'static str,
    pub(super) proves: &'static str,
}

impl Report {
    /// Counts the checks of a finished run.
    pub(super) fn new(
        options: &Options,
        checks: Vec<Check>,
        census: Log,
        instruments: Vec<(&'static str, &'static str)>,
        seconds: f64,
    ) -> Self {
        let passed = checks.iter().filter(|check| check.outcome == Outcome::Passed).count();
        let failed = checks.iter().filter(|check| check.failed()).count();
        Self {
            version: env!("CARGO_PKG_VERSION"),
            effort: options.effort,
            seed: options.seed,
            only: options.only.clone(),
            passed,
            failed,
            not_run: checks.len() - passed - failed,
            seconds,
            environment: Environment::here(),
            instruments: instruments.into_iter().map(|(name, proves)| Instrument { name, proves }).collect(),
            checks,
            census,
        }
    }

    /// "412 passed, 0 failed, 1 not run (census: obvhs on …)".
    pub(super) fn summary(&self) -> String {
        let missing: Vec<&str> =
            self.checks.iter().filter(|c| matches!(c.outcome, Outcome::NotRun(_))).map(|c| &*c.subject).collect();
        let (shown, more) = missing.split_at(missing.len().min(4));
        let names = match (shown.is_empty(), more.len()) {
            (true, _) => String::new(),
            (_, 0) => format!(" ({})", shown.join(", ")),
            (_, more) => format!(" ({} and {more} more)", shown.join(", ")),
        };
        format!("{} passed, {} failed, {} not run{names}", self.passed, self.failed, self.not_run)
    }

    /// The effort in one word.
    pub(super) fn effort_name(&self) -> &'static str {
        match self.effort {
            Effort::Quick => "quick",
            Effort::Standard => "standard",
            Effort::Full => "full",
        }
    }
}
