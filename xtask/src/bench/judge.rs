//! Which rows of `benches/limits.toml` rose, fell, appeared or disappeared.

use super::callgrind::Count;
use super::limits::{Limits, percent};
use std::fmt;

/// A row whose count fell by more than this many percent should have its number tightened.
const NOTEWORTHY: f64 = 2.0;

/// Every row on either side, in the order in which they are counted; rows that are no longer counted come last.
pub(crate) struct Judgement(Vec<Row>);

struct Row {
    name: String,
    committed: Option<u64>,
    now: Option<u64>,
    /// Percent.
    allowed: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Verdict {
    Within,
    Fell,
    Rose,
    New,
    Gone,
}

impl Judgement {
    pub(crate) fn of(limits: &Limits, counts: &[Count]) -> Self {
        let counted = counts.iter().map(|count| {
            let limit = limits.row(&count.row);
            Row {
                name: count.row.clone(),
                committed: limit.map(|limit| limit.count),
                now: Some(count.instructions),
                allowed: limit.map_or(0.0, |limit| limit.allowed()),
            }
        });
        let gone = limits.rows.iter().filter(|(name, _)| counts.iter().all(|count| count.row != *name));
        let gone = gone.map(|(name, limit)| Row {
            name: name.clone(),
            committed: Some(limit.count),
            now: None,
            allowed: limit.allowed(),
        });
        Self(counted.chain(gone).collect())
    }

    pub(crate) fn passed(&self) -> bool {
        self.0.iter().all(|row| matches!(row.verdict(), Verdict::Within | Verdict::Fell))
    }

    /// One line of how many rows there are of each kind.
    pub(crate) fn summary(&self) -> String {
        let number = |verdict| self.0.iter().filter(|row| row.verdict() == verdict).count();
        let mut parts = vec![format!("{} rows", self.0.len())];
        for (verdict, what) in [
            (Verdict::Rose, "rose beyond their limit"),
            (Verdict::New, "are not in benches/limits.toml"),
            (Verdict::Gone, "are no longer counted"),
            (Verdict::Fell, "fell: --accept would keep that"),
        ] {
            let n = number(verdict);
            if n > 0 {
                parts.push(format!("{n} {what}"));
            }
        }
        if self.passed() {
            parts.push("none rose beyond its limit".to_owned());
        }
        parts.join(", ")
    }
}

impl Row {
    fn change(&self) -> Option<f64> {
        Some(percent(self.committed?, self.now?))
    }

    fn verdict(&self) -> Verdict {
        match (self.committed, self.now, self.change()) {
            (None, ..) => Verdict::New,
            (_, None, _) => Verdict::Gone,
            (.., Some(change)) if change > self.allowed => Verdict::Rose,
            (.., Some(change)) if change < -NOTEWORTHY => Verdict::Fell,
            _ => Verdict::Within,
        }
    }
}

/// A table: row, committed, now, change in percent, and what is remarkable about it.
impl fmt::Display for Judgement {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let width = self.0.iter().map(|row| row.name.len()).max().unwrap_or(0);
        writeln!(f, "{:width$} {:>12} {:>12} {:>8}", "instructions", "committed", "now", "change")?;
        let number = |n: Option<u64>| n.map_or("-".to_owned(), |n| n.to_string());
        for row in &self.0 {
            let change = row.change().map_or("-".to_owned(), |change| format!("{change:+.2} %"));
            let remark = match row.verdict() {
                Verdict::Within => String::new(),
                Verdict::Fell => "  fell".to_owned(),
                Verdict::Rose => format!("  ROSE, {} % is allowed", row.allowed),
                Verdict::New => "  NEW".to_owned(),
                Verdict::Gone => "  GONE".to_owned(),
            };
            let (committed, now) = (number(row.committed), number(row.now));
            writeln!(f, "{:width$} {committed:>12} {now:>12} {change:>8}{remark}", row.name)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: &str = "rustc = \"1\"\ntarget = \"t\"\n[rows]\n\
        \"a/x\" = { count = 1000, reason = \"r\" }\n\
        \"a/y\" = { count = 1000, rise = 5, because = \"it allocates\", reason = \"r\" }\n";

    /// The verdicts when `a/x` and `a/y` count so much.
    fn verdicts(counts: &[(&str, u64)]) -> (bool, Vec<Verdict>) {
        let count = |&(row, instructions): &(&str, u64)| Count { row: row.to_owned(), instructions };
        let counts: Vec<_> = counts.iter().map(count).collect();
        let judgement = Judgement::of(&LIMITS.parse().unwrap(), &counts);
        (judgement.passed(), judgement.0.iter().map(Row::verdict).collect())
    }

    #[test]
    fn one_percent_passes_and_three_fail() {
        use Verdict::*;
        assert_eq!(verdicts(&[("a/x", 1010), ("a/y", 1000)]), (true, vec![Within, Within]));
        assert_eq!(verdicts(&[("a/x", 1020), ("a/y", 1000)]), (true, vec![Within, Within]));
        assert_eq!(verdicts(&[("a/x", 1030), ("a/y", 1000)]), (false, vec![Rose, Within]));
    }

    #[test]
    fn a_row_has_the_limit_that_it_names() {
        use Verdict::*;
        assert_eq!(verdicts(&[("a/x", 1000), ("a/y", 1050)]), (true, vec![Within, Within]));
        assert_eq!(verdicts(&[("a/x", 1000), ("a/y", 1051)]), (false, vec![Within, Rose]));
    }

    #[test]
    fn a_fall_passes_and_is_told() {
        use Verdict::*;
        assert_eq!(verdicts(&[("a/x", 979), ("a/y", 981)]), (true, vec![Fell, Within]));
    }

    #[test]
    fn a_row_that_is_missing_on_either_side_fails() {
        use Verdict::*;
        assert_eq!(verdicts(&[("a/x", 1000)]), (false, vec![Within, Gone]));
        assert_eq!(verdicts(&[("a/x", 1000), ("a/y", 1000), ("a/z", 1)]), (false, vec![Within, Within, New]));
    }

    #[test]
    fn the_table_names_what_failed() {
        let counts = [Count { row: "a/x".to_owned(), instructions: 1030 }];
        let judgement = Judgement::of(&LIMITS.parse().unwrap(), &counts);
        let table = judgement.to_string();
        assert!(table.contains("+3.00 %  ROSE, 2 % is allowed") && table.contains("GONE"), "{table}");
        assert_eq!(judgement.summary(), "2 rows, 1 rose beyond their limit, 1 are no longer counted");
    }
}
