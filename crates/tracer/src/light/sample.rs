//! What a light is asked, and what it answers.

use crate::sides::Sides;
use gonio_kernel::{F32x8, Frame, Mask8, Real, Rgb, Vec3};

/// Shadow rays stop this much short of the light, relative to its distance: the rounding of the distance and of t.
pub const SHORT_OF_LIGHT: f32 = 1.0 - 16.0 / 16_777_216.0;

/// Eight shading points as lights see them.
#[derive(Clone, Copy, Debug)]
pub struct Reference<'a> {
    frame: &'a Frame<F32x8>,
    sides: &'a Sides,
}

impl<'a> Reference<'a> {
    #[inline(always)]
    pub(crate) fn new(frame: &'a Frame<F32x8>, sides: &'a Sides) -> Self {
        Self { frame, sides }
    }

    /// The shading frame, on the side of wo, or of the winding where the material transmits.
    #[inline(always)]
    pub fn frame(&self) -> &Frame<F32x8> {
        self.frame
    }

    /// How a shadow ray goes to that point of the world.
    #[inline(always)]
    pub fn towards(&self, target: Vec3<F32x8>) -> Towards {
        let to = target - self.sides.origin_towards(target);
        let distance2 = to.length2();
        let distance = distance2.sqrt();
        Towards { wi: to * distance.recip(), distance, distance2 }
    }
}

/// The way from shading points to points of the world.
#[derive(Clone, Copy, Debug)]
pub struct Towards {
    /// Unit; not finite where both are one point.
    pub wi: Vec3<F32x8>,
    /// How far it is \[m\].
    pub distance: F32x8,
    /// Its square.
    pub distance2: F32x8,
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
    pub(super) fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self {
            wi: Vec3::select(mask, yes.wi, no.wi),
            pdf: F32x8::select(mask, yes.pdf, no.pdf),
            radiance: Rgb::select(mask, yes.radiance, no.radiance),
            distance: F32x8::select(mask, yes.distance, no.distance),
            possible: (mask & yes.possible) | (!mask & no.possible),
        }
    }

    /// Where there is none.
    pub(super) fn none() -> Self {
        Self {
            wi: Vec3::unit_z(),
            pdf: F32x8::splat(1.0),
            radiance: Rgb::splat(F32x8::splat(0.0)),
            distance: F32x8::splat(0.0),
            possible: Mask8::from_bits(0),
        }
    }

    /// Of a light in one point, whose intensity depends on the direction in which it leaves.
    #[inline(always)]
    pub(super) fn of_point(
        at: &Reference,
        position: Vec3<f32>,
        intensity: impl FnOnce(Vec3<F32x8>) -> Rgb<F32x8>,
    ) -> Self {
        let Towards { wi, distance, distance2 } = at.towards(Vec3::broadcast(position));
        Self {
            wi,
            pdf: F32x8::ONE,
            radiance: intensity(-wi) * distance2.recip(),
            distance,
            possible: distance.gt(F32x8::ZERO),
        }
    }
}
