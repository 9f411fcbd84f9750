//! `Check`: what one instrument found about one subject, and whether that is good enough.

use serde::Serialize;

/// How a check ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The measurement lies within its limit.
    Passed,
    /// It does not.
    Failed,
    /// It could not run, and why. Never counted as passed.
    NotRun(String),
}

/// One row of a validation report.
#[derive(Clone, Debug, Serialize)]
pub struct Check {
    /// The instrument, kebab case: `furnace`, `chi2`, `census`…
    pub instrument: String,
    /// What was measured: a lobe with its parameters and precision, a scene, a backend.
    pub subject: String,
    /// How it ended.
    pub outcome: Outcome,
    /// What was measured, in the terms of `limit`; a p-value for a statistical test.
    pub measured: f64,
    /// The bound that `measured` must keep.
    pub limit: f64,
    /// What the two numbers are and which way round: "max |f − f'|/f ≤", "p ≥".
    pub meaning: String,
    /// Where the worst case lies, or why the check could not run: one line, may be empty.
    pub detail: String,
    /// Wall time of the check \[s\].
    pub seconds: f64,
}

impl Check {
    /// Whether this check fails a run.
    pub fn failed(&self) -> bool {
        self.outcome == Outcome::Failed
    }
}
