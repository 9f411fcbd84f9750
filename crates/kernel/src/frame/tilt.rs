//! Tilted frames: shading normals that are not the surface's own, and the two rules that keep them harmless.
//!
//! A normal map (Cohen, Olano & Manocha 1998, "Appearance-Preserving Simplification") tilts the frame in which a lobe is
//! evaluated, and an interpolated vertex normal does the same. The geometry stays, so a viewer, or light, can be above one
//! of the two normals and below the other. Two rules decide what happens then; each is written once, here.
//!
//! **Light** ([`on_its_side`]). Whether it was reflected or transmitted is decided by the geometric side. What the tilted
//! lobe sends to the wrong one is dropped, so that nothing shines through a wall. The energy is lost: white Lambert tilted by
//! β returns (1 + cosβ)/2 from wherever it is seen, 93 % at 30°, 75 % at 60°. A mirror loses all or nothing. Making up for
//! it takes facets beside the tilted one (Schüßler et al. 2017, "Microfacet-Based Normal Mapping for Robust Monte Carlo Path
//! Tracing").
//!
//! **The viewer** ([`facing`]). A normal that faces away from the viewer is turned towards them until they graze it.
//! pbrt-v4 shades such a point as the back of the tilted surface, which lets light through; Mitsuba's `normalmap` tilts it to
//! the other side, or leaves it black; Cycles, Iray and MoonRay bend every normal until the viewer's mirror image rises
//! above the surface (Keller et al. 2017, "The Iray Light Transport Simulation and Rendering System", A.3). Ours changes no
//! normal that can be seen, leaves no black Lambert, and has no seam: at the border of what can be seen it is the given normal.
//! Its price: behind that border the frame depends on wo, so f(wo, wi) = f(wi, wo) does not hold there, and a mirror stays as
//! black as it was just before.

use super::Frame;
use crate::real::Real;
use crate::vec3::Vec3;

/// The cosine at which a viewer grazes a normal: a thousand times the rounding of [`facing`] in `f32`, and 0.06°.
pub const GRAZING: f64 = 1e-3;

impl<R: Real> Frame<R> {
    /// The frame tilted by a normal in its own coordinates, of any length: (0, 0, 1) leaves it as it is.
    ///
    /// The tangent stays as close to the old one as it can be. A normal that is zero, not finite, or not above the surface
    /// (z ≤ 0) gives back this frame, to the bit, and so does one along z.
    #[inline(always)]
    pub fn tilted(&self, n: Vec3<R>) -> Self {
        let n = n.normalize_or(Vec3::unit_z());
        let tilts = n.z.gt(R::ZERO) & (n.x.abs() + n.y.abs()).gt(R::ZERO);
        Self::select(tilts, Self::from_normal_tangent(self.to_world(n), self.x), *self)
    }
}

/// The shading normal with which a viewer at wo is shown: n, turned towards wo as far as it takes to be seen.
///
/// All are unit and in one frame; `geometric` lies on wo's side. The result is n, to the bit, where n·wo is at least
/// [`GRAZING`] (or, nearer to the horizon, the cosine of the geometric normal); otherwise it is in the plane of n and wo.
/// It has positive cosines to wo and to the geometric normal: if n does not allow that, being behind the surface or not
/// finite, it is the geometric normal.
#[inline(always)]
pub fn facing<R: Real>(n: Vec3<R>, geometric: Vec3<R>, wo: Vec3<R>) -> Vec3<R> {
    let least = R::lit(GRAZING).min(geometric.dot(wo));
    let cos = n.dot(wo);
    // Its cosine to wo is least/|…|, and |…| ≤ 1 up to GRAZING². Only n ≈ −wo cancels, both of them in the horizon.
    let turned = n.along(least - cos, wo).normalize();
    let n = Vec3::select(cos.lt(least), turned, n);
    let usable = n.dot(wo).gt(R::ZERO) & n.dot(geometric).gt(R::ZERO);
    Vec3::select(usable, n, geometric)
}

