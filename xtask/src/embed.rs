//! `cargo xtask embed`: builds and runs the programs of `tests/embed` as their owners would.
//!
//! They are no members of the workspace and start from a folder outside of it, so that nothing of `.cargo/config.toml` reaches
//! them: the crates must build and be right without our flags.

use crate::cargo::{Outcome, cargo, must, root};
use std::process::ExitCode;

/// The programs, and how many lines they may take: they show what an embedding costs.
const PROGRAMS: [&str; 2] = ["own-lobe", "eight-metals"];
const MOST_LINES: usize = 60;

pub(crate) fn run() -> Outcome {
    for name in PROGRAMS {
        let folder = root().join("tests/embed").join(name);
        let main = folder.join("src/main.rs");
        let text = std::fs::read_to_string(&main).map_err(|e| format!("{}: {e}", main.display()))?;
        let lines = text.lines().count();
        if lines > MOST_LINES {
            return Err(format!("{}: {lines} lines; at most {MOST_LINES} are shown", main.display()));
        }
        let mut command = cargo();
        command.args(["run", "--quiet", "--manifest-path"]).arg(folder.join("Cargo.toml"));
        command.arg("--target-dir").arg(root().join("target/embed"));
        // Flags come from the folder in which cargo starts, and from the environment.
        command.current_dir(std::env::temp_dir()).env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
        must(&mut command)?;
        println!("embed: {name} builds without flags and runs ({lines} lines)");
    }
    Ok(ExitCode::SUCCESS)
}
