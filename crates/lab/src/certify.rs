//! `certify`: the instruments pointed at a model of the user's own, for which an `f32` implementation is enough.

use crate::check::{Check, Outcome};
use crate::finding::Finding;
use crate::run::{Options, Task, execute, tasks_of_subject};
use crate::subject::Subject;
use crate::totality;
use gonio_kernel::Lobe;
use serde::Serialize;
use std::fmt;

/// What the instruments found about one model.
#[derive(Clone, Debug, Serialize)]
pub struct Certificate {
    /// The model's name.
    pub name: String,
    /// One row per measurement. What could not run says why.
    pub checks: Vec<Check>,
}

impl Certificate {
    /// Whether nothing failed. What did not run is not a failure: read the checks.
    pub fn holds(&self) -> bool {
        !self.checks.iter().any(Check::failed)
    }
}

impl fmt::Display for Certificate {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        writeln!(out, "{}: {}", self.name, if self.holds() { "holds" } else { "FAILED" })?;
        for check in &self.checks {
            let Check { instrument, measured, meaning, limit, detail, .. } = check;
            match &check.outcome {
                Outcome::NotRun(reason) => writeln!(out, "  not run  {instrument}: {reason}")?,
                Outcome::Passed => {
                    writeln!(out, "  passed   {instrument}: {meaning} {limit:.3e}, measured {measured:.3e}")?
                }
                Outcome::Failed => {
                    writeln!(out, "  FAILED   {instrument}: {meaning} {limit:.3e}, measured {measured:.3e}; {detail}")?;
                }
            }
        }
        Ok(())
    }
}

/// Measures a model of the user's own: everything that `f32` alone can answer. What needs more says that it did not run.
pub fn certify<L: Lobe<f32> + Sync>(name: &str, lobe: &L, options: &Options) -> Certificate {
    let subject = Subject::of_lobe(name, lobe);
    let mut tasks = tasks_of_subject(&subject);
    for view in subject.views() {
        tasks.push(Task::new("totality", format!("{name} f32"), 0, move |run| totality::measure_probe(view, run)));
    }
    for (instrument, needs) in MISSING {
        tasks.push(Task::new(instrument, name, 0, move |_| Finding::not_run(needs)));
    }
    let mut checks = Vec::new();
    execute(tasks, options, &mut |check| checks.push(check));
    Certificate { name: name.to_owned(), checks }
}

/// What an `f32` implementation alone cannot answer.
const MISSING: [(&str, &str); 3] = [
    ("precision", "needs an f64 form of the lobe"),
    ("jacobian", "needs an f64 form of the lobe"),
    ("lanes", "needs an eight-lane form of the lobe"),
];
