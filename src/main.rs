//! The `gonio` program: checks the processor, then runs the command line.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    // First of all: on an older processor anything else may end in an illegal instruction.
    if gonio_cli::processor_suffices() { gonio_cli::run() } else { ExitCode::FAILURE }
}
