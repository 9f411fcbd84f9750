//! `cargo xtask`: what takes more than one plain cargo command. It orchestrates, links none of our crates, and needs
//! nothing but std, so that it builds in a second.

#![forbid(unsafe_code)]

mod bench;
mod cargo;
mod ci;
mod elf;
mod embed;
mod embree;
mod fuzz;
mod gonio;
mod no_std;
mod package;
mod peers;
mod rays;
mod sources;

use std::process::ExitCode;

const USAGE: &str = "\
cargo xtask validate [--features LIST] [ARG]...
                                 build as the tests are built, then `gonio validate ARG...` from the root of the
                                 repository; exit code 0 passed, 1 error, 2 wrong usage, 3 a check failed
cargo xtask embree               get what the feature `embree` needs, if the system does not have it
cargo xtask embed                build and run programs that use the crates from outside, without this repository's flags
cargo xtask no-std               prove that the kernel needs no std, no allocator and cannot panic
cargo xtask peers [--rounds N] [--spp N] [--python PATH]
                                 the Cornell box against Mitsuba 3, in turns; Python with mitsuba is `python3`
cargo xtask bsdfs [--rounds N] [--only TEXT] [--python PATH]
                                 the lobes against Mitsuba 3, in turns: eight lanes, in-cache batches
cargo xtask bench                all ratios of times, only reported: `ratio`, `bsdfs`, `rays`
cargo xtask bench --gate         count instructions by callgrind and compare with benches/limits.toml; exit code 3 if a row
                                 rose beyond its limit, is new or is missing
cargo xtask bench --accept REASON [--only ROW]
                                 write what is counted now into benches/limits.toml, with the reason
cargo xtask rays [--ratio | --build | --threads | --sizes | --instances] [ARG]...
                                 the speed of ray casting beside Embree, on one core: see benches/accel.rs
cargo xtask ratio                how much faster eight lanes are than one direction at a time
cargo xtask fuzz [--executions N] [--target NAME]
                                 N inputs for each parser, 1,000,000 unless told; what broke one stays in target/fuzz
cargo xtask tables [--check]     write the kernel's generated tables, or exit 1 if they would differ
cargo xtask package              build what would be published: each package alone, its documentation as docs.rs makes it, all with
                                 the oldest compiler that is promised
cargo xtask ci                   all that CI runs: .ci/run
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((command, rest)) = arguments.split_first() else {
        print!("{USAGE}");
        return ExitCode::SUCCESS;
    };
    let result = match (command.as_str(), rest) {
        ("validate", rest) => gonio::validate(rest),
        ("embree", []) => embree::run(),
        ("embed", []) => embed::run(),
        ("no-std", []) => no_std::run(),
        ("peers", rest) => peers::pictures(rest),
        ("bsdfs", rest) => peers::lobes(rest),
        ("bench", rest) => bench::run(rest),
        ("ratio", []) => bench::ratio(),
        ("rays", rest) => rays::run(rest),
        ("fuzz", rest) => fuzz::run(rest),
        ("tables", rest) => gonio::tables(rest),
        ("package", []) => package::run(),
        ("ci", []) => ci::run(),
        ("help" | "-h" | "--help", []) => {
            print!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        _ => Err(format!("no such command: {}\n{USAGE}", arguments.join(" "))),
    };
    result.unwrap_or_else(|error| {
        eprintln!("xtask: {error}");
        ExitCode::FAILURE
    })
}
