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
    // a² = (|…| + t0)/2 cancels where t0 < 0; there a = ηk/s with s² = (|…| − t0)/2. Both are written a = n/w, and w is
    // multiplied through, so that one division serves both polarisations and both cases.
    let s = ((a2b2 + t0.abs()) * R::lit(0.5)).sqrt();
    let inside = t0.lt(R::ZERO);
    let n = R::select(inside, eta * k, s);
    let w = R::select(inside, s, R::ONE);
    let two_n_cos = R::lit(2.0) * n * cos_o;
    let p = (a2b2 + cos2) * w;
    let q = cos2.mul_add(a2b2, sin2 * sin2) * w;
    // (R⊥ + R∥)/2 = R⊥ · ½(1 + (q − r)/(q + r)) = R⊥ · q/(q + r)
    let reflectance = (p - two_n_cos) * q / ((p + two_n_cos) * two_n_cos.mul_add(sin2, q));
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
            Self::Conductor { eta, k } => {
                Rgb::new(conductor(cos_o, eta.r, k.r), conductor(cos_o, eta.g, k.g), conductor(cos_o, eta.b, k.b))
            }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::close;

    #[test]
    fn at_normal_incidence_glass_reflects_the_square_of_n_minus_1_over_n_plus_1() {
        assert!(close(dielectric(1.0, 1.5), 0.04, 1e-15));
        assert!(close(dielectric(1.0, 1.0 / 1.5), 0.04, 1e-15));
        assert_eq!(dielectric(0.7, 1.0), 0.0); // no interface, no reflection
    }

    #[test]
    fn at_brewsters_angle_only_perpendicular_light_is_reflected() {
        let n = 1.5_f64; // tan θ = n, where r∥ = 0 and r⊥ = (1 − n²)/(1 + n²)
        let cos = 1.0 / (1.0 + n * n).sqrt();
        let perpendicular = ((1.0 - n * n) / (1.0 + n * n)).powi(2);
        assert!(close(dielectric(cos, n), 0.5 * perpendicular, 1e-15));
    }

    #[test]
    fn beyond_the_critical_angle_everything_is_reflected() {
        let critical = (1.0 - 1.0 / (1.5_f64 * 1.5)).sqrt(); // sin θ = 1/1.5
        assert_eq!(dielectric(critical - 1e-6, 1.0 / 1.5), 1.0);
        assert_eq!(dielectric(0.0, 1.0 / 1.5), 1.0);
        let inside = dielectric(critical + 1e-6, 1.0 / 1.5);
        assert!(inside < 1.0 && inside > 0.95, "{inside}");
    }

    #[test]
    fn a_conductor_without_extinction_is_a_dielectric() {
        for eta in [0.5_f64, 0.9, 1.1, 1.5, 4.0] {
            for step in 0..=100 {
                let cos = f64::from(step) / 100.0;
                let (c, d) = (conductor(cos, eta, 0.0), dielectric(cos, eta));
                assert!(close(c, d, 1e-7), "eta {eta}, cos {cos}: {c} and {d}");
            }
        }
    }

    #[test]
    fn at_normal_incidence_silver_reflects_its_textbook_value() {
        let (eta, k) = (0.135_f64, 3.99);
        let textbook = ((eta - 1.0).powi(2) + k * k) / ((eta + 1.0).powi(2) + k * k);
        assert!(close(conductor(1.0, eta, k), textbook, 1e-14));
        assert!(close(conductor(1.0_f32, 0.135, 3.99).into(), textbook, 1e-6));
    }

    #[test]
    fn at_grazing_incidence_every_interface_is_a_mirror() {
        assert!(close(dielectric(0.0, 1.5), 1.0, 1e-15));
        assert!(close(conductor(0.0, 0.2, 3.9), 1.0, 1e-15));
        assert_eq!(schlick(0.0, 0.04), 1.0);
        assert_eq!(schlick(1.0, 0.04), 0.04);
    }

    /// Reflection from a conductor, in the complex form of the textbook.
    fn complex_conductor(cos: f64, eta: f64, k: f64) -> f64 {
        // u + iv = √((η + ik)² − sin²θ)
        let (re, im) = (eta * eta - k * k - (1.0 - cos * cos), 2.0 * eta * k);
        let (u, v) = {
            let u = ((re.hypot(im) + re.abs()) / 2.0).sqrt();
            if re >= 0.0 { (u, im / (2.0 * u)) } else { (im / (2.0 * u), u) }
        };
        let perpendicular = ((u - cos).powi(2) + v * v) / ((u + cos).powi(2) + v * v);
        // r∥ = r⊥ · (u + iv − sin θ tan θ)/(u + iv + sin θ tan θ)
        let st = (1.0 - cos * cos) / cos;
        let parallel = perpendicular * ((u - st).powi(2) + v * v) / ((u + st).powi(2) + v * v);
        0.5 * (perpendicular + parallel)
    }

    #[test]
    fn the_real_form_of_a_conductor_is_its_complex_form() {
        for (eta, k) in [(0.22, 3.68), (0.96, 2.59), (1.17, 2.46), (3.1, 0.01), (0.05, 0.3), (4.0, 20.0)] {
            for step in 1..=50 {
                let cos = step as f32 / 50.0;
                let exact = complex_conductor(cos.into(), eta, k);
                assert!(close(conductor(f64::from(cos), eta, k), exact, 1e-12), "eta {eta}, k {k}, cos {cos}");
                let (eta32, k32) = (eta as f32, k as f32);
                let exact = complex_conductor(cos.into(), eta32.into(), k32.into());
                assert!(close(conductor(cos, eta32, k32).into(), exact, 2e-6), "eta {eta}, k {k}, cos {cos} in f32");
            }
        }
    }
}
