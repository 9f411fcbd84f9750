//! The kernel's arithmetics by their names, and how their numbers are printed.

use clap::ValueEnum;

/// Which arithmetic answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Precision {
    /// Scalar, single precision
    F32,
    /// Scalar, double precision
    F64,
    /// Eight at a time, single precision: equal to f32 bit for bit
    Lanes,
}

impl Precision {
    /// The shortest decimal that reads back as the same number in this arithmetic.
    pub(super) fn print(self, x: f64) -> String {
        match self {
            Self::F64 => format!("{x:?}"),
            Self::F32 | Self::Lanes => format!("{:?}", x as f32), // exact: it was an f32
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
            Self::Lanes => "lanes",
        }
    }
}
