//! The Beckmann distribution of microfacet normals, a surface of Gaussian slopes, with Smith's masking.
//!
//! Beckmann & Spizzichino 1963; Cook & Torrance 1982; Walter et al. 2007, "Microfacet Models for Refraction through Rough
//! Surfaces"; anisotropic and height-correlated as in Heitz 2014, "Understanding the Masking-Shadowing Function in
//! Microfacet-Based BRDFs". With α_x along the tangent and α_y along the bitangent, both in [1e-8, 1]:
//!
//! - D(m) = exp(−(m_x²/α_x² + m_y²/α_y²)/m_z²) / (π α_x α_y m_z⁴)
//! - Λ(w) = (erf a − 1)/2 + exp(−a²)/(2a√π), a = |w_z|/t, t = √(α_x²w_x² + α_y²w_y²)
//!
//! Λ is exact, not Walter's rational fit, and comes as s(w) = |w_z|(1 + 2Λ) = |w_z| erf a + t exp(−a²)/√π, which needs no
//! division by w_z.
//!
//! **Visible normals.** For α = 1 and a view in the xz-plane with cotangent a, the slope y is Gaussian and the slope x has
//! the density (a − x)₊ exp(−x²) (Heitz & d'Eon 2014, "Importance Sampling Microfacet-Based BSDFs using the Distribution
//! of Visible Normals"). Its integral cannot be inverted in closed form, and is inverted by Newton's method elsewhere
//! (Jakob 2014, "An Improved Visible Normal Sampling Routine for the Beckmann Distribution"). But that of its size t = |x| can:
//! both signs together have the density max(2a, a + t) exp(−t²), of which
//!
//! - a exp(−t²), twice where t < a, is Gaussian: t = erf⁻¹ of a linear function of u₀ on either side of a;
//! - t exp(−t²) where t > a is Rayleigh's: t² = a² − ln v.
//!
//! Where t < a, the sign falls by u₁ in the proportion a + t to a − t, and what is left of u₁ gives y. So the map is exact to
//! rounding in every precision and without a loop; but it jumps between its parts, and slopes beyond a are reached from both.
//!
//! **Cost.** `d`: two divisions, one exponential. `smith_length`: one division, one root, one exponential. `sample_visible`
//! beyond that: two divisions, one root, two logarithms, two inverse error functions. Newton's method (two steps of Halley's from a
//! guess within 0.07) took 2.7 times as long in eight lanes.

use super::visible::lengthened;
use crate::math::{erf_inv_over, erf_inv_within, erfc_and_exp, exp_negative, flushed_square, ln_normal};
use crate::real::Real;
use crate::roughness::Alpha;
use crate::vec3::Vec3;
use core::f64::consts::{FRAC_1_PI, FRAC_2_SQRT_PI};

/// A Beckmann surface of widths alpha_x and alpha_y, each in [1e-8, 1]; √2 times the standard deviations of its slopes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beckmann<R> {
    /// Width along the tangent, α_u.
    pub alpha_x: R,
    /// Width along the bitangent, α_v.
    pub alpha_y: R,
}

impl<R: Real> Beckmann<R> {
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

    /// D of the half vector h = wo + wi with h.z ≥ 0, not normalised, with |h|² given \[1/sr\].
    #[inline]
    pub fn d(&self, h: Vec3<R>, h_length2: R) -> R {
        let args = [self.alpha_x, self.alpha_y, h.x, h.y, h.z, h_length2];
        let [d] = R::named(
            "beckmann_d",
            args,
            #[inline(always)]
            |[alpha_x, alpha_y, x, y, z, h_length2]| [Self { alpha_x, alpha_y }.d_text(Vec3::new(x, y, z), h_length2)],
        );
        d
    }

    #[inline(always)]
    fn d_text(&self, h: Vec3<R>, h_length2: R) -> R {
        let (h, h_length2) = lengthened(h, h_length2);
        // Where h lies that close to the horizon, D is 0 by 1e20 in the exponent; and all quotients stay finite.
        let z = h.z.max(R::lit(1e-16));
        let (over_a, over_z2) = ((self.alpha_x * self.alpha_y).recip(), (z * z).recip());
        let (x, y) = (h.x * self.alpha_y * over_a, h.y * self.alpha_x * over_a);
        // The root first, because secant⁴ may overflow where the exponential is 0.
        let root = exp_negative(R::lit(-0.5) * x.mul_add(x, y * y) * over_z2) * (h_length2 * over_z2);
        flushed_square(root, over_a * R::lit(FRAC_1_PI))
    }

