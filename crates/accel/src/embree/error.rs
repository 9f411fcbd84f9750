//! Why Embree cannot be used.

use thiserror::Error;

/// Why Embree cannot be used.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum EmbreeError {
    /// The library that was found is too old or too new.
    #[error("the library is Embree {}.{}.{}, but 4.2 or a later 4 is needed", .0 / 10_000, .0 / 100 % 100, .0 % 100)]
    Version(isize),
    /// Embree refused something.
    #[error("Embree cannot {task}: {reason}")]
    Refused {
        /// What was asked for.
        task: &'static str,
        /// What it said.
        reason: &'static str,
    },
}
