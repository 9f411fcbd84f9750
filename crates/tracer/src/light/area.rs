//! Emissive triangles: chosen by power, sampled uniformly over their area, found again by rays that hit them.
//!
//! A triangle is chosen with probability proportional to its power (area times luminance), so the density of a point per area
//! is luminance / Σ(area · luminance), the same on all triangles of a material. Light leaves from the front of the winding.

use super::sample::{LightSample, Reference, Towards};
use crate::alias::{alias_table, pick};
use crate::surface_point::SurfacePoint;
use gonio_kernel::warp::sample_uniform_triangle;
use gonio_kernel::{F32x8, Real, Rgb, U32x8, Vec3, each_lane};

/// An emissive triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Emitter {
    pub(crate) corners: [Vec3<f32>; 3],
    /// The side of the winding that emits, unit.
    pub(crate) normal: Vec3<f32>,
    pub(crate) radiance: Rgb<f32>,
}

/// All emissive triangles of a world.
#[derive(Clone, Debug, Default)]
pub(crate) struct EmissiveTriangles {
    emitters: Vec<Emitter>,
    alias: Vec<(f32, u32)>,
    /// Σ area · luminance.
    power: f64,
    /// Density per area of a point, per luminance of its radiance; the choice between kinds of light included.
    pdf_area_per_luminance: f32,
}

impl EmissiveTriangles {
    /// Triangles of positive luminance.
    pub(crate) fn new(emitters: Vec<Emitter>) -> Self {
        let weights: Vec<f64> = emitters.iter().map(|e| e.area() * f64::from(e.radiance.luminance())).collect();
        let power = weights.iter().sum();
        Self { alias: alias_table(&weights), power, emitters, pdf_area_per_luminance: 0.0 }
    }

    /// Says which share of all light samples is theirs.
    pub(crate) fn set_share(&mut self, share: f32) {
        if !self.emitters.is_empty() {
            self.pdf_area_per_luminance = (f64::from(share) / self.power) as f32;
        }
    }

    /// Each of them.
    pub(crate) fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    /// A uniform point of a triangle chosen by power: `slot` is a random word, the rest are numbers in [0, 1).
    #[inline(always)]
    pub(crate) fn sample(&self, at: &Reference, slot: U32x8, u_select: F32x8, u_position: [F32x8; 2]) -> LightSample {
        let emitters = each_lane(|lane| &self.emitters[pick(&self.alias, slot.lane(lane), u_select.lane(lane))]);
        let corner = |c: usize| Vec3::from_lanes(|l| emitters[l].corners[c]);
        let corners = [corner(0), corner(1), corner(2)];
        let normal = Vec3::from_lanes(|l| emitters[l].normal);
        let radiance = Rgb::from_lanes(|l| emitters[l].radiance);
        let target = SurfacePoint::new(&corners, sample_uniform_triangle(u_position)).off_plane(normal);
        let Towards { wi, distance, distance2 } = at.towards(target);
        let cos = -normal.dot(wi);
        LightSample {
            wi,
            pdf: self.pdf(radiance, [distance2, F32x8::ONE], cos),
            radiance,
            distance,
            possible: cos.gt(F32x8::ZERO) & distance.gt(F32x8::ZERO),
        }
    }

    /// Density per solid angle with which [`EmissiveTriangles::sample`] chooses a point of that radiance, seen under `cos` from
    /// a distance whose square is the product of two factors.
    #[inline(always)]
    pub(crate) fn pdf(&self, radiance: Rgb<F32x8>, distance2: [F32x8; 2], cos: F32x8) -> F32x8 {
        let pdf_area = radiance.luminance() * F32x8::splat(self.pdf_area_per_luminance);
        pdf_area * distance2[0] * distance2[1] / cos
    }
}

impl Emitter {
    fn area(&self) -> f64 {
        let [a, b, c] = self.corners.map(|v| Vec3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z)));
        0.5 * (b - a).cross(c - a).length()
    }
}
