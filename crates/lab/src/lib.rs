//! The instruments of Gonio: white furnace, reciprocity, chi-squared, totality, and the faults that test them.
//!
//! The nouns, in order:
//!
//! - A `Probe` is a scattering model as an instrument sees it: plain `f64` in and out, whatever computes inside.
//! - A `Subject` is a model with its probes (`f32`, and where they exist `f64` and eight lanes) and what is claimed of it.
//! - An instrument measures a subject and returns a [`Check`]: a number, its limit, and what the two mean.
//! - [`validate_kernel`] runs every instrument over the zoo, all lobes of the kernel at many parameters.
//! - [`certify`] runs those that make sense for a model of your own and returns a [`Certificate`]; [`certify_surface`] does
//!   it for a surface of the kernel's lobes, whose numbers it can also vary.
//! - A planted fault is a model that is wrong on purpose. Every instrument must catch its faults, or the run fails.
//!
//! Statistical tests share one significance: with a correct kernel, a run fails by chance with probability 0.01 at most,
//! however many tests it makes.
//!
//! ```
//! use gonio_kernel::{Rgb, lobe::Lambert};
//! use gonio_lab::{Effort, Options, certify};
//!
//! let mine = Lambert::new(Rgb::new(0.8_f32, 0.5, 0.2));
//! let certificate = certify("my lobe", &mine, &Options::new(Effort::Quick));
//! assert!(certificate.holds(), "{certificate}");
//! ```
#![forbid(unsafe_code)]

mod anatomy;
mod cells;
mod certify;
mod check;
mod chi2;
mod consistency;
mod directions;
mod discrete;
mod elementary;
mod faults;
mod faults_beneath;
mod finding;
mod frames;
mod furnace;
mod lanes;
mod mitsuba;
mod normal_map;
mod normalisation;
mod oracle;
pub mod plots;
mod precision;
mod probe;
mod quadrature;
mod random;
mod reciprocity;
mod reference;
mod run;
mod speed;
mod statistics;
mod subject;
mod sweep;
pub mod tables;
mod totality;
mod walk;
mod warps;
mod weight;
mod white;
mod zoo;

pub use certify::{Certificate, certify, certify_surface};
pub use check::{Check, Effort, Outcome};
pub use run::{Options, instruments, validate_kernel};
pub use speed::{Call, Speed, exercise};
pub use sweep::SafeRange;
pub use white::FurnaceMap;
