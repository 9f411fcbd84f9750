//! `cargo xtask bench`: speed, as ratios of times that are only reported, and as counts of instructions that are a gate.
//!
//! A time on a shared machine varies by a tenth; a count of instructions in one thread without a clock does not vary at all,
//! so a rise of two percent is a fact. What a count does not see: the memory, the width of the divider, a mispredicted
//! branch. It guards what was won, and says nothing of what is faster.
//!
//! What is counted is the build that tests and validation share (optimised, debug assertions on), because another one would
//! cost minutes: `benches/counts.rs` adds seconds to it. Counts belong to one compiler and one target, which
//! `benches/limits.toml` names.

mod callgrind;
mod judge;
mod limits;
mod parse;

use crate::cargo::{Outcome, cargo, program, root, run as run_program};
use crate::{peers, rays};
use judge::Judgement;
use limits::{Build, Limits};
use std::process::ExitCode;

const LIMITS: &str = "benches/limits.toml";
/// Exit code of a gate that found what must not be; as that of `gonio validate`.
const FAILED: u8 = 3;

pub(crate) fn run(arguments: &[String]) -> Outcome {
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => times(),
        ["--gate"] => gate(),
        ["--accept", reason] => accept(reason, None),
        ["--accept", reason, "--only", row] | ["--only", row, "--accept", reason] => accept(reason, Some(row)),
        _ => Err("usage: cargo xtask bench [--gate | --accept REASON [--only ROW]]".to_owned()),
    }
}

/// Ratios of times, one command after the other. They are only reported: whoever wants a verdict runs the command by itself.
fn times() -> Outcome {
    type Command = (&'static str, fn() -> Outcome);
    const COMMANDS: [Command; 3] = [("ratio", ratio), ("bsdfs", || peers::lobes(&[])), ("rays", || rays::run(&[]))];
    for (name, command) in COMMANDS {
        println!("== cargo xtask {name}");
        if let Err(error) = command() {
            println!("did not run: {error}");
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// `cargo xtask ratio`: eight lanes against one direction at a time.
pub(crate) fn ratio() -> Outcome {
    run_program(cargo().args(["bench", "--bench", "kernel", "--", "--ratio"]))
}

/// Exit code 0 if no row rose beyond its limit, else 3.
fn gate() -> Outcome {
    if !callgrind::runs_here() {
        println!("bench --gate: did not run: callgrind counts on Linux, and the numbers are those of x86-64");
        return Ok(ExitCode::SUCCESS);
    }
    let (limits, build) = (read()?, build()?);
    limits.belong_to(&build).map_err(|error| format!("{LIMITS}: {error}"))?;
    let judgement = Judgement::of(&limits, &callgrind::count()?);
    print!("{judgement}");
    println!("{build}: {}", judgement.summary());
    if judgement.passed() {
        return Ok(ExitCode::SUCCESS);
    }
    println!(
        "Where a row's instructions are, benches/counts.rs tells how to see. If it has to be: cargo xtask bench --accept \"REASON\""
    );
    Ok(ExitCode::from(FAILED))
}

/// Writes what rows count now, with the reason.
fn accept(reason: &str, only: Option<&str>) -> Outcome {
    if !callgrind::runs_here() {
        return Err("bench --accept: callgrind counts on Linux, and the numbers are those of x86-64".to_owned());
    }
    let (mut limits, build) = (read()?, build()?);
    let counts = callgrind::count()?;
    let changed = limits.accept(&build, &counts, reason, only)?;
    std::fs::write(root().join(LIMITS), limits.to_string()).map_err(|error| format!("{LIMITS}: {error}"))?;
    changed.iter().for_each(|row| println!("{row}"));
    println!("{LIMITS}: {} of {} rows changed: {reason}", changed.len(), counts.len());
    Ok(ExitCode::SUCCESS)
}

fn read() -> Result<Limits, String> {
    let text = std::fs::read_to_string(root().join(LIMITS)).map_err(|error| format!("{LIMITS}: {error}"))?;
    text.parse().map_err(|error| format!("{LIMITS}:{error}"))
}

/// The compiler that cargo uses here, and its target.
fn build() -> Result<Build, String> {
    let mut rustc = program(std::env::var_os("RUSTC").unwrap_or("rustc".into()));
    let output = rustc.arg("-vV").output().map_err(|error| format!("cannot start rustc: {error}"))?;
    Build::of(&String::from_utf8_lossy(&output.stdout)).ok_or_else(|| "rustc -vV names no version".to_owned())
}
