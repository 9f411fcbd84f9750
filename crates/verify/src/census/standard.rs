//! What is required of a backend: how closely its answers are compared with those of brute, the oracle.

use gonio_accel::Intersect;
use gonio_tracer::Backend;
use serde::Serialize;

/// The oracle's name.
pub(crate) const ORACLE: &str = "brute";

/// How a backend is compared with the oracle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Standard {
    /// Every bit.
    Exact,
    /// Hit or miss, and the triangle or the distance within 1e-5 of distance and size. A few exceptions are allowed.
    Close,
    /// As close, but nothing is required.
    Reported,
}

impl Standard {
    /// What is required of a backend. A fast test promises nothing at edges.
    pub fn of(backend: Backend, intersect: Intersect) -> Self {
        match intersect {
            Intersect::Fast if backend != Backend::Brute => Self::Reported,
            _ if backend.is_exact() => Self::Exact,
            _ => Self::Close,
        }
    }
}
