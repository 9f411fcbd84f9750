//! Brackets in TOML, looked at before the text is parsed.
//!
//! The parser of `toml` counts how deep it is, but not while it recovers from an error: some kilobytes of unclosed
//! brackets between broken keys overflow its stack, which ends the process. Texts nested so deep never reach it.

/// Far beyond what a scene needs, far below what a stack bears.
const DEEPEST: usize = 64;

/// The byte of a bracket that nests too deep or closes another kind, and what to say about it.
pub(super) fn fault(text: &str) -> Option<(usize, String)> {
    let bytes = text.as_bytes();
    let mut open = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let byte = bytes[at];
        match byte {
            b'#' => at = line_end(bytes, at),
            b'"' | b'\'' => {
                at = string_end(bytes, at);
                continue;
            }
            b'[' | b'{' if open.len() == DEEPEST => {
                return Some((at, format!("brackets are nested more than {DEEPEST} deep")));
            }
            b'[' => open.push(b']'),
            b'{' => open.push(b'}'),
            b']' | b'}' => match open.pop() {
                Some(expected) if expected == byte => {}
                Some(expected) => {
                    return Some((at, format!("expected `{}`, not `{}`", char::from(expected), char::from(byte))));
                }
                None => return Some((at, format!("`{}` closes nothing", char::from(byte)))),
            },
            _ => {}
        }
        at += 1;
    }
    None
}

fn line_end(bytes: &[u8], from: usize) -> usize {
    bytes[from..].iter().position(|&byte| byte == b'\n').map_or(bytes.len(), |length| from + length)
}

/// One past a string, or past its line if it does not end there.
fn string_end(bytes: &[u8], start: usize) -> usize {
    let quote = bytes[start];
    let long = bytes[start..].starts_with(&[quote; 3]);
    let mut at = start + if long { 3 } else { 1 };
    while at < bytes.len() {
        match bytes[at] {
            b'\\' if quote == b'"' => at += 1,
            b'\n' if !long => return at,
            byte if byte == quote && !long => return at + 1,
            byte if byte == quote && bytes[at..].starts_with(&[quote; 3]) => {
                // Two quotes may stand before the three that end a long string.
                let quotes = bytes[at..].iter().take_while(|&&byte| byte == quote).count();
                return at + quotes.min(5);
            }
            _ => {}
        }
        at += 1;
    }
    bytes.len()
}

#[cfg(test)]
mod tests {
    use super::fault;

    #[test]
    fn strings_and_comments_hold_any_brackets() {
        for text in [
            "a = \"[[ \\\" ]\" # }}}\nb = ['{', \"\"\"\n]] \"\"\"\"\"]\n",
            "c = '''\n{ ' }} '''''\n[[d]]\ne = { f = [1, 2], g = \"it's\" }\n",
            "h = \"unclosed [\ni = 'unclosed {\n",
            "",
        ] {
            assert_eq!(fault(text), None, "{text}");
        }
    }

    #[test]
    fn what_nests_too_deep_or_does_not_match_is_found() {
        assert_eq!(fault(&"[".repeat(64)), None);
        assert_eq!(fault(&"[".repeat(65)).map(|fault| fault.0), Some(64));
        assert_eq!(fault("a = [ }").map(|fault| fault.0), Some(6));
        assert_eq!(fault("]").map(|fault| fault.0), Some(0));
        assert_eq!(fault("a = \"\"\"x\"\"\" ]").map(|fault| fault.0), Some(12));
    }
}
