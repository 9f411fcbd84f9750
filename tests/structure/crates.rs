//! The order of the crates: dependencies go one way only, by the list below.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// Each crate and those of ours that it may depend on. A crate that is not here fails.
const ALLOWED: [(&str, &[&str]); 11] = [
    ("gonio-kernel", &[]),
    ("gonio-report", &[]),
    ("gonio-accel", &["gonio-kernel"]),
    ("gonio-lab", &["gonio-kernel", "gonio-report"]),
    ("gonio-tracer", &["gonio-kernel", "gonio-accel"]),
    ("gonio-io", &["gonio-tracer", "gonio-kernel", "gonio-accel"]),
    ("gonio-measured", &["gonio-io", "gonio-tracer", "gonio-lab", "gonio-report", "gonio-kernel"]),
    (
        "gonio-verify",
        &["gonio-measured", "gonio-io", "gonio-tracer", "gonio-lab", "gonio-report", "gonio-accel", "gonio-kernel"],
    ),
    (
        "gonio-cli",
        &[
            "gonio-verify",
            "gonio-measured",
            "gonio-io",
            "gonio-tracer",
            "gonio-lab",
            "gonio-report",
            "gonio-accel",
            "gonio-kernel",
        ],
    ),
    ("xtask", &[]),
    ("gonio", &["gonio-cli"]),
];

/// The package whose tests cross crates: its dev-dependencies are free, because nothing depends on it.
const ROOT: &str = "gonio";

/// What a package depends on among the packages of the workspace.
#[derive(Default)]
struct Package {
    normal: BTreeSet<String>,
    dev: BTreeSet<String>,
}

type Packages = BTreeMap<String, Package>;

#[test]
fn dependencies_go_one_way_only() {
    let faults = faults(&workspace());
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn wrong_dependencies_are_noticed() {
    let package = |normal: &[&str], dev: &[&str]| Package {
        normal: normal.iter().map(|&name| name.to_owned()).collect(),
        dev: dev.iter().map(|&name| name.to_owned()).collect(),
    };
    let of = |packages: Vec<(&str, Package)>| {
        faults(&packages.into_iter().map(|(name, package)| (name.to_owned(), package)).collect())
    };
    let kernel = || ("gonio-kernel", package(&[], &[]));
    let accel = || ("gonio-accel", package(&["gonio-kernel"], &[]));
    assert!(of(vec![kernel(), accel(), ("gonio-tracer", package(&["gonio-accel"], &[]))]).is_empty());
    assert!(of(vec![kernel(), ("gonio", package(&[], &["gonio-kernel"]))]).is_empty());
    assert_eq!(of(vec![kernel(), ("gonio-extra", package(&[], &[]))]), ["gonio-extra is not in the list of crates"]);
    assert_eq!(
        of(vec![kernel(), accel(), ("gonio-lab", package(&["gonio-accel"], &[]))]),
        ["gonio-lab may not depend on gonio-accel"]
    );
    assert_eq!(
        of(vec![("gonio-kernel", package(&[], &["gonio-accel"])), accel()]),
        ["gonio-kernel depends on itself by its dev-dependency gonio-accel"]
    );
}

fn faults(packages: &Packages) -> Vec<String> {
    let mut faults = Vec::new();
    for (name, package) in packages {
        let Some((_, allowed)) = ALLOWED.iter().find(|(listed, _)| listed == name) else {
            faults.push(format!("{name} is not in the list of crates"));
            continue;
        };
        let wrong = package.normal.iter().filter(|dependency| !allowed.contains(&dependency.as_str()));
        faults.extend(wrong.map(|dependency| format!("{name} may not depend on {dependency}")));
        if name != ROOT {
            let wrong = package.dev.iter().filter(|&dependency| reaches(packages, dependency, name));
            faults
                .extend(wrong.map(|dependency| format!("{name} depends on itself by its dev-dependency {dependency}")));
        }
    }
    faults
}

/// Whether `from` is `to` or depends on it, dev-dependencies included.
fn reaches(packages: &Packages, from: &str, to: &str) -> bool {
    let mut seen = BTreeSet::new();
    let mut open = vec![from];
    while let Some(name) = open.pop() {
        if name == to {
            return true;
        }
        if let Some(package) = packages.get(name)
            && seen.insert(name)
        {
            open.extend(package.normal.iter().chain(&package.dev).map(String::as_str));
        }
    }
    false
}

/// The packages of the workspace, as cargo sees them.
fn workspace() -> Packages {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let ours: BTreeSet<String> = packages.iter().map(|package| text(&package["name"])).collect();
    let read = |package: &Value| {
        let mut read = Package::default();
        for dependency in package["dependencies"].as_array().unwrap() {
            let name = text(&dependency["name"]);
            if ours.contains(&name) {
                // A build dependency orders crates as a normal one does.
                let list = if dependency["kind"] == "dev" { &mut read.dev } else { &mut read.normal };
                list.insert(name);
            }
        }
        (text(&package["name"]), read)
    };
    packages.iter().map(read).collect()
}
