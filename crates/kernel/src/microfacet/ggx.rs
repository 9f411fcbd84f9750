//! The GGX (Trowbridge–Reitz) distribution of microfacet normals with Smith's masking.
//!
//! Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces"; anisotropic and height-correlated as in
//! Heitz 2014, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs"; visible normals sampled by
//! Dupuy & Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps", and for reflection within the bound of
//! Eto & Tokuyoshi 2023, "Bounded VNDF Sampling for Smith–GGX Reflections".
//!
//! With α_x along the tangent and α_y along the bitangent:
//!
//! $$ D(m) = \frac{1}{\pi\\,\alpha_x \alpha_y\\,(m_x^2/\alpha_x^2 + m_y^2/\alpha_y^2 + m_z^2)^2} \qquad
//!    s(w) = \sqrt{w_z^2 + \alpha_x^2 w_x^2 + \alpha_y^2 w_y^2} $$
//!
//! with $s(w) = |\cos\theta|\\,(1 + 2\Lambda(w))$, from which [`super`] makes masking, shadowing and densities.
//!
//! Nothing is formed by subtraction: D comes from the unnormalised half vector, which stays exact near the mirror
//! direction. Cost: D one division, s one root, its reach two divisions and a root, a visible normal one root.

use super::visible::{Reach, lengthened};
use crate::math::sin_cos_turns;
use crate::real::Real;
use crate::roughness::Alpha;
use crate::vec3::Vec3;

/// A GGX surface of widths alpha_x and alpha_y, each in [1e-8, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx<R> {
    /// Width along the tangent, α_u.
    pub alpha_x: R,
    /// Width along the bitangent, α_v.
    pub alpha_y: R,
}

impl<R: Real> Ggx<R> {
    /// The same along tangent and bitangent, by alpha or by a user's roughness.
    #[inline(always)]
    pub fn isotropic(alpha: impl Into<Alpha<R>>) -> Self {
        let Alpha(alpha) = alpha.into();
        Self { alpha_x: alpha, alpha_y: alpha }
    }
    /// Along tangent and bitangent, by alpha or by a user's roughness.
    #[inline(always)]
    pub fn new(x: impl Into<Alpha<R>>, y: impl Into<Alpha<R>>) -> Self {
        Self { alpha_x: x.into().0, alpha_y: y.into().0 }
    }

    /// D of the normal along h (any length, h.z ≥ 0), with |h|² given \[1/sr\].
    #[inline(always)]
    pub fn d(&self, h: Vec3<R>, h_length2: R) -> R {
        let args = [self.alpha_x, self.alpha_y, h.x, h.y, h.z, h_length2];
        let [d] = R::named(
            "ggx_d",
            args,
            #[inline(always)]
            |[alpha_x, alpha_y, x, y, z, h_length2]| [Self { alpha_x, alpha_y }.d_text(Vec3::new(x, y, z), h_length2)],
        );
        d
    }

    #[inline(always)]
    fn d_text(&self, h: Vec3<R>, h_length2: R) -> R {
        let (h, _) = lengthened(h, h_length2);
        // With a = α_x α_y: D = a³|h|⁴/(π (α_y²h_x² + α_x²h_y² + a²h_z²)²), one division instead of four. One factor α is
        // lifted by about 1/α_min, so that the squares of the least widths do not underflow; a power of two rounds nothing.
        let lift = R::lit(134_217_728.0); // 2²⁷
        let (alpha_x, alpha_y) = (self.alpha_x * lift, self.alpha_y * lift);
        let a = alpha_x * self.alpha_y;
        // The same squares above and below, so that their roundings cancel where one of them dominates.
        let (x2, y2, z2) = (h.x * h.x, h.y * h.y, h.z * h.z);
        let q = x2.mul_add(alpha_y * alpha_y, y2.mul_add(alpha_x * alpha_x, z2 * (a * a)));
        let r = a * lift * (x2 + y2 + z2) / q;
        // r·a first: r alone may be as large as 1/a.
        r * (r * (self.alpha_x * self.alpha_y * R::lit(core::f64::consts::FRAC_1_PI)))
    }

