//! The structure of the code: which crate may use which, no import cycles within a crate, no long file without a reason.

mod crates; // The order of the crates, by `cargo metadata`.
mod cycles; // The graph of imports and the cycles in it.
mod imports; // What a module names of others.
mod modules; // The modules of a crate and the names in them.
mod planted; // Source trees with a fault each, and some without.

use modules::Crate;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The crates that are held to have no import cycles, each with its root.
const ACYCLIC: [(&str, &str); 9] = [
    ("crates/kernel/src", "lib.rs"),
    ("crates/accel/src", "lib.rs"),
    ("crates/lab/src", "lib.rs"),
    ("crates/report/src", "lib.rs"),
    ("crates/tracer/src", "lib.rs"),
    ("crates/io/src", "lib.rs"),
    ("crates/verify/src", "lib.rs"),
    ("crates/cli/src", "lib.rs"),
    ("xtask/src", "main.rs"),
];

#[test]
fn no_module_imports_itself_through_others() {
    let mut found = Vec::new();
    for (folder, root) in ACYCLIC {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        let graph = imports::of(&Crate::read(&sources(&folder), root).unwrap());
        found.extend(cycles::cycles(&graph).into_iter().map(|cycle| format!("{}: {cycle}", folder.display())));
    }
    assert!(found.is_empty(), "{} import cycles:\n{}", found.len(), found.join("\n"));
}

/// Folders whose files are held to be short.
const SHORT: [&str; 5] = ["crates", "src", "xtask/src", "tests", "benches"];

/// More lines than that are two thoughts.
const MOST_LINES: usize = 400;

/// How a line among the first ones starts that says why a file is longer.
const REASON: &str = "//! Over 400 lines: ";

#[test]
fn long_files_give_their_reason() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files = SHORT.iter().flat_map(|folder| rust_files(&root.join(folder)));
    let long: Vec<String> = files
        .filter(|file| is_too_long(&fs::read_to_string(file).unwrap()))
        .map(|file| file.display().to_string())
        .collect();
    assert!(long.is_empty(), "over {MOST_LINES} lines without a line {REASON:?} in the head:\n{}", long.join("\n"));
}

#[test]
fn a_long_file_is_noticed_unless_it_gives_a_reason_in_its_head() {
    let of = |head: &str, lines: usize| is_too_long(&format!("{head}{}", "//\n".repeat(lines)));
    assert!(of("", 401) && !of("", 400));
    assert!(!of("//! A proof.\n//! Over 400 lines: it is one.\n", 500));
    assert!(of("//! Over 400 lines:\n", 500), "no reason is given");
    assert!(of(&format!("{}//! Over 400 lines: too late.\n", "//\n".repeat(15)), 500));
}

fn is_too_long(text: &str) -> bool {
    let has_reason =
        text.lines().take(15).any(|line| line.strip_prefix(REASON).is_some_and(|reason| !reason.trim().is_empty()));
    text.lines().count() > MOST_LINES && !has_reason
}

/// The Rust files below a folder: path within it, with slashes, and text.
fn sources(folder: &Path) -> BTreeMap<String, String> {
    let mut files = BTreeMap::new();
    for path in rust_files(folder) {
        let name = path.strip_prefix(folder).unwrap().to_string_lossy().replace('\\', "/");
        files.insert(name, fs::read_to_string(&path).unwrap());
    }
    files
}

/// All Rust files below a folder.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}
