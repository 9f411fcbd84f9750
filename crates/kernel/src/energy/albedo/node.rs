//! The shape of the generated coefficients of [`super::AlbedoCurve`].

/// How many nodes, and coefficients of a curve.
pub const NODES: usize = 12;
/// How many polynomials of α describe what is the same for every index.
pub const IN_ALPHA: usize = 10;
/// How many polynomials of α describe what differs.
pub const IN_ALPHA_ETA: usize = 8;
/// How many functions of the index: [`super::eta_basis`].
pub const IN_ETA: usize = 6;

/// The fits of one node, polynomials of the eighth root of α in T_i(2w − 1).
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// x of the node, in (−1, 1).
    pub x: f64,
    /// (1 − E_white) over [`super::missing_factor`].
    pub missing: [f64; IN_ALPHA],
    /// q of (1 − c)⁵.
    pub schlick: [f64; IN_ALPHA],
    /// q of dielectrics, to be summed over [`super::eta_basis`].
    pub dielectric: [[f64; IN_ALPHA_ETA]; IN_ETA],
    /// 2∫ℓ(µ) µ dµ of the polynomial that is 1 at this node and 0 at the others.
    pub weight: [f64; IN_ALPHA],
}
