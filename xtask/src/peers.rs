//! Speed beside that of Mitsuba 3: `cargo xtask peers` for pictures by `benches/peers.py`, `cargo xtask bsdfs` for scattering
//! models by `benches/bsdfs.py`.

use crate::cargo::{Outcome, cargo, must, program, run as run_program};
use std::process::Stdio;

/// The Cornell box.
pub(crate) fn pictures(arguments: &[String]) -> Outcome {
    let (python, passed_on) = options("peers", &["--rounds", "--spp"], arguments)?;
    must(cargo().args(["build", "--release", "--bin", "gonio"]))?;
    run_program(program(&python).args(["benches/peers.py", "--gonio", "target/release/gonio"]).args(passed_on))
}

/// The lobes. The script starts the built benchmark itself, as its partner.
pub(crate) fn lobes(arguments: &[String]) -> Outcome {
    let (python, passed_on) = options("bsdfs", &["--rounds", "--only"], arguments)?;
    must(cargo().args(["bench", "--bench", "kernel", "--no-run"]))?;
    run_program(program(&python).arg("benches/bsdfs.py").args(passed_on))
}

/// A Python that has Mitsuba, and the options that are the script's.
fn options<'a>(command: &str, scripts: &[&str], arguments: &'a [String]) -> Result<(String, Vec<&'a String>), String> {
    let mut python = "python3".to_owned();
    let mut passed_on = Vec::new();
    let mut arguments = arguments.iter();
    while let Some(option) = arguments.next() {
        let value = arguments.next().ok_or_else(|| format!("{command}: {option} needs a value"))?;
        match option.as_str() {
            "--python" => python.clone_from(value),
            known if scripts.contains(&known) => passed_on.extend([option, value]),
            _ => return Err(format!("{command}: no such option: {option}")),
        }
    }
    let importable = program(&python)
        .args(["-c", "import mitsuba"])
        .stderr(Stdio::null())
        .status()
        .map_err(|e| format!("{command}: cannot start {python}: {e}"))?;
    if !importable.success() {
        return Err(format!(
            "{command}: {python} cannot import mitsuba. Install it with `{python} -m pip install mitsuba==3.9.1`, or name \
             a Python that has it with --python PATH."
        ));
    }
    Ok((python, passed_on))
}
