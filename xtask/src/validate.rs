//! `cargo xtask validate`: builds `gonio` in the profile of the tests, so that both share one build, and runs its checks.

use crate::cargo::{Outcome, cargo, run as run_program};

/// Passes on the exit code: 0 success, 1 an error, 2 wrong usage, 3 a check failed; cargo's 101 if the build failed.
pub(crate) fn run(arguments: &[String]) -> Outcome {
    run_program(cargo().args(["run", "--bin", "gonio", "--", "validate"]).args(arguments))
}
