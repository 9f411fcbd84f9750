//! The environment: light from infinitely far away, the same from everywhere or a map.
//!
//! A constant environment is sampled by cosine about the shading normal, a map by its luminance over the whole sphere: samples
//! below the horizon are wasted.

use super::map::EnvironmentMap;
use super::sample::{LightSample, Reference};
use crate::fingerprint::Fingerprint;
use crate::sampler::Random4;
use crate::scene;
use gonio_kernel::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere};
use gonio_kernel::{F32x8, Mask, Mask8, Real, Rgb, Vec3};

/// What lies behind everything, and who sees it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Environment {
    sky: Option<Sky>,
    camera_visible: bool,
    illuminates: bool,
    /// Which share of all light samples is its.
    share: f32,
}

/// Radiance by direction, not black.
#[derive(Clone, Debug)]
enum Sky {
    /// The same from everywhere.
    Constant(Rgb<f32>),
    /// A picture.
    Map(Box<EnvironmentMap>),
}

/// What eight paths see that leave the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Escaped {
    pub(crate) radiance: Rgb<F32x8>,
    /// Density per solid angle with which a light sample chooses the direction, the choice between kinds of light included.
    pub(crate) pdf: F32x8,
}

impl Environment {
    /// What the scene describes; black is none.
    pub(crate) fn new(environment: &scene::Environment) -> Self {
        let sky = match &environment.sky {
            scene::Sky::Constant(radiance) => (radiance.largest() > 0.0).then_some(Sky::Constant(*radiance)),
            scene::Sky::Map(map) => {
                EnvironmentMap::new(&map.picture, map.rotation, map.intensity).map(|map| Sky::Map(Box::new(map)))
            }
        };
        let (camera_visible, illuminates) = (environment.camera_visible, environment.illuminates);
        Self { sky, camera_visible, illuminates, share: 0.0 }
    }

    /// Says which share of all light samples is its.
    pub(crate) fn set_share(&mut self, share: f32) {
        self.share = share;
    }

    /// Whether it is a light, and not only a background that the camera sees.
    pub(crate) fn is_light(&self) -> bool {
        self.light().is_some()
    }

    #[inline(always)]
    fn light(&self) -> Option<&Sky> {
        self.sky.as_ref().filter(|_| self.illuminates)
    }

    /// A direction in which its light arrives: `u` are the numbers of the light sample, `more` draws four that a map needs
    /// besides.
    #[inline(always)]
    pub(crate) fn sample(&self, at: &Reference, u: &Random4, more: impl FnOnce() -> Random4) -> Option<LightSample> {
        let distance = F32x8::splat(f32::INFINITY);
        Some(match self.light()? {
            Sky::Constant(radiance) => {
                let local = sample_cosine_hemisphere([u.unit(2), u.unit(3)]);
                LightSample {
                    wi: at.frame().to_world(local),
                    pdf: self.pdf_constant(local),
                    radiance: Rgb::broadcast(*radiance),
                    distance,
                    possible: Mask8::splat(true),
                }
            }
            Sky::Map(map) => {
                let wi = map.sample(&more(), [u.0[1], u.0[2]]);
                let seen = map.at(wi);
                let possible = seen.pdf.gt(F32x8::ZERO);
                LightSample {
                    wi,
                    pdf: seen.pdf * F32x8::splat(self.share),
                    radiance: seen.radiance,
                    distance,
                    possible,
                }
            }
        })
    }

    /// Density of a light sample in the local direction wi, as far as it depends on the frame there: a path carries it until
    /// it leaves the world. 0 for a map, which looks its density up when it is seen.
    #[inline(always)]
    pub(crate) fn pdf_ahead(&self, wi: Vec3<F32x8>) -> F32x8 {
        match self.light() {
            Some(Sky::Constant(_)) => self.pdf_constant(wi),
            _ => F32x8::ZERO,
        }
    }

    /// What paths see in the directions `dir` after so many scattering events, with what [`Environment::pdf_ahead`] said of
    /// them; `None` if it is black for them.
    #[inline(always)]
    pub(crate) fn escaped(&self, depth: u32, dir: Vec3<F32x8>, pdf_ahead: impl FnOnce() -> F32x8) -> Option<Escaped> {
        let is_seen = if depth == 0 { self.camera_visible } else { self.illuminates };
        Some(match self.sky.as_ref().filter(|_| is_seen)? {
            Sky::Constant(radiance) => Escaped { radiance: Rgb::broadcast(*radiance), pdf: pdf_ahead() },
            Sky::Map(map) => {
                let seen = map.at(dir);
                Escaped { radiance: seen.radiance, pdf: seen.pdf * F32x8::splat(self.share) }
            }
        })
    }

    /// Takes it into a fingerprint.
    pub(crate) fn describe(&self, print: &mut Fingerprint) {
        match &self.sky {
            None => {}
            Some(Sky::Constant(radiance)) => print.numbers([radiance.r, radiance.g, radiance.b]),
            Some(Sky::Map(map)) => map.describe(print),
        }
        print.bytes(&[u8::from(self.camera_visible), u8::from(self.illuminates)]);
    }

    /// Density of a local direction in a constant environment.
    #[inline(always)]
    fn pdf_constant(&self, wi: Vec3<F32x8>) -> F32x8 {
        pdf_cosine_hemisphere(wi) * F32x8::splat(self.share)
    }
}