/// Whether light that a lobe scattered along wi leaves the surface where the lobe sent it: above the geometric normal (which
/// lies on wo's side), or below it where it is to go `through`. Light for which this is false carries nothing.
#[inline(always)]
pub fn on_its_side<R: Real>(geometric: Vec3<R>, wi: Vec3<R>, through: R::Mask) -> R::Mask {
    let above = geometric.dot(wi).gt(R::ZERO);
    (above & !through) | (!above & through)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::tests::assert_frame;
    use crate::testing::{Random, close, special_values};

    fn some_frame(random: &mut Random) -> Frame<f32> {
        Frame::from_normal_tangent(random.direction(), random.direction())
    }

    #[test]
    fn a_tilted_frame_has_the_maps_normal_and_leans_its_tangent() {
        let mut random = Random(31);
        for _ in 0..1000 {
            let (base, n) = (some_frame(&mut random), random.above());
            let frame = base.tilted(n * 0.25);
            assert_frame(frame, n);
            assert!(close((base.to_local(frame.z) - n).length().into(), 0.0, 1e-6), "{n:?} became {:?}", frame.z);
            // In the plane of the old tangent and the new normal, on the old tangent's side.
            assert!(close(frame.y.dot(base.x).into(), 0.0, 1e-5) && frame.x.dot(base.x) > 0.0, "{n:?}");
        }
    }

    #[test]
    fn a_quarter_turn_about_the_bitangent_moves_x_down() {
        let flat = Frame { x: Vec3::new(1.0_f32, 0.0, 0.0), y: Vec3::new(0.0, 1.0, 0.0), z: Vec3::unit_z() };
        let frame = flat.tilted(Vec3::new(0.6, 0.0, 0.8));
        let expected = Frame { x: Vec3::new(0.8, 0.0, -0.6), y: flat.y, z: Vec3::new(0.6, 0.0, 0.8) };
        for (a, b) in [(frame.x, expected.x), (frame.y, expected.y), (frame.z, expected.z)] {
            assert!(close((a - b).length().into(), 0.0, 1e-6), "{frame:?}");
        }
    }

    #[test]
    fn a_normal_that_tilts_nothing_or_cannot_be_used_gives_back_the_frame() {
        let mut random = Random(32);
        let values = special_values();
        for _ in 0..20 {
            let base = some_frame(&mut random);
            for n in [[0.0, 0.0, 1.0], [0.0, -0.0, 0.2], [0.0; 3], [0.6, 0.0, -0.8], [0.6, 0.8, 0.0], [0.0, 0.0, -1.0]]
            {
                assert_eq!(base.tilted(Vec3::from(n)), base, "{n:?}");
            }
            for &x in &values {
                for &z in &values {
                    for n in [Vec3::new(x, 0.3, z), Vec3::new(0.3, z, x), Vec3::new(z, x, x)] {
                        let frame = base.tilted(n);
                        assert_frame(frame, n);
                        let finite = n.x.is_finite() && n.y.is_finite() && n.z.is_finite();
                        assert!(finite && n.z > 0.0 || frame == base, "{n:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_normal_that_faces_the_viewer_stays_and_another_turns_until_they_graze_it() {
        let mut random = Random(33);
        let (mut stayed, mut turned) = (0, 0);
        for _ in 0..20_000 {
            let (geometric, n, wo) = (random.direction(), random.direction(), random.direction());
            let (cos_n, cos_wo) = (n.dot(geometric), geometric.dot(wo));
            if cos_n < 1e-3 || cos_wo < 2e-3 {
                continue;
            }
            let shown = facing(n, geometric, wo);
            assert!(shown.dot(wo) > 0.0 && shown.dot(geometric) > 0.0, "{n:?} {geometric:?} {wo:?}");
            if n.dot(wo) >= 1e-3 {
                assert_eq!(shown, n);
                stayed += 1;
            } else {
                assert!(close(shown.length().into(), 1.0, 1e-6));
                // Between n and wo, at the cosine GRAZING over the sine between them.
                let sine = n.cross(wo).length();
                assert!(close((shown.dot(wo) * sine).into(), GRAZING, 1e-5), "{}", shown.dot(wo));
                assert!(close((n.cross(wo).dot(shown) / sine).into(), 0.0, 1e-4) || sine < 1e-2, "{shown:?}");
                turned += 1;
            }
        }
        assert!(stayed > 1000 && turned > 1000, "{stayed} and {turned}");
    }

    #[test]
    fn what_cannot_be_shown_becomes_the_geometric_normal() {
        let (up, wo) = (Vec3::<f32>::unit_z(), Vec3::new(0.6, 0.0, 0.8));
        for n in [Vec3::new(0.6, 0.0, -0.8), Vec3::new(1.0, 0.0, 0.0), Vec3::splat(f32::NAN), -up] {
            assert_eq!(facing(n, up, wo), up, "{n:?}");
        }
        // A viewer in the surface itself sees no normal: nothing breaks.
        let beside = Vec3::new(1.0, 0.0, 0.0);
        assert_eq!(facing(Vec3::new(-0.6, 0.0, 0.8), up, beside), up);
        assert_eq!(facing(up, up, Vec3::new(1.0, 0.0, 1e-6)), up);
    }

    #[test]
    fn light_counts_where_the_geometry_agrees_with_the_lobe() {
        let up = Vec3::<f32>::unit_z();
        let (above, below) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.6, 0.0, -0.8));
        assert!(on_its_side(up, above, false) && on_its_side(up, below, true));
        assert!(!on_its_side(up, below, false) && !on_its_side(up, above, true));
    }
}
