//! With the feature `embree`: programs and tests of this package find the library where it was linked, however they are started.
//! `crates/accel/build.rs` has the rest.

use std::env::{var, var_os};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if var_os("CARGO_FEATURE_EMBREE").is_none() || var_os("CARGO_CFG_UNIX").is_none() {
        return;
    }
    println!("cargo:rerun-if-env-changed=EMBREE_LIB_DIR");
    if let Ok(folder) = var("EMBREE_LIB_DIR") {
        println!("cargo:rustc-link-arg=-Wl,-rpath,{folder}");
    }
}
