//! How numbers are written: short in tables, shorter on axes.

/// A number in a few characters: integers as they are, others with three digits.
pub fn short(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 {
        "0".to_owned()
    } else if size < 1e6 && x.fract() == 0.0 {
        format!("{x:.0}")
    } else if (0.01..1000.0).contains(&size) {
        format!(
            "{:.*}",
            if size >= 100.0 {
                1
            } else if size >= 1.0 {
                2
            } else {
                4
            },
            x
        )
    } else if size >= 1e300 {
        "∞".to_owned() // the reports' stand-in for it
    } else {
        format!("{x:.1e}")
    }
}

/// The label of a tick: a number as short as it can be said.
pub fn tick(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e4).contains(&value.abs()) {
        return format!("{value:.0e}").replace('-', "−");
    }
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.replace('-', "−") }
}

/// A range as its two ends, or what is said where there is none.
pub fn range(ends: Option<[f64; 2]>, without: &str) -> String {
    ends.map_or_else(|| without.to_owned(), |[lo, hi]| format!("{lo:.1e} to {hi:.1e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (x, text) in
            [(0.0, "0"), (12.0, "12"), (0.25, "0.2500"), (3.456, "3.46"), (1.5e-7, "1.5e-7"), (f64::MAX, "∞")]
        {
            assert_eq!(short(x), text);
        }
    }

    #[test]
    fn ticks_are_shorter() {
        for (x, text) in [(0.0, "0"), (0.25, "0.25"), (-2.0, "−2"), (1e-4, "1e−4"), (20_000.0, "2e4"), (-1e-9, "−1e−9")]
        {
            assert_eq!(tick(x), text);
        }
        assert_eq!(range(Some([1e-3, 2.0]), "nowhere"), "1.0e-3 to 2.0e0");
        assert_eq!(range(None, "nowhere"), "nowhere");
    }
}
