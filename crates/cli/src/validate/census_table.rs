//! The census as a table of the page: families of rays against backends, all specimens and scales together.

use super::html::escape;
use crate::census::ORACLE;
use crate::census::family::Family;
use crate::census::judge::is_judged;
use crate::census::record::{Log, Row};
use std::fmt::Write;

/// The table, or nothing if there was no census.
pub(super) fn table(log: &Log) -> String {
    let mut backends: Vec<&str> = Vec::new();
    for row in &log.rows {
        if row.backend != ORACLE && !backends.contains(&row.backend.as_str()) {
            backends.push(&row.backend);
        }
    }
    if backends.is_empty() {
        return String::new();
    }
    let mut page =
        "<h2>Census</h2>\n<p class=\"soft\">Rays that a backend answers otherwise than brute force does, of all that \
                    were cast at all specimens and scales; and leaks, rays that got through where a surface must stop \
                    them. Grey is what nothing is required of: rays aimed at edges, vertices and planes, of a backend \
                    with a triangle test of its own.</p>\n<table><thead><tr><th>Rays</th>"
            .to_owned();
    for backend in &backends {
        let _ = write!(page, "<th>{}</th>", escape(backend));
    }
    page += "</tr></thead><tbody>\n";
    for family in Family::ALL {
        let _ = write!(page, "<tr><td>{}</td>", escape(&family.to_string()));
        for backend in &backends {
            let of = |row: &&Row| row.backend == *backend && row.family == family;
            page += &cell(backend, &log.rows.iter().filter(of).collect::<Vec<_>>());
        }
        page += "</tr>\n";
    }
    page + "</tbody></table>\n"
}

fn cell(backend: &str, rows: &[&Row]) -> String {
    let sum = |count: fn(&Row) -> u64| rows.iter().map(|row| count(row)).sum::<u64>();
    let (rays, differ, leaks) = (sum(|r| r.rays), sum(Row::exceptions), sum(|r| r.leaks));
    let judged = rows.iter().any(|row| is_judged(row));
    let class = match (judged, differ) {
        (false, _) => "soft",
        (true, 0) => "good",
        (true, _) => "none",
    };
    let leaks = if leaks > 0 { format!(", {leaks} leak") } else { String::new() };
    let name = escape(backend);
    format!("<td class=\"number\" data-name=\"{name}\"><span class=\"{class}\">{differ}</span> of {rays}{leaks}</td>")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::census::Standard;

    #[test]
    fn counts_are_added_over_specimens_and_brute_has_no_column() {
        let row = |backend: &str, standard, prim| Row {
            rays: 100,
            prim,
            ..Row::new("s", 1.0, Family::Camera, backend, standard)
        };
        let rows = vec![
            row(ORACLE, Standard::Exact, 0),
            row("obvhs", Standard::Exact, 0),
            row("obvhs", Standard::Exact, 0),
            row("embree", Standard::Close, 3),
        ];
        let page = table(&Log { rows, ..Log::default() });
        assert!(page.contains("<th>obvhs</th><th>embree</th>") && !page.contains("<th>brute</th>"), "{page}");
        assert!(page.contains("<span class=\"good\">0</span> of 200"), "{page}");
        assert!(page.contains("<span class=\"none\">3</span> of 100"), "{page}");
        assert_eq!(table(&Log::default()), "");
    }
}
