//! `cargo xtask embree`: gets what the feature `embree` needs, once.
//!
//! 1. The library Embree 4: that of the system, or else a private copy below `target/embree`, out of the Python package
//!    [`EMBREE`], whose wheel carries the library and the TBB that it needs.
//! 2. libclang, with which the bindings are made at build time: that of the system, or else a private copy out of the Python
//!    package [`CLANG`]. It comes without the headers of a compiler; those of the C compiler that links our programs serve.
//!
//! Where both are is written to `target/embree/config.toml`, which `.cargo/config.toml` includes if it is there. From then on plain cargo
//! does: `cargo test --features embree`. Run again, it looks again, and downloads only what is missing.

use crate::cargo::{Outcome, program, root};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// The Python package that carries Embree, and its version.
const EMBREE: &str = "embreex==4.4.0.post1";
/// The Python package that carries libclang, and its version.
const CLANG: &str = "libclang==18.1.1";

/// What everybody calls the library; a wheel has a hash in the name.
const LIBRARY: &str = "libembree4.so";

pub(crate) fn run() -> Outcome {
    if !cfg!(target_os = "linux") {
        return Err(
            "embree: this command knows Linux alone. Install Embree 4 and libclang, and set EMBREE_LIB_DIR to \
                    the folder of the library."
                .to_owned(),
        );
    }
    let home = root().join("target/embree");
    fs::create_dir_all(&home).map_err(|e| format!("{}: cannot be made: {e}", home.display()))?;
    let library = match system_embree() {
        Some(folder) => folder,
        None => private_embree(&home)?,
    };
    println!("embree: the library is {}", library.join(LIBRARY).display());
    let mut config = String::from("# Written by `cargo xtask embree`; included by .cargo/config.toml.\n[env]\n");
    let mut set = |name: &str, value: &str| writeln!(config, "{name} = {value:?}").expect("text can be written");
    set("EMBREE_LIB_DIR", utf8(&library)?);
    if let Some(found) = system_clang() {
        println!("embree: libclang is {}", found.display());
    } else {
        let folder = private_clang(&home)?;
        println!("embree: libclang is {}", folder.join("libclang.so").display());
        set("LIBCLANG_PATH", utf8(&folder)?);
        set("BINDGEN_EXTRA_CLANG_ARGS", &format!("-isystem {}", compiler_headers()?));
    }
    let path = home.join("config.toml");
    fs::write(&path, config).map_err(|e| format!("{}: cannot be written: {e}", path.display()))?;
    println!("embree: ready; add `--features embree` to cargo build, test or run");
    Ok(ExitCode::SUCCESS)
}

fn utf8(path: &Path) -> Result<&str, String> {
    path.to_str()
        .ok_or_else(|| format!("{}: a path that is not UTF-8 cannot be written to a file of cargo", path.display()))
}

/// The folder of an installed Embree 4 with its link for linkers, as development packages have it.
fn system_embree() -> Option<PathBuf> {
    let named = std::env::var_os("EMBREE_LIB_DIR").map(PathBuf::from);
    let asked = ["embree4", "embree"].into_iter().filter_map(|name| {
        let output = Command::new("pkg-config").args(["--variable=libdir", name]).output().ok()?;
        Some(PathBuf::from(String::from_utf8(output.stdout).ok()?.trim()))
    });
    let usual = [
        "/usr/lib/x86_64-linux-gnu",
        "/usr/lib64",
        "/usr/lib",
        "/usr/local/lib64",
        "/usr/local/lib",
        "/opt/embree/lib",
    ];
    // A private copy of an earlier run may be what the variable names: that is not the system's.
    let own = root().join("target/embree");
    let folders = named.into_iter().chain(asked).chain(usual.map(PathBuf::from));
    folders.filter(|folder| !folder.starts_with(&own)).find(|folder| folder.join(LIBRARY).exists())
}

/// A libclang where bindgen looks for it unasked.
fn system_clang() -> Option<PathBuf> {
    let is_clang = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let versioned = name.starts_with("libclang-") && name.contains(".so") && !name.contains("-cpp."); // another library
        name == "libclang.so" || name.starts_with("libclang.so.") || versioned
    };
    let llvm = fs::read_dir("/usr/lib").into_iter().flatten().flatten().map(|entry| entry.path());
    let llvm = llvm.filter(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("llvm-")));
    let usual = ["/usr/lib/x86_64-linux-gnu", "/usr/lib64", "/usr/lib", "/usr/local/lib"].map(PathBuf::from);
    let folders = usual.into_iter().chain(llvm.map(|path| path.join("lib")));
    folders.flat_map(|folder| fs::read_dir(folder).into_iter().flatten().flatten()).map(|e| e.path()).find(is_clang)
}

