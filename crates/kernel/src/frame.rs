//! The canonical frame: the one place where a world direction becomes a local one and back.
//!
//! In the local frame the shading normal is `z`, the tangent `x`, the bitangent `y`, and x × y = z. A frame made from a
//! normal alone has an arbitrary tangent (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"), which is fine
//! for isotropic lobes only. A frame made from a normal and a tangent keeps the normal and orthonormalises the tangent
//! against it. Any input gives an orthonormal frame: a normal that is zero or not finite becomes `z`, a tangent that is
//! parallel to the normal is ignored.

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
