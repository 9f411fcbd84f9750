//! The light that single scattering loses between microfacets, and two ways to give it back.
//!
//! A microfacet model that follows light to the first facet only loses what meets a second one: at $\alpha = 1$ up to 69 % of
//! it. What is missing is known. Let $E(\mu)$ be the directional albedo of the isotropic GGX reflector with $F = 1$ and Smith's
//! height-correlated masking, $f = D G_2/(4\mu_o\mu_i)$, and $E_{avg} = 2\int_0^1 E(\mu)\\,\mu\\,d\mu$ its cosine mean.
//!
//! - [`kulla_conty`] adds a lobe, wide and reciprocal, which holds exactly what is missing
//!   (Kulla & Conty 2017, "Revisiting Physically Based Shading at Imageworks", after Kelemen & Szirmay-Kalos 2001):
//!   $$f_{ms} = F_{ms}\\,\frac{(1 - E(\mu_o))(1 - E(\mu_i))}{\pi(1 - E_{avg})}.$$
//!   Light that is scattered more than once is coloured more than once: [`multiple_fresnel`], by facets met at
//!   [`facet_cosines`]. Against the random walk (the instrument `walk`) the total of metals is right to 2 %.
//! - [`turquin`] scales the single scattering up (Turquin 2019, "Practical multiple scattering compensation for microfacet
//!   models"): one factor, no further lobe, no reciprocity.
//!
//! **How $1 - E$ is computed.** No grid: lanes cannot gather, and interpolation would be coarse where it matters. A factor
//! holds the boundary layer at grazing, whose width is α, and the growth with α,
//! $$1 - E = \frac{4\mu\alpha^2(1 + 12\alpha^2)}{(\mu + \alpha)(\mu + 4\alpha)^2}\\,P(v, w), \qquad
//!   v^4 = \frac{\mu(1 + 12\alpha)}{\mu + 12\alpha}, \quad w = \frac{5\alpha}{1 + 4\alpha},$$
//! and leaves a P between 0.16 and 5.2, whose logarithm a tensor of Chebyshev polynomials follows on the unit square, to which
//! v and w stretch all that there is of μ and α. Because 1 − E is what is approximated, it is positive however small it is. Its mean is
//! $1 - E_{avg} = \alpha^2 \ln(1 + 0.218/\alpha)\\,Q(\sqrt\alpha)$, the logarithm being that of GGX's long tail.
//!
//! In `f32` a logarithm's absolute error is the result's relative one, so the polynomials are summed from the nearer end of
//! their interval, and what is small there, 1 − v or 1 − w, is computed and not left over: 1 − E is right to 6 units of the
//! last place, half of the time to one.
//!
//! The coefficients are those of [`TABLE`], made by `cargo xtask tables`, which prints their error into `energy/tables.rs`:
//! below 6e-5 for α in \[1e-8, 1\] and μ in (0, 1\]. $1 - E_{avg}$ is fitted to the integral of the approximation itself, not of
//! the truth, so that a white compensated reflector returns $E_{true} + (1 - E)$: all light, but for the error of $E$.
//!
//! **Anisotropy.** For $\alpha_x \ne \alpha_y$ there is no more than an effective width, [`effective_alpha`], and what it leaves.

pub mod albedo;
mod coefficients;
mod tables;

pub use albedo::AlbedoCurve;
pub use coefficients::{MEAN, Table, V, W};
pub use tables::{ALBEDO, TABLE};

use crate::math::{exp, exp_m1, ln_1p, sin_cos_turns};
use crate::real::Real;
use crate::vec3::Vec3;

crate::choice! {
    /// What becomes of light that meets more than one facet.
    pub enum Compensation {
        /// It is lost.
        None = "none",
        /// It comes back as a wide lobe of its own: [`kulla_conty`]. Reciprocal.
        KullaConty = "kulla-conty",
        /// It makes the lobe brighter: [`turquin`]. Not reciprocal.
        Turquin = "turquin",
    }
}