    /// s(w) = √(w_z² + α_x²w_x² + α_y²w_y²): the length of w in the space where the surface is a hemisphere.
    #[inline(always)]
    pub fn smith_length(&self, w: Vec3<R>) -> R {
        let args = [self.alpha_x, self.alpha_y, w.x, w.y, w.z];
        let [s] = R::named(
            "ggx_smith_length",
            args,
            #[inline(always)]
            |[alpha_x, alpha_y, x, y, z]| {
                let (x, y) = (alpha_x * x, alpha_y * y);
                [x.mul_add(x, y.mul_add(y, z * z)).sqrt()]
            },
        );
        s
    }

    /// How much of the lower cap can reflect above the horizon, in [0, 1]: Eto & Tokuyoshi's
    /// k = (1 − α²)(1 + sinθ)²/((1 + sinθ)² + α²cos²θ) with the lesser width, as a fraction from which
    /// cos²θ = (1 + sinθ)(1 − sinθ) has cancelled a factor.
    #[inline(always)]
    fn bound_fraction(&self, wo: Vec3<R>) -> (R, R) {
        let a2 = self.alpha_x.min(self.alpha_y).sqr();
        let sin = wo.x.mul_add(wo.x, wo.y * wo.y).sqrt();
        let kept = (R::ONE - a2).mul_add(sin, R::ONE - a2);
        (kept, R::lit(2.0).mul_add(a2, kept))
    }

    /// See [`Reach`]: normals that may reflect above the horizon, as far as Eto & Tokuyoshi's bound k tells.
    #[inline(always)]
    pub fn reach(&self, wo: Vec3<R>, s_o: R) -> Reach<R> {
        let (kept, of) = self.bound_fraction(wo);
        // Two divisions, but a sampler needs but one of them, and a density the other.
        Reach { depth: (kept / of).mul_add(wo.z, s_o), inverse: of / kept.mul_add(wo.z, s_o * of) }
    }

