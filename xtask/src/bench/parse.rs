//! Reads `benches/limits.toml`: as much of TOML as it needs, a comment at the top, two strings, and one line for each row.

use super::limits::{Build, Limit, Limits, RISE};
use std::str::FromStr;

impl FromStr for Limits {
    /// Line and what is wrong with it.
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut limits = Self {
            head: String::new(),
            build: Build { rustc: String::new(), target: String::new() },
            rows: Vec::new(),
        };
        let (mut in_head, mut in_rows) = (true, false);
        for (line, number) in text.lines().zip(1..) {
            let at = |error: String| format!("{number}: {error}");
            let content = line.trim();
            let is_text = content.is_empty() || content.starts_with('#');
            in_head &= is_text;
            if is_text {
                if in_head {
                    limits.head += &format!("{line}\n");
                } else if !content.is_empty() {
                    return Err(at("a comment below the first key would be lost".to_owned()));
                }
            } else if content == "[rows]" {
                in_rows = true;
            } else if in_rows {
                let (name, limit) = row(content).map_err(at)?;
                if limits.row(&name).is_some() {
                    return Err(at(format!("{name} is there twice")));
                }
                limits.rows.push((name, limit));
            } else {
                let (key, value) =
                    content.split_once('=').ok_or_else(|| at(format!("not `key = value`: {content}")))?;
                let (value, rest) = quoted(value).map_err(at)?;
                match (key.trim(), rest) {
                    ("rustc", "") => limits.build.rustc = value,
                    ("target", "") => limits.build.target = value,
                    _ => return Err(at(format!("neither rustc nor target nor [rows]: {content}"))),
                }
            }
        }
        Ok(limits)
    }
}

/// `"NAME" = { count = N, rise = PERCENT, because = "WHY", reason = "WHY" }`; rise and because together or not at all.
fn row(line: &str) -> Result<(String, Limit), String> {
    let (name, rest) = quoted(line)?;
    let fields = rest.strip_prefix('=').map(str::trim).and_then(|rest| rest.strip_prefix('{')?.strip_suffix('}'));
    let mut rest = fields.ok_or_else(|| format!("{name}: not `= {{ … }}` in one line"))?.trim();
    let (mut count, mut rise, mut because, mut reason) = (None, None, None, None);
    while let Some((key, after)) = rest.split_once('=') {
        let (key, after) = (key.trim(), after.trim());
        let wrong = |what: &str| format!("{name}: {key} is not {what}");
        let end = after.find(',').unwrap_or(after.len());
        let (plain, after_plain) = (after[..end].trim(), &after[end..]);
        let seen = match key {
            "count" => {
                let number = plain.parse().ok().filter(|&number| number > 0);
                rest = after_plain;
                count.replace(number.ok_or_else(|| wrong("a positive number"))?).is_some()
            }
            "rise" => {
                let percent = plain.parse().ok().filter(|&percent: &f64| percent >= 0.0 && percent.is_finite());
                rest = after_plain;
                rise.replace(percent.ok_or_else(|| wrong("a number of percent"))?).is_some()
            }
            "because" | "reason" => {
                let (text, after) = quoted(after)?;
                rest = after;
                let field = if key == "reason" { &mut reason } else { &mut because };
                field.replace(text).is_some()
            }
            _ => return Err(format!("{name}: no such field: {key}")),
        };
        if seen {
            return Err(format!("{name}: {key} is there twice"));
        }
        rest = rest.strip_prefix(',').unwrap_or(rest).trim();
    }
    if !rest.is_empty() {
        return Err(format!("{name}: not `key = value`: {rest}"));
    }
    let rise = match (rise, because) {
        (None, None) => None,
        (Some(rise), Some(because)) => Some((rise, because)),
        _ => return Err(format!("{name}: a rise other than {RISE} % says because of what, in `because`")),
    };
    let count = count.ok_or_else(|| format!("{name}: no count"))?;
    Ok((name.clone(), Limit { count, rise, reason: reason.ok_or_else(|| format!("{name}: no reason"))? }))
}

/// The string at the start of a text, and what follows it. Strings here have no escapes.
fn quoted(text: &str) -> Result<(String, &str), String> {
    let inner = text.trim().strip_prefix('"').and_then(|rest| rest.split_once('"'));
    match inner {
        Some((string, rest)) if !string.contains('\\') => Ok((string.to_owned(), rest.trim())),
        _ => Err(format!("not a string in quotation marks, without escapes: {}", text.trim())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_read_in_any_order_of_its_fields() {
        let (name, limit) = row(r#""a/b c" = {reason="a, b = c",count=12 , because = "why", rise = 0.5}"#).unwrap();
        assert_eq!((name.as_str(), limit.count, limit.reason.as_str()), ("a/b c", 12, "a, b = c"));
        assert_eq!(limit.rise, Some((0.5, "why".to_owned())));
    }

    #[test]
    fn what_is_not_a_row_is_refused() {
        for line in [
            "",
            "a = 1",
            r#""a" = 1"#,
            r#""a" = { }"#,
            r#""a" = { count = 1 }"#,
            r#""a" = { reason = "r" }"#,
            r#""a" = { count = 0, reason = "r" }"#,
            r#""a" = { count = -1, reason = "r" }"#,
            r#""a" = { count = 1.5, reason = "r" }"#,
            r#""a" = { count = 1, count = 2, reason = "r" }"#,
            r#""a" = { count = 1, reason = "r", rise = 3 }"#,
            r#""a" = { count = 1, reason = "r", because = "b" }"#,
            r#""a" = { count = 1, reason = "r", rise = nan, because = "b" }"#,
            r#""a" = { count = 1, reason = "r" what }"#,
            r#""a" = { count = 1, reason = "r" } # comment"#,
            r#""a" = { count = 1, reason = "r\n" }"#,
            r#""a" = { count = 1, reason = "r }"#,
            r#""a" = { count = 1, reason = "r", more = 2 }"#,
        ] {
            assert!(row(line).is_err(), "{line}");
        }
    }

    #[test]
    fn an_error_names_its_line() {
        for (text, line) in [
            ("rustc = \"1\"\nlibc = \"2\"\n", "2: "),
            ("rustc = \"1\"\n# late\n", "2: "),
            ("# head\n[rows]\n\"a\" = { count = 1, reason = \"r\" }\n\"a\" = { count = 1, reason = \"r\" }\n", "4: "),
        ] {
            let error = text.parse::<Limits>().unwrap_err();
            assert!(error.starts_with(line), "{error}");
        }
    }
}