    /// s(w) = |w_z|(1 + 2Λ(w)): |w_z| seen from above, t/√π in the horizon.
    #[inline(always)]
    pub fn smith_length(&self, w: Vec3<R>) -> R {
        let args = [self.alpha_x, self.alpha_y, w.x, w.y, w.z];
        let [s] = R::named(
            "beckmann_smith_length",
            args,
            #[inline(always)]
            |[alpha_x, alpha_y, x, y, z]| {
                let tilt = Self { alpha_x, alpha_y }.tilt(Vec3::new(x, y, z));
                let (erfc, e) = erfc_and_exp(tilt.cot);
                [z.abs().mul_add(R::ONE - erfc, tilt.length * e * R::lit(0.5 * FRAC_2_SQRT_PI))]
            },
        );
        s
    }

    /// A microfacet normal of any length, distributed as those visible from wo (above the surface).
    #[inline(always)]
    pub fn sample_visible(&self, wo: Vec3<R>, u: [R; 2]) -> Vec3<R> {
        let tilt = self.tilt(wo);
        let (along, across) = visible_slopes(tilt.cot, u);
        let slope_x = along * tilt.cos_phi - across * tilt.sin_phi;
        let slope_y = along * tilt.sin_phi + across * tilt.cos_phi;
        Vec3::new(-self.alpha_x * slope_x, -self.alpha_y * slope_y, R::ONE)
    }

    #[inline(always)]
    fn tilt(&self, w: Vec3<R>) -> Tilt<R> {
        let (x, y) = (self.alpha_x * w.x, self.alpha_y * w.y);
        let length = x.mul_add(x, y * y).sqrt();
        // Along the normal there is no azimuth, and none is needed.
        let tilted = length.gt(R::lit(1e-18));
        let length = length.max(R::lit(1e-18));
        let inverse = length.recip();
        Tilt {
            length,
            cot: w.z.abs() * inverse,
            cos_phi: R::select(tilted, x * inverse, R::ONE),
            sin_phi: (y * inverse).or_zero(tilted),
        }
    }
}

/// A direction seen in the space where the surface has α = 1: the length t of its part in the surface, the cotangent of its
/// angle to the normal, at most 1e18, and the azimuth.
struct Tilt<R> {
    length: R,
    cot: R,
    cos_phi: R,
    sin_phi: R,
}

/// The slopes of a visible facet of the surface of α = 1, towards a viewer of cotangent a in \[0, 1e18\] and across:
/// of density (a − x)₊ exp(−x² − y²).
#[inline(always)]
fn visible_slopes<R: Real>(cot: R, u: [R; 2]) -> (R, R) {
    let args = [cot, u[0], u[1]];
    let [along, across] = R::named(
        "beckmann_visible_slopes",
        args,
        #[inline(always)]
        |[cot, u0, u1]| {
            let (along, across) = visible_slopes_text(cot, [u0, u1]);
            [along, across]
        },
    );
    (along, across)
}

#[inline(always)]
fn visible_slopes_text<R: Real>(cot: R, u: [R; 2]) -> (R, R) {
    let (erfc, e) = erfc_and_exp(cot);
    let erf = R::ONE - erfc;
    // The weights of the three parts, over √π/2.
    let (even, gaussian, rayleigh) = (R::lit(2.0) * cot * erf, cot.mul_add(erf, cot), e * R::lit(0.5 * FRAC_2_SQRT_PI));
    let whole = gaussian + rayleigh;
    let place = u[0] * whole;
    let is_gaussian = place.lt(gaussian);
    let both_sides = place.lt(even);
    let ratio = R::select(is_gaussian, place, whole - place) / R::select(is_gaussian, cot, rayleigh);
    let share = R::select(both_sides, R::lit(0.5) * ratio, ratio - erf);
    // erf⁻¹(share), or √(a² − ln ratio): one logarithm for both.
    let rest = R::select(is_gaussian, (R::ONE - share) * (R::ONE + share), ratio).max(R::EPSILON * R::lit(0.25));
    let w = -ln_normal(rest);
    let size = R::select(is_gaussian, share * erf_inv_over(w), cot.mul_add(cot, w).max(R::ZERO).sqrt());

    // Sizes below a come with both signs, in the proportion a + t to a − t.
    let either = is_gaussian & size.lt(cot);
    let towards = cot + size;
    let place = u[1] * R::select(either, cot + cot, R::ONE);
    let away = either & place.ge(towards);
    let number = (place - towards.or_zero(away)) / R::select(either, cot + size.negated(away), R::ONE);
    (size.negated(!away), erf_inv_within(number.mul_add(R::lit(2.0), -R::ONE)))
}

#[cfg(test)]
mod tests;
