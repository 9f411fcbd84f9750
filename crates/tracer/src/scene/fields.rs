//! Fields: the named values from which a part of a scene is made, whatever file they stand in.
//!
//! A part names each of its keys once, beside what it means by them: `fields.vector("position")?`. A reader of files implements
//! [`Fields`] and says where in the file a value is refused; it also refuses the keys that no part has asked for.

use glam::DVec3;
use gonio_kernel::Rgb;
use std::error::Error;
use std::ops::RangeInclusive;

/// Why a field is refused; the reader's own error, with its place in the file.
pub type Refusal = Box<dyn Error + Send + Sync>;

/// Named values. Asking for a key makes it known, whether it is there or not.
pub trait Fields {
    /// A number in a range.
    ///
    /// # Errors
    /// If it is no number, or out of range.
    fn number(&mut self, key: &'static str, range: RangeInclusive<f64>) -> Result<Option<f64>, Refusal>;

    /// A whole number in a range.
    ///
    /// # Errors
    /// If it is no whole number, or out of range.
    fn integer(&mut self, key: &'static str, range: RangeInclusive<u64>) -> Result<Option<u64>, Refusal>;

    /// True or false.
    ///
    /// # Errors
    /// If it is neither.
    fn boolean(&mut self, key: &'static str) -> Result<Option<bool>, Refusal>;

    /// A colour, each channel in a range; or one number for all three.
    ///
    /// # Errors
    /// If it is no colour, or out of range.
    fn color(&mut self, key: &'static str, range: RangeInclusive<f64>) -> Result<Option<Rgb<f32>>, Refusal>;

    /// Three finite numbers.
    ///
    /// # Errors
    /// If it is anything else.
    fn vector(&mut self, key: &'static str) -> Result<Option<DVec3>, Refusal>;

    /// A refusal of what stands at a key, or of the whole if there is nothing.
    fn refuse(&self, key: &'static str, why: String) -> Refusal;

    /// A vector that must be there.
    ///
    /// # Errors
    /// As [`Fields::vector`], or if it is not there.
    fn required_vector(&mut self, key: &'static str) -> Result<DVec3, Refusal> {
        self.vector(key)?.ok_or_else(|| self.refuse(key, format!("needs \"{key}\"")))
    }

    /// A colour that must be there.
    ///
    /// # Errors
    /// As [`Fields::color`], or if it is not there.
    fn required_color(&mut self, key: &'static str, range: RangeInclusive<f64>) -> Result<Rgb<f32>, Refusal> {
        self.color(key, range)?.ok_or_else(|| self.refuse(key, format!("needs \"{key}\"")))
    }
}
