//! The statements of an OBJ file: every line means something, is dropped with a warning, or is refused with its number.
//!
//! Dropped is what a viewer would drop too: lines and points, curves, unknown keywords, texture coordinates or normals that
//! faces name and the file has not. A face may name vertices that are only defined further down; it then waits until the
//! end of the file.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use glam::DVec3;

use super::lines::{Lines, Survey};
use super::part::{Corner, Faults, NONE, Part, Pool, Scratch, unit};
use crate::SceneError;

/// Largest coordinate: far beyond any unit in use, and its cube is still finite in f32.
const MAX_COORDINATE: f64 = 1e12;

const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// What was read so far.
pub(super) struct Reader<'a> {
    path: &'a Path,
    survey: &'a Survey,
    pool: Pool,
    /// Positions, texture coordinates and normals so far.
    counts: [u32; 3],
    /// Without and with texture coordinates, the same with normals.
    parts: [Part; 4],
    /// The material of the faces that follow, as in [`Part::materials`].
    material: u32,
    material_index: HashMap<String, u32>,
    /// Material names with the line of their first use.
    pub(super) materials: Vec<(String, u32)>,
    /// Arguments of `mtllib` with their lines.
    pub(super) libraries: Vec<(String, u32)>,
    /// What was dropped: the sentence, the first line, how many lines, the last line.
    pub(super) dropped: BTreeMap<&'static str, (u32, u32, u32)>,
    pub(super) faults: Faults,
    face: Vec<Corner>,
    waiting: Waiting,
    scratch: Scratch,
}

/// Faces that name vertices further down.
#[derive(Default)]
struct Waiting {
    /// Line, material, number of corners.
    faces: Vec<(u32, u32, u32)>,
    corners: Vec<Corner>,
}

impl<'a> Reader<'a> {
    pub(super) fn new(path: &'a Path, survey: &'a Survey) -> Self {
        Self {
            path,
            survey,
            pool: Pool::default(),
            counts: [0; 3],
            parts: Default::default(),
            material: 0,
            material_index: HashMap::new(),
            materials: Vec::new(),
            libraries: Vec::new(),
            dropped: BTreeMap::new(),
            faults: Faults::default(),
            face: Vec::new(),
            waiting: Waiting::default(),
            scratch: Scratch::default(),
        }
    }

    /// Reads every statement; `progress` is told now and then how many bytes of the file are done.
    ///
    /// # Errors
    /// The first statement that cannot mean anything.
    pub(super) fn read(&mut self, lines: &mut Lines<'_>, progress: &mut dyn FnMut(u64)) -> Result<(), SceneError> {
        const STEP: u64 = 1 << 22;
        let mut told = 0;
        while let Some((number, statement)) = lines.next()? {
            self.statement(number, statement)?;
            if lines.bytes >= told + STEP {
                told = lines.bytes;
                progress(told);
            }
        }
        self.place_waiting()
    }

    /// The parts, of which some may be empty.
    pub(super) fn into_parts(self) -> [Part; 4] {
        self.parts
    }

    fn statement(&mut self, number: u32, line: &str) -> Result<(), SceneError> {
        let line = line.trim_ascii(); // white space is what it is to the survey
        let (keyword, rest) = line.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((line, ""));
        let values = rest.split('#').next().unwrap_or_default();
        match keyword {
            "v" => return self.vertex(number, values),
            "vt" => return self.texture_coordinate(number, values),
            "vn" => return self.normal(number, values),
            "f" | "fo" => return self.face(number, values),
            "usemtl" => self.use_material(number, rest.trim()),
            "mtllib" => self.libraries.push((rest.trim().to_owned(), number)),
            "l" | "p" => self.drop("lines and points are not drawn", number),
            "cstype" | "deg" | "bmat" | "step" | "curv" | "curv2" | "surf" | "parm" | "trim" | "hole" | "scrv"
            | "sp" | "end" | "con" => self.drop("free-form curves and surfaces are not supported", number),
            "" | "o" | "g" | "s" | "mg" | "vp" | "vw" | "lod" | "bevel" | "c_interp" | "d_interp" | "ctech"
            | "stech" | "usemap" | "maplib" | "shadow_obj" | "trace_obj" => {}
            _ if keyword.starts_with('#') => {}
            _ => self.drop("the line has an unknown keyword", number),
        }
        Ok(())
    }

