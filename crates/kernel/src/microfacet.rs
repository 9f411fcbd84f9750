//! Microfacet distributions: how the normals of a rough surface are spread, and which of them are seen.

mod ggx;

pub use ggx::Ggx;