impl Table {
    /// See [`Missing::of`].
    #[inline(always)]
    pub fn missing<R: Real>(&self, alpha: R) -> Missing<R> {
        let r = R::lit(4.0).mul_add(alpha, R::ONE).recip();
        let w = Within::new(R::lit(5.0) * alpha * r, (R::ONE - alpha) * r);
        Missing { alpha, in_v: self.missing.map(|row| chebyshev(w, &row.map(R::lit))) }
    }

    /// See [`missing_avg`].
    #[inline(always)]
    pub fn missing_avg<R: Real>(&self, alpha: R) -> R {
        let root = alpha.sqrt();
        let q = chebyshev(Within::new(root, R::ONE - root), &self.missing_avg.map(R::lit));
        (alpha * alpha) * (ln_1p(R::lit(0.218) / alpha) * q)
    }
}

/// 1 − E as a function of the angle, at one width. The polynomial in w is done once for wo and wi.
#[derive(Clone, Copy, Debug)]
pub struct Missing<R> {
    alpha: R,
    in_v: [R; V],
}

impl<R: Real> Missing<R> {
    /// What a surface of width alpha in \[1e-8, 1\] loses.
    #[inline(always)]
    pub fn of(alpha: R) -> Self {
        TABLE.missing(alpha)
    }

    /// 1 − E(cos), in \[0, 1\], for cos in (0, 1\]. Three divisions, two square roots, one exponential.
    #[inline(always)]
    pub fn at(&self, cos: R) -> R {
        let alpha = self.alpha;
        let wide = R::lit(12.0) * alpha;
        let r = (cos + wide).recip();
        let v = (cos * (R::ONE + wide) * r).sqrt().sqrt();
        // 1 − v⁴ = 12α(1 − μ)/(μ + 12α) is a product, and so is 1 − v.
        let rest = wide * (R::ONE - cos) * r / ((R::ONE + v) * v.mul_add(v, R::ONE));
        let p = exp(chebyshev(Within::new(v, rest), &self.in_v));
        let far = R::lit(4.0).mul_add(alpha, cos);
        let scale = ((cos + alpha) * (far * far)).recip();
        let alpha2 = alpha * alpha;
        // cos·scale first: the product of the numerators would underflow for narrow lobes.
        R::lit(4.0) * (cos * scale) * (alpha2 * R::lit(12.0).mul_add(alpha2, R::ONE)) * p
    }
}

/// A point of the unit interval by its distance to the nearer end.
#[derive(Clone, Copy, Debug)]
struct Within<R> {
    near: R,
    /// 1 at the upper end, −1 at the lower.
    end: R,
}

impl<R: Real> Within<R> {
    /// The point x in \[0, 1\], with 1 − x given.
    #[inline(always)]
    fn new(x: R, rest: R) -> Self {
        let low = x.lt(rest);
        Self { near: R::select(low, x, rest), end: R::select(low, -R::ONE, R::ONE) }
    }
}

/// Σ c_k T_k(2x − 1), by Reinsch's form of Clenshaw's recurrence (Gentleman 1969, "An error analysis of Goertzel's (Watt's)
/// method"): about the nearer end t = ±1 of \[−1, 1\] it adds (t ∓ 1) b instead of subtracting nearly equal numbers.
#[inline(always)]
fn chebyshev<R: Real, const N: usize>(x: Within<R>, coefficients: &[R; N]) -> R {
    let [constant, rest @ ..] = &coefficients[..] else { return R::ZERO };
    let half = R::lit(-2.0) * x.near * x.end;
    let step = half + half;
    let (mut d, mut b) = (R::ZERO, R::ZERO);
    for &c in rest.iter().rev() {
        d = step.mul_add(b, x.end.mul_add(d, c));
        b = x.end.mul_add(b, d);
    }
    *constant + half.mul_add(b, x.end * d)
}

/// 1 − E_avg: the part of uniform light that a white surface of width alpha in \[1e-8, 1\] loses. One logarithm.
#[inline(always)]
pub fn missing_avg<R: Real>(alpha: R) -> R {
    TABLE.missing_avg(alpha)
}

