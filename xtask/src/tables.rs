//! `cargo xtask tables`: the kernel's generated source, made by `gonio tables`, which links the laboratory.

use crate::cargo::{Outcome, cargo, run as run_program};

/// Writes the file, or with `--check` compares it: exit code 1 if it differs.
pub(crate) fn run(arguments: &[String]) -> Outcome {
    run_program(cargo().args(["run", "--quiet", "--bin", "gonio", "--", "tables"]).args(arguments))
}
