//! MTL text as `tobj` understands it: one bad line costs that line, not the file.
//!
//! `tobj` gives up on a whole library at its first odd line and panics on a colour of two numbers. Here each line is
//! looked at once: numbers are brought into their ranges, what makes no sense is dropped, both with a warning that has
//! the line. Names pass as numbers, so that no spelling of `newmtl` can lose one.

use std::fmt::Write as _;
use std::path::Path;

use crate::SceneError;

/// Keywords with numbers: canonical spelling, how many, least and largest value.
const NUMBERS: [(&str, usize, f64, f64); 13] = [
    ("Ka", 3, f64::MIN, f64::MAX), // not used, but its spelling must not trip the reader
    ("Kd", 3, 0.0, 1.0),
    ("Ks", 3, 0.0, 1.0),
    ("Ke", 3, 0.0, gonio_tracer::scene::MAX_RADIANCE),
    ("Tf", 3, 0.0, 1.0),
    ("Ns", 1, 0.0, 1e9),
    ("Ni", 1, 0.0, 1e3),
    ("d", 1, 0.0, 1.0),
    ("Tr", 1, 0.0, 1.0),
    ("Pr", 1, 0.0, 1.0),
    ("Pm", 1, 0.0, 1.0),
    ("aniso", 1, -1.0, 1.0),
    ("illum", 1, 0.0, 10.0),
];

/// Text that `tobj` reads without an error.
#[derive(Default)]
pub(super) struct Clean {
    pub(super) text: String,
    /// Names in order; in `text`, `newmtl` has the index instead of the name.
    pub(super) names: Vec<String>,
    pub(super) warnings: Vec<String>,
}

/// Looks at every line of an MTL file.
pub(super) fn clean(path: &Path, source: &str) -> Clean {
    let mut out = Clean::default();
    for (number, line) in (1_u32..).zip(source.lines()) {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        if keyword.is_empty() || keyword.starts_with('#') {
            continue;
        }
        if keyword.eq_ignore_ascii_case("newmtl") {
            let _ = writeln!(out.text, "newmtl {}", out.names.len()); // writing to a String cannot fail
            out.names.push(rest.to_owned());
        } else if out.names.is_empty() {
            out.warn(path, number, format!("\"{keyword}\" before the first newmtl is ignored"));
        } else if let Some(&entry) = NUMBERS.iter().find(|(name, ..)| keyword.eq_ignore_ascii_case(name)) {
            match numbers(entry, rest.split('#').next().unwrap_or_default()) {
                Ok((text, clamped)) => {
                    let _ = writeln!(out.text, "{} {text}", entry.0); // writing to a String cannot fail
                    if clamped {
                        out.warn(path, number, format!("\"{line}\" is out of range and becomes {text}"));
                    }
                }
                Err(why) => out.warn(path, number, format!("\"{line}\" is ignored: {why}")),
            }
        } else if rest.is_empty() {
            out.warn(path, number, format!("\"{keyword}\" has no value and is ignored"));
        } else {
            let keyword = if keyword.eq_ignore_ascii_case("map_Kd") { "map_Kd" } else { keyword };
            let _ = writeln!(out.text, "{keyword} {rest}"); // writing to a String cannot fail
        }
    }
    out
}

/// The numbers of a line as text, in range; whether one had to be moved.
fn numbers((name, wanted, least, most): (&str, usize, f64, f64), values: &str) -> Result<(String, bool), String> {
    let mut found = Vec::new();
    for word in values.split_whitespace().take(wanted) {
        match word.parse::<f64>() {
            Ok(value) if value.is_finite() => found.push(value),
            Ok(_) => return Err(format!("\"{word}\" is not finite")),
            Err(_) => return Err(format!("\"{word}\" is not a number")),
        }
    }
    if found.len() == 1 {
        found = vec![found[0]; wanted]; // `Kd 0.5` is grey
    }
    if found.len() != wanted {
        return Err(format!("{name} has {wanted} numbers, here are {}", found.len()));
    }
    if name == "illum" {
        found[0] = found[0].trunc(); // tobj reads an integer
    }
    let clamped: Vec<f64> = found.iter().map(|value| value.clamp(least, most)).collect();
    let text: Vec<String> = clamped.iter().map(f64::to_string).collect();
    Ok((text.join(" "), clamped != found))
}

impl Clean {
    fn warn(&mut self, path: &Path, number: u32, message: String) {
        self.warnings.push(SceneError::at(path, number, message).to_string());
    }
}
