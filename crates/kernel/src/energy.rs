//! The light that single scattering loses between microfacets, and two ways to give it back.
//!
//! A microfacet model that follows light to the first facet only loses what meets a second one: at $\alpha = 1$ up to 69 % of
//! it. What is missing is known. Let $E(\mu)$ be the directional albedo of the isotropic GGX reflector with $F = 1$ and Smith's
//! height-correlated masking, $f = D G_2/(4\mu_o\mu_i)$, and $E_{avg} = 2\int_0^1 E(\mu)\,\mu\,d\mu$ its cosine mean.
//!
//! - [`kulla_conty`] adds a lobe, wide and reciprocal, which holds exactly what is missing
//!   (Kulla & Conty 2017, "Revisiting Physically Based Shading at Imageworks", after Kelemen & Szirmay-Kalos 2001):
//!   $$f_{ms} = F_{ms}\,\frac{(1 - E(\mu_o))(1 - E(\mu_i))}{\pi(1 - E_{avg})}.$$
//!   Light that is scattered more than once is coloured more than once: [`multiple_fresnel`]. Against the random walk (the
//!   instrument `walk`) the total of coloured metals is right to 2 % (with [`scattered_again`]), to 6 % for channels that
//!   reflect less than half and at grazing.
//! - [`turquin`] scales the single scattering up (Turquin 2019, "Practical multiple scattering compensation for microfacet
//!   models"): one factor, no further lobe, no reciprocity.
//!
//! **How $1 - E$ is computed.** No grid: lanes cannot gather, and interpolation would be coarse where it matters. With
//! $x = \mu/(\mu + 4\alpha)$ the boundary layer at grazing, whose width is α, lies still, and
//! $$1 - E = \frac{4\mu\alpha^2}{(\mu + \alpha)(\mu + 4\alpha)^2}\,P(x^{1/4}, \alpha)$$
//! leaves a P between 0.1 and about 10, whose logarithm a tensor of Chebyshev polynomials follows; the fourth root tames what
//! happens at $\mu \to 0$. Because $1 - E$ is what is approximated, it is positive however small it is, and because it is the
//! logarithm that is summed, `f32` loses nothing to cancellation.
//! The coefficients are those of [`TABLE`], made by `cargo xtask tables`, which prints their error into `energy/tables.rs`:
//! below 6e-5 for α in \[1e-8, 1\] and μ in (0, 1\]. $1 - E_{avg}$ is fitted to the integral of the approximation itself, not of
//! the truth, so that a white compensated reflector returns $E_{true} + (1 - E)$: all light, but for the error of $E$.
//!
//! **Anisotropy.** For $\alpha_x \ne \alpha_y$ there is no more than an effective width, [`effective_alpha`], and what it leaves.

mod tables;

pub use tables::TABLE;

use crate::fresnel::conductor;
use crate::math::{exp, exp_m1, ln_1p, sin_cos_turns};
use crate::real::Real;
use crate::vec3::Vec3;

/// What becomes of light that meets more than one facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compensation {
    /// It is lost.
    None,
    /// It comes back as a wide lobe of its own: [`kulla_conty`]. Reciprocal.
    KullaConty,
    /// It makes the lobe brighter: [`turquin`]. Not reciprocal.
    Turquin,
}

/// How many Chebyshev polynomials of x^¼.
pub const X: usize = 14;
/// How many Chebyshev polynomials of α.
pub const ALPHA: usize = 10;
/// How many Chebyshev polynomials of the eighth root of α the mean takes.
pub const MEAN: usize = 22;

/// Coefficients of the approximation of 1 − E and 1 − E_avg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table {
    /// ln P: of T_i(2x^¼ − 1) T_j(2α − 1).
    pub missing: [[f64; ALPHA]; X],
    /// (1 − E_avg)/α²: T_k of [`Table::mean_argument`].
    pub missing_avg: [f64; MEAN],
}

impl Table {
    /// See [`Missing::of`].
    #[inline(always)]
    pub fn missing<R: Real>(&self, alpha: R) -> Missing<R> {
        let t = alpha + alpha - R::ONE;
        Missing { alpha, in_x: self.missing.map(|row| chebyshev(t, &row.map(R::lit))) }
    }

