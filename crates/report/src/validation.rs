//! The report of a validation: all checks, their sums, and the circumstances under which they were made.

mod page;

use crate::check::{Check, Outcome};
use crate::environment::Environment;
use crate::grade::{counts, groups, worst};
use serde::Serialize;

/// What was run, how it ended, and where.
#[derive(Clone, Debug, Serialize)]
pub struct Header {
    /// Of the program.
    pub version: &'static str,
    /// How thorough the run was, in one word.
    pub effort: &'static str,
    /// Where all random numbers came from.
    pub seed: u64,
    /// The part that was asked for, if not all.
    pub only: Option<String>,
    /// Checks that passed.
    pub passed: usize,
    /// Checks that failed.
    pub failed: usize,
    /// Checks that could not run.
    pub not_run: usize,
    /// Wall time of the whole run \[s\].
    pub seconds: f64,
    /// How the program was built, and where it ran.
    pub environment: Environment,
}

/// What `report.json` holds. The counts of a census, if there is one, are a part of it; what they look like is for the
/// census to say.
#[derive(Clone, Debug, Serialize)]
pub struct Validation<Census> {
    /// What was run, how it ended, and where.
    #[serde(flatten)]
    pub header: Header,
    /// All instruments, used or not.
    pub instruments: Vec<Instrument>,
    /// Every check, in the order of the run.
    pub checks: Vec<Check>,
    /// The counts behind the checks of the census, and every disagreement.
    pub census: Census,
}

/// An instrument and what it proves.
#[derive(Clone, Debug, Serialize)]
pub struct Instrument {
    /// Its name, as checks have it.
    pub name: &'static str,
    /// What a run of it proves.
    pub proves: &'static str,
}

/// What `summary.json` holds: a report whose checks are summed up by instrument, small enough to be kept.
#[derive(Clone, Debug, Serialize)]
pub struct Summary<'a> {
    #[serde(flatten)]
    header: &'a Header,
    instruments: Vec<Total<'a>>,
}

/// All checks of one instrument.
#[derive(Clone, Debug, Serialize)]
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

impl Header {
    /// The header of these checks.
    pub fn new(
        version: &'static str,
        effort: &'static str,
        seed: u64,
        only: Option<String>,
        checks: &[Check],
        seconds: f64,
        environment: Environment,
    ) -> Self {
        let [passed, failed, not_run] = counts(checks.iter());
        Self { version, effort, seed, only, passed, failed, not_run, seconds, environment }
    }
}

impl<Census> Validation<Census> {
    /// What an instrument proves; nothing if it is not known.
    fn proves(&self, name: &str) -> &'static str {
        self.instruments.iter().find(|instrument| instrument.name == name).map_or("", |i| i.proves)
    }

    /// The sums, by instrument.
    pub fn totals(&self) -> Summary<'_> {
        let instruments = groups(&self.checks).into_iter().map(|(name, checks)| {
            let [passed, failed, not_run] = counts(checks.iter().copied());
            Total {
                name,
                proves: self.proves(name),
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
    pub fn summary(&self) -> String {
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
}
