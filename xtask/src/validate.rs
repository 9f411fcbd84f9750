//! `cargo xtask validate`: builds `gonio` in the profile of the tests, so that both share one build, and runs its checks.

use crate::cargo::{Outcome, cargo, must, program, root, run as run_program};

/// Where the report goes unless the user says otherwise.
const OUT: &str = "target/validate";

pub(crate) fn run(arguments: &[String]) -> Outcome {
    must(cargo().args(["build", "--bin", "gonio"]))?;
    let mut validate = program(root().join("target/debug/gonio"));
    validate.arg("validate").args(arguments);
    if !arguments.iter().any(|a| a == "-o" || a == "--out" || a.starts_with("--out=")) {
        validate.args(["--out", OUT]);
    }
    run_program(&mut validate)
}