/// E(cos): the directional albedo of white GGX, for cos in (0, 1\] and alpha in \[1e-8, 1\]. Error below 6e-5.
#[inline(always)]
pub fn albedo<R: Real>(cos: R, alpha: R) -> R {
    R::ONE - Missing::of(alpha).at(cos)
}

/// E_avg: the cosine mean of [`albedo()`].
#[inline(always)]
pub fn albedo_avg<R: Real>(alpha: R) -> R {
    R::ONE - missing_avg(alpha)
}

/// F_ms: what becomes of the light that is scattered more than once, one channel, from the mean reflectance f of the facets it
/// meets and the probability `again` to meet a further one after the second: f² (1 − again)/(1 − f · again), in \[0, 1\]; 1 for
/// f = 1. A geometric series.
///
/// With `again` = 1 − E_avg and f = F_avg = 2∫F(μ)μ dμ this is Kulla & Conty's, with F_avg² where their slides have F_avg
/// (Hoffman 2019). Neither is what the random walk of Heitz et al. 2016 finds: [`scattered_again`], [`facet_cosines`].
#[inline(always)]
pub fn multiple_fresnel<R: Real>(f: R, again: R) -> R {
    f * f * (R::ONE - again) / (R::ONE - f * again)
}

/// How likely light that met two facets meets a further one, for [`multiple_fresnel`], from 1 − E at wo and wi and its mean.
///
/// Kulla & Conty take 1 − E_avg, but the second facet lies higher than the first: the random walk finds about 0.45 α over
/// all directions, in proportion to the losses of both. Symmetric in wo and wi, so f_ms stays reciprocal. Fitted to grey
/// reflectances of 0.2, 0.5 and 0.8 together with what [`facet_cosines`] is fitted to: they alone are right to 1.3 % of the total.
#[inline(always)]
pub fn scattered_again<R: Real>(alpha: R, missing_o: R, missing_i: R, missing_avg: R) -> R {
    (R::lit(0.68) * missing_i * (missing_o / missing_avg)).min(R::lit(0.545) * alpha)
}

/// At which cosines light from wo to wi meets the facets that scatter it more than once: half of them at either of the two
/// that are returned, both in (0, 1\], the greater first. F of [`multiple_fresnel`] is the mean of F there.
///
/// Light that comes in near the horizon meets facets near grazing, where all reflect more than their average says, unless the
/// surface is so wide that every facet is possible. In the random walk the cosine at the first facet of two is a function of
/// μ_o and α alone, and that at the second the same function of μ_i: about proportional to the cosine where that is
/// greater than α, and to α where it is not. So the cosine here is the geometric mean of 0.77 μ + 0.56 α at either end, symmetric
/// in wo and wi. It takes a second point, 0.43 of the first, to follow the bend of F where cosines scatter.
///
/// The four constants and the two of [`scattered_again`] were fitted to walks of 10⁶ photons for nine widths from 0.01 to 1,
/// eight cosines from 0.02 to 0.98, and the channels of five metals, seven other conductors, eight curves of Schlick's and five
/// of [`crate::fresnel::f82`]. Of the total albedo the five metals are right to 1.5 %, at
/// six other widths and eight other cosines as well, where fourteen metals that took no part in the fit are right to 1.9 %. Other
/// curves at most 2.7 % off: reflection that does not absorb (k = 0); 3.3 % off: a curve that its tint halves at 82° from 0.95.
#[inline(always)]
pub fn facet_cosines<R: Real>(alpha: R, cos_o: R, cos_i: R) -> [R; 2] {
    let wide = R::lit(0.56) * alpha;
    let end = |cos: R| R::lit(0.77).mul_add(cos, wide);
    let cos = (end(cos_o) * end(cos_i)).sqrt().min(R::ONE);
    [cos, R::lit(0.43) * cos]
}

