//! The reflectance kernel of Gonio: what light does at a surface point, written once for `f32`, `f64` and eight lanes.
//!
//! The nouns, in the order in which a shading call meets them:
//!
//! - [`Real`] is a number: `f32`, `f64` or [`F32x8`] (eight `f32` side by side). Everything below is generic over it,
//!   and lane *i* of a lane result equals the `f32` result bit for bit.
//! - [`Vec3`], [`Rgb`] and [`Frame`] carry directions, colours and the change to the local frame, in which the shading
//!   normal is `z`, the tangent `x` and the bitangent `y`.
//! - A [`Lobe`] is whatever scatters: it evaluates `f_cos` and `pdf`, samples `wi`, and weighs delta events. The models of the kernel
//!   are lobes ([`lobe::Lambert`], [`lobe::Conductor`], …), and so are their combinations: [`lobe::Mix`], [`lobe::Layer`],
//!   [`Surface`]. A user's own type can be one.
//! - A [`Model`] is a lobe whose parameters are declared once ([`mod@model`]): keys in files, domains, defaults, an `f64` twin, lanes.
//! - A [`Surface`] is a list of lobes, mixed and layered, whose number is known at run time only.
//! - A [`Closure`] is a lobe seen from `wo`, and the only guard against input outside the domain.
//!
//! Directions are unit vectors that point away from the surface. `wo` (towards the viewer) comes first, random numbers
//! `u` come last. There is no std, no allocation, no panic and no unsafe code in this crate.
//!
//! ```
//! use gonio_kernel::{Closure, Rgb, Vec3, lobe::Lambert};
//!
//! let chalk = Lambert::new(Rgb::new(0.8_f32, 0.5, 0.2));
//! let closure = Closure::new(chalk, Vec3::new(0.0, 0.0, 1.0));
//! let sample = closure.sample([0.3, 0.6, 0.1]);
//! assert!((sample.weight.g - 0.5).abs() < 1e-6);
//! assert_eq!(sample.pdf, closure.eval(sample.wi).pdf);
//! ```
//!
//! # Features
//!
//! A feature never changes a result.
//!
//! - `wide` (on by default): eight lanes, [`F32x8`], and the processor's own square root and fused multiply-add. Without it numbers
//!   are `f32` and `f64`, and both operations are software: slower, with the bits of a build that has the instructions.
//! - `glam`, `mint`: [`Vec3`], [`Rgb`] and [`Frame`] convert from and to the vectors and matrices of these crates.
//! - `bytemuck`: `F32x8` and `U32x8` are `Pod`. `Vec3` and `Rgb` are `AnyBitPattern`: `bytemuck::cast_slice` makes a slice of them
//!   of bytes or of `[f32; 3]`. They are not `Pod`, which of a generic struct only unsafe code may claim; towards arrays there is
//!   `From`.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod closure;
mod conversions;
pub mod energy;
pub mod frame;
pub mod fresnel;
#[cfg(feature = "wide")]
mod lanes;
pub mod lobe;
pub mod math;
pub mod metal;
pub mod microfacet;
pub mod model;
mod operators;
mod real;
mod rgb;
mod roughness;
pub mod surface;
pub mod table;
#[cfg(test)]
mod testing;
pub mod units;
mod vec3;
pub mod warp;

pub use closure::{BsdfSample, Closure};
pub use frame::Frame;
#[cfg(feature = "wide")]
pub use lanes::{F32x8, Mask8, U32x8, each_lane};
pub use lobe::{Event, Lobe, Properties, Sample, Transport, Value};
pub use model::{Model, Parameters};
#[doc(hidden)]
pub use real::Recordable;
pub use real::{Mask, Precision, Real};
pub use rgb::Rgb;
pub use roughness::{Alpha, Roughness};
pub use surface::Surface;
pub use table::Table;
pub use vec3::Vec3;

/// Runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
