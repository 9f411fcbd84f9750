//! OpenEXR files: a picture with everything needed to render it again.
//!
//! An EXR file has one part, whose channels are `R`, `G`, `B`, `A` if it is known, and, with [`Layers`](gonio_tracer::Layers), `albedo.R` … `sampleCount`: dotted names
//! are how compositors find layers. Channels are f32, `sampleCount` is u32. A crop's data window lies where the crop lies in
//! the display window of the whole picture.

mod decode;
mod encode;

pub use decode::read;
pub use encode::{encode, write};

/// (x, y) of the primaries and the white of Rec. 709.
pub(crate) const REC_709: [[f32; 2]; 4] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], [0.3127, 0.3290]];

/// How a picture came about; stored as EXR attributes of these names with `gonio_` before them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Metadata {
    /// Version of the renderer; the standard attribute `software` says `gonio` and this.
    pub version: String,
    /// Seed of all random numbers; stored as text, because EXR integers have 32 bits.
    pub seed: u64,
    /// Samples per pixel.
    pub spp: u32,
    /// Scattering events after which a path ends.
    pub max_depth: u32,
    /// Ray-casting backend.
    pub backend: String,
    /// Number of paths; stored as text.
    pub samples: u64,
    /// Seconds spent reading the scene.
    pub load_seconds: f64,
    /// Seconds spent building the acceleration structure.
    pub build_seconds: f64,
    /// Seconds spent rendering.
    pub render_seconds: f64,
    /// Hash of the film's integers, in hexadecimal.
    pub film_hash: String,
    /// Where a crop's upper left pixel lies in the whole picture, and the size of that; `None` if the picture is whole.
    pub window: Option<Window>,
    /// The standard attributes `worldToCamera` and `worldToNDC`, see [`Camera::matrices`](gonio_tracer::scene::Camera::matrices).
    pub matrices: Option<[[f32; 16]; 2]>,
    /// Further attributes: name and text.
    pub other: Vec<(String, String)>,
}

/// A picture's place in a larger one, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Column and row of its upper left pixel.
    pub at: [u32; 2],
    /// Size of the larger one.
    pub of: [u32; 2],
}

#[cfg(test)]
mod tests;
