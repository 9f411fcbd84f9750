#![doc = include_str!("../README.md")]
//!
//! # The way of the data
//!
//! The modules, in the order in which data flows through them:
//!
//! [`scene`] (plain data) → [`world`] (placed and recentred, with its lights and the [`effects`] that it calls for) → a
//! [`Backend`] casts its rays → [`render`] runs passes over the film, whose tiles drive queues of path states through the
//! stages generate, closest hit, sort, shade and shadow → the film adds samples as integers → a [`Picture`].
#![forbid(unsafe_code)]

// docs.rs sets no flags of ours: documentation is no program.
#[cfg(all(target_arch = "x86_64", not(all(target_feature = "avx2", target_feature = "fma")), not(docsrs)))]
compile_error!(
    "gonio-tracer needs AVX2 and FMA on x86-64: build inside the repository, whose .cargo/config.toml sets them, \
     or with RUSTFLAGS=\"-C target-cpu=x86-64-v3\""
);

mod alias;
mod backend;
mod bsdf;
mod camera;
pub mod effects;
mod error;
mod film;
mod fingerprint;
mod integrator;
mod layers;
pub mod light;
mod material;
pub mod normal_map;
mod picture;
mod point;
mod prepared;
mod queue;
mod render;
mod sampler;
pub mod scene;
mod shade;
mod sides;
mod stats;
mod surface_point;
pub mod texture;
pub mod world;

pub use backend::{Backend, BackendError};
pub use bsdf::{BatchBsdf, CustomLobe, Scattered};
pub use camera::View;
pub use effects::{Effect, EffectSet, SceneEffects};
pub use error::WorldError;
pub use film::{Crop, Rendering};
pub use layers::Layers;
pub use light::{SHORT_OF_LIGHT, Techniques};
pub use material::{MOST_COATS, MOST_LOBES, MaterialSurface, constant_surface};
pub use picture::Picture;
pub use prepared::Prepared;
pub use render::{Pass, Progress, RenderSettings, render};
pub use stats::{LargeSample, RenderStats};
pub use surface_point::SurfacePoint;
pub use world::World;
