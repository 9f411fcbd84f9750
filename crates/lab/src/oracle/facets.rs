//! Distributions of microfacet normals by the book, in tan²θ and slopes (Walter et al. 2007; Heitz 2014).

use crate::probe::Dir;
use gonio_kernel::microfacet::{Distribution, Microfacets};
use std::f64::consts::PI;

/// D(m); none for a distribution that this file does not know.
pub(super) fn d(microfacets: &Microfacets<f64>, m: [f64; 3]) -> Option<f64> {
    let [alpha_x, alpha_y] = microfacets.alphas();
    match microfacets.distribution {
        Distribution::Ggx => Some(ggx_d(alpha_x, alpha_y, m)),
        Distribution::Beckmann => Some(beckmann_d(alpha_x, alpha_y, m)),
        _ => None,
    }
}

/// Smith's Λ(w), w above the surface; none likewise.
pub(super) fn lambda(microfacets: &Microfacets<f64>, w: Dir) -> Option<f64> {
    let [alpha_x, alpha_y] = microfacets.alphas();
    match microfacets.distribution {
        Distribution::Ggx => Some(ggx_lambda(alpha_x, alpha_y, w)),
        Distribution::Beckmann => Some(beckmann_lambda(alpha_x, alpha_y, w)),
        _ => None,
    }
}

/// Λ of a Beckmann surface: Heitz 2014, equation 77.
pub(crate) fn beckmann_lambda(alpha_x: f64, alpha_y: f64, w: Dir) -> f64 {
    let a = w.z / ((alpha_x * w.x).powi(2) + (alpha_y * w.y).powi(2)).sqrt();
    if a.is_infinite() { 0.0 } else { 0.5 * ((-a * a).exp() / (a * PI.sqrt()) - statrs::function::erf::erfc(a)) }
}

/// D in slopes: Walter et al. 2007, equation 25.
fn beckmann_d(alpha_x: f64, alpha_y: f64, m: [f64; 3]) -> f64 {
    let slopes = [m[0] / m[2] / alpha_x, m[1] / m[2] / alpha_y];
    (-slopes[0] * slopes[0] - slopes[1] * slopes[1]).exp() / (PI * alpha_x * alpha_y * m[2].powi(4))
}

/// D(m) = 1 / (π α_x α_y cos⁴θ (1 + tan²θ (cos²φ/α_x² + sin²φ/α_y²))²).
fn ggx_d(alpha_x: f64, alpha_y: f64, m: [f64; 3]) -> f64 {
    let cos2 = m[2] * m[2];
    let sin2 = m[0] * m[0] + m[1] * m[1];
    if sin2 == 0.0 {
        return 1.0 / (PI * alpha_x * alpha_y);
    }
    let (cos2_phi, sin2_phi) = (m[0] * m[0] / sin2, m[1] * m[1] / sin2);
    let e = sin2 / cos2 * (cos2_phi / (alpha_x * alpha_x) + sin2_phi / (alpha_y * alpha_y));
    1.0 / (PI * alpha_x * alpha_y * cos2 * cos2 * (1.0 + e) * (1.0 + e))
}

/// Λ(w) = (√(1 + α² tan²θ) − 1)/2 with α² = cos²φ α_x² + sin²φ α_y².
fn ggx_lambda(alpha_x: f64, alpha_y: f64, w: Dir) -> f64 {
    let sin2 = w.x * w.x + w.y * w.y;
    if sin2 == 0.0 {
        return 0.0;
    }
    let alpha2 = w.x * w.x / sin2 * alpha_x * alpha_x + w.y * w.y / sin2 * alpha_y * alpha_y;
    ((1.0 + alpha2 * sin2 / (w.z * w.z)).sqrt() - 1.0) / 2.0
}
