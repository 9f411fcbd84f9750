//! The canonical frame: the one place where a world direction becomes a local one and back.
//!
//! In the local frame the shading normal is `z`, the tangent `x`, the bitangent `y`, and x × y = z. A frame made from a
//! normal alone has an arbitrary tangent (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"), which is fine
//! for isotropic lobes only. A frame made from a normal and a tangent keeps the normal and orthonormalises the tangent
//! against it. Any input gives an orthonormal frame: a normal that is zero or not finite becomes `z`, a tangent that is
//! parallel to the normal is ignored.

mod tilt;

pub use tilt::{GRAZING, facing, on_its_side};

use crate::real::Real;
use crate::vec3::Vec3;

/// A right-handed orthonormal basis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<R> {
    /// The tangent, local x.
    pub x: Vec3<R>,
    /// The bitangent, local y.
    pub y: Vec3<R>,
    /// The shading normal, local z.
    pub z: Vec3<R>,
}

impl<R: Real> Frame<R> {
    /// A frame about the normal `n` (any length) with an arbitrary tangent.
    #[inline(always)]
    pub fn from_normal(n: Vec3<R>) -> Self {
        let z = n.normalize_or(Vec3::unit_z());
        let (x, y) = tangents(z);
        Self { x, y, z }
    }

    /// A frame about the normal `n` whose tangent is as close to `tangent` as it can be (both of any length).
    /// The tangent is ignored where it is zero, not finite, or within about 1e-4 radians of ±n.
    #[inline(always)]
    pub fn from_normal_tangent(n: Vec3<R>, tangent: Vec3<R>) -> Self {
        let z = n.normalize_or(Vec3::unit_z());
        let (arbitrary, _) = tangents(z);
        let t = tangent.normalize_or(arbitrary);
        let rest = t - z * z.dot(t);
        let ok = rest.length2().gt(R::lit(1e-8)); // below, the difference is mostly rounding
        let x = Vec3::select(ok, rest, arbitrary).normalize();
        // Once more against the normal: the first subtraction leaves eps/|rest|.
        let x = (x - z * z.dot(x)).normalize();
        Self { x, y: z.cross(x), z }
    }

    /// `yes` where `mask`, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        let each = |yes, no| Vec3::select(mask, yes, no);
        Self { x: each(yes.x, no.x), y: each(yes.y, no.y), z: each(yes.z, no.z) }
    }

    /// World to local.
    #[inline(always)]
    pub fn to_local(&self, v: Vec3<R>) -> Vec3<R> {
        Vec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }

    /// Local to world.
    #[inline(always)]
    pub fn to_world(&self, v: Vec3<R>) -> Vec3<R> {
        (self.x * v.x).along(v.y, self.y).along(v.z, self.z)
    }
}

/// Two unit vectors that make a right-handed basis with the unit vector `z`. The sign bit of z.z decides the branch, so
/// that −0 is handled like the southern hemisphere and 1/(sign + z.z) is never larger than 1.
#[inline(always)]
pub fn tangents<R: Real>(z: Vec3<R>) -> (Vec3<R>, Vec3<R>) {
    let sign = R::ONE.copysign(z.z);
    let a = -(sign + z.z).recip();
    let b = z.x * z.y * a;
    let x = Vec3::new((sign * z.x * z.x).mul_add(a, R::ONE), sign * b, -sign * z.x);
    let y = Vec3::new(b, (z.y * z.y).mul_add(a, sign), -z.y);
    (x, y)
}

/// cosθ = n·w of a local direction.
#[inline(always)]
pub fn cos_theta<R: Real>(w: Vec3<R>) -> R {
    w.z
}

/// sin²θ of a local direction, from x and y: 1 − z² would cancel near the normal.
#[inline(always)]
pub fn sin2_theta<R: Real>(w: Vec3<R>) -> R {
    w.x.mul_add(w.x, w.y * w.y)
}

/// Whether both local directions lie strictly above the surface.
#[inline(always)]
pub fn both_above<R: Real>(wo: Vec3<R>, wi: Vec3<R>) -> R::Mask {
    wo.z.gt(R::ZERO) & wi.z.gt(R::ZERO)
}

