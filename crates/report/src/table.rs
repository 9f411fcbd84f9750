//! Tables of a page.

use crate::markup::{Html, escape};
use std::fmt::Write;

/// A table: names of columns, and rows of cells.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// The row of names, or nothing.
    head: String,
    body: String,
}

/// A cell of a [`Table`].
#[derive(Clone, Debug, Default)]
pub struct Cell(String);

impl Table {
    /// A table with named columns.
    pub fn new<H: Into<Html>>(columns: impl IntoIterator<Item = H>) -> Self {
        let names: String = columns.into_iter().map(|name| format!("<th>{}</th>", name.into().as_str())).collect();
        Self { head: format!("<thead><tr>{names}</tr></thead>"), body: String::new() }
    }

    /// A table whose rows speak for themselves.
    pub fn without_names() -> Self {
        Self::default()
    }

    /// Adds a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = Cell>) {
        let cells: String = cells.into_iter().map(|cell| cell.0).collect();
        let _ = writeln!(self.body, "<tr>{cells}</tr>");
    }

    /// The whole table.
    pub(crate) fn markup(&self) -> String {
        format!("<table>{}<tbody>\n{}</tbody></table>\n", self.head, self.body)
    }
}

impl Cell {
    /// Text, or a piece of a page.
    pub fn new(content: impl Into<Html>) -> Self {
        Self(format!("<td>{}</td>", content.into().as_str()))
    }

    /// Text that matters less than what is beside it.
    pub fn soft(text: &str) -> Self {
        Self(format!("<td class=\"soft\">{}</td>", escape(text)))
    }

    /// A number. On a narrow screen its name stands before it, because there are no columns.
    pub fn number(name: &str, content: impl Into<Html>) -> Self {
        Self(format!("<td class=\"number\" data-name=\"{}\">{}</td>", escape(name), content.into().as_str()))
    }

    /// Nothing.
    pub fn empty() -> Self {
        Self("<td></td>".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_in_a_table_stays_text() {
        let mut table = Table::new(["a<b"]);
        table.row([Cell::new("<i>"), Cell::number("\"", "1"), Cell::soft("&"), Cell::empty()]);
        assert_eq!(
            table.markup(),
            "<table><thead><tr><th>a&lt;b</th></tr></thead><tbody>\n<tr><td>&lt;i&gt;</td><td class=\"number\" \
             data-name=\"&quot;\">1</td><td class=\"soft\">&amp;</td><td></td></tr>\n</tbody></table>\n"
        );
        assert_eq!(Table::without_names().markup(), "<table><tbody>\n</tbody></table>\n");
    }
}
