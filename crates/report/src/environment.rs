//! The circumstances of a measurement: how the program was built, and on what it ran.

use crate::table::{Cell, Table};
use serde::Serialize;

/// Where and how a program was built and run. Who builds the program knows; this is what is written of it.
#[derive(Clone, Debug, Serialize)]
pub struct Environment {
    /// The triple that it was compiled for, or only the architecture.
    pub target: &'static str,
    /// Features of the processor that it takes for granted.
    pub target_features: Vec<&'static str>,
    /// The compiler, if it is known.
    pub rustc: Option<&'static str>,
    /// Whether it was built with assertions.
    pub debug_assertions: bool,
    /// The processor's own name.
    pub processor: String,
    /// How many threads run at the same time.
    pub threads: usize,
}

impl Environment {
    /// A row for each circumstance.
    pub(crate) fn table(&self) -> Table {
        let mut table = Table::without_names();
        let assertions = if self.debug_assertions { "on" } else { "off" };
        for (name, value) in [
            ("Version", env!("CARGO_PKG_VERSION").to_owned()),
            ("Compiler", self.rustc.unwrap_or("not known").to_owned()),
            ("Target", format!("{} with {}", self.target, self.target_features.join(", "))),
            ("Debug assertions", assertions.to_owned()),
            ("Processor", format!("{}, {} threads", self.processor, self.threads)),
        ] {
            table.row([Cell::soft(name), Cell::new(value)]);
        }
        table
    }
}
