//! With the feature `embree`: tells the linker where Embree is, as `cargo xtask embree` found it.
//!
//! `EMBREE_LIB_DIR` names the folder; `.cargo/config.toml` sets it to what the command found. The folder becomes a link inside of
//! OUT_DIR, because cargo lets the programs that it runs, tests among them, search such folders for libraries, but only those
//! inside of its own. A program that is started without cargo needs a run path, which only its own package can
//! ask for: see the build script of the root package.

use std::env::{var, var_os};
use std::path::{Path, PathBuf};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if var_os("CARGO_FEATURE_EMBREE").is_none() {
        return;
    }
    println!("cargo:rerun-if-env-changed=EMBREE_LIB_DIR");
    let folder = var_os("EMBREE_LIB_DIR").map(PathBuf::from).filter(|folder| has_embree(folder));
    let Some(folder) = folder else {
        let found =
            var("EMBREE_LIB_DIR").map_or("is not set".to_owned(), |path| format!("is {path:?}, which has none"));
        println!(
            "cargo::error=the feature `embree` needs the library Embree 4: run `cargo xtask embree` (EMBREE_LIB_DIR {found})"
        );
        return;
    };
    println!("cargo:rerun-if-changed={}", folder.display());
    let link = PathBuf::from(var_os("OUT_DIR").expect("cargo sets OUT_DIR")).join("embree");
    println!("cargo:rustc-link-search=native={}", linked(&folder, &link).display());
}

fn has_embree(folder: &Path) -> bool {
    ["libembree4.so", "libembree4.dylib", "embree4.lib"].iter().any(|name| folder.join(name).exists())
}

/// The link to the folder, or the folder itself where links cannot be made.
fn linked<'a>(folder: &'a Path, link: &'a Path) -> &'a Path {
    let _ = std::fs::remove_file(link); // of an earlier run
    #[cfg(unix)]
    if std::os::unix::fs::symlink(folder, link).is_ok() {
        return link;
    }
    folder
}
