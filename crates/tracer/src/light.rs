//! Lights: each kind says in one place how it is sampled and with which density, and whoever needs either asks it there.
//!
//! - `area`: emissive triangles, which rays also hit;
//! - `environment`: light from infinitely far away, constant or a map, which rays meet when they leave the world;
//! - `delta`: lights that no ray meets (point, spot, distant, and a user's own: [`Light`]).
//!
//! Each kind that a scene has gets the same share of the light samples; an absent kind has probability exactly 0.

pub(crate) mod area;
pub(crate) mod delta;
mod distant;
mod environment;
mod kinds;
pub(crate) mod lights;
mod map;
mod mis;
mod point;
pub(crate) mod sample;
mod spot;

pub use delta::{Bounds, Light, LightSource};
pub use distant::DistantLight;
pub use kinds::{KINDS, ReadLight};
pub use mis::Techniques;
pub use point::PointLight;
pub use sample::{LightSample, Reference, SHORT_OF_LIGHT, Towards};
pub use spot::SpotLight;
