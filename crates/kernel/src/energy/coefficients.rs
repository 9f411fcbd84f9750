//! What the approximation of the loss is made of.

/// How many Chebyshev polynomials of v.
pub const V: usize = 10;
/// How many Chebyshev polynomials of w.
pub const W: usize = 8;
/// How many Chebyshev polynomials of √α the mean takes.
pub const MEAN: usize = 14;

/// Coefficients of the approximation of 1 − E and 1 − E_avg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table {
    /// ln P: of T_i(2v − 1) T_j(2w − 1).
    pub missing: [[f64; W]; V],
    /// Q: of T_k(2√α − 1).
    pub missing_avg: [f64; MEAN],
}
