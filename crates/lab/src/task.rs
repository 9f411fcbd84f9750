//! `Task`: one row of the report, not yet measured, and what is asked of a run as a whole.

use crate::effort::Effort;
use crate::finding::{Finding, Run};
use crate::random::seed_for;
use crate::statistics::FAMILY_SIGNIFICANCE;
use gonio_report::Check;
use std::time::Instant;

/// What to run, and how thoroughly.
#[derive(Clone, Debug)]
pub struct Options {
    /// How many rows and samples.
    pub effort: Effort,
    /// Where all random numbers of a run come from. A correct kernel passes with any seed.
    pub seed: u64,
    /// Only checks whose instrument has this name, or whose subject contains this text.
    pub only: Option<String>,
    /// The probability with which all statistical tests of the run together may fail a correct kernel.
    pub significance: f64,
}

impl Options {
    /// Everything, at the given effort, with the usual seed.
    pub fn new(effort: Effort) -> Self {
        Self { effort, seed: 1, only: None, significance: FAMILY_SIGNIFICANCE }
    }

    /// Whether a check is asked for.
    pub fn want(&self, instrument: &str, subject: &str) -> bool {
        self.only.as_ref().is_none_or(|only| only == instrument || subject.contains(only.as_str()))
    }
}

/// One row of the report, not yet measured.
pub(crate) struct Task<'a> {
    pub(crate) instrument: &'static str,
    subject: String,
    /// How many p-values it judges at the level of a single test.
    pub(crate) tests: usize,
    measure: Box<dyn Fn(&Run) -> Finding + Send + Sync + 'a>,
}

impl<'a> Task<'a> {
    /// A task.
    pub(crate) fn new(
        instrument: &'static str,
        subject: impl Into<String>,
        tests: usize,
        measure: impl Fn(&Run) -> Finding + Send + Sync + 'a,
    ) -> Self {
        Self { instrument, subject: subject.into(), tests, measure: Box::new(measure) }
    }
    /// Whether it is asked for.
    pub(crate) fn wanted(&self, options: &Options) -> bool {
        options.want(self.instrument, &self.subject)
    }
    pub(crate) fn run(&self, options: &Options, level: f64) -> Check {
        let start = Instant::now();
        let seed = seed_for(options.seed, &format!("{} {}", self.instrument, self.subject));
        let finding = (self.measure)(&Run { effort: options.effort, seed, level });
        finding.into_check(self.instrument, self.subject.clone(), start.elapsed().as_secs_f64())
    }
}

/// A task that fails unless the measurement fails.
pub(crate) fn planted(
    name: &str,
    instrument: &str,
    measure: impl Fn(&Run) -> Finding + Send + Sync + 'static,
) -> Task<'static> {
    Task::new("planted-faults", format!("{name} → {instrument}"), 0, move |run| {
        let found = measure(&Run { effort: Effort::Quick, ..*run });
        let mut finding = Finding::at_most(0.0, "faults not caught ≤");
        if found.failed() {
            finding.note(format!("caught: {}", found.detail()));
        } else {
            finding.raise(1.0, || format!("NOT caught: {}", found.detail()));
        }
        finding
    })
}
