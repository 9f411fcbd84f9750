//! The reports of Gonio: HTML, SVG and JSON, and nothing about what is measured.
//!
//! In the order in which a report is made:
//!
//! - A [`Check`] is what one instrument found about one subject; [`grade`] says how close it came to its limit.
//! - [`number`] and [`Html`] say how numbers and text are written: one author each, and text cannot become markup.
//! - A [`Table`] has [`Cell`]s, a [`Plot`] is drawn as SVG, an [`Exhibit`] is a rendered picture beside its deviation.
//! - A [`Page`] puts them one below the other: self-contained, no script, light and dark, readable on a phone.
//! - A [`Validation`] is the report of many checks: the whole as [`json`], sums by instrument, and a page.
//!
//! This crate knows no other crate of ours. Who measures fills these types; no markup is written elsewhere.
//!
//! ```
//! use gonio_report::{Cell, Page, Table, Tone};
//!
//! let mut table = Table::new(["Material", "Albedo"]);
//! table.row([Cell::new("chalk & lime"), Cell::number("albedo", "0.82")]);
//! let mut page = Page::new("Albedos");
//! page.verdict(Tone::Good, "All below one");
//! page.table(&table);
//! assert!(page.finish().contains("<td>chalk &amp; lime</td>"));
//! ```
#![forbid(unsafe_code)]

mod bar;
mod check;
mod checks;
mod colours;
mod environment;
mod exhibit;
pub mod grade;
pub mod json;
mod markup;
pub mod number;
mod page;
mod plot;
mod table;
mod validation;

pub use check::{Check, Outcome};
pub use checks::table as checks_table;
pub use colours::{Colours, around_mid_grey};
pub use environment::Environment;
pub use exhibit::{Exhibit, Speed};
pub use markup::{Html, Tone};
pub use page::Page;
pub use plot::{Axis, Figure, Histogram, Map, Plot};
pub use table::{Cell, Table};
pub use validation::{Header, Instrument, Summary, Validation};
