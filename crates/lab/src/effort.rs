//! `Effort`: how thorough a run is.

use serde::Serialize;

/// How thorough a run is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Effort {
    /// A minute or two: every instrument and row, small samples.
    Quick,
    /// Up to twelve times the samples, where samples are what finds faults.
    Standard,
    /// As many samples as find a density that is off by 2 % over 5 % of the directions, in each view, fifty million pairs per
    /// model, every bit pattern of elementary functions; most of an hour.
    Full,
}

impl Effort {
    /// Its name, as reports have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Standard => "standard",
            Self::Full => "full",
        }
    }
}
