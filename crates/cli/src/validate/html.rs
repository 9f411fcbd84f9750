//! The report as one self-contained page: no script, nothing loaded, light and dark, readable on a phone.

use super::census_table;
use super::draw::figure;
use super::grade::{groups, severity, short, verdict, worst};
use super::report::Report;
use super::scenes::{Exhibit, MAGNIFIED};
use crate::environment::Environment;
use gonio_lab::plots::Plot;
use gonio_lab::{Check, Outcome};
use std::collections::BTreeSet;
use std::fmt::Write;

/// The whole page.
pub(super) fn page(report: &Report, exhibits: &[Exhibit], plots: &[Plot]) -> String {
    let (class, word) = if report.header.failed > 0 { ("bad", "Failed") } else { ("good", "Passed") };
    let mut page = head(&format!("Gonio validation: {word}"));
    let _ = writeln!(
        page,
        "<h1>Gonio validation</h1>\n\
         <p class=\"verdict {class}\">{word}: {}</p>\n<p class=\"soft\">gonio {}, {} effort, seed {}, {:.1} s{}. Statistical tests \
         of a run fail by chance with probability 0.01 at most, all together: half of that belongs to the rendered scenes, \
         half to the kernel.</p>",
        escape(&report.summary()),
        report.header.version,
        report.effort_name(),
        report.header.seed,
        report.header.seconds,
        report.header.only.as_ref().map_or_else(String::new, |only| format!(", only “{}”", escape(only))),
    );
    failures(&mut page, report);
    overview(&mut page, report);
    pictures(&mut page, exhibits);
    page += &census_table::table(&report.census);
    speeds(&mut page, exhibits);
    lobes(&mut page, plots);
    page += "<h2>Every check</h2>\n";
    for (name, group) in groups(&report.checks) {
        instrument(&mut page, report, name, &group);
    }
    environment(&mut page, &report.header.environment);
    page + "</body>\n</html>\n"
}

/// The beginning of a page, up to its body.
pub(crate) fn head(title: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n\
         <style>\n{}</style>\n</head>\n<body>\n",
        escape(title),
        include_str!("report.css"),
    )
}

fn failures(page: &mut String, report: &Report) {
    let failed: Vec<&Check> = report.checks.iter().filter(|check| check.failed()).collect();
    if !failed.is_empty() {
        *page += "<h2 class=\"bad\">What failed</h2>\n";
        rows(page, &failed);
    }
    let missing: Vec<&Check> =
        report.checks.iter().filter(|check| matches!(check.outcome, Outcome::NotRun(_))).collect();
    if !missing.is_empty() {
        *page += "<h2 class=\"none\">What did not run</h2>\n";
        rows(page, &missing);
    }
}

fn overview(page: &mut String, report: &Report) {
    *page += "<h2>Instruments</h2>\n<table><thead><tr><th>Instrument</th><th>Rows</th><th>Worst against its limit</th>\
              <th>Measured</th><th>Limit</th><th>Time</th><th></th></tr></thead><tbody>\n";
    for (name, group) in groups(&report.checks) {
        let seconds: f64 = group.iter().map(|check| check.seconds).sum();
        let worst = worst(group.iter().copied());
        let (measured, limit) = worst.map_or_else(Default::default, |w| (short(w.measured), short(w.limit)));
        let _ = writeln!(
            page,
            "<tr><td><a href=\"#{0}\">{0}</a></td><td class=\"number\" data-name=\"rows\">{1}</td><td>{2}</td>\
             <td class=\"number\" data-name=\"measured\">{measured}</td><td class=\"number\" data-name=\"limit\">{limit}</td>\
             <td class=\"number\" data-name=\"time\">{seconds:.1} s</td><td>{3}</td></tr>",
            escape(name),
            group.len(),
            worst.map_or_else(String::new, bar),
            mark(verdict(&group)),
        );
    }
    *page += "</tbody></table>\n<p class=\"soft\">Bars are logarithmic, from a millionth of the limit to ten times it; the \
              mark is the limit.</p>\n";
}

