//! What can go wrong before there is anything to measure.

use gonio_accel::GeometryError;
use gonio_io::{ImageError, SceneError};
use gonio_tracer::scene::BuildError;
use gonio_tracer::{BackendError, WorldError};
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why something could not be measured.
#[derive(Debug, Error)]
pub enum Error {
    /// A scale takes what is cast at beyond what rays can reach.
    #[error("{name} at scale {scale}")]
    Scale {
        /// What was cast at.
        name: String,
        /// The factor on all lengths.
        scale: f64,
        /// Why it cannot be.
        source: GeometryError,
    },
    /// A backend could not be built.
    #[error(transparent)]
    Backend(Box<dyn std::error::Error + Send + Sync>),
    /// A scene could not be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A scene that is built in code is not sound.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A scene could not be placed.
    #[error("scene: {0}")]
    World(#[from] WorldError),
    /// A picture could not be written.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A file or folder could not be used.
    #[error("{}: cannot be {what}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// "made", "written" or "read".
        what: &'static str,
        /// What the system said.
        source: io::Error,
    },
}

impl From<BackendError> for Error {
    fn from(error: BackendError) -> Self {
        Self::Backend(error.into())
    }
}

impl Error {
    /// What the system said about a file.
    pub(crate) fn file(path: &Path, what: &'static str) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::File { path: path.to_owned(), what, source }
    }
}
