//! Fresnel's equations: which part of unpolarised light a smooth interface reflects.
//!
//! Cosines are those between the direction and the (micro)normal, on wo's side. Results lie in [0, 1].

use crate::real::Real;
use crate::rgb::Rgb;

/// Reflectance of an interface between two dielectrics, eta = η_t/η_i > 0 seen from wo's side, cos_o in [0, 1].
/// Born & Wolf, Principles of Optics, section 1.5: the mean of (r∥)² and (r⊥)². 1 beyond the critical angle.
#[inline(always)]
pub fn dielectric<R: Real>(cos_o: R, eta: R) -> R {
    let sin2_o = (R::ONE - cos_o) * (R::ONE + cos_o);
    let cos2_t = R::ONE - sin2_o / (eta * eta);
    let total = cos2_t.le(R::ZERO);
    let cos_t = cos2_t.max(R::ZERO).sqrt();
    let parallel = (eta * cos_o - cos_t) / (eta * cos_o + cos_t);
    let perpendicular = (cos_o - eta * cos_t) / (cos_o + eta * cos_t);
    R::select(total, R::ONE, (parallel.sqr() + perpendicular.sqr()) * R::lit(0.5))
}

/// Reflectance of a conductor of index η − ik seen from vacuum, for one wavelength or channel; cos_o in [0, 1], η > 0, k ≥ 0.
///
/// With a² + b² = |√((η − ik)² − sin²θ)|² and a its real part (Born & Wolf, section 14.2, in the real form of
/// Lazányi & Szirmay-Kalos 2005):
/// R⊥ = (a² + b² − 2a cosθ + cos²θ)/(a² + b² + 2a cosθ + cos²θ), R∥ = R⊥ · (same with sin²θ tan²θ).
#[inline(always)]
pub fn conductor<R: Real>(cos_o: R, eta: R, k: R) -> R {
    let cos2 = cos_o * cos_o;
    let sin2 = (R::ONE - cos_o) * (R::ONE + cos_o);
    let eta2 = eta * eta;
    let k2 = k * k;
    let t0 = eta2 - k2 - sin2;
    let a2b2 = t0.mul_add(t0, R::lit(4.0) * eta2 * k2).sqrt();
    // a² = (|…| + t0)/2 cancels where t0 < 0; there a² = 2η²k²/(|…| − t0) is the same without the subtraction.
    let sum = a2b2 + t0.abs();
    let small = R::lit(2.0) * eta2 * k2 / sum;
    let a2 = R::select(t0.lt(R::ZERO), small, sum * R::lit(0.5));
    let two_a_cos = R::lit(2.0) * a2.max(R::ZERO).sqrt() * cos_o;
    let p = a2b2 + cos2;
    let q = cos2.mul_add(a2b2, sin2 * sin2);
    let r = two_a_cos * sin2;
    // (R⊥ + R∥)/2 = R⊥ · ½(1 + (q − r)/(q + r)) = R⊥ · q/(q + r): one division for both polarisations.
    let reflectance = (p - two_a_cos) * q / ((p + two_a_cos) * (q + r));
    reflectance.max(R::ZERO).min(R::ONE)
}

/// Schlick's approximation: f0 + (1 − f0)(1 − cosθ)⁵. Schlick 1994, "An Inexpensive BRDF Model for Physically-based Rendering".
#[inline(always)]
pub fn schlick<R: Real>(cos_o: R, f0: R) -> R {
    let m = (R::ONE - cos_o).max(R::ZERO);
    let m2 = m * m;
    (R::ONE - f0).mul_add(m2 * m2 * m, f0)
}

/// What a reflecting interface is made of, per channel.
#[derive(Clone, Copy, Debug)]
pub enum Fresnel<R> {
    /// A conductor: index η in (0, 100], extinction k in [0, 100].
    Conductor {
        /// Index of refraction.
        eta: Rgb<R>,
        /// Extinction coefficient.
        k: Rgb<R>,
    },
    /// Schlick's curve through f0 in [0, 1].
    Schlick {
        /// Reflectance at normal incidence.
        f0: Rgb<R>,
    },
}

impl<R: Real> Fresnel<R> {
    /// The reflectance of each channel at cos_o in [0, 1].
    #[inline(always)]
    pub fn reflectance(&self, cos_o: R) -> Rgb<R> {
        match *self {
            Self::Conductor { eta, k } => Rgb::new(
                conductor(cos_o, eta.r, k.r),
                conductor(cos_o, eta.g, k.g),
                conductor(cos_o, eta.b, k.b),
            ),
            Self::Schlick { f0 } => f0.map(|f0| schlick(cos_o, f0)),
        }
    }

    /// Whether every parameter lies in its domain.
    #[inline(always)]
    pub fn domain(&self) -> R::Mask {
        match *self {
            Self::Conductor { eta, k } => eta.within(1e-4, 100.0) & k.within(0.0, 100.0),
            Self::Schlick { f0 } => f0.within(0.0, 1.0),
        }
    }
}
