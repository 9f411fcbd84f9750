//! Starting other programs from the root of the repository, with the one sentence that explains a failure.

use std::path::Path;
use std::process::{Command, ExitCode};

/// What a command of ours returns: an exit code to pass on, or what went wrong.
pub(crate) type Outcome = Result<ExitCode, String>;

/// The root of the repository.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."))
}

/// The cargo that runs us, in the root of the repository.
pub(crate) fn cargo() -> Command {
    program(std::env::var_os("CARGO").unwrap_or("cargo".into()))
}

/// A program, in the root of the repository.
pub(crate) fn program(name: impl AsRef<std::ffi::OsStr>) -> Command {
    let mut command = Command::new(name);
    command.current_dir(root());
    command
}

/// Runs a command and passes on its exit code; a program that a signal ended counts as a failure.
pub(crate) fn run(command: &mut Command) -> Outcome {
    let status = command.status().map_err(|e| format!("cannot start {:?}: {e}", command.get_program()))?;
    let code = status.code().ok_or_else(|| format!("{:?} was ended: {status}", command.get_program()))?;
    Ok(ExitCode::from(u8::try_from(code).unwrap_or(u8::MAX)))
}

/// Runs a command that must succeed.
pub(crate) fn must(command: &mut Command) -> Result<(), String> {
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{command:?}: {status}")),
        Err(e) => Err(format!("cannot start {:?}: {e}", command.get_program())),
    }
}
