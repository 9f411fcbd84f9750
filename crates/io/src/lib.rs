//! The files of Gonio: scenes in, pictures in and out.
//!
//! This crate knows formats and nothing else: what it reads becomes the plain data of [`gonio_tracer::scene`], and what it
//! writes is a [`gonio_tracer::Picture`] that somebody else rendered.
//!
//! | files | here |
//! |---|---|
//! | scene files (TOML), OBJ and MTL | [`load`], [`load_with`], [`scene_from_toml_str`] |
//! | material files (TOML) | [`material_from_toml_str`] |
//! | images on surfaces (PNG, JPEG) | [`bitmap`] |
//! | pictures of radiance (Radiance, OpenEXR) | [`hdr`] |
//! | rendered pictures with their layers | [`exr`], [`png`], [`read_picture`] |
//!
//! ```no_run
//! let scene = gonio_io::load("scenes/cornell-box.toml".as_ref())?;
//! println!("{} meshes", scene.meshes.len());
//! # Ok::<(), gonio_io::SceneError>(())
//! ```
#![forbid(unsafe_code)]

pub mod bitmap;
mod encoded;
mod error;
pub mod exr;
pub mod hdr;
mod mtl;
mod obj;
mod paths;
mod picture;
pub mod png;
mod scene;
mod textures;
pub mod whole_file;

pub use error::{ImageError, SceneError};
pub use picture::read_picture;
pub use scene::{load, load_with, material_from_toml_str, scene_from_toml_str};

/// Runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
