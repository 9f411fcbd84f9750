//! `Finding`: what an instrument brings back, before it has a name: a worst number, its limit, and where it was met.

use crate::effort::Effort;
use crate::random::Random;
use gonio_report::{Check, Outcome};

/// The conditions under which a task measures.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    /// How thoroughly.
    pub(crate) effort: Effort,
    /// The seed of this task alone.
    pub(crate) seed: u64,
    /// The level of each single statistical test of the run.
    pub(crate) level: f64,
}

impl Run {
    /// The task's stream of random numbers.
    pub(crate) fn random(&self) -> Random {
        Random::new(self.seed)
    }
    /// A count by effort.
    pub(crate) fn by_effort(&self, quick: usize, standard: usize, full: usize) -> usize {
        match self.effort {
            Effort::Quick => quick,
            Effort::Standard => standard,
            Effort::Full => full,
        }
    }
}

/// The worst that was met, against its limit.
#[derive(Clone, Debug)]
pub(crate) struct Finding {
    meaning: &'static str,
    limit: f64,
    measured: f64,
    /// Large numbers are bad; else small ones are.
    upwards: bool,
    detail: String,
    note: String,
    not_run: Option<String>,
}

impl Finding {
    /// A measurement that must not exceed `limit`; starts at 0.
    pub(crate) fn at_most(limit: f64, meaning: &'static str) -> Self {
        let (detail, note) = (String::new(), String::new());
        Self { meaning, limit, measured: 0.0, upwards: true, detail, note, not_run: None }
    }
    /// A measurement that must reach `limit`, of something that is so by design; starts at 0 and keeps the largest.
    pub(crate) fn at_least(limit: f64, meaning: &'static str) -> Self {
        Self { upwards: false, ..Self::at_most(limit, meaning) }
    }
    /// A p-value that must not fall below the level; starts at 1.
    pub(crate) fn p_value(level: f64) -> Self {
        Self { measured: 1.0, upwards: false, ..Self::at_most(level, "p ≥") }
    }
    /// Could not run, and why.
    pub(crate) fn not_run(reason: impl Into<String>) -> Self {
        Self { not_run: Some(reason.into()), ..Self::at_most(0.0, "") }
    }
    /// Whether it did run and is out of its limit.
    pub(crate) fn failed(&self) -> bool {
        self.not_run.is_none() && self.out_of_limit()
    }

    fn out_of_limit(&self) -> bool {
        // A NaN keeps no limit.
        let kept = if self.upwards { self.measured <= self.limit } else { self.measured >= self.limit };
        !kept
    }
    /// Takes in one number; keeps the largest, with its detail. NaN counts as infinite.
    pub(crate) fn raise(&mut self, x: f64, detail: impl FnOnce() -> String) {
        let x = if x.is_nan() { f64::INFINITY } else { x };
        if x > self.measured {
            self.measured = x;
            self.detail = detail();
        }
    }
    /// Takes in one p-value; keeps the smallest, with its detail. NaN counts as 0.
    pub(crate) fn lower(&mut self, p: f64, detail: impl FnOnce() -> String) {
        let p = if p.is_nan() { 0.0 } else { p };
        if p < self.measured {
            self.measured = p;
            self.detail = detail();
        }
    }
    /// A law is broken: out of any limit.
    pub(crate) fn broken(&mut self, detail: impl FnOnce() -> String) {
        if self.upwards { self.raise(f64::INFINITY, detail) } else { self.lower(0.0, detail) }
    }
    /// Says something about the measurement as a whole.
    pub(crate) fn note(&mut self, note: String) {
        self.note = note;
    }
    /// Where the worst was met.
    pub(crate) fn detail(&self) -> &str {
        &self.detail
    }

    /// The row of the report.
    pub(crate) fn into_check(self, instrument: &str, subject: String, seconds: f64) -> Check {
        let outcome = match &self.not_run {
            Some(reason) => Outcome::NotRun(reason.clone()),
            None if self.out_of_limit() => Outcome::Failed,
            None => Outcome::Passed,
        };
        // JSON has no infinity: a broken law shows as the largest number.
        let measured = self.measured.clamp(-f64::MAX, f64::MAX);
        let detail = match (self.detail.is_empty(), self.note.is_empty()) {
            (false, false) => format!("{}; {}", self.detail, self.note),
            _ => self.detail + &self.note,
        };
        Check {
            instrument: instrument.to_owned(),
            subject,
            outcome,
            measured,
            limit: self.limit,
            meaning: self.meaning.to_owned(),
            detail,
            seconds,
        }
    }
}
