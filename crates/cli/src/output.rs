//! Where results go: standard output for `-`, else a file that appears whole or not at all.

use anyhow::{Context, Result};
use gonio_io::whole_file::WholeFile;
use std::convert::Infallible;
use std::fmt;
use std::io::{self, BufWriter, Stdout, Write};
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
    writer: Writer,
}

enum Writer {
    Stdout(BufWriter<Stdout>),
    File(WholeFile),
}

impl Output {
    /// Opens the output; an error now means that nothing was computed in vain.
    pub(crate) fn create(target: &Target) -> Result<Self> {
        let writer = match target {
            Target::Stdout => Writer::Stdout(BufWriter::new(io::stdout())),
            Target::File(path) => Writer::File(WholeFile::create(path).with_context(|| unwritable(target))?),
        };
        Ok(Self { target: target.clone(), writer })
    }

    /// Puts the file in its place.
    pub(crate) fn finish(self) -> Result<()> {
        match self.writer {
            Writer::Stdout(mut stdout) => stdout.flush(),
            Writer::File(file) => file.finish(),
        }
        .with_context(|| unwritable(&self.target))
    }

    fn writer(&mut self) -> &mut dyn Write {
        match &mut self.writer {
            Writer::Stdout(stdout) => stdout,
            Writer::File(file) => file,
        }
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer().write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.writer().flush()
    }
}

/// Writes all of an output at once.
pub(crate) fn write_all(target: &Target, bytes: &[u8]) -> Result<()> {
    let mut output = Output::create(target)?;
    output.write_all(bytes).with_context(|| unwritable(target))?;
    output.finish()
}

/// Writes a whole text.
pub(crate) fn write_text(target: &Target, text: &str) -> Result<()> {
    write_all(target, text.as_bytes())
}

/// Finds out whether a file can appear at `path`, without touching what is there.
pub(crate) fn probe(path: &Path) -> Result<()> {
    WholeFile::probe(path).with_context(|| unwritable(path.display()))
}

/// The extension in lower case.
pub(crate) fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase()
}

/// What is said before the reason.
fn unwritable(target: impl fmt::Display) -> String {
    format!("{target}: cannot be written")
}
