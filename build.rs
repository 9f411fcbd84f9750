//! With the feature `embree`: programs and tests of this package find the library where it was linked, however they are started.
//! `crates/accel/build.rs` has the rest.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=EMBREE_LIB_DIR");
    let embree = std::env::var_os("CARGO_FEATURE_EMBREE").is_some();
    let unix = std::env::var_os("CARGO_CFG_UNIX").is_some();
    if let (true, true, Ok(folder)) = (embree, unix, std::env::var("EMBREE_LIB_DIR")) {
        println!("cargo:rustc-link-arg=-Wl,-rpath,{folder}");
    }
}