    /// See [`missing_avg`].
    #[inline(always)]
    pub fn missing_avg<R: Real>(&self, alpha: R) -> R {
        alpha * alpha * chebyshev(Self::mean_argument(alpha), &self.missing_avg.map(R::lit))
    }

    /// The eighth root of alpha in \[1e-8, 1\], mapped to \[−1, 1\]. 1 − E_avg goes as α² ln(1/α), and over eight decades the
    /// logarithm is a polynomial of that root.
    #[inline(always)]
    pub fn mean_argument<R: Real>(alpha: R) -> R {
        alpha.sqrt().sqrt().sqrt().mul_add(R::lit(2.0 / 0.9), R::lit(-1.1 / 0.9))
    }
}

/// 1 − E as a function of the angle, at one width. The polynomial in α is done once for wo and wi.
#[derive(Clone, Copy, Debug)]
pub struct Missing<R> {
    alpha: R,
    in_x: [R; X],
}

impl<R: Real> Missing<R> {
    /// What a surface of width alpha in \[1e-8, 1\] loses.
    #[inline(always)]
    pub fn of(alpha: R) -> Self {
        TABLE.missing(alpha)
    }

    /// 1 − E(cos), in \[0, 1\], for cos in (0, 1\]. One division, two square roots, one exponential.
    #[inline(always)]
    pub fn at(&self, cos: R) -> R {
        let near = cos + self.alpha;
        let far = R::lit(4.0).mul_add(self.alpha, cos);
        let r = (near * far).recip();
        let x = cos * near * r;
        let y = x.sqrt().sqrt();
        let p = exp(chebyshev(y + y - R::ONE, &self.in_x));
        (self.alpha * self.alpha * r) * (R::lit(4.0) * x * p)
    }
}

/// Σ c_k T_k(t), by Clenshaw's recurrence.
#[inline(always)]
fn chebyshev<R: Real, const N: usize>(t: R, coefficients: &[R; N]) -> R {
    let (mut b1, mut b2) = (R::ZERO, R::ZERO);
    for &c in coefficients.iter().rev() {
        (b1, b2) = ((t + t).mul_add(b1, c - b2), b1);
    }
    // One step too far: 2t·b1 − b2 + c₀ where t·b1 is due.
    b1 - t * b2
}

/// 1 − E_avg: the part of uniform light that a white surface of width alpha in \[1e-8, 1\] loses. Three square roots.
#[inline(always)]
pub fn missing_avg<R: Real>(alpha: R) -> R {
    TABLE.missing_avg(alpha)
}

/// E(cos): the directional albedo of white GGX, for cos in (0, 1\] and alpha in \[1e-8, 1\]. Error below 6e-5.
#[inline(always)]
pub fn albedo<R: Real>(cos: R, alpha: R) -> R {
    R::ONE - Missing::of(alpha).at(cos)
}

/// E_avg: the cosine mean of [`albedo`].
#[inline(always)]
pub fn albedo_avg<R: Real>(alpha: R) -> R {
    R::ONE - missing_avg(alpha)
}

/// F_ms: what becomes of the light that is scattered more than once, one channel, from the mean reflectance f_avg of one
/// facet and the probability `again` to meet a further one after the second: F_avg² (1 − again)/(1 − F_avg · again), in
/// \[0, 1\]; 1 for f_avg = 1. A geometric series.
///
/// With `again` = 1 − E_avg this is Kulla & Conty's, with F_avg² where their slides have F_avg (Hoffman 2019). Against the
/// random walk of Heitz et al. 2016, in per cent of the total albedo, grey reflectances from 0.2 to 0.9, cosines from 0.03 to 1:
/// within 1 % up to α = 0.45 and 2.2 % up to 0.6, but 4.6 % too dark at 0.8 and 7.8 % at 1; with F_avg instead of its square
/// 64 % too bright. [`scattered_again`] is closer.
#[inline(always)]
pub fn multiple_fresnel<R: Real>(f_avg: R, again: R) -> R {
    f_avg * f_avg * (R::ONE - again) / (R::ONE - f_avg * again)
}

