//! The picture: what a rendering ends in, and what an environment map begins with.

/// A picture in linear Rec. 709, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels per row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Radiance, `width * height` entries.
    pub rgb: Vec<[f32; 3]>,
}