    /// A normal of any length, distributed as those visible from wo (above the surface) within reach, with s(wo) given.
    #[inline(always)]
    pub fn sample_visible(&self, wo: Vec3<R>, s_o: R, reach: Reach<R>, u: [R; 2]) -> Vec3<R> {
        // In the stretched space the surface is a hemisphere, and its mirrored view fills a spherical cap. Of radius s rather
        // than 1, because wo is that long there and nothing needs to be divided.
        let (sin_phi, cos_phi) = sin_cos_turns(u[0]);
        let depth = u[1] * reach.depth; // below the pole; s ≥ k|wo.z|, so it is not below the other one
        let r = (depth * (s_o + s_o - depth)).sqrt();
        let m = Vec3::new(
            r.mul_add(cos_phi, self.alpha_x * wo.x),
            r.mul_add(sin_phi, self.alpha_y * wo.y),
            // Its square is not 0, and it tips over no normal of the narrowest surface.
            (s_o + wo.z - depth).max(R::lit(1e-18)),
        );
        Vec3::new(self.alpha_x * m.x, self.alpha_y * m.y, m.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, close};
    use core::f64::consts::{FRAC_PI_2, PI, TAU};

    #[test]
    fn along_the_normal_d_is_one_over_pi_alpha_x_alpha_y() {
        for (alpha_x, alpha_y) in [(1.0_f64, 1.0), (0.5, 0.1), (1e-3, 1e-2)] {
            let d = Ggx { alpha_x, alpha_y }.d(Vec3::unit_z() * 1.7, 1.7 * 1.7);
            assert!(close(d * PI * alpha_x * alpha_y, 1.0, 1e-14));
        }
    }

    #[test]
    fn the_facets_together_project_onto_the_whole_surface() {
        // ∫ D cosθ dω = 1, by midpoints in tan θ = tan ψ, which d ψ spreads evenly enough for these widths.
        for (alpha_x, alpha_y) in [(1.0, 1.0), (0.5, 0.2), (0.3, 0.9)] {
            let ggx = Ggx { alpha_x, alpha_y };
            let (rows, columns) = (1000, 400);
            let mut sum = 0.0;
            for row in 0..rows {
                let (sin, cos) = ((f64::from(row) + 0.5) / f64::from(rows) * FRAC_PI_2).sin_cos();
                for column in 0..columns {
                    let (sin_phi, cos_phi) = ((f64::from(column) + 0.5) / f64::from(columns) * TAU).sin_cos();
                    sum += ggx.d(Vec3::new(sin * cos_phi, sin * sin_phi, cos), 1.0) * cos * sin;
                }
            }
            let integral = sum * FRAC_PI_2 / f64::from(rows) * TAU / f64::from(columns);
            assert!(close(integral, 1.0, 1e-5), "{alpha_x}, {alpha_y}: {integral}");
        }
    }

    #[test]
    fn a_smooth_view_along_the_normal_stretches_to_its_own_length() {
        let ggx = Ggx { alpha_x: 0.3_f64, alpha_y: 0.7 };
        assert_eq!(ggx.smith_length(Vec3::unit_z()), 1.0);
        assert!(close(ggx.smith_length(Vec3::new(1.0, 0.0, 0.0)), 0.3, 1e-15));
    }

    #[test]
    fn a_visible_normal_lies_above_the_surface_and_faces_the_viewer() {
        let mut random = Random(5);
        for alpha in [1e-8_f32, 1e-4, 0.1, 1.0] {
            let ggx = Ggx { alpha_x: alpha, alpha_y: 1.0 };
            for _ in 0..1000 {
                let wo = random.above();
                let u = [random.unit(), random.unit()];
                let s_o = ggx.smith_length(wo);
                for reach in [Reach::whole(wo, s_o), ggx.reach(wo, s_o)] {
                    let m = ggx.sample_visible(wo, s_o, reach, u).normalize();
                    assert!(close(m.length().into(), 1.0, 1e-6) && m.z >= 0.0 && m.dot(wo) >= -1e-6, "{wo:?} {m:?}");
                }
            }
        }
    }

    #[test]
    fn the_bound_loses_no_normal_that_reflects_above_the_horizon() {
        // A normal below the bound has its mirrored view below the horizon: none that reflects upwards is missing.
        let mut random = Random(6);
        for (alpha_x, alpha_y) in [(1.0, 1.0), (0.5, 0.5), (0.9, 0.1), (0.05, 0.4)] {
            let ggx = Ggx { alpha_x, alpha_y };
            for _ in 0..10_000 {
                let wo = Vec3::from(<[f32; 3]>::from(random.above()).map(f64::from));
                let (s_o, (kept, of)) = (ggx.smith_length(wo), ggx.bound_fraction(wo));
                let k = kept / of;
                let u: f64 = random.unit().into();
                // z of the cap, uniform over all visible normals; those below −k o_z are left out.
                let (o_z, z) = (wo.z / s_o, (1.0 - u).mul_add(1.0 + wo.z / s_o, -wo.z / s_o));
                if z < -k * o_z {
                    let m = ggx.sample_visible(wo, s_o, Reach::whole(wo, s_o), [random.unit().into(), u]).normalize();
                    assert!((m * (2.0 * wo.dot(m)) - wo).z <= 1e-12, "{wo:?} {m:?}");
                }
            }
        }
    }

    #[test]
    fn the_narrowest_surface_is_finite_and_peaks_as_it_should() {
        let ggx = Ggx { alpha_x: 1e-8_f32, alpha_y: 1e-8 };
        let peak = ggx.d(Vec3::unit_z() * 2.0, 4.0);
        assert!(close(f64::from(peak) * PI * 1e-16, 1.0, 1e-6), "{peak}");
        assert!(ggx.d(Vec3::new(1.0, 1.0, 0.0), 2.0).is_finite());
    }
}
