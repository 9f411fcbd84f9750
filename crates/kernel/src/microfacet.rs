//! Microfacet distributions: how the normals of a rough surface are spread, and which of them are seen.

mod beckmann;
mod ggx;

pub use beckmann::Beckmann;
pub use ggx::Ggx;
