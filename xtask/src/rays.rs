//! `cargo xtask rays`: the speed of ray casting, by `benches/accel.rs`, beside Embree if it is there.

use crate::cargo::{Outcome, built, cargo, must, program, root, run as run_program};
use std::ffi::OsString;
use std::process::{Command, Stdio};

/// Builds the benchmark, and starts it with these arguments, `--ratio` unless they name something else; on one core, but for
/// what needs two.
pub(crate) fn run(arguments: &[String]) -> Outcome {
    let mut build = cargo();
    build.args(["bench", "--bench", "accel", "--no-run"]);
    if root().join("target/embree/config.toml").exists() || std::env::var_os("EMBREE_LIB_DIR").is_some() {
        build.args(["--features", "embree"]);
    } else {
        eprintln!("rays: Embree is not there (`cargo xtask embree` gets it); obvhs is measured alone");
    }
    let built = built(&mut build, "accel")?;
    let pinned = !arguments.iter().any(|argument| argument == "--threads");
    let mut bench = match last_core().filter(|_| pinned) {
        Some(core) => {
            let mut taskset = program("taskset");
            taskset.args(["-c", &core.to_string()]).arg(built);
            taskset
        }
        None => {
            if pinned {
                eprintln!("rays: there is no taskset; the process may move between cores");
            }
            program(built)
        }
    };
    let modes = ["--ratio", "--build", "--threads", "--sizes", "--instances"];
    let mode = if arguments.iter().any(|argument| modes.contains(&argument.as_str())) { None } else { Some("--ratio") };
    run_program(bench.args(mode).args(arguments))
}

/// The last core that this process may use: interrupts prefer the first. `None` without `taskset`.
fn last_core() -> Option<usize> {
    must(Command::new("taskset").arg("--version").stdout(Stdio::null())).ok()?;
    let own = OsString::from(std::process::id().to_string());
    let output = Command::new("taskset").arg("-cp").arg(own).output().ok()?;
    // "pid 17's current affinity list: 0-3,6"
    let text = String::from_utf8(output.stdout).ok()?;
    text.trim().rsplit([',', '-', ' ']).next()?.parse().ok()
}
