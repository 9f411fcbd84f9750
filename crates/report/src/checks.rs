//! Checks as a table: what was measured, against which limit, and what the two mean.

use crate::bar;
use crate::check::{Check, Outcome};
use crate::markup::{Html, Tone};
use crate::number::short;
use crate::table::{Cell, Table};

/// A row for each check. What did not run says why in the place of its numbers.
pub fn table<'a>(checks: impl IntoIterator<Item = &'a Check>) -> Table {
    let mut table = Table::new(["Subject", "Against its limit", "Measured", "Meaning and limit", ""]);
    for check in checks {
        let subject = Cell::new(Html::from(format!("{}: {}", check.instrument, check.subject)).detail(&check.detail));
        let result = Cell::new(verdict(match check.outcome {
            Outcome::Passed => "PASS",
            Outcome::Failed => "FAIL",
            Outcome::NotRun(_) => "NOT RUN",
        }));
        let [bar, measured, meaning] = match &check.outcome {
            Outcome::NotRun(why) => [Cell::empty(), Cell::empty(), Cell::new(&**why)],
            Outcome::Passed | Outcome::Failed => [
                Cell::new(bar::of_check(check)),
                Cell::number("measured", short(check.measured)),
                Cell::new(format!("{} {}", check.meaning, short(check.limit))),
            ],
        };
        table.row([subject, bar, measured, meaning, result]);
    }
    table
}

/// A verdict in its colour.
pub(crate) fn verdict(word: &str) -> Html {
    let tone = match word {
        "PASS" => Tone::Good,
        "FAIL" => Tone::Bad,
        _ => Tone::Open,
    };
    Html::toned(tone, word)
}
