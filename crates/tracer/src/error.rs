//! What cannot be rendered.

use gonio_accel::GeometryError;
use gonio_kernel::surface::SurfaceError;
use thiserror::Error;

/// Why a scene cannot be made ready.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum WorldError {
    /// The lobes of a material do not fit into a surface.
    #[error("material \"{material}\": {why}")]
    Lobes {
        /// The material's name.
        material: String,
        /// What does not fit.
        why: SurfaceError,
    },
    /// A light cannot be sampled.
    #[error("light {number}: {why}")]
    Light {
        /// Which one, from 1.
        number: usize,
        /// What is wrong with it.
        why: String,
    },
    /// Rays cannot be cast at what is placed: too many triangles, or positions that overflow `f32`.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
}