fn pictures(page: &mut String, exhibits: &[Exhibit]) {
    if exhibits.is_empty() {
        return;
    }
    let _ = writeln!(
        page,
        "<h2>Furnaces</h2>\n<p class=\"soft\">Left as rendered, right the deviation from the answer, magnified {MAGNIFIED} times around grey: \
         noise without structure is right.</p>\n<div class=\"pictures\">"
    );
    for exhibit in exhibits {
        let image =
            |bytes: &[u8], what: &str| format!("<img alt=\"{what}\" src=\"data:image/png;base64,{}\">", base64(bytes));
        let _ = writeln!(
            page,
            "<figure><div>{}{}</div><figcaption>{}<br>{}</figcaption></figure>",
            image(&exhibit.rendered, "as rendered"),
            image(&exhibit.deviation, "deviation"),
            escape(exhibit.name),
            escape(&exhibit.answer),
        );
    }
    *page += "</div>\n";
}

/// How fast each backend rendered the furnaces.
fn speeds(page: &mut String, exhibits: &[Exhibit]) {
    let backends: BTreeSet<&str> = exhibits.iter().flat_map(|e| &e.speeds).map(|s| s.backend.as_str()).collect();
    if backends.is_empty() {
        return;
    }
    let most = exhibits.iter().flat_map(|e| &e.speeds).map(|s| s.msamples_per_second).fold(1e-300, f64::max);
    *page += "<h2>Backends</h2>\n<p class=\"soft\">Millions of samples per second of the furnaces above, all threads, one run \
              each: an impression, not a measurement (<code>gonio accel bench</code> measures).</p>\n<table><thead><tr><th>Furnace</th>";
    for backend in &backends {
        let _ = write!(page, "<th>{}</th>", escape(backend));
    }
    *page += "</tr></thead><tbody>\n";
    for exhibit in exhibits {
        let _ = write!(page, "<tr><td>{}</td>", escape(exhibit.name));
        for backend in &backends {
            let speed = exhibit.speeds.iter().find(|s| s.backend == *backend).map_or(0.0, |s| s.msamples_per_second);
            let _ = write!(
                page,
                "<td class=\"number\" data-name=\"{}\">{speed:.2}<svg class=\"bar\" viewBox=\"0 0 100 8\" \
                 preserveAspectRatio=\"none\" aria-hidden=\"true\"><rect class=\"fill\" y=\"1\" width=\"{:.1}\" \
                 height=\"6\"/></svg></td>",
                escape(backend),
                100.0 * speed / most
            );
        }
        *page += "</tr>\n";
    }
    *page += "</tbody></table>\n";
}

/// The plots, lobe by lobe.
fn lobes(page: &mut String, plots: &[Plot]) {
    let mut names: Vec<&str> = Vec::new();
    for plot in plots {
        if !names.contains(&&*plot.lobe) {
            names.push(&plot.lobe);
        }
    }
    for name in names {
        let _ = writeln!(page, "<h2>Lobe: {}</h2>\n<div class=\"pictures\">", escape(name));
        plots.iter().filter(|plot| plot.lobe == name).for_each(|plot| *page += &figure(plot));
        *page += "</div>\n";
    }
}

fn instrument(page: &mut String, report: &Report, name: &str, group: &[&Check]) {
    let proves = report.instruments.iter().find(|i| i.name == name).map_or("", |i| i.proves);
    let open = if group.iter().any(|check| check.failed()) { " open" } else { "" };
    let _ = writeln!(
        page,
        "<details id=\"{0}\"{open}><summary><h3>{0}</h3> {1} <span class=\"soft\">{2} rows. {3}</span></summary>",
        escape(name),
        mark(verdict(group)),
        group.len(),
        escape(proves),
    );
    rows(page, group);
    *page += "</details>\n";
}