/// How likely light that met two facets meets a further one, for [`multiple_fresnel`], from 1 − E at wo and wi and its mean.
///
/// Kulla & Conty take 1 − E_avg, but the second facet lies higher than the first: the random walk finds about 0.45 α over
/// all directions, in proportion to the losses of both. Symmetric in wo and wi, so f_ms stays reciprocal.
#[inline(always)]
pub fn scattered_again<R: Real>(alpha: R, missing_o: R, missing_i: R, missing_avg: R) -> R {
    (R::lit(0.73) * missing_i * (missing_o / missing_avg)).min(R::lit(0.6) * alpha)
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

/// F_avg = 2∫F(μ)μ dμ of Schlick's curve, one channel: (20 f0 + 1)/21.
#[inline(always)]
pub fn schlick_avg<R: Real>(f0: R) -> R {
    f0.mul_add(R::lit(20.0 / 21.0), R::lit(1.0 / 21.0))
}

/// F_avg of Schlick's curve less a μ(1 − μ)⁶, one channel: (20 f0 + 1)/21 − a/126. With Hoffman's "F82" model (2019, "Fresnel
/// Equations Considered Harmful") a is what bends the curve to its value at μ = 1/7.
#[inline(always)]
pub fn f82_avg<R: Real>(f0: R, a: R) -> R {
    a.mul_add(R::lit(-1.0 / 126.0), schlick_avg(f0))
}

/// F_avg of a conductor of index η − ik, one channel, by Gauss's rule of four points for the weight 2μ.
///
/// Error below 7e-4 for k ≥ 0.5 and η in \[0.03, 6\], where all metals are. It reaches 0.11 where k = 0 and η < 1: total
/// reflection ends at an edge there.
#[inline(always)]
pub fn conductor_avg<R: Real>(eta: R, k: R) -> R {
    cosine_mean(|cos| conductor(cos, eta, k))
}

/// 2∫f(μ)μ dμ by Gauss's rule of four points.
#[inline(always)]
pub(crate) fn cosine_mean<R: Real>(f: impl Fn(R) -> R) -> R {
    GAUSS.iter().fold(R::ZERO, |sum, &[cos, weight]| R::lit(weight).mul_add(f(R::lit(cos)), sum))
}

/// Points and weights of ∫f(μ) 2μ dμ over \[0, 1\], exact to degree 7: Abramowitz & Stegun, table 25.8, k = 1, twice.
const GAUSS: [[f64; 2]; 4] = [
    [0.139_759_864_343_780_6, 0.062_361_941_900_016_14],
    [0.416_409_567_631_083_2, 0.259_695_095_216_465],
    [0.723_156_986_361_876_2, 0.406_929_136_020_542_7],
    [0.942_895_803_885_482_3, 0.271_013_826_862_976_1],
];

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
    fn single_precision_is_as_good_as_the_fit() {
        let mut random = Random(71);
        for _ in 0..20_000 {
            let alpha = 10.0_f32.powf(-8.0 * random.unit());
            let cos = if random.unit() < 0.5 { 1.0 - random.unit() } else { 10.0_f32.powf(-10.0 * random.unit()) };
            let (single, double) = (Missing::of(alpha).at(cos), Missing::of(f64::from(alpha)).at(cos.into()));
            assert!(
                (0.0..1.0).contains(&single) && close((f64::from(single) - double) / double, 0.0, 3e-5),
                "{alpha} {cos}"
            );
            let (single, double) = (missing_avg(alpha), missing_avg(f64::from(alpha)));
            assert!(close((f64::from(single) - double) / double, 0.0, 3e-5), "{alpha}");
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
    fn mean_reflectances_are_the_means() {
        let mean = |f: &dyn Fn(f64) -> f64| -> f64 {
            let n = 20_000;
            (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n)).map(|mu| 2.0 * mu * f(mu) / f64::from(n)).sum()
        };
        let schlick = |mu: f64| 0.3 + 0.7 * (1.0 - mu).powi(5);
        assert!(close(schlick_avg(0.3), mean(&schlick), 1e-7));
        assert!(close(f82_avg(0.3, 1.5), mean(&|mu| schlick(mu) - 1.5 * mu * (1.0 - mu).powi(6)), 1e-7));
        for (eta, k) in
            [(0.143_f64, 3.983), (0.375, 2.386), (1.442, 1.603), (0.138, 2.147), (1.1, 6.8), (2.9, 3.0), (4.0, 0.5)]
        {
            assert!(close(conductor_avg(eta, k), mean(&|mu| conductor(mu, eta, k)), 7e-4), "{eta} {k}");
        }
    }
}
