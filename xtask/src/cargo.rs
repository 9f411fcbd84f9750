//! Starting other programs from the root of the repository, with the one sentence that explains a failure.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

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

/// Runs a cargo command that builds the benchmark of that name; where the program is, by what cargo says of it.
pub(crate) fn built(build: &mut Command, bench: &str) -> Result<PathBuf, String> {
    build.arg("--message-format=json-render-diagnostics").stderr(Stdio::inherit());
    let output = build.output().map_err(|e| format!("cannot start cargo: {e}"))?;
    if !output.status.success() {
        return Err(format!("the benchmark {bench} cannot be built"));
    }
    let messages = String::from_utf8_lossy(&output.stdout);
    let path = messages.lines().find_map(|message| executable(message, bench));
    path.ok_or_else(|| format!("cargo does not say where the benchmark {bench} is"))
}

/// The path in cargo's message about a target of that name, if it is a program; paths of ours need no escapes.
fn executable(message: &str, name: &str) -> Option<PathBuf> {
    let (target, rest) = message.split_once("\"executable\":\"")?;
    target.contains(&format!("\"name\":\"{name}\"")).then(|| rest.split_once('"'))?.map(|(path, _)| path.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cargo_says_where_a_program_is() {
        let message =
            r#"{"target":{"kind":["bench"],"name":"counts"},"executable":"/target/debug/deps/counts-1f","fresh":true}"#;
        assert_eq!(executable(message, "counts"), Some("/target/debug/deps/counts-1f".into()));
        assert_eq!(executable(message, "gonio"), None);
        assert_eq!(executable(r#"{"target":{"name":"counts"},"executable":null}"#, "counts"), None);
    }
}
