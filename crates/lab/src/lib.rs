//! The instruments of Gonio: white furnace, reciprocity, chi-squared, totality, and the faults that test them.
//!
//! The nouns, in order:
//!
//! - A [`TestBsdf`] is a lobe with its `f64` twin, its lanes and its numbers: any lobe that is made of declared parameters.
//! - A `Probe` is a lobe as an instrument sees it: plain `f64` in and out, whatever computes inside.
//! - The `catalog` holds every variant of every model of the kernel, as the declarations say, and surfaces made of them.
//! - An instrument measures a lobe and returns a [`Check`]: a number, its limit, and what the two mean.
//! - [`validate_kernel`] runs every instrument over the catalog.
//! - [`certify`] runs those that make sense for one lobe, yours or ours, and returns a [`Certificate`]; [`certify_single`] does
//!   it for a lobe that is implemented for `f32` only.
//! - [`plots`] shows what the instruments see; [`Certificate::page`] puts it all on a page, by means of `gonio-report`.
//! - A planted fault is a lobe or a building block that is wrong on purpose. Every instrument must catch its faults, or the run fails.
//!
//! Statistical tests share one significance: with a correct kernel, a run fails by chance with probability 0.01 at most,
//! however many tests it makes.
//!
//! A model of one's own, alone and as the base of a mixture:
//!
//! ```
//! use gonio_kernel::{Event, Lobe, Parameters, Real, Rgb, Sample, Transport, Value, Vec3, frame::both_above, lobe::Mirror};
//! use gonio_kernel::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere};
//! use gonio_lab::{Effort, Options, certify};
//!
//! gonio_kernel::model! {
//!     /// Reflects more of the light the steeper it leaves.
//!     struct Dusty<R> = "dusty" {
//!         /// What is reflected along the normal.
//!         base_color: Rgb<R> = 0.8 in gonio_kernel::model::REFLECTANCE,
//!     }
//! }
//! impl<R: Real> Lobe<R> for Dusty<R> {
//!     type Prepared = ();
//!     fn prepare(&self, _wo: Vec3<R>, _transport: Transport) {}
//!     fn eval(&self, wo: Vec3<R>, _: &(), wi: Vec3<R>) -> Value<R> {
//!         let pdf = pdf_cosine_hemisphere(wi);
//!         Value { f_cos: self.base_color * (pdf * (wo.z * wi.z)), pdf }.or_zero(both_above(wo, wi))
//!     }
//!     fn sample(&self, wo: Vec3<R>, _: &(), u: [R; 3]) -> Sample<R> {
//!         let wi = sample_cosine_hemisphere([u[1], u[2]]);
//!         Sample { wi, event: Event::reflected(!both_above(wo, wi)) }
//!     }
//!     fn delta(&self, _: Vec3<R>, _: &(), _: &Sample<R>) -> Value<R> { Value::zero() }
//!     fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> { self.base_color * (wo.z * R::lit(2.0 / 3.0)) }
//!     fn domain(&self) -> R::Mask { self.in_domain() }
//! }
//!
//! let dusty = Dusty { base_color: Rgb::new(0.8_f32, 0.5, 0.2) };
//! let half = Rgb::splat(0.5);
//! let varnished = dusty.times(half).plus(Mirror::new(Rgb::splat(1.0_f32)).times(half));
//! let options = Options::new(Effort::Quick);
//! for certificate in [certify("dusty", &dusty, &options), certify("varnished", &varnished, &options)] {
//!     assert!(certificate.holds(), "{certificate}");
//!     assert!(certificate.ranges.iter().any(|range| range.number == "base_color.g" && range.precision == "f64"));
//! }
//! ```
#![forbid(unsafe_code)]

mod catalog;
mod cells;
mod certify;
mod chi2;
mod consistency;
mod delta;
mod directions;
mod effort;
mod elementary;
mod faults;
mod finding;
mod frames;
mod furnace;
mod lanes;
mod layering;
mod mitsuba;
mod mutations;
mod normal_map;
mod normalisation;
mod oracle;
pub mod plots;
mod precision;
mod probe;
mod quadrature;
pub mod random;
mod reciprocity;
mod reference;
mod run;
mod slab;
mod speed;
mod statistics;
mod sweep;
pub mod tables;
mod task;
mod test_bsdf;
mod totality;
mod under_test;
mod walk;
mod warps;
mod weight;
mod white;

pub use certify::{Certificate, certify, certify_single};
pub use effort::Effort;
pub use gonio_report::{Check, Outcome};
pub use run::{instruments, validate_kernel};
pub use speed::{Call, Count, Speed, exercise};
pub use statistics::sidak;
pub use sweep::SafeRange;
pub use task::Options;
pub use test_bsdf::{Number, TestBsdf};
pub use white::FurnaceMap;

/// Runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
