//! Domains with a meaning: what a number of a model says, and which values it may have.

use crate::real::Real;

/// What a number says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Role {
    /// Part of the light.
    Reflectance,
    /// A user's roughness.
    Roughness,
    /// Alpha of a distribution of microfacet normals.
    Alpha,
    /// An exponent of a cosine.
    Exponent,
    /// An index of refraction.
    Index,
    /// An extinction coefficient.
    Extinction,
    /// An angle.
    Angle,
    /// A factor on a lobe.
    Weight,
}

/// A domain with a meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Quantity {
    /// What it says.
    pub role: Role,
    /// The least value.
    pub lo: f64,
    /// The largest value.
    pub hi: f64,
    /// From where on steps of sweeps and plots are ratios; none if they are differences.
    pub log_from: Option<f64>,
    /// What it is in a lobe that absorbs nothing, if it says how much is absorbed.
    pub white: Option<f64>,
    /// Between which values plots show it.
    pub shown: [f64; 2],
    /// A usual value.
    pub typical: f64,
    /// "" for a pure number.
    pub unit: &'static str,
}

impl Quantity {
    /// A closed interval; plots show all of it.
    pub const fn new(role: Role, lo: f64, hi: f64) -> Self {
        Self { role, lo, hi, log_from: None, white: None, shown: [lo, hi], typical: 0.5 * (lo + hi), unit: "" }
    }
    /// The same, swept in ratios from `x` on.
    #[must_use]
    pub const fn log_from(self, x: f64) -> Self {
        Self { log_from: Some(x), ..self }
    }
    /// The same, with nothing absorbed at `x`.
    #[must_use]
    pub const fn white(self, x: f64) -> Self {
        Self { white: Some(x), ..self }
    }
    /// The same, shown by plots between these, and at `typical` where only one value is shown.
    #[must_use]
    pub const fn shown(self, lo: f64, hi: f64, typical: f64) -> Self {
        Self { shown: [lo, hi], typical, ..self }
    }

    /// Whether x lies in the interval. An end that is no `f32` (1e-8) may have been rounded out of it, by 1e-6 of itself.
    ///
    /// ```
    /// use gonio_kernel::model::ALPHA;
    /// assert!(ALPHA.contains(1e-8_f32) && !ALPHA.contains(0.0_f32) && !ALPHA.contains(f32::NAN));
    /// ```
    #[inline(always)]
    pub fn contains<R: Real>(self, x: R) -> R::Mask {
        let rounded = |end: f64, sign: f64| if f64::from(end as f32) == end { end } else { end * (1.0 + sign * 1e-6) };
        x.ge(R::lit(rounded(self.lo, -1.0))) & x.le(R::lit(rounded(self.hi, 1.0)))
    }

    /// x moved to the nearer end if it lies outside; NaN becomes the least value.
    #[inline(always)]
    pub fn clamp<R: Real>(self, x: R) -> R {
        x.clamp(self.lo, self.hi)
    }
}

/// The smallest width of microfacets: below, even `f64` directions are coarser than the lobe, and the surface is a mirror.
/// (In `f32` that is so below 1e-4: the lobe stays finite and its weights right, but its shape is that of the lattice.)
pub const ALPHA_MIN: f64 = 1e-8;

/// Part of the light, in \[0, 1\].
pub const REFLECTANCE: Quantity = Quantity::new(Role::Reflectance, 0.0, 1.0).white(1.0);
/// A factor on a lobe, in \[0, 1\].
pub const WEIGHT: Quantity = Quantity::new(Role::Weight, 0.0, 1.0);
/// A user's roughness, in \[0, 1\].
pub const ROUGHNESS: Quantity = Quantity::new(Role::Roughness, 0.0, 1.0);
/// A user's roughness of microfacets, whose square is alpha, in \[1e-4, 1\].
pub const MICROFACET_ROUGHNESS: Quantity = Quantity::new(Role::Roughness, 1e-4, 1.0);
/// Alpha of a distribution of microfacet normals, in \[1e-8, 1\].
pub const ALPHA: Quantity = Quantity::new(Role::Alpha, ALPHA_MIN, 1.0).log_from(1e-8).shown(1e-4, 1.0, 0.2);
/// Exponent of a cosine, in \[0, 1e7\].
pub const EXPONENT: Quantity = Quantity::new(Role::Exponent, 0.0, 1e7).log_from(1e-2).shown(1.0, 1e4, 30.0);
/// A relative index of refraction, in \[0.01, 100\].
pub const INDEX: Quantity = Quantity::new(Role::Index, 0.01, 100.0).log_from(0.01).shown(0.4, 2.5, 1.5);
/// The relative index of a coat, in \[1, 3\].
pub const COATING_INDEX: Quantity = Quantity::new(Role::Index, 1.0, 3.0).shown(1.0, 2.5, 1.5);
/// Alpha of a coat, in \[0, 1\]; 0 is smooth.
pub const COATING_ALPHA: Quantity = Quantity::new(Role::Alpha, 0.0, 1.0).shown(1e-4, 1.0, 0.2);
/// A user's roughness of a coat, in \[0, 1\]; 0 is smooth.
pub const COATING_ROUGHNESS: Quantity = Quantity::new(Role::Roughness, 0.0, 1.0).shown(0.0, 1.0, 0.1);
/// The real part of a conductor's index, in \[1e-4, 100\]. Without a real part everything is reflected: 1 − R = 4η/((η + 1)² + k²).
pub const ETA: Quantity = Quantity::new(Role::Index, 1e-4, 100.0).log_from(1e-4).white(1e-4).shown(0.1, 10.0, 0.2);
/// The imaginary part of a conductor's index, in \[0, 100\].
pub const EXTINCTION: Quantity =
    Quantity::new(Role::Extinction, 0.0, 100.0).log_from(1e-4).white(100.0).shown(0.1, 10.0, 3.0);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_a_domain_lie_in_it_in_every_precision() {
        for q in [REFLECTANCE, ROUGHNESS, MICROFACET_ROUGHNESS, ALPHA, EXPONENT, INDEX, COATING_INDEX, ETA, EXTINCTION]
        {
            for end in [q.lo, q.hi] {
                assert!(q.contains(end as f32) && q.contains(end), "{q:?}");
            }
            assert!(!q.contains((q.lo - 0.1) as f32) && !q.contains(q.hi * 1.001) && !q.contains(f64::NAN), "{q:?}");
            assert!(q.contains(q.clamp(f32::NAN)) && q.contains(q.clamp(1e30_f32)) && q.contains(q.clamp(-1.0_f64)));
        }
    }
}