/// f_ms \[1/sr\] from 1 − E at wo and wi, their mean and F_ms, as of [`Missing::at`], [`missing_avg`], [`multiple_fresnel`].
#[inline(always)]
pub fn kulla_conty<R: Real>(missing_o: R, missing_i: R, missing_avg: R, f_ms: R) -> R {
    // (missing_o/missing_avg) first: the product of the numerators would underflow for narrow lobes.
    f_ms * missing_i * (missing_o / missing_avg) * R::lit(core::f64::consts::FRAC_1_PI)
}

/// A direction as light leaves that was scattered more than once: about even in the logarithm of μ + 4α, as 1 − E is.
#[inline(always)]
pub fn sample_multiple<R: Real>(alpha: R, u: [R; 2]) -> Vec3<R> {
    let a = R::lit(4.0) * alpha;
    let cos = (a * exp_m1(u[0] * ln_1p(a.recip()))).min(R::ONE);
    let sin = ((R::ONE - cos) * (R::ONE + cos)).max(R::ZERO).sqrt();
    let (sin_phi, cos_phi) = sin_cos_turns(u[1]);
    Vec3::new(sin * cos_phi, sin * sin_phi, cos)
}

/// Density of [`sample_multiple`] \[1/sr\] at a cosine in (0, 1\]: 1/(2π (μ + 4α) ln(1 + 1/(4α))).
#[inline(always)]
pub fn pdf_multiple<R: Real>(alpha: R, cos: R) -> R {
    let a = R::lit(4.0) * alpha;
    R::lit(0.5 * core::f64::consts::FRAC_1_PI) / ((cos + a) * ln_1p(a.recip()))
}

/// The width whose isotropic losses stand for those of an anisotropic surface: √(α_x α_y), which keeps the area of the lobe.
///
/// An approximation, and the light that comes back is no longer all. Measured over nine cosines from 0.01 to 1 and seven
/// azimuths, the total albedo of a white surface compensated by Kulla & Conty lies within
/// \[0.88, 1.03\] for 0.5 × 1, \[0.82, 1.02\] for 0.3 × 0.9, \[0.90, 1.04\] for 0.03 × 0.3, \[0.65, 1.00\] for 0.1 × 1 and
/// \[0.54, 1.01\] for 0.01 × 1; the least is met at grazing along the wide axis. Tried and worse: the root mean square width
/// and the mean (up to 7 and 5 % too bright), the larger width (23 %), and the width projected on the direction's azimuth
/// (23 %, because the light's second half of the way does not keep that azimuth).
#[inline(always)]
pub fn effective_alpha<R: Real>(alpha_x: R, alpha_y: R) -> R {
    (alpha_x * alpha_y).sqrt()
}

