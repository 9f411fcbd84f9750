//! The report: all checks, their sums, and the circumstances under which they were made.

use crate::cpu;
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
}

/// Where and how the program was built and run.
#[derive(Debug, Serialize)]
pub(super) struct Environment {
    pub(super) target: &'static str,
    pub(super) target_features: Vec<&'static str>,
    pub(super) rustc: Option<&'static str>,
    pub(super) debug_assertions: bool,
    pub(super) processor: String,
    pub(super) threads: usize,
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

impl Environment {
    fn here() -> Self {
        let features = [
            ("avx", cfg!(target_feature = "avx")),
            ("avx2", cfg!(target_feature = "avx2")),
            ("avx512f", cfg!(target_feature = "avx512f")),
            ("bmi1", cfg!(target_feature = "bmi1")),
            ("bmi2", cfg!(target_feature = "bmi2")),
            ("f16c", cfg!(target_feature = "f16c")),
            ("fma", cfg!(target_feature = "fma")),
            ("lzcnt", cfg!(target_feature = "lzcnt")),
            ("movbe", cfg!(target_feature = "movbe")),
            ("neon", cfg!(target_feature = "neon")),
            ("sse4.2", cfg!(target_feature = "sse4.2")),
        ];
        Self {
            target: option_env!("GONIO_TARGET").unwrap_or(std::env::consts::ARCH),
            target_features: features.iter().filter(|(_, on)| *on).map(|(name, _)| *name).collect(),
            rustc: option_env!("GONIO_RUSTC"),
            debug_assertions: cfg!(debug_assertions),
            processor: cpu::name(),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
        }
    }
}
