//! A place from which no ray can escape. [`super::inside`] finds such places, [`super::dice`] casts from them.

use gonio_kernel::Vec3;

/// A ball inside of a closed surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    pub(crate) centre: Vec3<f32>,
    pub(crate) radius: f32,
    /// The line through the centre along this axis meets a vertex or an edge exactly.
    pub(crate) axis: usize,
}
