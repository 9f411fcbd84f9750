//! The report: all checks, their sums, and the circumstances under which they were made.

use super::grade::{groups, worst};
use crate::census::record::Log;
use crate::environment::Environment;
use gonio_lab::{Check, Effort, Options, Outcome};
use serde::Serialize;

/// What was run, how it ended, and where.
#[derive(Debug, Serialize)]
pub(super) struct Header {
    pub(super) version: &'static str,
    pub(super) effort: Effort,
    pub(super) seed: u64,
    pub(super) only: Option<String>,
    pub(super) passed: usize,
    pub(super) failed: usize,
    pub(super) not_run: usize,
    pub(super) seconds: f64,
    pub(super) environment: Environment,
}

/// What `report.json` holds.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    #[serde(flatten)]
    pub(super) header: Header,
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

/// What `summary.json` holds: a report whose checks are summed up by instrument, small enough to be kept.
#[derive(Debug, Serialize)]
pub(super) struct Summary<'a> {
    #[serde(flatten)]
    header: &'a Header,
    instruments: Vec<Total<'a>>,
}

/// All checks of one instrument.
#[derive(Debug, Serialize)]
struct Total<'a> {
    name: &'a str,
    proves: &'a str,
    passed: usize,
    failed: usize,
    not_run: usize,
    /// The check that came closest to its limit, or failed it by most.
    worst: Option<&'a Check>,
    /// Everything it was used on.
    subjects: Vec<&'a str>,
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
        let [passed, failed, not_run] = counts(checks.iter());
        Self {
            header: Header {
                version: env!("CARGO_PKG_VERSION"),
                effort: options.effort,
                seed: options.seed,
                only: options.only.clone(),
                passed,
                failed,
                not_run,
                seconds,
                environment: Environment::here(),
            },
            instruments: instruments.into_iter().map(|(name, proves)| Instrument { name, proves }).collect(),
            checks,
            census,
        }
    }

    /// The sums, by instrument.
    pub(super) fn totals(&self) -> Summary<'_> {
        let instruments = groups(&self.checks).into_iter().map(|(name, checks)| {
            let [passed, failed, not_run] = counts(checks.iter().copied());
            Total {
                name,
                proves: self.instruments.iter().find(|instrument| instrument.name == name).map_or("", |i| i.proves),
                passed,
                failed,
                not_run,
                worst: worst(checks.iter().copied()),
                subjects: checks.iter().map(|check| &*check.subject).collect(),
            }
        });
        Summary { header: &self.header, instruments: instruments.collect() }
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
        format!("{} passed, {} failed, {} not run{names}", self.header.passed, self.header.failed, self.header.not_run)
    }

    /// The effort in one word.
    pub(super) fn effort_name(&self) -> &'static str {
        match self.header.effort {
            Effort::Quick => "quick",
            Effort::Standard => "standard",
            Effort::Full => "full",
        }
    }
}

/// How many passed, failed, and could not run.
fn counts<'a>(checks: impl Iterator<Item = &'a Check>) -> [usize; 3] {
    checks.fold([0; 3], |[passed, failed, not_run], check| match check.outcome {
        Outcome::Passed => [passed + 1, failed, not_run],
        Outcome::Failed => [passed, failed + 1, not_run],
        Outcome::NotRun(_) => [passed, failed, not_run + 1],
    })
}
