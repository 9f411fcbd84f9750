//! The report on a terminal: one line per instrument, then what failed, then the sums. Where `--only` asks for few rows,
//! each is printed with what it found.

use gonio_report::grade::{groups, severity, verdict, worst};
use gonio_report::number::short;
use gonio_report::{Check, Outcome, Validation};

/// Failing rows that are printed; the rest is in the report.
const SHOWN: usize = 30;
/// Rows that are printed one by one, if no more were asked for.
const FEW: usize = 64;
/// Longest meaning that fits the table.
const MEANING: usize = 36;

/// The whole text.
pub(super) fn text<Census>(report: &Validation<Census>) -> String {
    let groups = groups(&report.checks);
    let width = groups.iter().map(|(name, _)| name.len()).max().unwrap_or(0).max("instrument".len());
    let mut out = format!(
        "gonio {} validate, {} effort, seed {}\n\n{:width$}  rows  {:>9}  {:<9}  {:MEANING$}  {:>7}  result\n",
        report.header.version,
        report.header.effort,
        report.header.seed,
        "instrument",
        "worst",
        "limit",
        "where worst is measured as",
        "seconds",
    );
    for (name, group) in &groups {
        let seconds: f64 = group.iter().map(|check| check.seconds).sum();
        let missing = group.iter().filter(|check| matches!(check.outcome, Outcome::NotRun(_))).count();
        let note = if missing > 0 && missing < group.len() { format!(" ({missing} not run)") } else { String::new() };
        let (measured, limit, meaning) = worst(group.iter().copied()).map_or_else(
            || (String::new(), String::new(), String::new()),
            |check| (short(check.measured), short(check.limit), cut(&check.meaning)),
        );
        out += &format!(
            "{name:width$}  {:4}  {measured:>9}  {limit:<9}  {meaning:MEANING$}  {seconds:7.1}  {}{note}\n",
            group.len(),
            verdict(group),
        );
    }
    out.push('\n');
    if report.header.only.is_some() && report.checks.len() <= FEW {
        rows(&mut out, &report.checks);
    }
    let mut failed: Vec<&Check> = report.checks.iter().filter(|check| check.failed()).collect();
    failed.sort_by(|a, b| severity(b).total_cmp(&severity(a)));
    for check in failed.iter().take(SHOWN) {
        let (measured, limit) = (short(check.measured), short(check.limit));
        out += &format!(
            "FAIL  {}: {}\n      {measured} against {} {limit}\n",
            check.instrument, check.subject, check.meaning
        );
        if !check.detail.is_empty() {
            out += &format!("      {}\n", check.detail);
        }
    }
    if failed.len() > SHOWN {
        out += &format!("      … and {} more: see the report\n", failed.len() - SHOWN);
    }
    for check in &report.checks {
        if let Outcome::NotRun(why) = &check.outcome {
            out += &format!("not run  {}: {}: {why}\n", check.instrument, check.subject);
        }
    }
    out + &format!("{}, {:.1} s\n", report.summary(), report.header.seconds)
}

/// What was found where nothing failed.
fn rows(out: &mut String, checks: &[Check]) {
    let told = || checks.iter().filter(|check| check.outcome == Outcome::Passed && !check.detail.is_empty());
    let width = told().map(|check| check.subject.chars().count()).max().unwrap_or(0);
    for check in told() {
        *out += &format!("{:width$}  {}\n", check.subject, check.detail);
    }
    if told().next().is_some() {
        out.push('\n');
    }
}

fn cut(text: &str) -> String {
    if text.chars().count() <= MEANING {
        return text.to_owned();
    }
    // The end says which way round the limit is.
    let (head, tail) = (MEANING - 3, text.chars().last().unwrap_or_default());
    format!("{}… {tail}", text.chars().take(head).collect::<String>())
}
