//! The random walk on a slab: a dielectric coat over a diffuse base, every bounce between them followed.
//!
//! The stack is an interface (smooth, or rough as Walter et al. 2007 have it), nothing absorbing below it, and a Lambertian base.
//! Light that enters is scattered by the base and leaves through the interface or is reflected down again, as often as it takes.
//! This is the truth for layers that scale the base by what enters and leaves (`gonio_kernel::lobe::Layer`): they conserve energy
//! over a white base, and are brighter and less saturated than it over a coloured one, because the second and later reflections of
//! the base colour the light again.
//!
//! The interface of the walk scatters once per crossing, so a rough one loses light; that share is counted and reported, and a walk
//! through a rough interface is compared relative to what it does not lose.

use crate::random::{Random, direction};
use gonio_kernel::closure::Unguarded;
use gonio_kernel::lobe::{AnyLobe, Dielectric, RoughDielectric};
use gonio_kernel::microfacet::Ggx;
use gonio_kernel::warp::sample_cosine_hemisphere;
use gonio_kernel::{Rgb, Transport, Vec3};

/// A coat of index eta over a diffuse base.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slab {
    /// Index of the coat over that of the outside.
    pub(crate) eta: f64,
    /// Alpha of the interface; smooth if 0.
    pub(crate) alpha: f64,
    /// Albedo of the base.
    pub(crate) base: Rgb<f64>,
}

/// What became of the light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Returned {
    /// The directional albedo.
    pub(crate) albedo: Rgb<f64>,
    /// The standard error of the mean of its green channel.
    pub(crate) error: f64,
    /// The share of the light that the interface lost between facets, weighted as it was when it was lost.
    pub(crate) lost: f64,
}

/// Reflections of the base after which a walk is cut: with the densest coat 0.85 is reflected down again, 0.85²⁰⁰ is nothing.
const LONGEST: usize = 200;

impl Slab {
    fn interface(&self) -> AnyLobe<'static, f64> {
        if self.alpha > 0.0 {
            RoughDielectric::new(Ggx::isotropic(self.alpha), self.eta).into()
        } else {
            Dielectric::new(self.eta).into()
        }
    }

    /// What returns of light that arrives at that cosine, by so many walks.
    pub(crate) fn walk(&self, cos: f64, walks: usize, random: &mut Random) -> Returned {
        let interface = self.interface();
        let (mut sum, mut square, mut lost) = (Rgb::zero(), 0.0, 0.0);
        for _ in 0..walks {
            let (weight, missed) = self.one(&interface, direction(cos, 0.4), random);
            sum += weight;
            square += weight.g * weight.g;
            lost += missed;
        }
        let n = walks as f64;
        let albedo = sum * (1.0 / n);
        let error = ((square / n - albedo.g * albedo.g).max(0.0) / n).sqrt();
        Returned { albedo, error, lost: lost / n }
    }

    /// The weight with which one walk leaves upwards, and the green weight that its crossings lost.
    fn one(&self, interface: &AnyLobe<'static, f64>, from: Vec3<f64>, random: &mut Random) -> (Rgb<f64>, f64) {
        let (mut weight, mut lost) = (Rgb::splat(1.0), 0.0);
        // `wo` points against the ray: the side from which it meets the interface.
        let mut wo = from;
        for _ in 0..LONGEST {
            // Energy, not radiance: what crosses is not scaled.
            let at = Unguarded::new(interface, wo, Transport::Importance);
            let sample = at.sample([random.uniform(), random.uniform(), random.uniform()]);
            if sample.event.failed {
                return (Rgb::zero(), lost + weight.g);
            }
            let value = if sample.event.is_delta { at.delta(&sample) } else { at.eval(sample.wi) };
            let kept = value.f_cos.g / value.pdf;
            lost += weight.g * (1.0 - kept);
            weight *= kept;
            if sample.wi.z > 0.0 {
                return (weight, lost);
            }
            // Down to the base, and up again, cosine-distributed, whatever the direction was.
            weight *= self.base;
            let up = sample_cosine_hemisphere([random.uniform(), random.uniform()]);
            wo = -up;
        }
        (Rgb::zero(), lost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn over_a_white_base_a_smooth_coat_loses_nothing() {
        let mut random = Random::new(51);
        for (eta, cos) in [(1.1, 0.9), (1.5, 0.1), (2.5, 0.5)] {
            let slab = Slab { eta, alpha: 0.0, base: Rgb::splat(1.0) };
            let returned = slab.walk(cos, 20_000, &mut random);
            assert!((returned.albedo.g - 1.0).abs() < 1e-9 && returned.lost.abs() < 1e-9, "{eta} {cos}: {returned:?}");
        }
    }

    #[test]
    fn over_a_grey_base_a_smooth_coat_returns_the_geometric_series() {
        // F + (1 − F)(1 − F_i) ρ/(1 − F_i ρ), F_i = 1 − (1 − F_avg)/η² the diffuse reflectance from within (Saunderson 1942).
        let (eta, rho, mut random) = (1.5_f64, 0.5, Random::new(52));
        let f = ((eta - 1.0) / (eta + 1.0)).powi(2);
        let steps = 20_000;
        let mean: f64 = (0..steps)
            .map(|i| {
                let mu = (f64::from(i) + 0.5) / f64::from(steps);
                2.0 * mu * gonio_kernel::fresnel::dielectric(mu, eta) / f64::from(steps)
            })
            .sum();
        let inner = 1.0 - (1.0 - mean) / (eta * eta);
        let truth = f + (1.0 - f) * (1.0 - inner) * rho / (1.0 - inner * rho);
        let returned = Slab { eta, alpha: 0.0, base: Rgb::splat(rho) }.walk(1.0, 200_000, &mut random);
        // Five standard errors: one test in 1.7 million fails by chance.
        assert!((returned.albedo.g - truth).abs() < 5.0 * returned.error, "{returned:?} and {truth}");
    }
}
