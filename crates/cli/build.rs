//! Tells the program which compiler and target made it, for the environment section of a validation report.

use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let version = Command::new(rustc).arg("--version").output().ok().filter(|output| output.status.success());
    if let Some(version) = version.and_then(|output| String::from_utf8(output.stdout).ok()) {
        println!("cargo:rustc-env=GONIO_RUSTC={}", version.trim());
    }
    if let Ok(target) = std::env::var("TARGET") {
        println!("cargo:rustc-env=GONIO_TARGET={target}");
    }
}
