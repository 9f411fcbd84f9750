//! Where results go: standard output for `-`, else a file that appears whole or not at all.
//!
//! A file is written under a temporary name beside its target and renamed at the end, so a run that fails or is interrupted
//! leaves the old file alone. A target that exists and is not a regular file (`/dev/null`, a pipe) is written to directly.

use anyhow::{Context, Result, bail};
use std::convert::Infallible;
use std::fmt;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// The name of an output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// `-`
    Stdout,
    /// Anything else.
    File(PathBuf),
}

impl Target {
    /// `-` is standard output, anything else a file.
    pub(crate) fn named(text: &str) -> Self {
        if text == "-" { Self::Stdout } else { Self::File(text.into()) }
    }
}

impl FromStr for Target {
    type Err = Infallible;
    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(Self::named(text))
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stdout => f.write_str("standard output"),
            Self::File(path) => path.display().fmt(f),
        }
    }
}

/// An output that is being written.
pub(crate) struct Output {
    target: Target,
    temporary: Option<PathBuf>,
    writer: BufWriter<Box<dyn Write>>,
}

impl Output {
    /// Opens the output; an error now means that nothing was computed in vain.
    pub(crate) fn create(target: &Target) -> Result<Self> {
        let (writer, temporary): (Box<dyn Write>, _) = match target {
            Target::Stdout => (Box::new(io::stdout()), None),
            Target::File(path) if is_special(path) => {
                (Box::new(File::options().write(true).open(path).with_context(|| unwritable(path))?), None)
            }
            Target::File(path) => {
                let temporary = temporary_name(path)?;
                let file = File::create_new(&temporary).with_context(|| unwritable(path))?;
                (Box::new(file), Some(temporary))
            }
        };
        Ok(Self { target: target.clone(), temporary, writer: BufWriter::new(writer) })
    }

    /// Puts the file in its place.
    pub(crate) fn finish(mut self) -> Result<()> {
        self.writer.flush().with_context(|| format!("{}: cannot be written", self.target))?;
        if let (Some(temporary), Target::File(path)) = (&self.temporary, &self.target) {
            fs::rename(temporary, path).with_context(|| unwritable(path))?;
            self.temporary = None;
        }
        Ok(())
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        if let Some(temporary) = &self.temporary {
            let _ = fs::remove_file(temporary); // unfinished; there is nobody left to tell
        }
    }
}

/// Writes a whole text.
pub(crate) fn write_text(target: &Target, text: &str) -> Result<()> {
    let mut output = Output::create(target)?;
    output.write_all(text.as_bytes()).with_context(|| format!("{target}: cannot be written"))?;
    output.finish()
}

/// Finds out whether a file can appear at `path`, without touching what is there.
pub(crate) fn probe(path: &Path) -> Result<()> {
    let temporary = temporary_name(path)?;
    File::create_new(&temporary).and_then(|_| fs::remove_file(&temporary)).with_context(|| unwritable(path))
}

fn unwritable(path: &Path) -> String {
    format!("{}: cannot be written", path.display())
}

fn is_special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

fn temporary_name(path: &Path) -> Result<PathBuf> {
    if path.is_dir() {
        bail!("{}: cannot be written: it is a folder", path.display());
    }
    let Some(name) = path.file_name() else { bail!("{}: cannot be written: it names no file", path.display()) };
    Ok(path.with_file_name(format!(".{}.{}.tmp", name.to_string_lossy(), std::process::id())))
}
