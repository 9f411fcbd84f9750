//! TOML with line numbers: a table hands out values by key and refuses the keys that nobody asked for.

use std::cell::RefCell;
use std::ops::RangeInclusive;
use std::path::Path;

use glam::DVec3;
use gonio_kernel::Rgb;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::nesting;
use crate::error::{SceneError, quoted};

/// The text and its name: turns a place in it into a line.
#[derive(Clone, Copy)]
pub(super) struct Document<'d> {
    pub(super) path: &'d Path,
    pub(super) text: &'d str,
}

impl<'d> Document<'d> {
    /// Parses the text.
    ///
    /// # Errors
    /// What `toml` says about the syntax, with the line.
    pub(super) fn parse(&self) -> Result<Spanned<DeTable<'d>>, SceneError> {
        if let Some((at, why)) = nesting::fault(self.text) {
            return Err(self.error(at, why));
        }
        DeTable::parse(self.text)
            .map_err(|error| self.error(error.span().map_or(0, |span| span.start), error.message().replace('\n', ", ")))
    }

    /// An error at a byte of the text.
    pub(super) fn error(&self, offset: usize, message: impl Into<String>) -> SceneError {
        let before = &self.text.as_bytes()[..offset.min(self.text.len())];
        let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
        SceneError::at(self.path, u32::try_from(line).unwrap_or(u32::MAX), message)
    }
}

/// A table of the document. Every key must be asked for before [`Table::finish`].
pub(super) struct Table<'d> {
    document: Document<'d>,
    name: String,
    start: usize,
    entries: &'d DeTable<'d>,
    known: RefCell<Vec<&'static str>>,
}

impl<'d> Table<'d> {
    pub(super) fn new(document: Document<'d>, name: &str, start: usize, entries: &'d DeTable<'d>) -> Self {
        Self { document, name: name.to_owned(), start, entries, known: RefCell::default() }
    }

    /// The value of a key, if it is there.
    pub(super) fn get(&self, key: &'static str) -> Option<Value<'d>> {
        self.know(key);
        let item = self.entries.get(key)?;
        Some(Value { document: self.document, name: key.to_owned(), item })
    }

    /// Whether a key is there.
    pub(super) fn has(&self, key: &str) -> bool {
        self.entries.contains_key(key)
    }

    /// A key that may be there: [`Table::finish`] names it and does not refuse it.
    pub(super) fn know(&self, key: &'static str) {
        let mut known = self.known.borrow_mut();
        if !known.contains(&key) {
            known.push(key);
        }
    }

    /// All entries in the order of the file, for tables whose keys are names.
    pub(super) fn entries(&self) -> Vec<(&'d str, usize, Value<'d>)> {
        let value = |name: &str, item| Value { document: self.document, name: name.to_owned(), item };
        let mut all: Vec<_> =
            self.entries.iter().map(|(key, item)| (&**key.get_ref(), key.span().start, item)).collect();
        all.sort_by_key(|&(_, start, _)| start);
        all.into_iter().map(|(name, start, item)| (name, start, value(name, item))).collect()
    }

    /// Refuses keys that were never asked for.
    pub(super) fn finish(&self) -> Result<(), SceneError> {
        let known = self.known.borrow();
        let stray = self.entries.keys().filter(|key| !known.contains(&&**key.get_ref()));
        match stray.min_by_key(|key| key.span().start) {
            None => Ok(()),
            Some(key) => {
                let (name, known) = (key.get_ref(), quoted(known.iter().copied()));
                let text = format!("unknown key \"{name}\" in {}; known are {known}", self.name);
                Err(self.document.error(key.span().start, text))
            }
        }
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// An error at the table's beginning.
    pub(super) fn error(&self, message: impl Into<String>) -> SceneError {
        self.document.error(self.start, message)
    }
}

/// A value of the document with the key it belongs to.
pub(super) struct Value<'d> {
    document: Document<'d>,
    pub(super) name: String,
    item: &'d Spanned<DeValue<'d>>,
}

impl<'d> Value<'d> {
    pub(super) fn document(&self) -> Document<'d> {
        self.document
    }

    /// An error at this value.
    pub(super) fn error(&self, message: impl Into<String>) -> SceneError {
        self.document.error(self.item.span().start, message)
    }

