//! Lines of a text of any size, age and encoding, one at a time.
//!
//! A text is never in memory as a whole: an OBJ file may be larger than the machine's memory. It is read twice. The
//! [`Survey`] learns what only the whole file can tell: how its lines end and how many vertices it defines. Then
//! [`Lines`] hands out statements.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek};
use std::path::Path;

use crate::SceneError;

/// Longest statement in bytes, continued lines included: a polygon of a million corners.
const LONGEST: usize = 1 << 24;
/// Bytes read at once.
const BLOCK: usize = 1 << 18;

/// What a whole file holds.
pub(super) struct Survey {
    /// Ends a line. Before 2001, a Macintosh ended lines with a lone carriage return.
    end: u8,
    /// Lines that begin like a position, a texture coordinate and a normal; never fewer than there are.
    pub(super) vertices: [u64; 3],
    /// Lines that begin like a face.
    pub(super) faces: u64,
}

impl Survey {
    /// Looks through a file.
    ///
    /// # Errors
    /// The file cannot be read, or is not text: it has a zero byte or an endless line.
    pub(super) fn of(path: &Path, file: &File) -> Result<Self, SceneError> {
        let end = line_end(file).map_err(|error| unreadable(path, &error))?;
        let mut survey = Self { end, vertices: [0; 3], faces: 0 };
        let mut lines = Lines::new(path, file, &survey)?;
        while lines.read()? {
            let line = lines.raw.trim_ascii_start();
            if line.contains(&0) {
                let text = "here is a zero byte: an OBJ file is plain text, one byte per letter";
                return Err(SceneError::at(path, lines.number, text));
            }
            let keyword = line.iter().position(u8::is_ascii_whitespace).map_or(line, |end| &line[..end]);
            match keyword.strip_suffix(b"\\").unwrap_or(keyword) {
                b"v" => survey.vertices[0] += 1,
                b"vt" => survey.vertices[1] += 1,
                b"vn" => survey.vertices[2] += 1,
                b"f" | b"fo" => survey.faces += 1,
                _ => {}
            }
        }
        if survey.vertices.iter().any(|&count| count >= u64::from(u32::MAX)) {
            return Err(SceneError::file(path, "has more than 2³² vertices"));
        }
        Ok(survey)
    }
}

fn line_end(mut file: &File) -> io::Result<u8> {
    file.rewind()?;
    let mut reader = BufReader::with_capacity(BLOCK, file);
    loop {
        let block = reader.fill_buf()?;
        if block.contains(&b'\n') {
            return Ok(b'\n');
        }
        let length = block.len();
        if length == 0 {
            return Ok(b'\r');
        }
        reader.consume(length);
    }
}

/// The statements of a file, from its beginning.
pub(super) struct Lines<'a> {
    path: &'a Path,
    reader: BufReader<&'a File>,
    end: u8,
    /// Lines read so far.
    pub(super) number: u32,
    /// Bytes read so far.
    pub(super) bytes: u64,
    raw: Vec<u8>,
    statement: String,
}

impl<'a> Lines<'a> {
    pub(super) fn new(path: &'a Path, mut file: &'a File, survey: &Survey) -> Result<Self, SceneError> {
        file.rewind().map_err(|error| unreadable(path, &error))?;
        let reader = BufReader::with_capacity(BLOCK, file);
        Ok(Self { path, reader, end: survey.end, number: 0, bytes: 0, raw: Vec::new(), statement: String::new() })
    }

    /// The next statement without the byte-order mark, and the line on which it begins. A backslash at the end of a line
    /// continues it. Lines that are not UTF-8 are read as Latin-1, which keeps different names different.
    ///
    /// # Errors
    /// The file cannot be read, or a statement is too long.
    pub(super) fn next(&mut self) -> Result<Option<(u32, &str)>, SceneError> {
        self.statement.clear();
        let mut first = None;
        while self.read()? {
            let start = *first.get_or_insert(self.number);
            let line = match str::from_utf8(&self.raw) {
                Ok(line) => Cow::Borrowed(line),
                Err(_) => self.raw.iter().map(|&byte| char::from(byte)).collect(),
            };
            let Some(beginning) = line.trim_end().strip_suffix('\\') else {
                self.statement.push_str(&line);
                break;
            };
            self.statement.push_str(beginning);
            self.statement.push(' ');
            if self.statement.len() > LONGEST {
                return Err(endless(self.path, start));
            }
        }
        Ok(first.map(|start| (start, self.statement.as_str())))
    }

    /// Reads a line into `raw`; false at the end of the file.
    fn read(&mut self) -> Result<bool, SceneError> {
        self.raw.clear();
        let mut rest = self.reader.by_ref().take(LONGEST as u64 + 1);
        let length = rest.read_until(self.end, &mut self.raw).map_err(|error| unreadable(self.path, &error))?;
        if length == 0 {
            return Ok(false);
        }
        self.number = self.number.saturating_add(1);
        self.bytes += length as u64;
        if self.raw.last() == Some(&self.end) {
            self.raw.pop();
        }
        if self.raw.len() > LONGEST {
            return Err(endless(self.path, self.number));
        }
        if self.number == 1 && self.raw.starts_with(b"\xef\xbb\xbf") {
            self.raw.drain(..3);
        }
        Ok(true)
    }
}

fn unreadable(path: &Path, error: &io::Error) -> SceneError {
    SceneError::file(path, format!("cannot be read: {error}"))
}

fn endless(path: &Path, line: u32) -> SceneError {
    SceneError::at(path, line, format!("the line is longer than {LONGEST} bytes: this is not an OBJ file"))
}
