//! Rendered pictures whose answer is known, and how fast they were rendered.

use crate::bar;
use crate::colours::around_mid_grey;
use crate::markup::{Html, escape, png_address};
use crate::table::{Cell, Table};
use std::collections::BTreeSet;

/// A picture for a report, beside how far it is from its answer.
#[derive(Clone, Debug)]
pub struct Exhibit {
    /// What was rendered.
    pub name: String,
    /// What every pixel should be, in words.
    pub answer: String,
    /// A PNG file: as rendered.
    pub rendered: Vec<u8>,
    /// A PNG file: the shades of [`Exhibit::shade`].
    pub deviation: Vec<u8>,
    /// Of one rendering with each backend.
    pub speeds: Vec<Speed>,
}

/// How fast a backend rendered.
#[derive(Clone, Debug)]
pub struct Speed {
    /// Its name.
    pub backend: String,
    /// Millions of samples per second.
    pub msamples_per_second: f64,
}

impl Exhibit {
    /// How much the deviation is magnified.
    pub const MAGNIFIED: f64 = 10.0;

    /// The shade, linear, of a value that should be another.
    pub fn shade(value: f64, expected: f64) -> f32 {
        around_mid_grey(Self::MAGNIFIED * (value / expected - 1.0))
    }

    /// Both pictures with their words.
    pub(crate) fn figure(&self) -> Html {
        let image = |file: &[u8], what: &str| format!("<img alt=\"{what}\" src=\"{}\">", png_address(file));
        Html::raw(format!(
            "<figure><div>{}{}</div><figcaption>{}<br>{}</figcaption></figure>\n",
            image(&self.rendered, "as rendered"),
            image(&self.deviation, "deviation"),
            escape(&self.name),
            escape(&self.answer),
        ))
    }
}

/// How fast each backend rendered each exhibit, if any was measured.
pub(crate) fn speeds(exhibits: &[Exhibit]) -> Option<Table> {
    let all = || exhibits.iter().flat_map(|exhibit| &exhibit.speeds);
    let backends: BTreeSet<&str> = all().map(|speed| speed.backend.as_str()).collect();
    if backends.is_empty() {
        return None;
    }
    let most = all().map(|speed| speed.msamples_per_second).fold(1e-300, f64::max);
    let mut table = Table::new(std::iter::once("Furnace").chain(backends.iter().copied()));
    for exhibit in exhibits {
        let cell = |backend: &&str| {
            let speed = exhibit.speeds.iter().find(|s| s.backend == *backend).map_or(0.0, |s| s.msamples_per_second);
            Cell::number(backend, Html::from(format!("{speed:.2}")).and(bar::of_share(speed / most)))
        };
        table.row(std::iter::once(Cell::new(&*exhibit.name)).chain(backends.iter().map(cell)));
    }
    Some(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_backend_has_a_column_and_the_fastest_the_longest_bar() {
        let speed = |backend: &str, msamples_per_second| Speed { backend: backend.to_owned(), msamples_per_second };
        let exhibit = |speeds| Exhibit {
            name: "box".to_owned(),
            answer: String::new(),
            rendered: Vec::new(),
            deviation: Vec::new(),
            speeds,
        };
        let page = speeds(&[exhibit(vec![speed("obvhs", 4.0), speed("brute", 1.0)])]).unwrap().markup();
        assert!(page.contains("<th>Furnace</th><th>brute</th><th>obvhs</th>"), "{page}");
        assert!(page.contains("1.00<svg") && page.contains("width=\"25.0\"") && page.contains("width=\"100.0\""));
        assert!(speeds(&[exhibit(Vec::new())]).is_none());
        assert_eq!(Exhibit::shade(2.0, 2.0), 0.214);
    }
}