/// Turquin's factor for single scattering of one channel, 1 + f0 (1/E(wo) − 1), from 1 − E at wo and the reflectance f0 at
/// normal incidence. At least 1; depends on wo alone, so what it multiplies is not reciprocal.
#[inline(always)]
pub fn turquin<R: Real>(f0: R, missing_o: R) -> R {
    f0.mul_add(missing_o / (R::ONE - missing_o), R::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, close};

    #[test]
    fn a_surface_of_width_one_seen_along_its_normal_loses_the_logarithm_of_two() {
        assert!(close(albedo(1.0, 1.0), 1.0 - core::f64::consts::LN_2, 6e-5));
        assert!(close(albedo(1.0_f32, 1.0).into(), 1.0 - core::f64::consts::LN_2, 6e-5));
    }

    #[test]
    fn a_smooth_surface_loses_nothing_and_grazing_light_is_not_lost_either() {
        for alpha in [1e-8_f32, 1e-4, 1e-2] {
            assert!(missing_avg(alpha) > 0.0 && missing_avg(alpha) <= 40.0 * alpha * alpha);
            assert!(Missing::of(alpha).at(1.0) <= 2.0 * alpha * alpha);
        }
        for alpha in [1e-8_f32, 1e-4, 1.0] {
            for cos in [1e-38_f32, 1e-30, 1e-20] {
                let missing = Missing::of(alpha).at(cos);
                assert!((0.0..1e-5).contains(&missing), "{alpha} {cos} {missing}");
            }
        }
    }

    #[test]
    fn what_is_added_to_a_white_surface_is_what_it_lost() {
        // ∫ f_ms μ dω = 2∫(1 − E)μ dμ · (1 − E(wo))/(1 − E_avg), by midpoints in √μ, which crowd towards grazing.
        for alpha in [0.03_f64, 0.1, 0.3, 0.7, 1.0] {
            let (missing, mean) = (Missing::of(alpha), missing_avg(alpha));
            let count = 4000;
            let mut sum = 0.0;
            for i in 0..count {
                let t = (f64::from(i) + 0.5) / f64::from(count);
                let cos = t * t;
                let f = kulla_conty(missing.at(0.5), missing.at(cos), mean, multiple_fresnel(1.0, mean));
                sum += core::f64::consts::TAU * f * cos * 2.0 * t / f64::from(count);
            }
            assert!(close(sum / missing.at(0.5), 1.0, 3e-4), "{alpha}: {sum}");
        }
    }

    #[test]
    fn single_precision_loses_few_units_of_the_last_place() {
        let mut random = Random(71);
        for _ in 0..20_000 {
            let alpha = 10.0_f32.powf(-8.0 * random.unit());
            let cos = if random.unit() < 0.5 { 1.0 - random.unit() } else { 10.0_f32.powf(-10.0 * random.unit()) };
            let (single, double) = (Missing::of(alpha).at(cos), Missing::of(f64::from(alpha)).at(cos.into()));
            assert!(
                (0.0..1.0).contains(&single) && close((f64::from(single) - double) / double, 0.0, 1e-6),
                "{alpha} {cos}"
            );
            let (single, double) = (missing_avg(alpha), missing_avg(f64::from(alpha)));
            assert!(close((f64::from(single) - double) / double, 0.0, 5e-7), "{alpha}");
        }
    }

    #[test]
    fn turquin_returns_all_light_of_a_white_surface_and_multiple_fresnel_that_of_a_white_metal() {
        for alpha in [0.1_f64, 0.5, 1.0] {
            let missing = Missing::of(alpha).at(0.7);
            assert!(close((1.0 - missing) * turquin(1.0, missing), 1.0, 1e-14));
            assert_eq!(turquin(0.0, missing), 1.0);
            assert!(close(multiple_fresnel(1.0, missing_avg(alpha)), 1.0, 1e-14));
            assert_eq!(multiple_fresnel(0.0, missing_avg(alpha)), 0.0);
        }
    }

    #[test]
    fn polynomials_are_as_good_at_either_end() {
        // T_k(t) = cos(k arccos t), with x given by its distance to the end.
        let coefficients = [0.3, -0.7, 0.2, 0.4, -0.1];
        for near in [1e-12_f64, 1e-3, 0.2, 0.5] {
            for end in [-1.0, 1.0] {
                let angle = 2.0 * near.sqrt().asin();
                let angle = if end > 0.0 { angle } else { core::f64::consts::PI - angle };
                let sum: f64 = (0..5).map(|k| coefficients[k] * (k as f64 * angle).cos()).sum();
                assert!(close(chebyshev(Within { near, end }, &coefficients), sum, 1e-15), "{near} {end}");
            }
        }
    }

    #[test]
    fn light_meets_facets_at_grazing_where_it_comes_in_at_grazing_unless_the_surface_is_wide() {
        let [narrow, wide] = [1e-3_f64, 1.0].map(|alpha| facet_cosines(alpha, 0.01, 0.02));
        assert!(narrow[0] < 0.02 && wide[0] > 0.5, "{narrow:?} {wide:?}");
        for alpha in [1e-8_f32, 0.1, 1.0] {
            for (o, i) in [(1e-38_f32, 1e-38_f32), (1e-38, 1.0), (0.3, 0.7), (1.0, 1.0)] {
                let there = facet_cosines(alpha, o, i);
                assert_eq!(there, facet_cosines(alpha, i, o));
                assert!(there.iter().all(|cos| *cos > 0.0 && *cos <= 1.0), "{alpha} {o} {i}: {there:?}");
            }
        }
    }
}