/// A copy of the library below `home`, its folder.
fn private_embree(home: &Path) -> Result<PathBuf, String> {
    let unpacked = wheel(home, EMBREE)?;
    let folder = unpacked.join("embreex.libs");
    let hashed = fs::read_dir(&folder).into_iter().flatten().flatten().map(|entry| entry.file_name());
    let hashed = hashed.filter(|name| name.to_string_lossy().starts_with("libembree4-")).min();
    let hashed = hashed.ok_or_else(|| format!("{}: {EMBREE} has no library there", folder.display()))?;
    let link = folder.join(LIBRARY);
    // Programs look for the hashed name; only the linker needs this one.
    #[cfg(unix)]
    if !link.exists() {
        std::os::unix::fs::symlink(&hashed, &link).map_err(|e| format!("{}: cannot be made: {e}", link.display()))?;
    }
    let _ = hashed;
    Ok(folder)
}

/// A copy of libclang below `home`, its folder.
fn private_clang(home: &Path) -> Result<PathBuf, String> {
    let unpacked = wheel(home, CLANG)?;
    let folder = unpacked.join(format!("{}.data/platlib/clang/native", CLANG.replace("==", "-")));
    if folder.join("libclang.so").exists() {
        Ok(folder)
    } else {
        Err(format!("{}: {CLANG} has no library there", folder.display()))
    }
}

/// Unpacks a Python package to a folder of its own, unless that was done.
fn wheel(home: &Path, package: &str) -> Result<PathBuf, String> {
    let unpacked = home.join(package.replace("==", "-"));
    if unpacked.exists() {
        return Ok(unpacked);
    }
    let python = python()?;
    let (download, part) = (home.join("download"), home.join("unpacking"));
    for folder in [&download, &part] {
        let _ = fs::remove_dir_all(folder); // of a run that was stopped
    }
    println!("embree: downloading {package}");
    let mut pip = program(python);
    pip.args([
        "-m",
        "pip",
        "download",
        "--quiet",
        "--disable-pip-version-check",
        "--no-deps",
        "--only-binary=:all:",
        "--dest",
    ]);
    must(pip.arg(&download).arg(package), &format!("{package} cannot be downloaded (is there a network?)"))?;
    let wheel = fs::read_dir(&download).into_iter().flatten().flatten().map(|entry| entry.path()).next();
    let wheel = wheel.ok_or_else(|| format!("{}: pip left nothing there", download.display()))?;
    must(
        program(python).args(["-m", "zipfile", "-e"]).arg(wheel).arg(&part),
        &format!("{package} cannot be unpacked"),
    )?;
    fs::rename(&part, &unpacked).map_err(|e| format!("{}: cannot be made: {e}", unpacked.display()))?;
    let _ = fs::remove_dir_all(&download); // no longer needed; harmless if it stays
    Ok(unpacked)
}

/// A Python with pip.
fn python() -> Result<&'static str, String> {
    let has_pip = |name: &&str| {
        let output = Command::new(name).args(["-m", "pip", "--version"]).output();
        output.is_ok_and(|output| output.status.success())
    };
    ["python3", "python"].into_iter().find(has_pip).ok_or_else(|| {
        "embree: there is no Embree 4 on this system, and no Python with pip to get a copy with. Either install Embree 4 \
         with its development files (Debian from 13 on, Ubuntu from 24.04 on: `apt-get install libembree-dev libclang-dev`), or \
         Python (`apt-get install python3-pip`), and run this again."
            .to_owned()
    })
}

/// The folder of `stddef.h` and its kin.
fn compiler_headers() -> Result<String, String> {
    let missing = "embree: libclang needs the headers of a C compiler: `apt-get install gcc`";
    let output = Command::new("cc").arg("-print-file-name=include").output().map_err(|e| format!("{missing} ({e})"))?;
    let folder = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    if Path::new(&folder).join("stddef.h").exists() { Ok(folder) } else { Err(missing.to_owned()) }
}

fn must(command: &mut Command, failure: &str) -> Result<(), String> {
    crate::cargo::must(command).map_err(|error| format!("embree: {failure}: {error}"))
}
