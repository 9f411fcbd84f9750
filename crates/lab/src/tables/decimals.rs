//! Coefficients as they are written.

/// A coefficient to eight decimals: far finer than the fit, and coarse enough that no machine's last bit shows.
pub(super) fn number(x: f64) -> String {
    format!("{x:.8}")
}

/// A coefficient as it is read again.
pub(super) fn rounded(x: f64) -> f64 {
    number(x).parse().unwrap_or(x)
}
