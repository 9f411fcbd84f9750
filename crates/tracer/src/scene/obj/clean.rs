//! OBJ text as `tobj` understands it: every line is looked at once before `tobj` reads it.
//!
//! `tobj` gives no line numbers, and some inputs it misreads without a word: an `l` of three points becomes a triangle,
//! an index far out of range wraps around, faces with and without normals in one group shift the normals of the rest,
//! a file with a byte-order mark loses its first line. Here such lines are refused with their number, rewritten to what
//! they mean, or dropped with a warning where a viewer would drop them. The reading itself is left to `tobj`.

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;
use std::path::Path;

use crate::scene::SceneError;

/// Largest coordinate: far beyond any unit in use, and its cube is still finite in f32.
const MAX_COORDINATE: f64 = 1e12;

/// Text that `tobj` reads without an error, and what it would have lost.
#[derive(Default)]
pub(super) struct Clean {
    pub(super) text: String,
    /// Line of each face in `text`, in order.
    pub(super) face_lines: Vec<u32>,
    /// Material names with the line of their first use; in `text`, `usemtl` has the index instead of the name.
    pub(super) materials: Vec<(String, u32)>,
    /// Arguments of `mtllib` with their lines.
    pub(super) libraries: Vec<(String, u32)>,
    /// Number of lines in the file.
    pub(super) lines: u32,
    /// First face that names a vertex further down: `tobj` cannot always read these.
    pub(super) forward: Option<u32>,
    /// What was dropped: the sentence, the first line, how many lines, the last line.
    pub(super) dropped: BTreeMap<&'static str, (u32, u32, u32)>,
}

/// Looks at every line of an OBJ file.
///
/// # Errors
/// The first line that cannot mean anything.
pub(super) fn clean(path: &Path, source: &str) -> Result<Clean, SceneError> {
    let mut cleaner = Cleaner {
        path,
        out: Clean::default(),
        counts: [0; 3],
        highest: [(0, 0); 3],
        exists: [true, defines(source, "vt"), defines(source, "vn")],
        format: None,
        material_index: HashMap::new(),
    };
    cleaner.out.text.reserve(source.len() + source.len() / 8);
    let mut continued = String::new();
    let mut start = 1;
    for (number, line) in (1_u32..).zip(source.lines()) {
        cleaner.out.lines = number;
        if let Some(beginning) = line.trim_end().strip_suffix('\\') {
            if continued.is_empty() {
                start = number;
            }
            continued.push_str(beginning);
            continued.push(' ');
        } else if continued.is_empty() {
            cleaner.line(number, line)?;
        } else {
            continued.push_str(line);
            let whole = std::mem::take(&mut continued);
            cleaner.line(start, &whole)?;
        }
    }
    if !continued.is_empty() {
        cleaner.line(start, &continued)?;
    }
    cleaner.finish()
}

fn defines(source: &str, keyword: &str) -> bool {
    let starts = |line: &str| line.trim_start().strip_prefix(keyword).is_some_and(|rest| rest.starts_with([' ', '\t']));
    source.lines().any(starts)
}

struct Cleaner<'a> {
    path: &'a Path,
    out: Clean,
    /// Positions, texture coordinates and normals so far.
    counts: [i64; 3],
    /// The highest index used of each kind, and its line.
    highest: [(i64, u32); 3],
    /// Which kinds the file defines anywhere.
    exists: [bool; 3],
    /// Whether the last face had texture coordinates and normals.
    format: Option<(bool, bool)>,
    material_index: HashMap<String, usize>,
}

const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

