//! Runs `benches/counts.rs` under callgrind, one process for each group of rows, and reads what each row counted.
//!
//! Two functions of that program are known here by name: callgrind counts while one of them runs, and writes down and clears
//! its counters when the other, which surrounds it, is left. One function cannot serve both: callgrind 3.19 ignores
//! `--toggle-collect` where `--dump-after` applies.

use crate::cargo::{built, cargo, program, root};
use std::path::Path;
use std::process::{Command, Stdio};

/// Where callgrind writes.
const OUTPUT: &str = "target/counts";

/// The instructions of a row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Count {
    /// GROUP/ROW.
    pub(crate) row: String,
    pub(crate) instructions: u64,
}

pub(crate) fn runs_here() -> bool {
    cfg!(all(target_os = "linux", target_arch = "x86_64"))
}

/// Counts every row.
pub(crate) fn count() -> Result<Vec<Count>, String> {
    Command::new("valgrind").arg("--version").stdout(Stdio::null()).status().map_err(|error| {
        format!("cannot start valgrind ({error}). Install it, on Debian and Ubuntu with `apt-get install valgrind`.")
    })?;
    // As the tests are built.
    let counts = built(cargo().args(["build", "--bench", "counts"]), "counts")?;
    let directory = root().join(OUTPUT);
    std::fs::create_dir_all(&directory).map_err(|error| format!("{}: {error}", directory.display()))?;

    let listed = output(Command::new(&counts).arg("--list"))?;
    let mut groups: Vec<&str> = listed.lines().filter_map(|row| row.split('/').next()).collect();
    groups.dedup();
    let mut all = Vec::new();
    for group in groups {
        all.extend(count_group(&counts, group, &directory.join(group))?);
    }
    let rows: Vec<&str> = listed.lines().collect();
    let counted: Vec<&str> = all.iter().map(|count| count.row.as_str()).collect();
    if rows == counted { Ok(all) } else { Err(format!("listed were {rows:?}, counted were {counted:?}")) }
}

/// The rows of a group, in one run.
fn count_group(counts: &Path, group: &str, file: &Path) -> Result<Vec<Count>, String> {
    let mut valgrind = program("valgrind");
    valgrind.args(["--quiet", "--tool=callgrind", "--combine-dumps=yes"]);
    valgrind.args(["--toggle-collect=*counted_by_the_gate*", "--dump-after=*dumped_by_the_gate*"]);
    valgrind.arg(format!("--callgrind-out-file={}", file.display())).arg(counts).arg(group);
    let rows = output(&mut valgrind)?;
    let profile = std::fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let totals = totals(&profile).ok_or_else(|| format!("{}: a total is not a number", file.display()))?;
    pair(&rows, &totals).map_err(|error| format!("{group}: {error}"))
}

/// The total of each dump in a profile.
fn totals(profile: &str) -> Option<Vec<u64>> {
    profile.lines().filter_map(|line| line.strip_prefix("totals: ")).map(|total| total.trim().parse().ok()).collect()
}

/// Each row with its dump. The last dump is what comes after all rows, in which nothing is counted.
fn pair(rows: &str, totals: &[u64]) -> Result<Vec<Count>, String> {
    let rows: Vec<&str> = rows.lines().collect();
    match totals.split_last() {
        Some((0, dumps)) if !rows.is_empty() && rows.len() == dumps.len() && !dumps.contains(&0) => {
            let count = |(&row, &instructions): (&&str, &u64)| Count { row: row.to_owned(), instructions };
            Ok(rows.iter().zip(dumps).map(count).collect())
        }
        _ => Err(format!("of {} rows and what comes after them callgrind counted {totals:?}", rows.len())),
    }
}

/// What a command that must succeed prints; what it says on stderr is part of the error.
fn output(command: &mut Command) -> Result<String, String> {
    let output = command.stdout(Stdio::piped()).output();
    let output = output.map_err(|error| format!("cannot start {:?}: {error}", command.get_program()))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(format!("{command:?}: {}\n{said}", output.status));
    }
    String::from_utf8(output.stdout).map_err(|error| format!("{command:?}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_the_total_of_its_dump() {
        let profile = "part: 1\ntotals: 12\n\npart: 2\ntotals: 34\n\npart: 3\ntotals: 0\n";
        let counts = pair("a/x\na/y\n", &totals(profile).unwrap()).unwrap();
        let pairs: Vec<_> = counts.iter().map(|count| (count.row.as_str(), count.instructions)).collect();
        assert_eq!(pairs, [("a/x", 12), ("a/y", 34)]);
    }

    #[test]
    fn totals_that_do_not_fit_the_rows_are_an_error() {
        for (rows, totals) in [
            ("a/x\n", &[][..]),         // no profile
            ("", &[0]),                 // no row
            ("a/x\n", &[5]),            // counted until the end: a function was not found
            ("a/x\n", &[5, 1]),         // counted outside of rows
            ("a/x\n", &[5, 6, 0]),      // dumped more often than there are rows
            ("a/x\na/y\n", &[5, 0]),    // or less often
            ("a/x\na/y\n", &[5, 0, 0]), // a row of nothing: the work was optimised away
        ] {
            assert!(pair(rows, totals).is_err(), "{rows:?} {totals:?}");
        }
    }
}
