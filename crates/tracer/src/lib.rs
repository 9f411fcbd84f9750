//! The path tracer of Gonio: scene in, image out.
//!
//! The modules, in the order in which data flows through them:
//!
//! [`scene`] (files to plain data) → [`world`] (placed, recentred, with [`Plan`] and lights) → a [`Backend`] casts its rays
//! → [`render`] drives queues of path states through generate, closest hit, sort, shade and shadow stages → the film adds
//! samples as integers → [`image`] writes the picture.
//!
//! ```no_run
//! use std::ops::ControlFlow;
//!
//! use gonio_accel::Intersect;
//! use gonio_tracer::{Backend, RenderSettings, World, render, scene::Scene};
//!
//! let scene = Scene::load("scenes/cornell-box.toml".as_ref())?;
//! let world = World::new(&scene)?;
//! let accel = Backend::Obvhs.build(world.geometry(), Intersect::Robust)?;
//! let rendering = render(&world, &*accel, &RenderSettings::of(&scene, &world), &mut |_| ControlFlow::Continue(()));
//! println!("{}", rendering.stats.film_hash);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

// docs.rs sets no flags of ours: documentation is no program.
#[cfg(all(target_arch = "x86_64", not(all(target_feature = "avx2", target_feature = "fma")), not(docsrs)))]
compile_error!(
    "gonio-tracer needs AVX2 and FMA on x86-64: build inside the repository, whose .cargo/config.toml sets them, \
     or with RUSTFLAGS=\"-C target-cpu=x86-64-v3\""
);

mod alias;
mod backend;
mod environment;
mod film;
mod fingerprint;
pub mod hdr;
pub mod image;
mod layers;
mod light;
mod material;
pub mod normal_map;
mod plan;
mod point;
mod queue;
mod render;
mod sampler;
pub mod scene;
mod shade;
mod stats;
pub mod texture;
pub mod whole_file;
pub mod world;

pub use backend::{Backend, BackendError};
pub use layers::Layers;
pub use light::Techniques;
pub use material::{BatchBsdf, CustomLobe, MaterialSurface, Scattered, constant_surface};
pub use plan::Plan;
pub use point::SurfacePoint;
pub use render::{Crop, Pass, Progress, RenderSettings, Rendering, render};
pub use shade::SHORT_OF_LIGHT;
pub use stats::{LargeSample, RenderStats};
pub use world::{View, World};

/// Runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