/// A table of checks.
pub(crate) fn rows(page: &mut String, checks: &[&Check]) {
    *page += "<table><thead><tr><th>Subject</th><th>Against its limit</th><th>Measured</th><th>Meaning and limit</th><th></th></tr></thead><tbody>\n";
    for check in checks {
        let (measures, result) = match &check.outcome {
            Outcome::NotRun(why) => (format!("<td></td><td></td><td>{}</td>", escape(why)), mark("NOT RUN")),
            outcome => {
                let numbers = format!(
                    "<td>{}</td><td class=\"number\" data-name=\"measured\">{}</td><td>{} {}</td>",
                    bar(check),
                    short(check.measured),
                    escape(&check.meaning),
                    short(check.limit),
                );
                (numbers, mark(if *outcome == Outcome::Passed { "PASS" } else { "FAIL" }))
            }
        };
        let detail = if check.detail.is_empty() {
            String::new()
        } else {
            format!("<div class=\"detail\">{}</div>", escape(&check.detail))
        };
        let _ = writeln!(
            page,
            "<tr><td>{}: {}{detail}</td>{measures}<td>{result}</td></tr>",
            escape(&check.instrument),
            escape(&check.subject)
        );
    }
    *page += "</tbody></table>\n";
}

/// How the program was built, and where it ran.
pub(crate) fn environment(page: &mut String, e: &Environment) {
    let assertions = if e.debug_assertions { "on" } else { "off" };
    let rows = [
        ("Version", env!("CARGO_PKG_VERSION").to_owned()),
        ("Compiler", e.rustc.unwrap_or("not known").to_owned()),
        ("Target", format!("{} with {}", e.target, e.target_features.join(", "))),
        ("Debug assertions", assertions.to_owned()),
        ("Processor", format!("{}, {} threads", e.processor, e.threads)),
    ];
    *page += "<h2>Circumstances</h2>\n<table><tbody>\n";
    for (name, value) in rows {
        let _ = writeln!(page, "<tr><td class=\"soft\">{name}</td><td>{}</td></tr>", escape(&value));
    }
    *page += "</tbody></table>\n";
}

fn mark(verdict: &str) -> String {
    let class = match verdict {
        "PASS" => "good",
        "FAIL" => "bad",
        _ => "none",
    };
    format!("<span class=\"{class}\">{verdict}</span>")
}

/// Measured over limit on a logarithmic scale from 10⁻⁶ to 10, 100 wide.
fn bar(check: &Check) -> String {
    let place = |ratio: f64| (100.0 * (ratio.max(1e-300).log10() + 6.0) / 7.0).clamp(0.0, 100.0);
    let severity = severity(check);
    // Too small for the scale is still something; nothing at all is nothing.
    let width = if severity == 0.0 { 0.0 } else { place(severity).max(1.0) };
    let class = if check.failed() { "over" } else { "fill" };
    format!(
        "<svg class=\"bar\" viewBox=\"0 0 100 8\" preserveAspectRatio=\"none\" role=\"img\" aria-label=\"{} of the limit\">\
         <rect class=\"track\" y=\"3\" width=\"100\" height=\"2\"/><rect class=\"{class}\" y=\"1\" width=\"{width:.1}\" height=\"6\"/>\
         <rect class=\"limit\" x=\"{:.1}\" width=\"1\" height=\"8\"/></svg>",
        short(severity),
        place(1.0),
    )
}

/// Text that cannot become markup.
pub(crate) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// RFC 4648, with padding.
pub(super) fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let word = group.iter().fold(0_u32, |word, &byte| word << 8 | u32::from(byte)) << (8 * (3 - group.len()));
        for digit in 0..4 {
            let value = DIGITS[(word >> (18 - 6 * digit)) as usize & 63];
            text.push(if digit <= group.len() { char::from(value) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_rfc() {
        for (plain, coded) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn text_cannot_become_markup() {
        assert_eq!(escape("<a & \"b\">"), "&lt;a &amp; &quot;b&quot;&gt;");
    }
}
