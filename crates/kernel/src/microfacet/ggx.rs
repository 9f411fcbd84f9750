//! The GGX (Trowbridge–Reitz) distribution of microfacet normals with Smith's masking.
//!
//! Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces"; anisotropic and height-correlated as in
//! Heitz 2014, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs"; visible normals sampled by
//! Dupuy & Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps".
//!
//! With α_x along the tangent and α_y along the bitangent:
//!
//! - D(m) = 1 / (π α_x α_y (m_x²/α_x² + m_y²/α_y² + m_z²)²)
//! - Λ(w) = (√(1 + (α_x²w_x² + α_y²w_y²)/w_z²) − 1)/2, G₁ = 1/(1 + Λ), G₂ = 1/(1 + Λ(wo) + Λ(wi))
//!
//! All formulas are arranged so that nothing is formed by subtraction: D from the unnormalised half vector, which stays
//! exact near the mirror direction, and Λ through the stretched length s(w) = √(w_z² + α_x²w_x² + α_y²w_y²), which gives
//! G₁ = 2w_z/(w_z + s(w)) and needs no division by w_z.

use crate::math::sin_cos_turns;
use crate::real::{Mask, Real};
use crate::vec3::Vec3;

/// A GGX surface of widths alpha_x and alpha_y, each in [1e-4, 1].
#[derive(Clone, Copy, Debug)]
pub struct Ggx<R> {
    /// Width along the tangent, α_u.
    pub alpha_x: R,
    /// Width along the bitangent, α_v.
    pub alpha_y: R,
}

impl<R: Real> Ggx<R> {
    /// D of the half vector h = wo + wi, not normalised, with |h|² given \[1/sr\].
    #[inline(always)]
    pub fn d(&self, h: Vec3<R>, h_length2: R) -> R {
        // Both directions nearly in the surface and opposite: the squares of h would underflow, D does not depend on |h|.
        let tiny = h_length2.lt(R::lit(1e-12));
        let (mut h, mut h_length2) = (h, h_length2);
        if tiny.any() {
            h = Vec3::select(tiny, h.normalize_or(Vec3::unit_z()), h);
            h_length2 = R::select(tiny, R::ONE, h_length2);
        }
        // With a = α_x α_y: D = a³|h|⁴/(π (α_y²h_x² + α_x²h_y² + a²h_z²)²), one division instead of four.
        let a = self.alpha_x * self.alpha_y;
        let x = self.alpha_y * h.x;
        let y = self.alpha_x * h.y;
        let z = a * h.z;
        let q = x.mul_add(x, y.mul_add(y, z * z));
        let r = a * h_length2 / q;
        r * r * a * R::lit(core::f64::consts::FRAC_1_PI)
    }

    /// s(w) = √(w_z² + α_x²w_x² + α_y²w_y²), the length of w in the space where the surface is a hemisphere.
    #[inline(always)]
    pub fn stretched_length(&self, w: Vec3<R>) -> R {
        let x = self.alpha_x * w.x;
        let y = self.alpha_y * w.y;
        x.mul_add(x, y.mul_add(y, w.z * w.z)).sqrt()
    }

    /// Height-correlated G₂/(4 cos_o), which is vis · cos_i, with s(wo) and s(wi) given:
    /// cos_i/(2(cos_i s(wo) + cos_o s(wi))).
    #[inline(always)]
    pub fn vis_cos_i(&self, cos_o: R, s_o: R, cos_i: R, s_i: R) -> R {
        // The ratio stays finite where the products of denormal cosines and widths would underflow.
        let lift = R::lit(1e20);
        let (cos_o, cos_i) = (cos_o * lift, cos_i * lift);
        R::lit(0.5) * cos_i / cos_i.mul_add(s_o, cos_o * s_i)
    }

    /// A microfacet normal, unit, distributed as those visible from wo (above the surface).
    #[inline(always)]
    pub fn sample_visible(&self, wo: Vec3<R>, u: [R; 2]) -> Vec3<R> {
        // In the stretched space the surface is a unit hemisphere, and its mirrored view fills a spherical cap.
        let o = Vec3::new(self.alpha_x * wo.x, self.alpha_y * wo.y, wo.z).normalize();
        let (sin_phi, cos_phi) = sin_cos_turns(u[0]);
        let z = (R::ONE - u[1]).mul_add(R::ONE + o.z, -o.z);
        let sin_theta = ((R::ONE - z) * (R::ONE + z)).max(R::ZERO).sqrt();
        let m = Vec3::new(sin_theta.mul_add(cos_phi, o.x), sin_theta.mul_add(sin_phi, o.y), z + o.z);
        Vec3::new(self.alpha_x * m.x, self.alpha_y * m.y, m.z.max(R::ZERO)).normalize_or(Vec3::unit_z())
    }

    /// Density of the directions that mirror wo in a visible normal \[1/sr\], D given: G₁(wo) D/(4 cos_o).
    #[inline(always)]
    pub fn pdf_visible_reflected(&self, d: R, cos_o: R, s_o: R) -> R {
        R::lit(0.5) * d / (cos_o + s_o)
    }

    /// Whether both widths lie in [1e-4, 1].
    #[inline(always)]
    pub fn domain(&self) -> R::Mask {
        let inside = |alpha: R| alpha.ge(R::lit(ALPHA_MIN)) & alpha.le(R::ONE);
        inside(self.alpha_x) & inside(self.alpha_y)
    }
}

/// The smallest width that `validate` tests in `f32`: below it the `f32` lattice of directions is coarser than the lobe,
/// and a mirror is the better model.
const ALPHA_MIN: f64 = 0.999_999e-4; // a hair below 1e-4, so that 1e-4 rounded to f32 is inside

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
        assert_eq!(ggx.stretched_length(Vec3::unit_z()), 1.0);
        assert!(close(ggx.stretched_length(Vec3::new(1.0, 0.0, 0.0)), 0.3, 1e-15));
    }

    #[test]
    fn a_visible_normal_is_a_unit_vector_above_the_surface_that_faces_the_viewer() {
        let mut random = Random(5);
        for alpha in [1e-4_f32, 0.1, 1.0] {
            let ggx = Ggx { alpha_x: alpha, alpha_y: 1.0 };
            for _ in 0..1000 {
                let wo = random.above();
                let m = ggx.sample_visible(wo, [random.unit(), random.unit()]);
                assert!(close(m.length().into(), 1.0, 1e-6) && m.z >= 0.0 && m.dot(wo) >= -1e-6, "{wo:?} {m:?}");
            }
        }
    }
}