    fn wrong(&self, wanted: &str) -> SceneError {
        let found = match self.item.get_ref() {
            DeValue::String(text) => format!("\"{text}\""),
            DeValue::Integer(integer) => integer.to_string(),
            DeValue::Float(float) => float.to_string(),
            DeValue::Boolean(boolean) => boolean.to_string(),
            DeValue::Datetime(_) => "a date".to_owned(),
            DeValue::Array(array) => format!("an array of {}", array.len()),
            DeValue::Table(_) => "a table".to_owned(),
        };
        self.error(format!("\"{}\" must be {wanted}, not {found}", self.name))
    }

    pub(super) fn string(&self) -> Result<&'d str, SceneError> {
        match self.item.get_ref() {
            DeValue::String(text) => Ok(text),
            _ => Err(self.wrong("a string")),
        }
    }

    pub(super) fn boolean(&self) -> Result<bool, SceneError> {
        self.item.get_ref().as_bool().ok_or_else(|| self.wrong("true or false"))
    }

    pub(super) fn integer(&self, range: RangeInclusive<u64>) -> Result<u64, SceneError> {
        let parsed = match self.item.get_ref() {
            DeValue::Integer(integer) => u64::from_str_radix(integer.as_str(), integer.radix()).ok(),
            _ => None,
        };
        let wanted = || format!("a whole number from {} to {}", range.start(), range.end());
        parsed.filter(|value| range.contains(value)).ok_or_else(|| self.wrong(&wanted()))
    }

    /// A number of any spelling, in a range; never NaN.
    pub(super) fn number(&self, range: RangeInclusive<f64>) -> Result<f64, SceneError> {
        let parsed = match self.item.get_ref() {
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
            DeValue::Integer(integer) => {
                u64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|value| value as f64)
            }
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            _ => None,
        };
        let wanted = || match (*range.start(), *range.end()) {
            (f64::MIN, f64::MAX) => "a finite number".to_owned(),
            (least, most) => format!("a number from {least} to {most}"),
        };
        parsed.filter(|value| range.contains(value)).ok_or_else(|| self.wrong(&wanted()))
    }

    /// A colour: three numbers, or one for all channels.
    pub(super) fn rgb(&self, range: RangeInclusive<f64>) -> Result<Rgb<f32>, SceneError> {
        self.rgb_f64(range).map(|color| color.map(|x| x as f32))
    }

    /// A colour as it is written.
    pub(super) fn rgb_f64(&self, range: RangeInclusive<f64>) -> Result<Rgb<f64>, SceneError> {
        if let DeValue::Integer(_) | DeValue::Float(_) = self.item.get_ref() {
            return self.number(range).map(Rgb::splat);
        }
        self.numbers(range).map(|numbers: [f64; 3]| Rgb::from(numbers))
    }

    /// A point or vector.
    pub(super) fn vector(&self) -> Result<DVec3, SceneError> {
        self.numbers(-1e12..=1e12).map(DVec3::from_array)
    }

    /// Exactly `N` numbers.
    pub(super) fn numbers<const N: usize>(&self, range: RangeInclusive<f64>) -> Result<[f64; N], SceneError> {
        let items = self.array()?;
        if items.len() != N {
            return Err(self.wrong(&format!("{N} numbers")));
        }
        let mut numbers = [0.0; N];
        for (number, item) in numbers.iter_mut().zip(items) {
            *number = item.number(range.clone())?;
        }
        Ok(numbers)
    }

    pub(super) fn array(&self) -> Result<Vec<Value<'d>>, SceneError> {
        let DeValue::Array(items) = self.item.get_ref() else { return Err(self.wrong("an array")) };
        let value = |item| Value { document: self.document, name: self.name.clone(), item };
        Ok(items.iter().map(value).collect())
    }

    /// The value as a table, called `name` in messages.
    pub(super) fn table(&self, name: &str) -> Result<Table<'d>, SceneError> {
        match self.item.get_ref() {
            DeValue::Table(entries) => Ok(Table::new(self.document, name, self.item.span().start, entries)),
            _ => Err(self.wrong("a table")),
        }
    }

    pub(super) fn is_table(&self) -> bool {
        self.item.get_ref().is_table()
    }
}
