//! What a search for any hit comes to.

/// What a search below a node or block comes to, given that the ray enters its box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Odds {
    /// The chance of a hit.
    pub(super) hit: f32,
    /// The expected cost.
    pub(super) cost: f32,
}
