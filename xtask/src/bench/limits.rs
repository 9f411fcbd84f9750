//! `benches/limits.toml`: what each row counted when somebody last accepted a change, and the sentence why.
//!
//! Read by `parse.rs`; written by `cargo xtask bench --accept`.

use super::callgrind::Count;
use std::fmt;

/// How many percent a row may rise that does not say otherwise.
pub(super) const RISE: f64 = 2.0;
/// A row that moved by no more percent than this keeps its number and its reason when a change is accepted.
const MOVED: f64 = 0.1;

/// The file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Limits {
    /// The comment at the top.
    pub(super) head: String,
    pub(super) build: Build,
    /// By name, in the order of counting.
    pub(crate) rows: Vec<(String, Limit)>,
}

/// What counts belong to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Build {
    pub(super) rustc: String,
    pub(super) target: String,
}

/// A row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Limit {
    pub(crate) count: u64,
    /// By how many percent it may rise, and why that is not [`RISE`].
    pub(super) rise: Option<(f64, String)>,
    /// Why the count last changed.
    pub(super) reason: String,
}

impl Build {
    /// From what `rustc -vV` prints.
    pub(crate) fn of(verbose: &str) -> Option<Self> {
        let field =
            |name| verbose.lines().find_map(|line| line.strip_prefix(name)).map(|value| value.trim().to_owned());
        Some(Self { rustc: field("rustc ")?, target: field("host: ")? })
    }
}

impl fmt::Display for Build {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "rustc {}, {}", self.rustc, self.target)
    }
}

impl Limit {
    /// By how many percent the row may rise.
    pub(crate) fn allowed(&self) -> f64 {
        self.rise.as_ref().map_or(RISE, |rise| rise.0)
    }
}

/// The change from one count to another.
pub(crate) fn percent(from: u64, to: u64) -> f64 {
    (to as f64 - from as f64) / from as f64 * 100.0
}

impl Limits {
    pub(crate) fn row(&self, name: &str) -> Option<&Limit> {
        self.rows.iter().find(|row| row.0 == name).map(|row| &row.1)
    }

    /// Counts of another compiler or target say nothing about these.
    pub(crate) fn belong_to(&self, build: &Build) -> Result<(), String> {
        if self.build == *build {
            return Ok(());
        }
        Err(format!(
            "the counts belong to {}, this is {build}. Nothing was compared. After a deliberate change of compiler: cargo xtask bench --accept \
             \"REASON\"",
            self.build
        ))
    }

    /// Takes over what was counted, for rows that moved and rows that are new, and forgets those that are no longer counted;
    /// with `only` that row alone. Which rows changed.
    pub(crate) fn accept(
        &mut self,
        build: &Build,
        counts: &[Count],
        reason: &str,
        only: Option<&str>,
    ) -> Result<Vec<String>, String> {
        if reason.trim().is_empty() || reason.contains(|c: char| c == '"' || c == '\\' || c.is_control()) {
            return Err("the reason is a sentence in one line, without quotation marks or backslashes".to_owned());
        }
        if let Some(name) = only {
            self.belong_to(build)?;
            if self.row(name).is_none() && counts.iter().all(|count| count.row != name) {
                return Err(format!("no such row: {name}"));
            }
        }
        let before = std::mem::take(&mut self.rows);
        let old = |name: &str| before.iter().find(|row| row.0 == name).map(|row| &row.1);
        let taken = |name: &str| only.is_none_or(|only| only == name);
        let mut changed = Vec::new();
        for Count { row, instructions } in counts {
            let limit = match old(row) {
                Some(limit) if !taken(row) || percent(limit.count, *instructions).abs() <= MOVED => limit.clone(),
                None if !taken(row) => continue,
                limit => {
                    changed.push(row.clone());
                    let rise = limit.and_then(|limit| limit.rise.clone());
                    Limit { count: *instructions, rise, reason: reason.to_owned() }
                }
            };
            self.rows.push((row.clone(), limit));
        }
        for row in before {
            if counts.iter().all(|count| count.row != row.0) {
                if taken(&row.0) {
                    changed.push(row.0);
                } else {
                    self.rows.push(row);
                }
            }
        }
        self.build = build.clone();
        Ok(changed)
    }
}

