//! `cargo xtask package`: what would be published can be built by those who get it.
//!
//! 1. Every package is made, and its sources are unpacked where neither this repository nor its `.cargo/config.toml` is in reach.
//! 2. Each is checked alone, with nothing but the other packages for its dependencies of ours.
//! 3. The documentation is made as docs.rs does it: `--cfg docsrs`, no flags but those that the manifests tell it, no warnings.
//! 4. All are checked with the oldest compiler that `rust-version` promises, if it is installed.

use crate::cargo::{Outcome, cargo, must, program, root};
use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};

/// What is published, dependencies first; the last one is the program.
const PACKAGES: [&str; 9] = [
    "gonio-kernel",
    "gonio-report",
    "gonio-accel",
    "gonio-lab",
    "gonio-tracer",
    "gonio-io",
    "gonio-verify",
    "gonio-cli",
    "gonio",
];

/// Flags that users are told to set.
const FLAGS: &str = if cfg!(target_arch = "x86_64") { "-C target-cpu=x86-64-v3" } else { "" };

/// The libraries, each with the flags that docs.rs is told in its manifest: those that compile the tracer, which refuses without.
const DOCUMENTED: [(&str, &str); 8] = [
    ("gonio-kernel", ""),
    ("gonio-report", ""),
    ("gonio-accel", ""),
    ("gonio-lab", ""),
    ("gonio-tracer", ""),
    ("gonio-io", FLAGS),
    ("gonio-verify", FLAGS),
    ("gonio-cli", FLAGS),
];

pub(crate) fn run() -> Outcome {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).map_err(|e| format!("Cargo.toml: {e}"))?;
    let (version, oldest) = (value(&manifest, "version")?, value(&manifest, "rust-version")?);
    must(cargo().args(["package", "--workspace", "--exclude", "xtask", "--allow-dirty", "--no-verify", "--quiet"]))?;
    // Outside of the repository, because cargo looks for a workspace and for flags in all folders above.
    let folder = std::env::temp_dir().join(format!("gonio-packages-{}", std::process::id()));
    let result = build(&folder, version, oldest);
    let removed = fs::remove_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()));
    result.and(removed).map(|()| ExitCode::SUCCESS)
}

fn build(folder: &Path, version: &str, oldest: &str) -> Result<(), String> {
    unpack(folder, version)?;
    for name in PACKAGES {
        must(outside(&mut cargo(), folder).args(["check", "--quiet", "--package", name]).env("RUSTFLAGS", FLAGS))?;
        println!("package: {name} {version} builds alone");
    }
    for (name, flags) in DOCUMENTED {
        let mut doc = cargo();
        outside(&mut doc, folder).args(["doc", "--quiet", "--no-deps", "--lib", "--package", name]);
        must(doc.env("RUSTFLAGS", flags).env("RUSTDOCFLAGS", "--cfg docsrs -D warnings"))?;
    }
    println!("package: documented as by docs.rs, without warnings");
    let has_oldest = program("rustup").args(["run", oldest, "rustc", "--version"]).output();
    if !has_oldest.is_ok_and(|output| output.status.success()) {
        println!("package: not built with Rust {oldest}, which is not installed");
        return Ok(());
    }
    let mut check = program("rustup");
    check.args(["run", oldest, "cargo"]).env_remove("CARGO").env_remove("RUSTC").env_remove("RUSTUP_TOOLCHAIN");
    must(outside(&mut check, folder).args(["check", "--quiet", "--workspace"]).env("RUSTFLAGS", FLAGS))?;
    println!("package: all build with Rust {oldest}");
    Ok(())
}

/// Unpacks the packages side by side into a workspace that takes each for its own: nothing of ours comes from elsewhere.
fn unpack(folder: &Path, version: &str) -> Result<(), String> {
    let write = |name: &str, text: &str| {
        fs::write(folder.join(name), text).map_err(|e| format!("{}: {e}", folder.join(name).display()))
    };
    fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let (mut members, mut patches) = (String::new(), String::new());
    for name in PACKAGES {
        let archive = root().join(format!("target/package/{name}-{version}.crate"));
        must(program("tar").arg("-xzf").arg(&archive).arg("-C").arg(folder))?;
        for file in ["README.md", "LICENSE-MIT", "LICENSE-APACHE"] {
            if !folder.join(format!("{name}-{version}")).join(file).is_file() {
                return Err(format!("{}: there is no {file} in it", archive.display()));
            }
        }
        members += &format!("\"{name}-{version}\",");
        patches += &format!("{name} = {{ path = \"{name}-{version}\" }}\n");
    }
    write(
        "Cargo.toml",
        &format!("[workspace]\nresolver = \"3\"\nmembers = [{members}]\n[patch.crates-io]\n{patches}"),
    )?;
    // The versions that everything else is tested with.
    fs::copy(root().join("Cargo.lock"), folder.join("Cargo.lock")).map_err(|e| format!("Cargo.lock: {e}"))?;
    Ok(())
}

/// Has a command start in that folder, and build into this repository's target folder.
fn outside<'a>(command: &'a mut Command, folder: &Path) -> &'a mut Command {
    command.current_dir(folder).env("CARGO_TARGET_DIR", root().join("target/package-check")).stdin(Stdio::null())
}

/// The value of the first line `key = "value"` of a manifest.
fn value<'a>(manifest: &'a str, key: &str) -> Result<&'a str, String> {
    let line = |line: &'a str| line.strip_prefix(key)?.strip_prefix(" = \"")?.strip_suffix('"');
    manifest.lines().find_map(line).ok_or_else(|| format!("Cargo.toml: there is no {key}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_from_their_own_lines() {
        let manifest = "[workspace.package]\nversion = \"0.1.0\"\nrust-version = \"1.89\"\n";
        assert_eq!((value(manifest, "version"), value(manifest, "rust-version")), (Ok("0.1.0"), Ok("1.89")));
        assert!(value(manifest, "edition").is_err());
    }
}
