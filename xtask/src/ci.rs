//! `cargo xtask ci`: runs `.ci/run`, the one list of what CI does.

use crate::cargo::{Outcome, program, run as run_program};

pub(crate) fn run() -> Outcome {
    run_program(program("bash").arg(".ci/run"))
}
