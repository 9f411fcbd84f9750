//! The report of a validation as a page.

use super::Validation;
use crate::bar;
use crate::check::{Check, Outcome};
use crate::checks::{table as checks_table, verdict as in_colour};
use crate::exhibit::{Exhibit, speeds};
use crate::grade::{groups, verdict, worst};
use crate::markup::{Html, Tone};
use crate::number::short;
use crate::page::Page;
use crate::plot::Plot;
use crate::table::{Cell, Table};

impl<Census> Validation<Census> {
    /// The whole page: what failed, all instruments, pictures, the census, plots, and every check.
    pub fn page(&self, exhibits: &[Exhibit], census: Option<&Table>, plots: &[Plot]) -> String {
        let (tone, word) = if self.header.failed > 0 { (Tone::Bad, "Failed") } else { (Tone::Good, "Passed") };
        let mut page = Page::new(&format!("Gonio validation: {word}"));
        page.headline("Gonio validation");
        page.verdict(tone, &format!("{word}: {}", self.summary()));
        page.note(format!(
            "gonio {}, {} effort, seed {}, {:.1} s{}. Statistical tests of a run fail by chance with probability 0.01 at most, \
             all together: half of that belongs to the rendered scenes, half to the kernel.",
            self.header.version,
            self.header.effort,
            self.header.seed,
            self.header.seconds,
            self.header.only.as_ref().map_or_else(String::new, |only| format!(", only “{only}”")),
        ));
        self.what_failed(&mut page);
        self.overview(&mut page);
        furnaces(&mut page, exhibits);
        if let Some(table) = census {
            page.heading("Census");
            page.note(CENSUS);
            page.table(table);
        }
        backends(&mut page, exhibits);
        lobes(&mut page, plots);
        page.heading("Every check");
        for (name, group) in groups(&self.checks) {
            let about = format!("{} rows. {}", group.len(), self.proves(name));
            let failed = group.iter().any(|check| check.failed());
            page.folded(name, failed, &in_colour(verdict(&group)), &about, &checks_table(group));
        }
        page.environment(&self.header.environment);
        page.finish()
    }

    fn what_failed(&self, page: &mut Page) {
        let mut part = |tone, heading: &str, is_part: fn(&&Check) -> bool| {
            let checks: Vec<&Check> = self.checks.iter().filter(is_part).collect();
            if !checks.is_empty() {
                page.toned_heading(tone, heading);
                page.table(&checks_table(checks));
            }
        };
        part(Tone::Bad, "What failed", |check| check.failed());
        part(Tone::Open, "What did not run", |check| matches!(check.outcome, Outcome::NotRun(_)));
    }

    fn overview(&self, page: &mut Page) {
        let columns = ["Instrument", "Rows", "Worst against its limit", "Measured", "Limit", "Time", ""];
        let mut table = Table::new(columns);
        for (name, group) in groups(&self.checks) {
            let seconds: f64 = group.iter().map(|check| check.seconds).sum();
            let worst = worst(group.iter().copied());
            let (measured, limit) = worst.map_or_else(Default::default, |w| (short(w.measured), short(w.limit)));
            table.row([
                Cell::new(Html::link(name)),
                Cell::number("rows", group.len().to_string()),
                Cell::new(worst.map_or_else(Html::default, bar::of_check)),
                Cell::number("measured", measured),
                Cell::number("limit", limit),
                Cell::number("time", format!("{seconds:.1} s")),
                Cell::new(in_colour(verdict(&group))),
            ]);
        }
        page.heading("Instruments");
        page.table(&table);
        page.note("Bars are logarithmic, from a millionth of the limit to ten times it; the mark is the limit.");
    }
}

/// What the table of the census shows.
const CENSUS: &str = "Rays that a backend answers otherwise than brute force does, of all that were cast at all specimens and \
                      scales; and leaks, rays that got through where a surface must stop them. Grey is what nothing is \
                      required of: rays aimed at edges, vertices and planes, of a backend with a triangle test of its own.";