    fn vertex(&mut self, number: u32, values: &str) -> Result<(), SceneError> {
        let ([x, y, z, last, ..], count) = self.numbers(number, "vertex", values, MAX_COORDINATE)?;
        let w = match count {
            3 => 1.0,
            4 => last,
            6 | 7 => {
                self.drop("vertex colours are not supported yet", number);
                1.0
            }
            _ => {
                let wanted = "a vertex has 3 coordinates, then optionally a weight or a colour";
                return Err(self.error(number, format!("{wanted}; here are {count} numbers")));
            }
        };
        let largest = x.abs().max(y.abs()).max(z.abs());
        if w == 0.0 || largest / w.abs() > MAX_COORDINATE {
            return Err(self.error(number, format!("the vertex divided by its weight {w} is not finite")));
        }
        self.define(0, |pool| pool.positions.push([x / w, y / w, z / w]));
        Ok(())
    }

    fn texture_coordinate(&mut self, number: u32, values: &str) -> Result<(), SceneError> {
        let ([u, v, ..], count) = self.numbers(number, "texture coordinate", values, f64::from(f32::MAX))?;
        if !(1..=3).contains(&count) {
            return Err(self.error(number, format!("a texture coordinate has 1 to 3 numbers; here are {count}")));
        }
        self.define(1, |pool| pool.uvs.push([u as f32, v as f32]));
        Ok(())
    }

    fn normal(&mut self, number: u32, values: &str) -> Result<(), SceneError> {
        let ([x, y, z, ..], count) = self.numbers(number, "normal", values, f64::MAX)?;
        if count != 3 {
            return Err(self.error(number, format!("a normal has 3 numbers; here are {count}")));
        }
        self.define(2, |pool| pool.normals.push(unit(DVec3::new(x, y, z))));
        Ok(())
    }

    /// Counts a vertex of one of the [`KINDS`], and keeps it if there is a face to use it.
    fn define(&mut self, kind: usize, keep: impl FnOnce(&mut Pool)) {
        self.counts[kind] += 1; // the survey has counted at least as many, fewer than 2³²
        if self.survey.faces > 0 {
            keep(&mut self.pool);
        }
    }

    /// Splits and checks at most eight numbers (more are counted as eight); those that are not there are 0.
    fn numbers(&self, number: u32, what: &str, values: &str, limit: f64) -> Result<([f64; 8], usize), SceneError> {
        let (mut numbers, mut count) = ([0.0; 8], 0);
        for (place, word) in numbers.iter_mut().zip(values.split_ascii_whitespace()) {
            let value: f64 =
                word.parse().map_err(|_| self.error(number, format!("\"{word}\" in a {what} is not a number")))?;
            if !value.is_finite() {
                return Err(self.error(number, format!("\"{word}\" in a {what} is not finite")));
            }
            if value.abs() > limit {
                let text = format!("\"{word}\" in a {what} is beyond the largest allowed, {limit:e}");
                return Err(self.error(number, text));
            }
            *place = value;
            count += 1;
        }
        Ok((numbers, count))
    }

    fn face(&mut self, number: u32, values: &str) -> Result<(), SceneError> {
        self.face.clear();
        let mut waits = false;
        for word in values.split_ascii_whitespace() {
            let corner = self.corner(number, word)?;
            waits |= (0..3).any(|kind| corner[kind] != NONE && corner[kind] >= self.counts[kind]);
            self.face.push(corner);
        }
        if self.face.len() < 3 {
            self.drop("a face needs three corners", number);
            return Ok(());
        }
        // Where some corners lack what others have, the face has it nowhere.
        let with = [1, 2].map(|kind| self.face.iter().all(|corner| corner[kind] != NONE));
        for corner in &mut self.face {
            let keep = |kind: usize| if with[kind - 1] { corner[kind] } else { NONE };
            *corner = [corner[0], keep(1), keep(2)];
        }
        if waits {
            self.waiting.faces.push((number, self.material, self.face.len() as u32));
            self.waiting.corners.extend(&self.face);
        } else {
            let part = &mut self.parts[usize::from(with[0]) + 2 * usize::from(with[1])];
            part.add(&self.pool, &self.face, self.material, number, &mut self.faults, &mut self.scratch);
        }
        Ok(())
    }

