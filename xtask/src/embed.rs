//! `cargo xtask embed`: builds and runs the programs of `tests/embed` as their owners would.
//!
//! They are no members of the workspace and start from a folder outside of it, so that nothing of `.cargo/config.toml` reaches
//! them: the kernel and the laboratory must build and be right without our flags. The tracer asks for one flag, and without it
//! the build must stop with the sentence that says so.

use crate::cargo::{Outcome, cargo, must, root};
use std::path::Path;
use std::process::{Command, ExitCode};

/// The programs, each with the flags that it needs, and how many lines they may take: they show what an embedding costs.
const PROGRAMS: [(&str, &str); 3] = [("own-lobe", ""), ("eight-metals", ""), ("spotlit", FLAG)];
/// What the tracer asks for on x86-64.
const FLAG: &str = if cfg!(target_arch = "x86_64") { "-C target-cpu=x86-64-v3" } else { "" };
/// What it says without.
const REFUSAL: &str = "error: gonio-tracer needs AVX2 and FMA on x86-64";
const MOST_LINES: usize = 59;

pub(crate) fn run() -> Outcome {
    for (name, flags) in PROGRAMS {
        let folder = root().join("tests/embed").join(name);
        let main = folder.join("src/main.rs");
        let text = std::fs::read_to_string(&main).map_err(|e| format!("{}: {e}", main.display()))?;
        let lines = text.lines().count();
        if lines > MOST_LINES {
            return Err(format!("{}: {lines} lines; at most {MOST_LINES} are shown", main.display()));
        }
        must(&mut from_outside("run", &folder, flags))?;
        if !flags.is_empty() {
            let output = from_outside("check", &folder, "").output().map_err(|e| format!("cannot start cargo: {e}"))?;
            let said = String::from_utf8_lossy(&output.stderr);
            if output.status.success() || said.matches(REFUSAL).count() != 1 || said.matches("error: ").count() > 2 {
                return Err(format!("{name}: without {flags} the build must stop with one sentence, not:\n{said}"));
            }
        }
        let with = if flags.is_empty() { "without flags".to_owned() } else { format!("with {flags}") };
        println!("embed: {name} builds {with} and runs ({lines} lines)");
    }
    Ok(ExitCode::SUCCESS)
}

/// A cargo command about a program, started outside of this repository.
fn from_outside(command: &str, folder: &Path, flags: &str) -> Command {
    let mut cargo = cargo();
    cargo.args([command, "--quiet", "--manifest-path"]).arg(folder.join("Cargo.toml"));
    cargo.arg("--target-dir").arg(root().join("target/embed"));
    // Flags come from the folder in which cargo starts, and from the environment.
    cargo.current_dir(std::env::temp_dir()).env_remove("CARGO_ENCODED_RUSTFLAGS").env("RUSTFLAGS", flags);
    cargo
}
