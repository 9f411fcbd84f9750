//! The path tracer of Gonio: a scene in memory in, a picture in memory out. Files belong to the crate `gonio-io`.
//!
//! The modules, in the order in which data flows through them:
//!
//! [`scene`] (plain data) → [`world`] (placed and recentred, with its lights and the [`effects`] that it calls for) → a
//! [`Backend`] casts its rays → [`render`] runs passes over the film, whose tiles drive queues of path states through the
//! stages generate, closest hit, sort, shade and shadow → the film adds samples as integers → a [`Picture`].
//!
//! A square under a white sky, seen from the front:
//!
//! ```
//! use std::ops::ControlFlow;
//!
//! use glam::{DAffine3, DVec3};
//! use gonio_accel::Intersect;
//! use gonio_kernel::{Rgb, lobe::Lambert};
//! use gonio_tracer::scene::{
//!     CameraSpec, Environment, FilmSettings, Instance, IntegratorSettings, LobeSpec, Material, Mesh, Scene,
//! };
//! use gonio_tracer::{Backend, Prepared, RenderSettings, World, render};
//!
//! let square = Mesh {
//!     name: "square".to_owned(),
//!     positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
//!     triangles: vec![[0, 1, 2], [0, 2, 3]],
//!     materials: vec![0, 0],
//!     ..Mesh::default()
//! };
//! let front = CameraSpec { origin: Some(DVec3::new(0.0, 0.0, 5.0)), ..CameraSpec::default() };
//! let scene = Scene {
//!     film: FilmSettings { width: 8, height: 8, spp: 16, exposure: 0.0 },
//!     camera: front.complete([DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)], 1.0)?,
//!     integrator: IntegratorSettings::default(),
//!     materials: vec![Material::new("grey", vec![LobeSpec::new(Lambert::new(Rgb::splat(0.5)))])],
//!     textures: Vec::new(),
//!     normal_maps: Vec::new(),
//!     meshes: vec![square],
//!     instances: vec![Instance { name: "square".to_owned(), mesh: 0, transform: DAffine3::IDENTITY }],
//!     environment: Environment::constant(Rgb::splat(1.0)),
//!     lights: Vec::new(),
//!     warnings: Vec::new(),
//! };
//! let prepared = Prepared::new(World::new(&scene)?, Backend::Obvhs, Intersect::Robust)?;
//! let rendering = render(&prepared, &RenderSettings::of(&scene), &mut |_| ControlFlow::Continue(()));
//! // In the middle half of the light comes back, at the edge the sky is seen.
//! assert!((rendering.picture.rgb[4 * 8 + 4][0] - 0.5).abs() < 1e-5);
//! assert_eq!(rendering.picture.rgb[0][0], 1.0);
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

/// Runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
