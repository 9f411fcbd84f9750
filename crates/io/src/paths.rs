//! Files named by other files: relative names, backslashes, and text of unknown encoding.

use std::fs;
use std::path::{Path, PathBuf};

use crate::SceneError;

/// The file that `name`, written in the file `from`, stands for; `None` if there is none.
///
/// Relative names start at the folder of `from`. Backslashes separate folders everywhere. A name that leads nowhere
/// (an absolute path on its author's machine) is looked for beside `from` by its last part.
pub(crate) fn find(from: &Path, name: &str) -> Option<PathBuf> {
    let folder = from.parent().unwrap_or(Path::new(""));
    let slashed = name.replace('\\', "/");
    let last = slashed.rsplit('/').next().unwrap_or_default();
    [name, slashed.as_str(), last]
        .into_iter()
        .filter(|candidate| !candidate.is_empty())
        .map(|candidate| folder.join(candidate))
        .find(|candidate| candidate.is_file())
}

/// The file's text without byte-order mark, lines ended by `\n`.
///
/// Bytes that are not UTF-8 are read as Latin-1, which keeps different names different.
pub(crate) fn read_text(path: &Path) -> Result<String, SceneError> {
    let bytes = fs::read(path).map_err(|error| SceneError::file(path, format!("cannot be read: {error}")))?;
    let text = match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => error.as_bytes().iter().map(|&byte| char::from(byte)).collect(),
    };
    let text = match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    };
    // Before 2001 a Macintosh ended lines with a lone carriage return.
    Ok(if text.contains('\n') { text } else { text.replace('\r', "\n") })
}
