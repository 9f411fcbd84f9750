//! Arguments: how they are read, and what is said when they cannot be.

use gonio_lab::random::bits;
use indicatif::ProgressBar;
use std::fmt;
use std::io::{IsTerminal, stderr};
use std::str::FromStr;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Wrong usage that only shows when the input is known (a crop outside of the picture): exit code 2, not 1.
#[derive(Debug)]
pub(crate) struct Usage(pub(crate) String);

impl fmt::Display for Usage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Usage {}

/// Prints a warning to standard error.
pub(crate) fn warn(sentence: &str) {
    eprintln!("warning: {sentence}");
}

/// A sign of life on a terminal; nothing elsewhere.
pub(crate) fn spinner(message: &'static str) -> Option<ProgressBar> {
    stderr().is_terminal().then(|| {
        let spinner = ProgressBar::new_spinner();
        spinner.enable_steady_tick(Duration::from_millis(200));
        spinner.set_message(message);
        spinner
    })
}

/// Reads exactly `N` values between separators.
pub(crate) fn several<T: FromStr, const N: usize>(text: &str, separator: char) -> Option<[T; N]> {
    let values: Vec<T> = text.split(separator).map(|part| part.trim().parse().ok()).collect::<Option<_>>()?;
    values.try_into().ok()
}

/// Reads a direction `x,y,z`. Any numbers will do: what is not a unit vector is outside of the kernel's domain, not an
/// error of spelling.
pub(crate) fn direction(text: &str) -> Result<[f64; 3], String> {
    several(text, ',').ok_or_else(|| "a direction is three numbers: x,y,z".to_owned())
}

/// Reads a number of samples, also as `1e6`.
pub(crate) fn count(text: &str) -> Result<u64, String> {
    let plain = text.parse::<u64>().ok();
    // Up to 2⁵³ an f64 holds every integer.
    let scientific =
        text.parse::<f64>().ok().filter(|x| x.fract() == 0.0 && (1.0..=9_007_199_254_740_992.0).contains(x));
    plain
        .filter(|&n| n > 0)
        .or(scientific.map(|x| x as u64))
        .ok_or_else(|| "a number of samples is an integer, at least 1".to_owned())
}

/// Reads a seed: a number, or "random" for one that nobody chose, from the clock and the process.
pub(crate) fn seed(text: &str) -> Result<u64, String> {
    if text == "random" {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_nanos() as u64);
        // Short enough to be typed again.
        return Ok(bits(now, u64::from(std::process::id()), 0) >> 32);
    }
    text.parse().map_err(|_| "a seed is a number from 0 to 2^64 - 1, or \"random\"".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_may_be_written_as_powers_of_ten() {
        assert_eq!(count("1e6"), Ok(1_000_000));
        assert_eq!(count("17"), Ok(17));
        for wrong in ["0", "-1", "1.5", "nan", "inf", ""] {
            assert!(count(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn several_values_must_be_exactly_as_many() {
        assert_eq!(several::<u32, 2>("3x4", 'x'), Some([3, 4]));
        assert_eq!(several::<u32, 2>("3x4x5", 'x'), None);
        assert_eq!(direction("0, 0.6,0.8"), Ok([0.0, 0.6, 0.8]));
        assert!(direction("0,1").is_err());
    }
}