fn furnaces(page: &mut Page, exhibits: &[Exhibit]) {
    if exhibits.is_empty() {
        return;
    }
    page.heading("Furnaces");
    page.note(format!(
        "Left as rendered, right the deviation from the answer, magnified {} times around grey: noise without structure is right.",
        Exhibit::MAGNIFIED
    ));
    page.exhibits(exhibits);
}

/// How fast each backend rendered the furnaces.
fn backends(page: &mut Page, exhibits: &[Exhibit]) {
    let Some(table) = speeds(exhibits) else { return };
    page.heading("Backends");
    let text = "Millions of samples per second of the furnaces above, all threads, one run each: an impression, not a \
                measurement (";
    page.note(Html::from(text).and(Html::code("gonio accel bench")).and(" measures)."));
    page.table(&table);
}

/// The plots, lobe by lobe.
fn lobes(page: &mut Page, plots: &[Plot]) {
    let mut names: Vec<&str> = Vec::new();
    for plot in plots {
        if !names.contains(&&*plot.lobe) {
            names.push(&plot.lobe);
        }
    }
    for name in names {
        page.heading(&format!("Lobe: {name}"));
        page.plots(plots.iter().filter(|plot| plot.lobe == name));
    }
}

#[cfg(test)]
mod tests {
    use crate::{Check, Environment, Header, Instrument, Outcome, Table, Validation, json};

    fn check(subject: &str, outcome: Outcome) -> Check {
        Check {
            instrument: "furnace".to_owned(),
            subject: subject.to_owned(),
            outcome,
            measured: 0.5,
            limit: 1.0,
            meaning: "albedo ≤".to_owned(),
            detail: "at <45°>".to_owned(),
            seconds: 0.25,
        }
    }

    fn validation(checks: Vec<Check>) -> Validation<u32> {
        let environment = Environment {
            target: "x86_64",
            target_features: vec!["avx2"],
            rustc: None,
            debug_assertions: true,
            processor: "one of few words".to_owned(),
            threads: 2,
        };
        let header = Header::new("1.2.3", "quick", 7, Some("furnace".to_owned()), &checks, 1.5, environment);
        let instruments = vec![Instrument { name: "furnace", proves: "no light is made" }];
        Validation { header, instruments, checks, census: 0 }
    }

    #[test]
    fn what_failed_and_what_did_not_run_comes_first_and_is_open() {
        let not_run = Outcome::NotRun("no <key>".to_owned());
        let report =
            validation(vec![check("a", Outcome::Passed), check("b & c", Outcome::Failed), check("d", not_run)]);
        assert_eq!(report.summary(), "1 passed, 1 failed, 1 not run (d)");
        let page = report.page(&[], Some(&Table::new(["Rays"])), &[]);
        for part in [
            "<p class=\"verdict bad\">Failed: 1 passed, 1 failed, 1 not run (d)</p>",
            "<h2 class=\"bad\">What failed</h2>\n<table>",
            "<td>furnace: b &amp; c<div class=\"detail\">at &lt;45°&gt;</div></td>",
            "<h2 class=\"none\">What did not run</h2>",
            "<td>no &lt;key&gt;</td><td><span class=\"none\">NOT RUN</span></td>",
            "<h2>Census</h2>",
            "<details id=\"furnace\" open><summary><h3>furnace</h3> <span class=\"bad\">FAIL</span> \
             <span class=\"soft\">3 rows. no light is made</span></summary>",
            "seed 7, 1.5 s, only “furnace”.",
        ] {
            assert!(page.contains(part), "{part} is not in {page}");
        }
        assert!(!page.contains("<script") && !page.contains("<link"));
        let quiet = validation(vec![check("a", Outcome::Passed)]).page(&[], None, &[]);
        assert!(!quiet.contains("What failed") && !quiet.contains("Census") && !quiet.contains("Furnaces"));
    }

    #[test]
    fn the_summary_has_the_sums_of_the_report() {
        let report = validation(vec![check("a", Outcome::Passed), check("b", Outcome::Failed)]);
        let text = json::text(&report.totals()).unwrap();
        assert!(text.starts_with("{\n  \"version\": \"1.2.3\",\n  \"effort\": \"quick\""), "{text}");
        assert!(text.contains("\"subjects\": [\n        \"a\",\n        \"b\"\n      ]") && text.ends_with("}\n"));
    }
}
