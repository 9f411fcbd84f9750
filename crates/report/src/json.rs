//! Reports as data.

use serde::Serialize;

/// A report as JSON: indented, with a line's end after its last line.
///
/// # Errors
/// If the report has what JSON does not, such as keys that are no text.
pub fn text(report: &impl Serialize) -> Result<String, serde_json::Error> {
    Ok(serde_json::to_string_pretty(report)? + "\n")
}
