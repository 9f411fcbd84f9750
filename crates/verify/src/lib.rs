//! What needs the tracer and the instruments together: Gonio verified as a whole.
//!
//! - [`census`]: the same rays through every ray-casting backend, yours or ours, and every disagreement by name. [`mod@bench`] says how
//!   many of them a backend casts per second.
//! - Furnace scenes, whose every pixel is known, rendered through the whole tracer.
//! - [`validate`]: the instruments of `gonio-lab`, the census and the furnaces in one run, each check handed on as it ends.
//! - [`difference`]: how two pictures of one scene differ, and whether chance explains it.
//!
//! Backends and scenes are measured here; what is said of them on a page is [`gonio_report`]'s, on a terminal the command line's.
#![forbid(unsafe_code)]

mod backends;
pub mod bench;
mod blocks;
pub mod census;
pub mod difference;
mod error;
mod lights;
mod outcome;
mod scenes;
mod shipped;
mod validation;

pub use error::Error;
pub use validation::{Found, instruments, validate};

/// Runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
