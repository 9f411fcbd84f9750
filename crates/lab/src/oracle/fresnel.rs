//! Reflectance of smooth interfaces by the book: complex amplitudes, Snell's angles, and the curves that stand for them.

use gonio_kernel::Rgb;
use gonio_kernel::fresnel::Fresnel;

/// The reflectance of each channel; none for a material that this file does not know.
pub(super) fn reflectance(material: &Fresnel<f64>, cos: f64) -> Option<[f64; 3]> {
    let by_channel =
        |a: Rgb<f64>, b: Rgb<f64>, f: fn(f64, f64, f64) -> f64| [f(cos, a.r, b.r), f(cos, a.g, b.g), f(cos, a.b, b.b)];
    match *material {
        Fresnel::Conductor { eta, k } => Some(by_channel(eta, k, conductor)),
        Fresnel::Schlick { f0 } => Some(by_channel(f0, f0, |cos, f0, _| schlick(cos, f0))),
        Fresnel::F82 { f0, tint } => Some(by_channel(f0, tint, f82)),
        Fresnel::Dielectric { eta } => Some([dielectric(cos, eta); 3]),
        _ => None,
    }
}

fn schlick(cos: f64, f0: f64) -> f64 {
    f0 + (1.0 - f0) * (1.0 - cos).powi(5)
}

/// Schlick's curve less a cosθ (1 − cosθ)⁶, with a such that the curve is tint times Schlick's at cosθ = 1/7.
fn f82(cos: f64, f0: f64, tint: f64) -> f64 {
    let bell = |cos: f64| cos * (1.0 - cos).powi(6);
    let at = 1.0 / 7.0;
    (schlick(cos, f0) - (1.0 - tint) * schlick(at, f0) * bell(cos) / bell(at)).max(0.0)
}

type Complex = [f64; 2];

fn times(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}
fn norm2(a: Complex) -> f64 {
    a[0] * a[0] + a[1] * a[1]
}
/// The root with non-negative real part, by polar angles.
fn root(a: Complex) -> Complex {
    let (r, phi) = (norm2(a).sqrt().sqrt(), 0.5 * a[1].atan2(a[0]));
    [r * phi.cos(), r * phi.sin()]
}

/// Fresnel's reflectance of an interface of complex index n = η − ik, unpolarised: amplitudes
/// r⊥ = (cosθ − s)/(cosθ + s), r∥ = (n² cosθ − s)/(n² cosθ + s), s = √(n² − sin²θ).
pub(crate) fn conductor(cos: f64, eta: f64, k: f64) -> f64 {
    let n2 = times([eta, -k], [eta, -k]);
    let s = root([n2[0] - (1.0 - cos * cos), n2[1]]);
    let n2_cos = n2.map(|x| x * cos);
    let ratio = |a: Complex| norm2([a[0] - s[0], a[1] - s[1]]) / norm2([a[0] + s[0], a[1] + s[1]]);
    0.5 * (ratio([cos, 0.0]) + ratio(n2_cos))
}

/// Fresnel's reflectance between dielectrics by Snell's angles: r⊥ = −sin(θ − θ′)/sin(θ + θ′), r∥ = tan(θ − θ′)/tan(θ + θ′).
pub(crate) fn dielectric(cos: f64, eta: f64) -> f64 {
    let theta = cos.min(1.0).acos(); // a product of two unit vectors may exceed 1 by rounding
    let sin_t = theta.sin() / eta;
    if sin_t >= 1.0 {
        return 1.0;
    }
    if theta < 1e-6 {
        return ((eta - 1.0) / (eta + 1.0)).powi(2);
    }
    let theta_t = sin_t.asin();
    let (minus, plus) = (theta - theta_t, theta + theta_t);
    0.5 * ((minus.sin() / plus.sin()).powi(2) + (minus.tan() / plus.tan()).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_printed_values() {
        // Glass of 1.5 reflects 4 % straight on and nothing polarised in the plane at Brewster's angle, where the rest is
        // ½(η² − 1)²/(η² + 1)²; a perfect dielectric limit of the conductor is the same curve.
        assert!((dielectric(1.0, 1.5) - 0.04).abs() < 1e-12);
        let brewster = 1.5_f64.atan().cos();
        let rest = 0.5 * (1.25_f64 / 3.25).powi(2);
        assert!((dielectric(brewster, 1.5) - rest).abs() < 1e-12);
        assert!((conductor(brewster, 1.5, 0.0) - rest).abs() < 1e-12);
        // ((η − 1)² + k²)/((η + 1)² + k²) at normal incidence.
        assert!((conductor(1.0, 0.2, 3.0) - (0.64 + 9.0) / (1.44 + 9.0)).abs() < 1e-12);
    }
}
