//! Fuzzing of every parser: whatever bytes a file holds, it loads soundly or is refused, quickly and in bounded memory.
//!
//! Inputs are mutations of a kept corpus (`tests/corpus`), the same in every run. A plain `cargo test` runs a few hundred of
//! each parser; `cargo xtask fuzz` runs a million. The programs in `fuzz/` put the same bodies under a coverage-guided
//! fuzzer. An input that broke a promise goes into the corpus with the fix.

mod bodies;
mod mutate;
mod run;

pub(crate) use run::high_water;

use bodies::{TARGETS, Target};
use std::path::Path;

/// Executions of each target in a plain test run: about a second each.
const FEW: u64 = 400;

/// What `cargo xtask fuzz` asks for.
fn asked<T: std::str::FromStr>(name: &str) -> Option<T> {
    std::env::var(name).ok().map(|text| text.parse().unwrap_or_else(|_| panic!("{name}={text}")))
}

#[test]
fn no_input_breaks_a_parser() {
    let executions = asked("GONIO_FUZZ_EXECUTIONS");
    let only: Option<String> = asked("GONIO_FUZZ_TARGET");
    let known = TARGETS.map(|target| target.name).join(", ");
    let targets: Vec<_> = TARGETS.iter().filter(|t| only.as_ref().is_none_or(|name| name == t.name)).collect();
    assert!(!targets.is_empty(), "the targets are {known}");
    for target in targets {
        match run::run(target, executions.unwrap_or(FEW), executions.is_some()) {
            Ok(report) => {
                println!(
                    "{:<10} {} executions, {:.0} per second, {} outcomes, slowest {:.1?}, most memory {} MiB",
                    target.name,
                    report.executions,
                    report.executions as f64 / report.seconds,
                    report.outcomes.len(),
                    report.slowest,
                    report.memory >> 20
                );
                assert!(report.outcomes.len() > 1, "{}: nothing but {:?}", target.name, report.outcomes);
                if std::env::var_os("GONIO_FUZZ_OUTCOMES").is_some() {
                    report.outcomes.iter().for_each(|outcome| println!("    {outcome}"));
                }
            }
            Err(broken) => panic!("{broken}"),
        }
    }
}

/// A target with the corpus of OBJ files and a planted fault.
fn faulty(body: fn(&Path, &[u8]) -> String) -> Result<(), String> {
    let target = Target { name: "obj", prepare: |_| (), body };
    run::run(&target, 4000, false).map(drop)
}

fn contains(data: &[u8], word: &[u8]) -> bool {
    data.windows(word.len()).any(|window| window == word)
}

#[test]
fn a_fault_that_needs_one_word_is_found() {
    let broken = faulty(|_, data| {
        assert!(!contains(data, b"1e309"), "planted");
        String::new()
    });
    let broken = broken.expect_err("the fault is found");
    let path = broken.rsplit(' ').next().expect("the message ends in a path");
    assert!(broken.starts_with("obj: execution ") && broken.contains(": a panic: planted; the input is "), "{broken}");
    assert!(contains(&std::fs::read(path).expect("the input is kept"), b"1e309"));
    std::fs::remove_file(path).expect("and can be removed");
}

#[test]
fn a_fault_that_needs_a_long_line_is_found() {
    let broken = faulty(|_, data| {
        assert!(data.split(|&byte| byte == b'\n').all(|line| line.len() < 1000), "planted");
        String::new()
    });
    let broken = broken.expect_err("the fault is found");
    std::fs::remove_file(broken.rsplit(' ').next().expect("the message ends in a path")).expect("the input is kept");
}

#[cfg(target_os = "linux")]
#[test]
fn memory_is_measured() {
    let Some(memory) = run::Memory::begin() else { return println!("memory: /proc is not there, not run") };
    let block = std::hint::black_box(vec![1_u8; 100 << 20]);
    assert!(memory.end() >= 90 << 20);
    drop(block);
}
