//! A page: one file, no script, nothing loaded, light and dark, readable on a phone.

use crate::environment::Environment;
use crate::exhibit::Exhibit;
use crate::markup::{Html, Tone, escape};
use crate::plot::Plot;
use crate::table::Table;
use std::fmt::Write;

/// A page that grows from the top down. One style sheet serves all.
#[derive(Clone, Debug)]
pub struct Page(String);

impl Page {
    /// A page with its title, which is not shown in it.
    pub fn new(title: &str) -> Self {
        Self(format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n\
             <style>\n{}</style>\n</head>\n<body>\n",
            escape(title),
            include_str!("page.css"),
        ))
    }

    fn line(&mut self, markup: &str) {
        let _ = writeln!(self.0, "{markup}");
    }

    /// What the page is about.
    pub fn headline(&mut self, text: &str) {
        self.line(&format!("<h1>{}</h1>", escape(text)));
    }

    /// How it ended, in one sentence.
    pub fn verdict(&mut self, tone: Tone, sentence: &str) {
        self.line(&format!("<p class=\"verdict {}\">{}</p>", tone.class(), escape(sentence)));
    }

    /// The beginning of a part.
    pub fn heading(&mut self, text: &str) {
        self.line(&format!("<h2>{}</h2>", escape(text)));
    }

    /// The beginning of a part that is good news or bad.
    pub fn toned_heading(&mut self, tone: Tone, text: &str) {
        self.line(&format!("<h2 class=\"{}\">{}</h2>", tone.class(), escape(text)));
    }

    /// A paragraph about what is shown.
    pub fn note(&mut self, text: impl Into<Html>) {
        self.line(&format!("<p class=\"soft\">{}</p>", text.into().as_str()));
    }

    /// A table.
    pub fn table(&mut self, table: &Table) {
        self.0 += &table.markup();
    }

    /// Plots side by side.
    pub fn plots<'a>(&mut self, plots: impl IntoIterator<Item = &'a Plot>) {
        self.figures(plots.into_iter().map(Plot::figure));
    }

    /// Pictures side by side.
    pub fn exhibits(&mut self, exhibits: &[Exhibit]) {
        self.figures(exhibits.iter().map(Exhibit::figure));
    }

    fn figures(&mut self, figures: impl Iterator<Item = Html>) {
        self.line("<div class=\"pictures\">");
        figures.for_each(|figure| self.0 += figure.as_str());
        self.line("</div>");
    }

    /// A table that is folded away below its name, open if it shall be seen at once. Links find it by the name.
    pub fn folded(&mut self, name: &str, open: bool, verdict: &Html, about: &str, table: &Table) {
        let open = if open { " open" } else { "" };
        self.line(&format!(
            "<details id=\"{0}\"{open}><summary><h3>{0}</h3> {1} <span class=\"soft\">{2}</span></summary>",
            escape(name),
            verdict.as_str(),
            escape(about),
        ));
        self.table(table);
        self.line("</details>");
    }

    /// How the program was built, and where it ran.
    pub fn environment(&mut self, environment: &Environment) {
        self.heading("Circumstances");
        self.table(&environment.table());
    }

    /// The whole page.
    pub fn finish(self) -> String {
        self.0 + "</body>\n</html>\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_whole_and_text_in_it_stays_text() {
        let mut page = Page::new("<t>");
        page.headline("<h>");
        page.verdict(Tone::Bad, "<v>");
        page.note(Html::from("<n> ").and(Html::code("gonio")));
        page.folded("name", true, &Html::toned(Tone::Good, "PASS"), "<about>", &Table::without_names());
        let text = page.finish();
        assert!(text.starts_with("<!DOCTYPE html>") && text.ends_with("</body>\n</html>\n"));
        for part in [
            "<title>&lt;t&gt;</title>",
            "<h1>&lt;h&gt;</h1>\n<p class=\"verdict bad\">&lt;v&gt;</p>\n<p class=\"soft\">&lt;n&gt; <code>gonio</code></p>\n",
            "<details id=\"name\" open><summary><h3>name</h3> <span class=\"good\">PASS</span> \
             <span class=\"soft\">&lt;about&gt;</span></summary>\n<table>",
        ] {
            assert!(text.contains(part), "{part} is not in {text}");
        }
    }
}
