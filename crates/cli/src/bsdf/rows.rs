//! Tables of numbers: read as CSV, written as CSV or as JSON lines.

use super::precision::Precision;
use crate::output::{Output, Target};
use anyhow::{Context, Result, bail};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};

/// How many rows are in memory at once.
pub(super) const BATCH: usize = 4096;

/// A table that is being written, row by row.
pub(super) struct RowWriter {
    output: Output,
    name: String,
    columns: &'static [&'static str],
    json: bool,
    precision: Precision,
}

impl RowWriter {
    /// Opens the table and writes the header of a CSV.
    pub(super) fn create(
        target: &Target,
        columns: &'static [&'static str],
        json: bool,
        precision: Precision,
    ) -> Result<Self> {
        let mut rows = Self { output: Output::create(target)?, name: target.to_string(), columns, json, precision };
        if !json {
            rows.line(&columns.join(","))?;
        }
        Ok(rows)
    }

    /// Writes one row: numbers for the first columns, and a word for the last if there is one more.
    pub(super) fn row(&mut self, numbers: impl IntoIterator<Item = f64>, word: Option<&str>) -> Result<()> {
        let mut cells: Vec<String> = numbers.into_iter().map(|x| self.precision.print(x)).collect();
        let line = if self.json {
            cells.extend(word.map(|word| format!("\"{word}\"")));
            let pairs: Vec<_> =
                self.columns.iter().zip(&cells).map(|(name, cell)| format!("\"{name}\":{cell}")).collect();
            format!("{{{}}}", pairs.join(","))
        } else {
            cells.extend(word.map(str::to_owned));
            cells.join(",")
        };
        self.line(&line)
    }

    /// Puts the file in its place.
    pub(super) fn finish(self) -> Result<()> {
        self.output.finish()
    }

    fn line(&mut self, text: &str) -> Result<()> {
        writeln!(self.output, "{text}").with_context(|| format!("{}: cannot be written", self.name))
    }
}

/// Reads rows of `N` numbers and hands them on in batches.
///
/// A first line that is the header (`columns`, any case) is skipped, and so are blank lines. NaN and infinities are numbers.
///
/// # Errors
/// The file cannot be read, or a row is something else; the message has file and line.
pub(super) fn read_rows<const N: usize>(
    source: &Target,
    columns: [&str; N],
    mut batch: impl FnMut(&[[f64; N]]) -> Result<()>,
) -> Result<()> {
    let (reader, name): (Box<dyn BufRead>, String) = match source {
        Target::Stdout => (Box::new(io::stdin().lock()), "standard input".to_owned()), // `-` as an input
        Target::File(path) => {
            let file = File::open(path).with_context(|| format!("{}: cannot be read", path.display()))?;
            (Box::new(BufReader::new(file)), path.display().to_string())
        }
    };
    let mut rows = Vec::with_capacity(BATCH);
    let mut first = true;
    for (line, number) in reader.lines().zip(1_u64..) {
        let line = line.with_context(|| format!("{name}:{number}: cannot be read"))?;
        let line = line.trim_start_matches('\u{feff}').trim();
        if line.is_empty() {
            continue;
        }
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let is_header = std::mem::take(&mut first)
            && cells.len() == N
            && cells.iter().zip(columns).all(|(cell, column)| cell.eq_ignore_ascii_case(column));
        if is_header {
            continue;
        }
        rows.push(parse(&cells).map_err(|why| anyhow::anyhow!("{name}:{number}: {why} ({})", columns.join(",")))?);
        if rows.len() == BATCH {
            batch(&rows)?;
            rows.clear();
        }
    }
    batch(&rows)
}

fn parse<const N: usize>(cells: &[&str]) -> Result<[f64; N]> {
    if cells.len() != N {
        bail!("a row has {N} numbers, this one has {} fields", cells.len());
    }
    let mut row = [0.0; N];
    for (number, cell) in row.iter_mut().zip(cells) {
        let Ok(parsed) = cell.parse() else { bail!("\"{cell}\" is not a number") };
        *number = parsed;
    }
    Ok(row)
}
