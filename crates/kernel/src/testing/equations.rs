//! Equations in the documentation arrive as they were written.
//!
//! Markdown takes the backslash before punctuation for its own: `\,` arrives as a comma, `\{` as a brace. In a doc comment it is
//! written twice.

use std::path::Path;
use std::string::String;
use std::vec::Vec;
use std::{format, fs};

/// The lines, counted from 0, in whose equations markdown eats a backslash. Code is no equation.
fn eaten(text: &str) -> Vec<usize> {
    let (mut lines, mut math, mut fenced) = (Vec::new(), None, false);
    for (number, line) in text.lines().enumerate() {
        let line = line.trim_start();
        let Some(doc) = line.strip_prefix("//!").or(line.strip_prefix("///")) else {
            (math, fenced) = (None, false); // a new comment
            continue;
        };
        if doc.trim_start().starts_with("```") {
            fenced = !fenced;
            continue;
        }
        let mut rest = if fenced { "" } else { doc };
        let mut code = false;
        while let Some(first) = rest.chars().next() {
            let mut used = first.len_utf8();
            match first {
                '`' if math.is_none() => code = !code,
                '$' if !code => {
                    let sign = if rest.starts_with("$$") { "$$" } else { "$" };
                    used = sign.len();
                    math = if math.is_none() { Some(sign) } else { None };
                }
                '\\' => {
                    let next = rest[1..].chars().next();
                    used += next.map_or(0, char::len_utf8);
                    if math.is_some() && next.is_some_and(|c| c.is_ascii_punctuation() && c != '\\') {
                        lines.push(number);
                    }
                }
                _ => (),
            }
            rest = &rest[used..];
        }
    }
    lines.dedup();
    lines
}

fn search(directory: &Path, found: &mut Vec<String>) {
    for entry in fs::read_dir(directory).expect("a directory of sources").flatten() {
        let path = entry.path();
        if path.is_dir() {
            search(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path).expect("a readable source");
            found.extend(eaten(&text).into_iter().map(|line| format!("{}:{}", path.display(), line + 1)));
        }
    }
}

#[test]
fn no_equation_loses_a_backslash() {
    let mut found = Vec::new();
    search(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut found);
    assert!(found.is_empty(), "write the backslash before punctuation twice:\n{}", found.join("\n"));
}

#[test]
fn a_lost_backslash_is_found_and_a_doubled_one_is_not() {
    assert_eq!(eaten(r"//! $a\,b$ and $$ \pi\{x\} $$"), [0]);
    assert_eq!(eaten("/// $$ a +\n///   b\\;c $$"), [1]);
    assert_eq!(eaten(r"/// $a\\,b$, \[0, 1\], `$x\,$`, $\alpha \cdot \frac12$"), [0; 0]);
    assert_eq!(eaten("/// ```\n/// $x\\,$\n/// ```\nlet x = \"$\\,\"; // $\\,$"), [0; 0]);
}