impl Cleaner<'_> {
    fn line(&mut self, number: u32, line: &str) -> Result<(), SceneError> {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        let values = rest.split('#').next().unwrap_or_default();
        match keyword {
            "v" => self.vertex(number, values),
            "vt" => self.texture_coordinate(number, values),
            "vn" => self.normal(number, values),
            "f" | "fo" => self.face(number, values),
            "usemtl" => {
                self.use_material(number, rest);
                Ok(())
            }
            "mtllib" => {
                self.out.libraries.push((rest.to_owned(), number));
                Ok(())
            }
            "l" | "p" => {
                self.drop("lines and points are not drawn", number);
                Ok(())
            }
            "cstype" | "deg" | "bmat" | "step" | "curv" | "curv2" | "surf" | "parm" | "trim" | "hole" | "scrv"
            | "sp" | "end" | "con" => {
                self.drop("free-form curves and surfaces are not supported", number);
                Ok(())
            }
            "" | "o" | "g" | "s" | "mg" | "vp" | "vw" | "lod" | "bevel" | "c_interp" | "d_interp" | "ctech"
            | "stech" | "usemap" | "maplib" | "shadow_obj" | "trace_obj" => Ok(()),
            _ if keyword.starts_with('#') => Ok(()),
            _ => {
                self.drop("the line has an unknown keyword", number);
                Ok(())
            }
        }
    }

    fn vertex(&mut self, number: u32, values: &str) -> Result<(), SceneError> {
        let (words, numbers, count) = self.numbers(number, "vertex", values, MAX_COORDINATE)?;
        let w = match count {
            3 => 1.0,
            4 => numbers[3],
            6 | 7 => {
                self.drop("vertex colours are not supported yet", number);
                1.0
            }
            _ => {
                let wanted = "a vertex has 3 coordinates, then optionally a weight or a colour";
                return Err(self.error(number, format!("{wanted}; here are {count} numbers")));
            }
        };
        let largest = numbers[..3].iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        if w == 0.0 || largest / w.abs() > MAX_COORDINATE {
            return Err(self.error(number, format!("the vertex divided by its weight {w} is not finite")));
        }
        self.counts[0] += 1;
        self.push("v", &words[..if count == 4 { 4 } else { 3 }]);
        Ok(())
    }

    fn texture_coordinate(&mut self, number: u32, values: &str) -> Result<(), SceneError> {
        let (mut words, _, count) = self.numbers(number, "texture coordinate", values, f64::from(f32::MAX))?;
        match count {
            1 => words[1] = "0",
            2 | 3 => {}
            _ => return Err(self.error(number, format!("a texture coordinate has 1 to 3 numbers; here are {count}"))),
        }
        self.counts[1] += 1;
        self.push("vt", &words[..2]);
        Ok(())
    }

    fn normal(&mut self, number: u32, values: &str) -> Result<(), SceneError> {
        let (words, _, count) = self.numbers(number, "normal", values, f64::MAX)?;
        if count != 3 {
            return Err(self.error(number, format!("a normal has 3 numbers; here are {count}")));
        }
        self.counts[2] += 1;
        self.push("vn", &words[..3]);
        Ok(())
    }

    /// Splits and checks at most eight numbers (more are counted as eight).
    fn numbers<'t>(
        &self,
        number: u32,
        what: &str,
        values: &'t str,
        limit: f64,
    ) -> Result<([&'t str; 8], [f64; 8], usize), SceneError> {
        let (mut words, mut numbers, mut count) = ([""; 8], [0.0; 8], 0);
        for word in values.split_whitespace().take(8) {
            let value: f64 =
                word.parse().map_err(|_| self.error(number, format!("\"{word}\" in a {what} is not a number")))?;
            if !value.is_finite() {
                return Err(self.error(number, format!("\"{word}\" in a {what} is not finite")));
            }
            if value.abs() > limit {
                return Err(
                    self.error(number, format!("\"{word}\" in a {what} is beyond the largest allowed, {limit:e}"))
                );
            }
            words[count] = word;
            numbers[count] = value;
            count += 1;
        }
        Ok((words, numbers, count))
    }

    fn face(&mut self, number: u32, values: &str) -> Result<(), SceneError> {
        let (mut corners, mut with_uv, mut with_normal) = (0, 0, 0);
        let mut as_written = true;
        for word in values.split_whitespace() {
            let parts = self.corner(number, word)?;
            as_written &= parts == split_corner(word);
            let [_, uv, normal] = parts;
            corners += 1;
            with_uv += usize::from(!uv.is_empty());
            with_normal += usize::from(!normal.is_empty());
        }
        if corners < 3 {
            self.drop("a face needs three corners", number);
            return Ok(());
        }
        let format = (with_uv == corners, with_normal == corners);
        if self.format.is_some_and(|last| last != format) {
            self.out.text.push_str("g\n"); // tobj keeps one format per group
        }
        self.format = Some(format);
        self.out.face_lines.push(number);
        if as_written && (with_uv == 0 || format.0) && (with_normal == 0 || format.1) {
            self.push("f", &[values]);
            return Ok(());
        }
        // Some corners lack what others have, or the file does: then the face has it nowhere.
        self.out.text.push('f');
        for word in values.split_whitespace() {
            let [position, uv, normal] = split_corner(word);
            let (uv, normal) = (if format.0 { uv } else { "" }, if format.1 { normal } else { "" });
            let _ = write!(self.out.text, " {position}/{uv}/{normal}"); // writing to a String cannot fail
        }
        self.out.text.push('\n');
        Ok(())
    }

    /// Checks one `position/uv/normal` of a face; leaves out what the whole file does not define.
    fn corner<'t>(&mut self, number: u32, word: &'t str) -> Result<[&'t str; 3], SceneError> {
        let mut parts = split_corner(word);
        for (kind, why) in [
            (1, "faces name texture coordinates, but the file defines none"),
            (2, "faces name normals, but the file defines none"),
        ] {
            if !self.exists[kind] && !parts[kind].is_empty() {
                parts[kind] = "";
                self.drop(why, number);
            }
        }
        if parts[0].is_empty() || word.split('/').count() > 3 {
            return Err(self.error(number, format!("\"{word}\" is not a corner of a face (vertex/texture/normal)")));
        }
        for (kind, part) in parts.iter().enumerate().filter(|(_, part)| !part.is_empty()) {
            let index: i64 =
                part.parse().map_err(|_| self.error(number, format!("\"{part}\" in a face is not an index")))?;
            let (what, defined) = (KINDS[kind], self.counts[kind]);
            if index == 0 {
                return Err(self.error(number, format!("{what} index 0 in a face: indices start at 1")));
            }
            if index < -defined {
                let text = format!("{what} index {index} in a face is out of range: {defined} are defined above it");
                return Err(self.error(number, text));
            }
            if index > defined {
                self.out.forward.get_or_insert(number);
            }
            if index > self.highest[kind].0 {
                self.highest[kind] = (index, number);
            }
        }
        Ok(parts)
    }

    fn use_material(&mut self, number: u32, name: &str) {
        let fresh = self.out.materials.len();
        let index = *self.material_index.entry(name.to_owned()).or_insert(fresh);
        if index == fresh {
            self.out.materials.push((name.to_owned(), number));
        }
        let _ = writeln!(self.out.text, "usemtl {index}"); // writing to a String cannot fail
    }

    fn finish(self) -> Result<Clean, SceneError> {
        for (kind, &(index, line)) in self.highest.iter().enumerate() {
            if index > self.counts[kind] {
                let (what, defined) = (KINDS[kind], self.counts[kind]);
                let text = format!("{what} index {index} in a face is out of range: the file defines {defined}");
                return Err(self.error(line, text));
            }
        }
        Ok(self.out)
    }

    fn push(&mut self, keyword: &str, words: &[&str]) {
        self.out.text.push_str(keyword);
        for word in words {
            self.out.text.push(' ');
            self.out.text.push_str(word);
        }
        self.out.text.push('\n');
    }

    fn drop(&mut self, why: &'static str, number: u32) {
        let tally = self.out.dropped.entry(why).or_insert((number, 0, 0));
        if tally.2 != number {
            (tally.1, tally.2) = (tally.1 + 1, number); // several corners of a face count once
        }
    }

    fn error(&self, number: u32, message: String) -> SceneError {
        SceneError::at(self.path, number, message)
    }
}

fn split_corner(word: &str) -> [&str; 3] {
    let mut parts = word.split('/');
    std::array::from_fn(|_| parts.next().unwrap_or_default())
}