impl fmt::Display for Limits {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Build { rustc, target } = &self.build;
        writeln!(f, "{}rustc = \"{rustc}\"\ntarget = \"{target}\"\n\n[rows]", self.head)?;
        for (name, Limit { count, rise, reason }) in &self.rows {
            write!(f, "\"{name}\" = {{ count = {count}, ")?;
            if let Some((percent, because)) = rise {
                write!(f, "rise = {percent}, because = \"{because}\", ")?;
            }
            writeln!(f, "reason = \"{reason}\" }}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# A head\n# of two lines.\n\nrustc = \"1.95.0\"\ntarget = \"t\"\n\n[rows]\n\
        \"a/x\" = { count = 1000, reason = \"first\" }\n\
        \"a/y\" = { count = 2000, rise = 5, because = \"it allocates\", reason = \"first\" }\n\
        \"a/z\" = { count = 3000, reason = \"first\" }\n";

    fn build(rustc: &str) -> Build {
        Build { rustc: rustc.to_owned(), target: "t".to_owned() }
    }

    /// The file after a change was accepted.
    fn accepted(rustc: &str, counts: &[(&str, u64)], only: Option<&str>) -> Result<(Vec<String>, String), String> {
        let count = |&(row, instructions): &(&str, u64)| Count { row: row.to_owned(), instructions };
        let mut limits: Limits = TEXT.parse().unwrap();
        let changed = limits.accept(&build(rustc), &counts.iter().map(count).collect::<Vec<_>>(), "second", only)?;
        Ok((changed, limits.to_string()))
    }

    fn words(text: &str) -> Vec<String> {
        text.split(' ').map(str::to_owned).collect()
    }

    #[test]
    fn what_is_read_is_written() {
        assert_eq!(TEXT.parse::<Limits>().unwrap().to_string(), TEXT);
    }

    #[test]
    fn another_compiler_is_refused() {
        let limits: Limits = TEXT.parse().unwrap();
        assert_eq!(limits.belong_to(&build("1.95.0")), Ok(()));
        let error = limits.belong_to(&build("1.96.0")).unwrap_err();
        assert!(error.contains("rustc 1.95.0, t") && error.contains("--accept"), "{error}");
    }

    #[test]
    fn rustc_names_itself() {
        let verbose = "rustc 1.95.0 (59807616e 2026-04-14)\nbinary: rustc\nhost: x86_64-unknown-linux-gnu\n";
        let build = Build::of(verbose).unwrap();
        assert_eq!(build.to_string(), "rustc 1.95.0 (59807616e 2026-04-14), x86_64-unknown-linux-gnu");
        assert_eq!(Build::of("no compiler"), None);
    }

    #[test]
    fn rows_that_moved_get_their_number_and_the_reason() {
        let (changed, text) = accepted("1.96.0", &[("a/x", 1001), ("a/y", 2100), ("a/new", 7)], None).unwrap();
        let rows = "[rows]\n\
            \"a/x\" = { count = 1000, reason = \"first\" }\n\
            \"a/y\" = { count = 2100, rise = 5, because = \"it allocates\", reason = \"second\" }\n\
            \"a/new\" = { count = 7, reason = \"second\" }\n";
        assert_eq!(changed, words("a/y a/new a/z"));
        assert!(text.ends_with(rows), "{text}");
        assert!(text.contains("rustc = \"1.96.0\""), "{text}");
    }

    #[test]
    fn only_one_row_is_touched_if_asked() {
        let counts = [("a/x", 1100), ("a/y", 2200), ("a/new", 7)];
        let (changed, text) = accepted("1.95.0", &counts, Some("a/x")).unwrap();
        let expected = TEXT.replace("count = 1000, reason = \"first\"", "count = 1100, reason = \"second\"");
        assert_eq!((changed, text), (words("a/x"), expected));
    }

    #[test]
    fn one_row_of_another_compiler_and_a_row_that_is_not_there_are_refused() {
        assert!(accepted("1.96.0", &[("a/x", 1100)], Some("a/x")).is_err());
        assert!(accepted("1.95.0", &[("a/x", 1100)], Some("a/w")).is_err());
    }

    #[test]
    fn a_reason_is_a_sentence_that_the_file_can_hold() {
        let mut limits: Limits = TEXT.parse().unwrap();
        for reason in ["", " ", "two\nlines", "a \"quotation\"", "a \\"] {
            assert!(limits.accept(&build("1.95.0"), &[], reason, None).is_err(), "{reason:?}");
        }
    }
}
