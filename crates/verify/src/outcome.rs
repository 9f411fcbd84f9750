//! What a check says of a condition: passed or failed.

use gonio_lab::Outcome;

/// Passed or failed.
pub(crate) fn outcome(passed: bool) -> Outcome {
    if passed { Outcome::Passed } else { Outcome::Failed }
}
