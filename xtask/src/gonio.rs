//! `cargo xtask validate` and `cargo xtask tables`: `gonio` as the tests are built, so that all share one build.

use crate::cargo::{Outcome, cargo, program, run as run_program};
use std::process::ExitCode;

/// `gonio validate`. Passes on the exit code: 0 success, 1 an error, 2 wrong usage, 3 a check failed; cargo's 101 if the
/// build failed.
pub(crate) fn validate(arguments: &[String]) -> Outcome {
    gonio("validate", arguments)
}

/// `gonio tables`: writes the kernel's generated source, or with `--check` compares it: exit code 1 if it differs.
pub(crate) fn tables(arguments: &[String]) -> Outcome {
    gonio("tables", arguments)
}

fn gonio(command: &str, arguments: &[String]) -> Outcome {
    let (for_cargo, for_gonio) = split(arguments);
    // With the tests, because what they need switches on features of common dependencies: without them, nearly everything
    // would be built a second time.
    let built = run_program(cargo().args(["build", "--bin", "gonio", "--test", "tests"]).args(for_cargo))?;
    if built != ExitCode::SUCCESS {
        return Ok(built);
    }
    let own = std::env::current_exe().map_err(|e| format!("this program cannot be found: {e}"))?;
    run_program(program(own.with_file_name("gonio")).arg(command).args(for_gonio))
}

/// What is cargo's, `--features LIST` and `--features=LIST`, and the rest.
fn split(arguments: &[String]) -> (Vec<&String>, Vec<&String>) {
    let mut is_list = false;
    arguments.iter().partition(|argument| {
        let features = *argument == "--features";
        std::mem::replace(&mut is_list, features) || features || argument.starts_with("--features=")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_are_for_cargo_and_the_rest_is_for_gonio() {
        let words = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
        let arguments = words("--quick --features embree --only census --features=more");
        let (for_cargo, for_gonio) = split(&arguments);
        assert_eq!(for_cargo, words("--features embree --features=more").iter().collect::<Vec<_>>());
        assert_eq!(for_gonio, words("--quick --only census").iter().collect::<Vec<_>>());
    }
}
