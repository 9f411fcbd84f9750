//! Visible normals and reflection in them: what distributions share.

use crate::real::{Mask, Real};
use crate::vec3::Vec3;

/// How far down the mirrored view of the stretched surface samples go: k cos_o + s_o, of which k = 1 are all visible normals.
#[derive(Clone, Copy, Debug)]
pub struct Reach<R> {
    /// k cos_o + s_o.
    pub depth: R,
    /// 1 / depth.
    pub inverse: R,
}

impl<R: Real> Reach<R> {
    /// All visible normals.
    #[inline(always)]
    pub fn whole(wo: Vec3<R>, s_o: R) -> Self {
        let depth = wo.z + s_o;
        Self { depth, inverse: depth.recip() }
    }
}

/// Density of the directions that mirror wo in a visible normal within reach \[1/sr\], D given: D/(2(k cos_o + s_o)), for k = 1
/// G₁(wo) D/(4 cos_o).
#[inline(always)]
pub fn pdf_visible_reflected<R: Real>(d: R, reach: Reach<R>) -> R {
    R::lit(0.5) * d * reach.inverse
}

/// wo mirrored in the normal along m, of any length in [1e-18, 1e18]: 2m(wo·m)/|m|² − wo.
#[inline(always)]
pub fn reflect<R: Real>(wo: Vec3<R>, m: Vec3<R>) -> Vec3<R> {
    let twice = R::lit(2.0) * wo.dot(m) / m.length2();
    Vec3::new(m.x.mul_add(twice, -wo.x), m.y.mul_add(twice, -wo.y), m.z.mul_add(twice, -wo.z))
}

/// h and |h|², as they are unless both directions lie nearly in the surface and are opposite: then the squares of h would
/// underflow, and as D does not depend on |h|, h becomes unit.
#[inline(always)]
pub(super) fn lengthened<R: Real>(h: Vec3<R>, h_length2: R) -> (Vec3<R>, R) {
    let tiny = h_length2.lt(R::lit(1e-12));
    if !tiny.any() {
        return (h, h_length2);
    }
    (Vec3::select(tiny, h.normalize_or(Vec3::unit_z()), h), R::select(tiny, R::ONE, h_length2))
}
