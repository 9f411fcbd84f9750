//! The certificate as a page: verdict, plots, safe ranges, costs, every check. Self-contained, no script.

use super::count::Count;
use crate::environment::Environment;
use crate::validate::draw::figure;
use crate::validate::html::{environment, escape, head, rows};
use gonio_lab::plots::Plot;
use gonio_lab::{Certificate, Check, Options, SafeRange};
use std::fmt::Write;

/// The whole page.
pub(super) fn page(
    certificate: &Certificate,
    options: &Options,
    instructions: &Result<Vec<Count>, String>,
    plots: &[Plot],
) -> String {
    let (class, word) = if certificate.holds() { ("good", "holds") } else { ("bad", "failed") };
    let name = escape(&certificate.name);
    let mut page = head(&format!("{}: certificate {word}", certificate.name));
    let failed: Vec<&Check> = certificate.checks.iter().filter(|check| check.failed()).collect();
    let _ = writeln!(
        page,
        "<h1>Certificate of {name}</h1>\n<p class=\"verdict {class}\">The certificate {word}: {} of {} checks failed</p>\n\
         <p class=\"soft\">{}. {:?} effort, seed {}.</p>",
        failed.len(),
        certificate.checks.len(),
        escape(&certificate.claims()),
        options.effort,
        options.seed,
    );
    if !failed.is_empty() {
        page += "<h2 class=\"bad\">What failed</h2>\n";
        rows(&mut page, &failed);
    }
    page += "<h2>What the instruments see</h2>\n<div class=\"pictures\">";
    plots.iter().for_each(|plot| page += &figure(plot));
    page += "</div>\n";
    ranges(&mut page, &certificate.ranges);
    costs(&mut page, certificate, instructions);
    page += "<h2>Every check</h2>\n";
    rows(&mut page, &certificate.checks.iter().collect::<Vec<_>>());
    environment(&mut page, &Environment::here());
    page + "</body>\n</html>\n"
}

fn ranges(page: &mut String, ranges: &[SafeRange]) {
    *page += "<h2>Where each number is safe without a guard</h2>\n<p class=\"soft\">By a sweep of the domain and far beyond: finite and \
              not negative; precise where f32 is as near to f64 as rounded inputs allow. Eight lanes give the bits of f32.</p>\n<table><thead><tr>\
              <th>Number</th><th>Arithmetic</th><th>Safe</th><th>Precise too</th><th>Domain</th><th>Here</th></tr></thead><tbody>\n";
    for r in ranges {
        let why = |side: &str, why: &Option<String>| {
            why.as_ref()
                .map_or_else(String::new, |why| format!("<div class=\"detail\">{side}, at {}</div>", escape(why)))
        };
        let ends = |range: Option<[f64; 2]>, without: &str| {
            range.map_or_else(|| without.to_owned(), |[lo, hi]| format!("{lo:.1e} to {hi:.1e}"))
        };
        let safe = ends(r.safe, "nowhere");
        let precise = ends(r.precise, if r.precision == "f32" { "nowhere" } else { "" });
        let _ = writeln!(
            page,
            "<tr><td>{}{}{}</td><td>{}</td><td class=\"number\" data-name=\"safe\">{safe}</td>\
             <td class=\"number\" data-name=\"precise\">{precise}</td>\
             <td class=\"number\" data-name=\"domain\">{:.3e} to {:.3e}</td><td class=\"number\" data-name=\"here\">{:.3e}</td></tr>",
            escape(&r.number),
            why("below", &r.below),
            why("above", &r.above),
            r.precision,
            r.domain[0],
            r.domain[1],
            r.value,
        );
    }
    *page += "</tbody></table>\n";
}

fn costs(page: &mut String, certificate: &Certificate, instructions: &Result<Vec<Count>, String>) {
    *page += "<h2>What a call costs</h2>\n<table><thead><tr><th>Call</th><th>Arithmetic</th><th>ns</th><th>Instructions</th></tr></thead><tbody>\n";
    for speed in &certificate.speeds {
        let counted = instructions.iter().flatten();
        let counted = counted.filter(|c| (c.call, c.arithmetic) == (speed.call, speed.arithmetic));
        let count = counted.map(|c| format!("{:.1}", c.instructions)).collect::<String>();
        let _ = writeln!(
            page,
            "<tr><td>{}</td><td>{}</td><td class=\"number\" data-name=\"ns\">{:.2}</td>\
             <td class=\"number\" data-name=\"instructions\">{count}</td></tr>",
            speed.call, speed.arithmetic, speed.ns
        );
    }
    *page += "</tbody></table>\n<p class=\"soft\">One thread; lanes per lane.";
    if let Err(why) = instructions {
        let _ = write!(page, " Instructions: not counted ({}).", escape(why));
    }
    *page += "</p>\n";
}
