//! Warps: uniform random numbers in [0, 1)² to points and directions, each with its density beneath it.
//!
//! All are closed forms. Random numbers must be below 1 (the tracer's and the lab's are at most 1 − 2⁻²⁴).

use crate::math::sin_cos_turns;
use crate::real::Real;
use crate::vec3::Vec3;

/// Cosine-weighted direction about +z, by Malley's method: a uniform point of the unit disk, lifted.
/// z = √(1 − u₀) > 0, so no sample lies in the horizon.
#[inline(always)]
pub fn sample_cosine_hemisphere<R: Real>(u: [R; 2]) -> Vec3<R> {
    let (sin, cos) = sin_cos_turns(u[1]);
    let r = u[0].sqrt();
    Vec3::new(r * cos, r * sin, (R::ONE - u[0]).sqrt())
}

/// Density of [`sample_cosine_hemisphere`] \[1/sr\]: cosθ/π above the horizon, 0 elsewhere.
#[inline(always)]
pub fn pdf_cosine_hemisphere<R: Real>(w: Vec3<R>) -> R {
    w.z.max(R::ZERO) * R::lit(core::f64::consts::FRAC_1_PI)
}

/// Uniform direction over the sphere.
#[inline(always)]
pub fn sample_uniform_sphere<R: Real>(u: [R; 2]) -> Vec3<R> {
    let (sin, cos) = sin_cos_turns(u[1]);
    // z = 1 − 2u and sin²θ = 4u(1 − u): the second form does not cancel at the poles.
    let r = (R::lit(4.0) * u[0] * (R::ONE - u[0])).sqrt();
    Vec3::new(r * cos, r * sin, u[0].mul_add(R::lit(-2.0), R::ONE))
}

/// Density of [`sample_uniform_sphere`] \[1/sr\]: 1/4π.
#[inline(always)]
pub fn pdf_uniform_sphere<R: Real>() -> R {
    R::lit(0.25 * core::f64::consts::FRAC_1_PI)
}

/// Barycentric coordinates (b₁, b₂) of a uniform point of a triangle; b₀ = 1 − b₁ − b₂.
/// Heitz 2019, "A Low-Distortion Map Between Triangle and Square".
#[inline(always)]
pub fn sample_uniform_triangle<R: Real>(u: [R; 2]) -> [R; 2] {
    let half = R::lit(0.5);
    let below = u[0].lt(u[1]);
    let b1 = R::select(below, u[0] * half, u[0] - u[1] * half);
    let b2 = R::select(below, u[1] - u[0] * half, u[1] * half);
    [b1, b2]
}

/// Density of [`sample_uniform_triangle`] with respect to (b₁, b₂): 2, that is 1/area in space.
#[inline(always)]
pub fn pdf_uniform_triangle<R: Real>() -> R {
    R::lit(2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, close};

    #[test]
    fn the_corners_of_the_square_go_where_the_formulas_say() {
        assert_eq!(sample_cosine_hemisphere([0.0_f32, 0.3]), Vec3::unit_z());
        assert_eq!(sample_uniform_sphere([0.0_f32, 0.3]), Vec3::unit_z());
        let below_one = 1.0 - f32::EPSILON / 2.0;
        assert!(sample_cosine_hemisphere([below_one, below_one]).z > 0.0);
    }

    #[test]
    fn sampled_directions_are_unit_and_their_means_are_known() {
        let (mut random, count) = (Random(13), 100_000);
        let (mut cosine, mut sphere, mut triangle) = (0.0, 0.0, 0.0);
        for _ in 0..count {
            let u = [random.unit(), random.unit()];
            let (c, s, [b1, b2]) = (sample_cosine_hemisphere(u), sample_uniform_sphere(u), sample_uniform_triangle(u));
            assert!(close(c.length().into(), 1.0, 1e-6) && close(s.length().into(), 1.0, 1e-6) && c.z > 0.0);
            assert!(b1 >= 0.0 && b2 >= 0.0 && b1 + b2 <= 1.0);
            cosine += f64::from(c.z);
            sphere += f64::from(s.z);
            triangle += f64::from(b1);
        }
        // E[cosθ] is 2/3, 0 and E[b₁] is 1/3, with standard errors of at most 0.577/√count.
        let error = 5.0 * 0.577 / f64::from(count).sqrt();
        for (sum, mean) in [(cosine, 2.0 / 3.0), (sphere, 0.0), (triangle, 1.0 / 3.0)] {
            assert!(close(sum / f64::from(count), mean, error), "{sum} {mean}");
        }
    }
}
