//! The instruments of Gonio: white furnace, reciprocity, chi-squared, totality, and the faults that test them.
#![forbid(unsafe_code)]

mod check;

pub use check::{Check, Effort, Outcome};
