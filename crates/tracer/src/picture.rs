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
    /// The share of each pixel in which the camera sees a surface, in [0, 1]; none if nobody knows. The radiance is that of the
    /// whole pixel, what is seen of the environment included, so it is premultiplied only where the environment is hidden from
    /// the camera.
    pub alpha: Option<Vec<f32>>,
}
