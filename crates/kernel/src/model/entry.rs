//! What a declaration says: the parameters of a model, line by line.

use super::quantity::Quantity;

/// A number or a colour of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Parameter {
    /// Its key in material files.
    pub key: &'static str,
    /// Three numbers, red, green and blue; one number stands for three equal ones.
    pub is_color: bool,
    /// Its domain and meaning.
    pub quantity: Quantity,
    /// What it is if it is not given; none if it must be.
    pub default: Option<f64>,
    /// What it says, in one sentence.
    pub doc: &'static str,
}

impl Parameter {
    #[doc(hidden)]
    pub const fn declared(
        key: &'static str,
        is_color: bool,
        quantity: Quantity,
        default: Option<f64>,
        doc: &'static str,
    ) -> Self {
        Self { key, is_color, quantity, default, doc }
    }
}

/// One of a few words.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Words {
    /// Its key in material files.
    pub key: &'static str,
    /// Each choice: its word, and other spellings, which are read with a warning.
    pub words: &'static [&'static [&'static str]],
    /// Which one it is if it is not given; none if it must be.
    pub default: Option<usize>,
    /// What it decides, in one sentence.
    pub doc: &'static str,
}

impl Words {
    #[doc(hidden)]
    pub const fn declared(
        key: &'static str,
        words: &'static [&'static [&'static str]],
        default: Option<usize>,
        doc: &'static str,
    ) -> Self {
        Self { key, words, default, doc }
    }
    /// The word of each choice.
    pub fn each(&self) -> impl Iterator<Item = &'static str> {
        self.words.iter().filter_map(|spellings| spellings.first().copied())
    }
    /// Which choice a word is, in any spelling.
    pub fn find(&self, word: &str) -> Option<usize> {
        self.words.iter().position(|spellings| spellings.contains(&word))
    }
}

/// A line of a model's table.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Entry {
    /// A number or a colour: takes a texture.
    Parameter(Parameter),
    /// One of a few words: takes none.
    Choice(Words),
    /// The lines of a group.
    Group(&'static [Entry]),
    /// One of several sets of parameters; a set without any is the default.
    OneOf {
        /// What they say.
        doc: &'static str,
        /// The sets.
        ways: &'static [&'static [Entry]],
    },
}

/// Calls `visit` with every key of a table, in order; a key that stands in several ways comes several times.
pub fn each_key(entries: &'static [Entry], visit: &mut dyn FnMut(&'static str)) {
    for entry in entries {
        match entry {
            Entry::Parameter(p) => visit(p.key),
            Entry::Choice(words) => visit(words.key),
            Entry::Group(entries) => each_key(entries, visit),
            Entry::OneOf { ways, .. } => ways.iter().for_each(|way| each_key(way, visit)),
        }
    }
}

/// A model's name, its sentence and its table.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ModelInfo {
    /// Its `type` in material files.
    pub name: &'static str,
    /// What it models.
    pub doc: &'static str,
    /// Its parameters.
    pub entries: &'static [Entry],
}

impl ModelInfo {
    #[doc(hidden)]
    pub const fn declared(name: &'static str, doc: &'static str, entries: &'static [Entry]) -> Self {
        Self { name, doc, entries }
    }
}