    /// Checks one `position/uv/normal` of a face; leaves out what the whole file does not define.
    fn corner(&mut self, number: u32, word: &str) -> Result<Corner, SceneError> {
        if word.starts_with('/') || word.bytes().filter(|&byte| byte == b'/').count() > 2 {
            return Err(self.error(number, format!("\"{word}\" is not a corner of a face (vertex/texture/normal)")));
        }
        let mut corner = [NONE; 3];
        let mut parts = word.split('/');
        for (kind, index) in corner.iter_mut().enumerate() {
            let part = parts.next().unwrap_or_default();
            let missing = match kind {
                _ if part.is_empty() || self.survey.vertices[kind] > 0 => None,
                0 => None,
                1 => Some("faces name texture coordinates, but the file defines none"),
                _ => Some("faces name normals, but the file defines none"),
            };
            match missing {
                Some(why) => self.drop(why, number),
                None if part.is_empty() => {}
                None => *index = self.index(number, kind, part)?,
            }
        }
        Ok(corner)
    }

    /// The number, from 0, of what an index of a face names.
    fn index(&self, number: u32, kind: usize, text: &str) -> Result<u32, SceneError> {
        let index: i64 =
            text.parse().map_err(|_| self.error(number, format!("\"{text}\" in a face is not an index")))?;
        let (what, above, all) = (KINDS[kind], i64::from(self.counts[kind]), self.survey.vertices[kind]);
        let out_of_range =
            |of: String| self.error(number, format!("{what} index {index} in a face is out of range: {of}"));
        match index {
            0 => Err(self.error(number, format!("{what} index 0 in a face: indices start at 1"))),
            1.. if index.unsigned_abs() > all => Err(out_of_range(format!("the file defines {all}"))),
            1.. => Ok((index - 1) as u32),
            _ if index < -above => Err(out_of_range(format!("{above} are defined above it"))),
            _ => Ok((above + index) as u32),
        }
    }

    /// Places the faces that name vertices further down.
    fn place_waiting(&mut self) -> Result<(), SceneError> {
        let Waiting { faces, corners } = std::mem::take(&mut self.waiting);
        let mut rest = &corners[..];
        for (line, material, length) in faces {
            let (face, after) = rest.split_at(length as usize);
            rest = after;
            for kind in 0..3 {
                let (what, defined) = (KINDS[kind], self.counts[kind]);
                if let Some(corner) = face.iter().find(|corner| corner[kind] != NONE && corner[kind] >= defined) {
                    let index = u64::from(corner[kind]) + 1;
                    let text = format!("{what} index {index} in a face is out of range: the file defines {defined}");
                    return Err(self.error(line, text));
                }
            }
            let [_, uv, normal] = face[0].map(|index| index != NONE);
            let part = &mut self.parts[usize::from(uv) + 2 * usize::from(normal)];
            part.add(&self.pool, face, material, line, &mut self.faults, &mut self.scratch);
        }
        Ok(())
    }

    fn use_material(&mut self, number: u32, name: &str) {
        self.material = match self.material_index.get(name) {
            Some(&slot) => slot,
            None => {
                self.materials.push((name.to_owned(), number));
                let slot = self.materials.len() as u32;
                self.material_index.insert(name.to_owned(), slot);
                slot
            }
        };
    }

    fn drop(&mut self, why: &'static str, number: u32) {
        let tally = self.dropped.entry(why).or_insert((number, 0, 0));
        if tally.2 != number {
            (tally.1, tally.2) = (tally.1 + 1, number); // several corners of a face count once
        }
    }

    fn error(&self, number: u32, message: String) -> SceneError {
        SceneError::at(self.path, number, message)
    }
}
