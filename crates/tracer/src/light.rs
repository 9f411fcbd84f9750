//! Lights: each kind says in one place how it is sampled and with which density, and whoever needs either asks it there.
//!
//! - [`area`]: emissive triangles, which rays also hit;
//! - [`environment`]: light from infinitely far away, constant or a map, which rays meet when they leave the world;
//! - [`delta`]: lights that no ray meets (point, spot, distant, and a user's own: [`Light`]).
//!
//! Each kind that a scene has gets the same share of the light samples; an absent kind has probability exactly 0.

pub(crate) mod area;
pub(crate) mod delta;
pub(crate) mod distant;
pub(crate) mod environment;
mod map;
mod mis;
pub(crate) mod point;
pub(crate) mod spot;

pub use delta::{Bounds, Light, LightSource};
pub use distant::DistantLight;
pub use mis::Techniques;
pub use point::PointLight;
pub use spot::SpotLight;

use crate::fingerprint::Fingerprint;
use crate::point::ShadingPoints;
use crate::sampler::Random4;
use crate::scene;
use crate::scene::fields::{Fields, Refusal};
use crate::sides::Sides;
use area::{EmissiveTriangles, Emitter};
use delta::DeltaLights;
use environment::Environment;
use std::sync::Arc;

use gonio_kernel::{F32x8, Frame, Mask, Mask8, Real, Rgb, Vec3};

/// Shadow rays stop this much short of the light, relative to its distance: the rounding of the distance and of t.
pub const SHORT_OF_LIGHT: f32 = 1.0 - 16.0 / 16_777_216.0;

/// Reads a light from the fields that describe it.
pub type ReadLight = fn(&mut dyn Fields) -> Result<Arc<dyn LightSource>, Refusal>;

/// The kinds of lights that scene files can name, by their `type`.
pub const KINDS: &[(&str, ReadLight)] =
    &[("point", PointLight::read), ("spot", SpotLight::read), ("distant", DistantLight::read)];

/// Eight shading points as lights see them.
#[derive(Clone, Copy, Debug)]
pub struct Reference<'a> {
    points: &'a ShadingPoints<'a>,
    sides: &'a Sides,
}

impl<'a> Reference<'a> {
    #[inline(always)]
    pub(crate) fn new(points: &'a ShadingPoints<'a>, sides: &'a Sides) -> Self {
        Self { points, sides }
    }

    /// The shading frame, on the side of wo, or of the winding where the material transmits.
    #[inline(always)]
    pub fn frame(&self) -> &Frame<F32x8> {
        &self.points.frame
    }

    /// Where a shadow ray to that point of the world starts. Distances and directions to it are measured from here.
    #[inline(always)]
    pub fn origin_towards(&self, target: Vec3<F32x8>) -> Vec3<F32x8> {
        self.sides.origin_towards(target)
    }
}

/// A direction in which light may arrive at each of eight points.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Towards the light, unit, in the world.
    pub wi: Vec3<F32x8>,
    /// Density per solid angle; for a delta light 1.
    pub pdf: F32x8,
    /// Radiance that arrives if nothing is in the way \[W/(m² sr)\]; for a delta light the irradiance of a surface that faces
    /// it \[W/m²\].
    pub radiance: Rgb<F32x8>,
    /// How far away the light is; infinity if it is not in the world \[m\].
    pub distance: F32x8,
    /// Whether light can arrive at all.
    pub possible: Mask8,
}

impl LightSample {
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self {
            wi: Vec3::select(mask, yes.wi, no.wi),
            pdf: F32x8::select(mask, yes.pdf, no.pdf),
            radiance: Rgb::select(mask, yes.radiance, no.radiance),
            distance: F32x8::select(mask, yes.distance, no.distance),
            possible: (mask & yes.possible) | (!mask & no.possible),
        }
    }
}

/// A light sample, and whether scattering cannot find that light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChosenSample {
    pub(crate) sample: LightSample,
    pub(crate) is_delta: Mask8,
}

/// All lights of a world.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lights {
    pub(crate) environment: Environment,
    pub(crate) triangles: EmissiveTriangles,
    pub(crate) delta: DeltaLights,
    /// Where the shares of triangles and of delta lights begin; that of the environment begins at 0, and the last ends at 1.
    starts: [f32; 2],
}

impl Lights {
    pub(crate) fn new(emitters: Vec<Emitter>, environment: &scene::Environment, delta: DeltaLights) -> Self {
        let (mut environment, mut triangles) = (Environment::new(environment), EmissiveTriangles::new(emitters));
        let mut delta = delta;
        let present = [environment.is_light(), !triangles.emitters().is_empty(), !delta.is_empty()];
        let of = present.iter().filter(|present| **present).count().max(1) as f32;
        let mut begun = 0;
        let [first, second, third] = present.map(|present| {
            begun += u8::from(present);
            f32::from(begun) / of
        });
        environment.set_share(first);
        triangles.set_share(second - first);
        delta.set_share(third - second);
        Self { environment, triangles, delta, starts: [first, second] }
    }

    /// Whether there is a light to sample.
    #[inline(always)]
    pub(crate) fn are_sampled(&self, techniques: Techniques) -> bool {
        let hittable = self.environment.is_light() || !self.triangles.emitters().is_empty();
        !self.delta.is_empty() || (hittable && techniques != Techniques::Scattering)
    }

    /// One light sample for each live lane. None if no lane has one. `u` are four random numbers, `more` draws further ones.
    #[inline(always)]
    pub(crate) fn sample(
        &self,
        techniques: Techniques,
        live: Mask8,
        at: &Reference,
        u: &Random4,
        more: impl FnOnce() -> Random4,
    ) -> Option<ChosenSample> {
        let u_select = u.unit(0);
        let [second, third] = self.starts.map(F32x8::splat);
        let of_environment = u_select.lt(second);
        let of_delta = u_select.ge(third);
        let of_triangles = !of_environment & !of_delta;
        // What is left of the number within the chosen kind decides the second number of the alias; below 1 even after rounding.
        let rest = |from: F32x8, to: F32x8| ((u_select - from) / (to - from)).min(F32x8::splat(0.999_999_94));
        let u_position = [u.unit(2), u.unit(3)];
        let hittable = techniques != Techniques::Scattering;

        let mut found: Option<LightSample> = None;
        let mut add = |lanes: Mask8, sample: LightSample| {
            found = Some(match found {
                None => LightSample { possible: sample.possible & lanes, ..sample },
                Some(other) => LightSample::select(lanes, sample, other),
            });
        };
        if hittable && (live & of_environment).any() {
            if let Some(sample) = self.environment.sample(at, u, more) {
                add(of_environment, sample);
            }
        }
        if hittable && (live & of_triangles).any() && !self.triangles.emitters().is_empty() {
            add(of_triangles, self.triangles.sample(at, u.0[1], rest(second, third), u_position));
        }
        if (live & of_delta).any() && !self.delta.is_empty() {
            add(of_delta, self.delta.sample(at, live & of_delta, u.0[1], rest(third, F32x8::ONE), u_position));
        }
        let sample = found?;
        Some(ChosenSample { sample: LightSample { possible: sample.possible & live, ..sample }, is_delta: of_delta })
    }

    /// Takes what the scene's triangles and materials do not say into a fingerprint.
    pub(crate) fn describe(&self, print: &mut Fingerprint) {
        self.environment.describe(print);
        self.delta.describe(print);
    }
}
