//! `cargo xtask peers`: the speed of Gonio beside that of Mitsuba 3, by `benches/peers.py`.

use crate::cargo::{Outcome, cargo, must, program, run as run_program};
use std::process::Stdio;

pub(crate) fn run(arguments: &[String]) -> Outcome {
    let mut python = "python3".to_owned();
    let mut passed_on = Vec::new();
    let mut arguments = arguments.iter();
    while let Some(option) = arguments.next() {
        let value = arguments.next().ok_or_else(|| format!("peers: {option} needs a value"))?;
        match option.as_str() {
            "--python" => python.clone_from(value),
            "--rounds" | "--spp" => passed_on.extend([option, value]),
            _ => return Err(format!("peers: no such option: {option}")),
        }
    }
    let importable = program(&python)
        .args(["-c", "import mitsuba"])
        .stderr(Stdio::null())
        .status()
        .map_err(|e| format!("peers: cannot start {python}: {e}"))?;
    if !importable.success() {
        return Err(format!(
            "peers: {python} cannot import mitsuba. Install it with `{python} -m pip install mitsuba==3.9.1`, or name \
             a Python that has it with --python PATH."
        ));
    }
    must(cargo().args(["build", "--release", "--bin", "gonio"]))?;
    run_program(program(&python).args(["benches/peers.py", "--gonio", "target/release/gonio"]).args(passed_on))
}
