//! Lights: emitting triangles and the environment, and the choice between them.
//!
//! A triangle is chosen with probability proportional to its power (area times luminance), so the density of a point is
//! luminance / Σ(area · luminance), the same on all triangles of a material. If there are both kinds of light, each gets
//! half of the samples; an absent kind has probability exactly 0. A constant environment is sampled by cosine about the
//! shading normal, a map by its luminance over the whole sphere: samples below the horizon are wasted.

use crate::alias::{alias_table, pick};
use crate::environment::EnvironmentMap;
use crate::fingerprint::Fingerprint;
use crate::scene::{Environment, Sky};
use gonio_kernel::{F32x8, Real, Rgb, U32x8, Vec3, each_lane};

/// An emitting triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Emitter {
    pub(crate) corners: [Vec3<f32>; 3],
    /// The side of the winding that emits, unit.
    pub(crate) normal: Vec3<f32>,
    pub(crate) radiance: Rgb<f32>,
}

/// All lights of a world.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lights {
    emitters: Vec<Emitter>,
    alias: Vec<(f32, u32)>,
    /// Σ area · luminance.
    power: f64,
    sky: Option<PreparedSky>,
    camera_sees_sky: bool,
    sky_illuminates: bool,
}

/// What lies behind everything, unless it is black.
#[derive(Clone, Debug)]
pub(crate) enum PreparedSky {
    /// The same radiance from everywhere.
    Constant(Rgb<f32>),
    /// A picture.
    Map(Box<EnvironmentMap>),
}

/// Eight emitters side by side.
pub(crate) struct Emitters {
    pub(crate) corners: [Vec3<F32x8>; 3],
    pub(crate) normal: Vec3<F32x8>,
    pub(crate) radiance: Rgb<F32x8>,
}

impl Lights {
    /// Lights of positive luminance; a black environment is none.
    pub(crate) fn new(emitters: Vec<Emitter>, environment: &Environment) -> Self {
        let weights: Vec<f64> = emitters.iter().map(|e| e.area() * f64::from(e.radiance.luminance())).collect();
        let sky = match &environment.sky {
            Sky::Constant(radiance) => (radiance.largest() > 0.0).then_some(PreparedSky::Constant(*radiance)),
            Sky::Map(map) => EnvironmentMap::new(&map.picture, map.rotation, map.intensity)
                .map(|map| PreparedSky::Map(Box::new(map))),
        };
        Self {
            alias: alias_table(&weights),
            power: weights.iter().sum(),
            emitters,
            sky,
            camera_sees_sky: environment.camera_visible,
            sky_illuminates: environment.illuminates,
        }
    }

    /// All emitting triangles.
    pub(crate) fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    /// Whether the environment does anything.
    pub(crate) fn has_sky(&self) -> bool {
        self.sky.is_some() && (self.camera_sees_sky || self.sky_illuminates)
    }

    /// What paths see that leave the world after so many scattering events; `None` if it is black for them.
    #[inline(always)]
    pub(crate) fn sky(&self, depth: u32) -> Option<&PreparedSky> {
        let seen = if depth == 0 { self.camera_sees_sky } else { self.sky_illuminates };
        self.sky.as_ref().filter(|_| seen)
    }

    /// The environment as a light; `None` if it is black or only seen by the camera.
    #[inline(always)]
    pub(crate) fn shining_sky(&self) -> Option<&PreparedSky> {
        self.sky.as_ref().filter(|_| self.sky_illuminates)
    }

    /// Takes the environment into a fingerprint.
    pub(crate) fn describe_sky(&self, print: &mut Fingerprint) {
        match &self.sky {
            None => {}
            Some(PreparedSky::Constant(radiance)) => print.bytes(format!("{radiance:?}").as_bytes()),
            Some(PreparedSky::Map(map)) => map.describe(print),
        }
        print.bytes(&[u8::from(self.camera_sees_sky), u8::from(self.sky_illuminates)]);
    }

    /// Probability of asking the environment.
    pub(crate) fn environment_probability(&self) -> f32 {
        match (self.shining_sky(), self.emitters.is_empty()) {
            (None, _) => 0.0,
            (Some(_), true) => 1.0,
            (Some(_), false) => 0.5,
        }
    }

    /// Density per area of choosing a point of an emitting triangle, per luminance of its radiance; the choice of strategy
    /// included.
    pub(crate) fn pdf_area_per_luminance(&self) -> f32 {
        if self.emitters.is_empty() {
            return 0.0;
        }
        let share = 1.0 - f64::from(self.environment_probability());
        (share / self.power) as f32
    }

    /// Eight emitters for two random words each.
    #[inline(always)]
    pub(crate) fn pick(&self, place: U32x8, toss: F32x8) -> Emitters {
        let emitters = each_lane(|lane| &self.emitters[pick(&self.alias, place.lane(lane), toss.lane(lane))]);
        let corner = |c: usize| Vec3::from_lanes(|l| emitters[l].corners[c]);
        Emitters {
            corners: [corner(0), corner(1), corner(2)],
            normal: Vec3::from_lanes(|l| emitters[l].normal),
            radiance: Rgb::new(
                F32x8::from_fn(|l| emitters[l].radiance.r),
                F32x8::from_fn(|l| emitters[l].radiance.g),
                F32x8::from_fn(|l| emitters[l].radiance.b),
            ),
        }
    }
}

impl Emitter {
    fn area(&self) -> f64 {
        let [a, b, c] = self.corners.map(|v| Vec3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z)));
        0.5 * (b - a).cross(c - a).length()
    }
}

/// Which ways of finding light take part. All give the same picture but for noise, which is what this is for: a wrong
/// density makes them differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Techniques {
    /// Both, weighted by the power heuristic.
    #[default]
    Both,
    /// Lights are asked; scattering finds light only behind delta events and the camera.
    Lights,
    /// Scattering alone.
    Scattering,
}

impl Techniques {
    /// The weight of light that was found with density `own` and that the other technique finds with density `other`;
    /// `alone` is the one that finds light this way when it is the only one.
    #[inline(always)]
    pub(crate) fn weight(self, alone: Self, own: F32x8, other: F32x8) -> F32x8 {
        match self {
            Self::Both => power_heuristic(own, other),
            only => F32x8::splat(if only == alone { 1.0 } else { 0.0 }),
        }
    }
}

/// The power heuristic with exponent 2 (Veach & Guibas 1995): the weight of a sample of density `a` that could also have
/// been drawn with density `b`. Written as a ratio, so that huge densities do not overflow; 1 where b is 0.
#[inline(always)]
fn power_heuristic(a: F32x8, b: F32x8) -> F32x8 {
    let r = b / a;
    r.mul_add(r, F32x8::ONE).recip()
}
