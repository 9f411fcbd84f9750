//! Instructions of a call, counted by valgrind: this program runs itself twice under callgrind, doing nothing but calls, and
//! the difference of the two counts over the difference of the calls is what one costs. Start-up cancels.

use gonio_lab::{Call, Count, exercise};
use gonio_tracer::MaterialSurface;
use std::path::Path;
use std::process::Command;
use std::str::FromStr;

/// What a run that is counted does: `eval:lanes:100`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exercise {
    call: Call,
    lanes: bool,
    /// Passes over 256 directions.
    passes: u32,
}

impl Exercise {
    /// Makes the calls.
    pub(super) fn run(self, surface: &MaterialSurface<f32>) {
        exercise(surface, self.call, self.lanes, self.passes);
    }
}

impl FromStr for Exercise {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "an exercise is CALL:ARITHMETIC:PASSES, as eval:lanes:100".to_owned();
        let [name, arithmetic, passes] = crate::usage::several::<String, 3>(text, ':').ok_or_else(wrong)?;
        let lanes = match &*arithmetic {
            "f32" => false,
            "lanes" => true,
            _ => return Err(wrong()),
        };
        Ok(Self { call: call(&name).ok_or_else(wrong)?, lanes, passes: passes.parse().map_err(|_| wrong())? })
    }
}

/// A call by its name.
fn call(name: &str) -> Option<Call> {
    Call::ALL.into_iter().find(|call| call.name() == name)
}

/// How often a pass is repeated in the shorter and in the longer run, and how many calls it makes.
const PASSES: [u32; 2] = [10, 110];
const CALLS: f64 = 256.0;

/// Counts both calls in both arithmetics, or says why that cannot be.
pub(super) fn count(material: &Path) -> Result<Vec<Count>, String> {
    Command::new("valgrind").arg("--version").output().map_err(|_| "valgrind is not installed".to_owned())?;
    let mut counts = Vec::new();
    for call in Call::ALL {
        for arithmetic in ["f32", "lanes"] {
            let [few, many] =
                PASSES.map(|passes| collected(material, &format!("{}:{arithmetic}:{passes}", call.name())));
            let instructions = (many? - few?) / (f64::from(PASSES[1] - PASSES[0]) * CALLS);
            counts.push(Count { call: call.name(), arithmetic, instructions });
        }
    }
    Ok(counts)
}

/// What callgrind counts in one run.
fn collected(material: &Path, exercise: &str) -> Result<f64, String> {
    let program = std::env::current_exe().map_err(|error| format!("this program does not find itself: {error}"))?;
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args(["certify", "--exercise", exercise])
        .arg(material)
        .output()
        .map_err(|error| format!("valgrind cannot be run: {error}"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let number =
        said.lines().filter_map(|line| line.split_once("Collected : ")).find_map(|(_, n)| n.trim().parse().ok());
    match number {
        Some(number) if output.status.success() => Ok(number),
        _ => Err(format!("valgrind cannot run this build: {}", said.lines().last().unwrap_or("it says nothing"))),
    }
}

/// The counts for a terminal.
pub(super) fn text(counts: &Result<Vec<Count>, String>) -> String {
    match counts {
        Err(why) => format!("\ninstructions: not counted ({why})\n"),
        Ok(counts) => counts.iter().fold("\ninstructions per call (lanes: per lane)\n".to_owned(), |text, c| {
            format!("{text}  {:6} {:5} {:8.1}\n", c.call, c.arithmetic, c.instructions)
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exercise_is_read_whole_or_refused() {
        let exercise: Exercise = "sample:lanes:7".parse().unwrap();
        assert_eq!((exercise.call, exercise.lanes, exercise.passes), (Call::Sample, true, 7));
        for wrong in ["", "eval", "eval:f64:1", "draw:f32:1", "eval:f32:-1", "eval:f32:1:2"] {
            assert!(wrong.parse::<Exercise>().is_err(), "{wrong}");
        }
    }
}