/// w with its z mirrored where wo is below the surface: seen so, wo is above.
#[inline(always)]
pub(crate) fn turned<R: Real>(wo: Vec3<R>, w: Vec3<R>) -> Vec3<R> {
    Vec3::new(w.x, w.y, R::select(wo.z.lt(R::ZERO), -w.z, w.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, close, special_values};

    /// Orthonormal to 1e-6 and right-handed.
    pub(super) fn assert_frame(frame: Frame<f32>, from: Vec3<f32>) {
        let Frame { x, y, z } = frame;
        for (a, b, dot) in [(x, x, 1.0), (y, y, 1.0), (z, z, 1.0), (x, y, 0.0), (y, z, 0.0), (z, x, 0.0)] {
            assert!(close(a.dot(b).into(), dot, 1e-6), "from {from:?}: {frame:?}");
        }
        assert!(close(x.cross(y).dot(z).into(), 1.0, 1e-6), "from {from:?}: {frame:?} is left-handed");
    }

    /// Every octant, axes and diagonals, with zeros of either sign, from denormal to huge.
    fn normals() -> impl Iterator<Item = Vec3<f32>> {
        const PARTS: [f32; 5] = [-1.0, -0.0, 0.0, 1e-4, 1.0];
        let each = PARTS.into_iter().flat_map(|x| PARTS.into_iter().flat_map(move |y| PARTS.map(|z| [x, y, z])));
        each.flat_map(|v| [1e-44, 1e-30, 1.0, 1e30].map(|length| Vec3::from(v.map(|x: f32| x * length))))
            .filter(|n| n.length2() > 0.0 || n.abs().x.max(n.abs().y).max(n.abs().z) > 0.0)
    }

    #[test]
    fn a_frame_from_any_normal_is_right_handed_and_keeps_the_normal() {
        for n in normals() {
            let frame = Frame::from_normal(n);
            assert_frame(frame, n);
            let along = |v: Vec3<f32>| Vec3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z));
            let exact = along(n) * along(n).length().recip();
            assert!(close((along(frame.z) - exact).length(), 0.0, 1e-6), "{n:?} became {:?}", frame.z);
        }
    }

    #[test]
    fn a_frame_from_normal_and_tangent_keeps_the_normal_and_leans_the_tangent() {
        let mut random = Random(6);
        for n in normals() {
            let tangent = random.direction();
            let frame = Frame::from_normal_tangent(n, tangent);
            assert_frame(frame, n);
            assert_eq!(frame.z, Frame::from_normal(n).z);
            assert!(close(frame.y.dot(tangent).into(), 0.0, 1e-5) && frame.x.dot(tangent) > 0.0, "{n:?} {tangent:?}");
        }
    }

    #[test]
    fn the_local_frame_is_its_own_frame_and_minus_z_turns_it_over() {
        let up = Frame::from_normal(Vec3::<f32>::unit_z());
        assert_eq!((up.x, up.y), (Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)));
        let down = Vec3::new(0.0, 0.0, -1.0);
        assert_frame(Frame::from_normal(down), down);
        assert_eq!(Frame::from_normal(down).z, down);
    }

    #[test]
    fn a_tangent_parallel_to_the_normal_is_ignored() {
        for n in normals() {
            for tangent in [n, -n, n * 0.5] {
                assert_frame(Frame::from_normal_tangent(n, tangent), n);
            }
        }
    }

    #[test]
    fn no_input_breaks_a_frame() {
        let values = special_values();
        for &x in &values {
            for &y in &values {
                for &z in &values {
                    let n = Vec3::new(x, y, z);
                    assert_frame(Frame::from_normal(n), n);
                    assert_frame(Frame::from_normal_tangent(Vec3::new(y, x, 1.0), n), n);
                }
            }
        }
    }

    #[test]
    fn local_and_back_is_the_same_direction() {
        let mut random = Random(7);
        for _ in 0..1000 {
            let (frame, v) = (Frame::from_normal(random.direction()), random.direction());
            let back = frame.to_world(frame.to_local(v));
            assert!(close((back - v).length().into(), 0.0, 1e-6), "{v:?} came back as {back:?}");
            assert!(close(frame.to_local(frame.z).z.into(), 1.0, 1e-6));
        }
    }
}
