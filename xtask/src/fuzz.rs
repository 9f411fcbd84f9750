//! `cargo xtask fuzz`: many more inputs for every parser than a plain test run has time for.
//!
//! It builds as the tests are built and hands its numbers on in the environment. The mutations are the same in every
//! run, so a failure repeats with the same numbers. For a fuzzer that follows coverage: `cargo +nightly fuzz run NAME` in
//! the root of the repository, after `cargo install cargo-fuzz`.

use crate::cargo::{Outcome, cargo, run as run_program};

pub(crate) fn run(arguments: &[String]) -> Outcome {
    let mut executions = "1000000";
    let mut command = cargo();
    command.args(["test", "--test", "tests", "--", "fuzz::no_input_breaks_a_parser", "--exact", "--nocapture"]);
    let mut rest = arguments;
    while let [name, value, after @ ..] = rest {
        match name.as_str() {
            "--executions" if value.parse::<u64>().is_ok_and(|n| n > 0) => executions = value,
            "--target" => drop(command.env("GONIO_FUZZ_TARGET", value)),
            _ => return Err(format!("{name} {value} is not --executions N or --target NAME")),
        }
        rest = after;
    }
    if let [stray] = rest {
        return Err(format!("{stray} is not --executions N or --target NAME"));
    }
    run_program(command.env("GONIO_FUZZ_EXECUTIONS", executions))
}
