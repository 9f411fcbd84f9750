//! The choice of a ray-casting backend.

use crate::scene::{Loading, Stage};
#[cfg(feature = "embree")]
use gonio_accel::Embree;
use gonio_accel::{Accel, Brute, Geometry, Intersect, Obvhs, ObvhsOptions};
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// A ray-casting backend. All find the same hits: `Brute` and `Obvhs` to the last bit, Embree up to rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// Every ray against every triangle: the oracle.
    Brute,
    /// A tree built by the `obvhs` crate.
    Obvhs,
    /// Intel's library Embree 4.
    #[cfg(feature = "embree")]
    Embree,
}

/// Why a backend could not be built.
#[derive(Debug, Error)]
#[error("the backend {backend} cannot be built")]
pub struct BackendError {
    /// Which backend.
    pub backend: Backend,
    /// What it said.
    pub source: Box<dyn std::error::Error + Send + Sync>,
}

impl Backend {
    /// All backends of this build.
    pub const ALL: [Self; 2 + cfg!(feature = "embree") as usize] = [
        Self::Brute,
        Self::Obvhs,
        #[cfg(feature = "embree")]
        Self::Embree,
    ];

    /// Whether its robust hits are those of `Brute` to the last bit, so that pictures have the same hash. The others agree up
    /// to rounding, so that isolated pixels differ.
    pub fn is_exact(self) -> bool {
        match self {
            Self::Brute | Self::Obvhs => true,
            #[cfg(feature = "embree")]
            Self::Embree => false,
        }
    }

    /// Builds the backend's structure over a geometry. `Brute` is robust whatever is asked for.
    ///
    /// # Errors
    /// If the backend lacks something that it needs, such as memory or its library.
    pub fn build(self, geometry: &Geometry, intersect: Intersect) -> Result<Box<dyn Accel>, BackendError> {
        self.build_with(geometry, intersect, &mut |_| ())
    }

    /// Like [`Backend::build`]; `progress` is told of how many triangles it is done, by those backends that know.
    ///
    /// # Errors
    /// If the backend lacks something that it needs, such as memory or its library.
    pub fn build_with(
        self,
        geometry: &Geometry,
        intersect: Intersect,
        progress: &mut dyn FnMut(Loading),
    ) -> Result<Box<dyn Accel>, BackendError> {
        let of = geometry.triangle_count() as u64;
        let mut tell = |done: usize| progress(Loading { stage: Stage::Building, done: done as u64, of });
        tell(0);
        Ok(match self {
            Self::Brute => Box::new(Brute::new(geometry)),
            Self::Obvhs => Box::new(Obvhs::with(geometry, ObvhsOptions { intersect, ..Default::default() }, &mut tell)),
            #[cfg(feature = "embree")]
            Self::Embree => {
                let built = Embree::new(geometry, intersect);
                Box::new(built.map_err(|error| BackendError { backend: self, source: error.into() })?)
            }
        })
    }
}

impl fmt::Display for Backend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Brute => "brute",
            Self::Obvhs => "obvhs",
            #[cfg(feature = "embree")]
            Self::Embree => "embree",
        })
    }
}

impl FromStr for Backend {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|b| b.to_string() == name).ok_or_else(|| {
            if name == "embree" {
                return "this build has no Embree: run `cargo xtask embree`, then build with `--features embree`"
                    .to_owned();
            }
            let known: Vec<_> = Self::ALL.iter().map(|b| format!("\"{b}\"")).collect();
            format!("there is no backend \"{name}\"; there are {}", known.join(", "))
        })
    }
}
