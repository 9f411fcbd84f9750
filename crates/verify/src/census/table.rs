//! The census as a table of the page: families of rays against backends, all specimens and scales together.

use super::family::Family;
use super::judge::is_judged;
use super::record::{Log, Row};
use super::standard::ORACLE;
use gonio_report::{Cell, Html, Table, Tone};

/// The table, or nothing if there was no census.
pub fn table(log: &Log) -> Option<Table> {
    let mut backends: Vec<&str> = Vec::new();
    for row in &log.rows {
        if row.backend != ORACLE && !backends.contains(&row.backend.as_str()) {
            backends.push(&row.backend);
        }
    }
    if backends.is_empty() {
        return None;
    }
    let mut table = Table::new(std::iter::once("Rays").chain(backends.iter().copied()));
    for family in Family::ALL {
        let cells = backends.iter().map(|backend| {
            let of = |row: &&Row| row.backend == *backend && row.family == family;
            cell(backend, &log.rows.iter().filter(of).collect::<Vec<_>>())
        });
        table.row(std::iter::once(Cell::new(family.to_string())).chain(cells));
    }
    Some(table)
}

fn cell(backend: &str, rows: &[&Row]) -> Cell {
    let sum = |count: fn(&Row) -> u64| rows.iter().map(|row| count(row)).sum::<u64>();
    let (rays, differ, leaks) = (sum(|r| r.rays), sum(Row::exceptions), sum(|r| r.leaks));
    let judged = rows.iter().any(|row| is_judged(row));
    let tone = match (judged, differ) {
        (false, _) => Tone::Soft,
        (true, 0) => Tone::Good,
        (true, _) => Tone::Open,
    };
    let leaks = if leaks > 0 { format!(", {leaks} leak") } else { String::new() };
    Cell::number(backend, Html::toned(tone, &differ.to_string()).and(format!(" of {rays}{leaks}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::census::Standard;
    use gonio_report::Page;

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
        let mut page = Page::new("census");
        page.table(&table(&Log { rows, ..Log::default() }).unwrap());
        let page = page.finish();
        assert!(page.contains("<th>obvhs</th><th>embree</th>") && !page.contains("<th>brute</th>"), "{page}");
        assert!(page.contains("<span class=\"good\">0</span> of 200"), "{page}");
        assert!(page.contains("<span class=\"none\">3</span> of 100"), "{page}");
        assert!(table(&Log::default()).is_none());
    }
}
