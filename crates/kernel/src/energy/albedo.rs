//! The directional albedo of a coat as a curve over the cosine: what its lobe reflects, and so what 1 − E it lets through.
//!
//! A layer over a base attenuates it by T = 1 − E of the top, where
//! $$E(\mu_o) = \int f(\omega_o, \omega_i)\\,\mu_i\\,d\omega_i, \qquad E_{avg} = 2\int_0^1 E(\mu)\\,\mu\\,d\mu.$$
//! Then f_top + f_base T(wo) T(wi)/T_avg is reciprocal and returns E(wo) + T(wo) over a white Lambertian base: all light, but for
//! the error of E (Kelemen & Szirmay-Kalos 2001, "A Microfacet Based Coupled Specular-Matte BRDF Model with Importance Sampling").
//!
//! E is needed at wi, for every direction, and lanes cannot gather: it is a polynomial of degree 11,
//! $$E_c(\mu) = B(x) + t_c\\,X(x) + (k_B + t_c k_X)(1 - \mu)^5, \qquad x = 2\frac{(1 + s)\mu}{\mu + s} - 1,$$
//! interpolated at the Chebyshev nodes of x when the curve is made, once per material. s follows the width of the boundary layer
//! at grazing, s = 0.045 + 0.25 √α. The tint t of the channels is 0 for what is grey.
//!
//! **What is interpolated.** Let p be the distribution of the cosines c at which light from µ meets the facets that reflect it.
//! Then E = ∫p(c) F(c) dc: the part that a white surface reflects, E_white, times a mean of F, which is F at a mean cosine,
//! $$E = E_{white}(\mu, \alpha)\\,F(\bar c), \qquad \bar c^2 = \mu^2 + \alpha^2 q(\mu, \alpha, \eta).$$
//! q depends little on the index: from 1.1 to 3, c̄ changes by 17 % at most. What is fitted, at every node by itself, is q as a
//! polynomial in the eighth root of α (8 terms) and in √((η − 1)/(η + 1)) (5), and 1 − E_white as [`missing_factor`] times
//! another in α (10). For α = 0 what is left is F(µ), exactly. α below [`ALPHA_SMOOTH`] goes over to that with α²: the layer at grazing is
//! then narrower than the curve can show, and what is shown is an upper bound.
//!
//! The coefficients are made by `cargo xtask tables`. Tried and worse: one tensor in x, α and η (12 × 8 × 6: errors of 2e-2 for α
//! below 0.09, because the layers of width α and √(η² − 1) cross), and one Gaussian rule of two or three cosines for p (4e-2 and
//! 6e-3, α = 0.05 and grazing).
//!
//! **Anisotropy** is not described. With [`super::effective_alpha`] the total over a white base lies, for indices 1.1 to 2.5, nine
//! cosines from 0.02 to 1 and seven azimuths, within \[0.93, 1.08\] for widths of 0.1 × 0.2, \[0.97, 1.05\] for 0.5 × 1, \[0.95,
//! 1.09\] for 0.3 × 0.9, \[0.78, 1.24\] for 0.03 × 0.3 and \[0.89, 1.21\] for 0.1 × 1: it does not conserve energy. With the smaller of
//! the two it nearly does, and is darker: \[0.86, 1.01\], \[0.94, 1.02\], \[0.89, 1.03\], \[0.55, 1.01\], \[0.68, 1.02\]. (With
//! Schlick's curve through f0 = 1 up to 1.08, for 0.03 × 0.3.)
//!
//! **E errs upwards**, by a margin that covers the error, so that no albedo exceeds 1. See [`AlbedoCurve`] for what is lost.

mod ggx;
mod node;

pub use ggx::{eta_basis, missing_factor};
pub use node::{IN_ALPHA, IN_ALPHA_ETA, IN_ETA, NODES, Node};

use super::tables::ALBEDO;
use crate::real::{Mask, Real};
use crate::rgb::Rgb;

/// The narrowest lobe that differs from a smooth surface: roughness 0.05.
pub const ALPHA_SMOOTH: f64 = 0.0025;
/// Its eighth root.
const ALPHA_SMOOTH_ROOT: f64 = 0.472_870_804_501_587_9;

/// How the cosine is stretched: x in \[−1, 1\] and µ in \[0, 1\].
#[derive(Clone, Copy, Debug)]
pub struct Stretch<R> {
    s: R,
}

impl<R: Real> Stretch<R> {
    /// That of a width alpha in \[0, 1\].
    #[inline(always)]
    pub fn new(alpha: R) -> Self {
        Self { s: R::lit(0.25).mul_add(alpha.max(R::lit(ALPHA_SMOOTH)).sqrt(), R::lit(0.045)) }
    }
    /// x of a cosine in \[0, 1\].
    #[inline(always)]
    pub fn x(self, cos: R) -> R {
        (R::lit(2.0).mul_add(self.s, R::ONE).mul_add(cos, -self.s) / (cos + self.s)).min(R::ONE)
    }
    /// The cosine of an x in \[−1, 1\].
    #[inline(always)]
    pub fn cos(self, x: R) -> R {
        let v = R::lit(0.5).mul_add(x, R::lit(0.5));
        self.s * v / (R::ONE - v + self.s)
    }
}

/// T₀(x) … T_{N−1}(x).
#[inline(always)]
fn chebyshev<R: Real, const N: usize>(x: R) -> [R; N] {
    let (mut last, mut next) = (x, R::ONE);
    [(); N].map(|()| {
        let this = next;
        // T₋₁ = T₁.
        next = (x + x).mul_add(this, -last);
        last = this;
        this
    })
}

/// Σ aᵢ bᵢ.
#[inline(always)]
fn dot<R: Real, const N: usize>(a: &[f64; N], b: &[R; N]) -> R {
    a.iter().zip(b).fold(R::ZERO, |sum, (&a, &b)| R::lit(a).mul_add(b, sum))
}

/// Values at the nodes to coefficients of T_i: (2/N) T_i(x_k), half of it for i = 0.
const FROM_NODES: [[f64; NODES]; NODES] = {
    let mut rows = [[0.0; NODES]; NODES];
    let mut k = 0;
    while k < NODES {
        let x = ALBEDO[k].x;
        let (mut last, mut next, mut i) = (x, 1.0, 0);
        while i < NODES {
            rows[i][k] = next * if i == 0 { 1.0 } else { 2.0 } / NODES as f64;
            (last, next) = (next, 2.0 * x * next - last);
            i += 1;
        }
        k += 1;
    }
    rows
};

/// Coefficients of T_i to those of powers: a row per power.
const TO_POWERS: [[f64; NODES]; NODES] = {
    let mut rows = [[0.0; NODES]; NODES];
    rows[0][0] = 1.0;
    rows[1][1] = 1.0;
    let mut i = 2;
    while i < NODES {
        let mut power = 0;
        while power < NODES {
            let raised = if power > 0 { 2.0 * rows[power - 1][i - 1] } else { 0.0 };
            rows[power][i] = raised - rows[power][i - 2];
            power += 1;
        }
        i += 1;
    }
    rows
};

/// A polynomial in x through values at the nodes, by powers of x.
///
/// In `f32` this goes by way of Chebyshev's coefficients: the products with powers are large, but they are relative to them.
#[inline]
fn interpolate<R: Real>(values: &[R; NODES]) -> [R; NODES] {
    let in_chebyshev = FROM_NODES.each_ref().map(|row| dot(row, values));
    TO_POWERS.each_ref().map(|row| dot(row, &in_chebyshev))
}

/// Horner's rule.
#[inline(always)]
fn polynomial<R: Real>(x: R, coefficients: &[R; NODES]) -> R {
    let [rest @ .., highest] = coefficients;
    rest.iter().rev().fold(*highest, |sum, &c| sum.mul_add(x, c))
}

/// The nodes of one α.
#[derive(Clone, Copy, Debug)]
struct Grid<R> {
    stretch: Stretch<R>,
    /// Polynomials of the eighth root of α.
    powers: [R; IN_ALPHA],
}

impl<R: Real> Grid<R> {
    /// That of alpha in \[0.0025, 1\].
    #[inline(always)]
    fn new(alpha: R) -> Self {
        let root = alpha.sqrt().sqrt().sqrt();
        let w = (root - R::lit(ALPHA_SMOOTH_ROOT)) * R::lit(2.0 / (1.0 - ALPHA_SMOOTH_ROOT)) - R::ONE;
        Self { stretch: Stretch::new(alpha), powers: chebyshev(w) }
    }
    /// 2∫E µ dµ of the polynomial through these values.
    #[inline(always)]
    fn avg(&self, values: &[R; NODES]) -> R {
        let mut sum = R::ZERO;
        for (node, &value) in ALBEDO.iter().zip(values) {
            sum = dot(&node.weight, &self.powers).mul_add(value, sum);
        }
        sum
    }
}

/// E(µ), the directional albedo of one material as a function of the cosine, per channel, erring upwards.
///
/// E_fit − E_true, which is what a coat over a white Lambertian base loses, is given with the constructors, as
/// `crates/lab/src/tables/albedo.rs` measures it between the nodes, in `f64` and `f32`. Its least value is −5.2e-5, for an index of
/// 3 at α = 1 and grazing; up to an index of 2.5 it is positive.
///
/// A curve is 31 numbers. Making one takes about 1200 fused multiplications, of which 290 find its coefficients, and for a
/// dielectric 12 evaluations of Fresnel's equations. [`Self::at`] takes one division, 11 fused multiplications for
/// the polynomial and about 20 operations around it; 12 more if the curve is coloured.
///
/// ```
/// use gonio_kernel::energy::AlbedoCurve;
///
/// let coat = AlbedoCurve::dielectric(0.09_f64, 1.5);
/// let (cos_o, cos_i) = (0.3, 0.8);
/// // What is left of a Lambertian base below, in both directions.
/// let attenuation = (1.0 - coat.at(cos_o).r) * (1.0 - coat.at(cos_i).r) / (1.0 - coat.avg().r);
/// assert!(attenuation > 0.8 && attenuation < 1.0);
/// // Little of the light is reflected along the normal, most of it at grazing.
/// assert!(coat.at(1.0).r < 0.05 && coat.at(0.02).r > 0.3);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct AlbedoCurve<R> {
    stretch: Stretch<R>,
    /// B by powers of x.
    base: [R; NODES],
    /// X by powers of x.
    extra: [R; NODES],
    /// k_B and k_X: of (1 − µ)⁵.
    grazing: [R; 2],
    /// 2∫E µ dµ of each channel, before its factor.
    avg: Rgb<R>,
    /// t of green and blue; that of red is 0.
    tint: [R; 2],
    /// Factor on each channel.
    scale: Rgb<R>,
}

impl<R: Real> AlbedoCurve<R> {
    /// (1 − t) a + t b, with (1 − µ)⁵ of either.
    #[inline]
    fn affine(grid: &Grid<R>, a: &[R; NODES], b: &[R; NODES], t: Rgb<R>, grazing: [R; 2]) -> Self {
        let mut rest = a.iter();
        let extra = b.map(|b| b - rest.next().copied().unwrap_or(R::ZERO));
        let mut rest = extra.iter();
        let base = a.map(|a| rest.next().copied().unwrap_or(R::ZERO).mul_add(t.r, a));
        let steeper = grazing[1] - grazing[0];
        let grazing = [steeper.mul_add(t.r, grazing[0]), steeper];
        // 2∫(1 − µ)⁵ µ dµ = 1/21.
        let avg = |values: &[R; NODES], k: R| R::lit(1.0 / 21.0).mul_add(k, grid.avg(values));
        let tint = [t.g - t.r, t.b - t.r];
        Self {
            stretch: grid.stretch,
            base: interpolate(&base),
            extra: interpolate(&extra),
            grazing,
            avg: channels([avg(&base, grazing[0]), avg(&extra, grazing[1])], tint),
            tint,
            scale: Rgb::splat(R::ONE),
        }
    }

    /// The same albedo at every angle, in \[0, 1\].
    #[inline(always)]
    pub fn constant(albedo: Rgb<R>) -> Self {
        let nothing = [R::ZERO; NODES];
        let mut one = nothing;
        if let Some(first) = one.first_mut() {
            *first = R::ONE;
        }
        Self {
            stretch: Stretch::new(R::ONE),
            base: one,
            extra: nothing,
            grazing: [R::ZERO; 2],
            avg: Rgb::splat(R::ONE),
            tint: [R::ZERO; 2],
            scale: albedo,
        }
    }

    /// The curve of a lobe that is multiplied by a colour in \[0, 1\].
    #[inline(always)]
    #[must_use]
    pub fn scaled(self, weight: Rgb<R>) -> Self {
        Self { scale: self.scale * weight, ..self }
    }

    /// Where `mask`, no more than an upper bound: E times 1.1, at most 1, with an average of which T(wo) T(wi)/T_avg never returns
    /// too much. For what the curve does not describe: see **Anisotropy** above.
    #[inline(never)]
    #[must_use]
    pub fn raised(self, mask: R::Mask) -> Self {
        if !mask.any() {
            return self;
        }
        let scale = self.scale.map(|scale| R::select(mask, scale * R::lit(1.1), scale));
        let least = Self { scale, ..self }.most_transmitted().map(|t| R::ONE - t);
        // What `avg` multiplies by the factor again.
        let least = Rgb::new(least.r / scale.r, least.g / scale.g, least.b / scale.b);
        let least = least.map(|e| e.or_zero(e.is_finite()));
        Self { scale, avg: Rgb::select(mask, least, self.avg), ..self }
    }

    /// Interpolates a grey function of the cosine, for a user-defined lobe: f is called at 12 cosines in (0, 1). The caller
    /// knows its error, and adds a margin: a line is right to 1e-5, a cubic to 4e-4, what is steep at grazing is not.
    #[inline(always)]
    pub fn from_fn(mut f: impl FnMut(R) -> R) -> Self {
        Self::from_fn_tinted(Rgb::zero(), |cos| [f(cos), R::ZERO])
    }

    /// The same for E = f₀ + tint f₁, where f returns both.
    #[inline(always)]
    pub fn from_fn_tinted(tint: Rgb<R>, mut f: impl FnMut(R) -> [R; 2]) -> Self {
        let grid = Grid::new(R::ONE);
        let values = ALBEDO.each_ref().map(|node| f(grid.stretch.cos(R::lit(node.x))));
        let (base, top) = (values.map(|[base, _]| base), values.map(|[base, extra]| base + extra));
        Self::affine(&grid, &base, &top, tint, [R::ZERO; 2])
    }

    /// E(cos) in \[0, 1\]; cos is moved into \[0, 1\], NaN to 0.
    #[inline(always)]
    pub fn at(&self, cos: R) -> Rgb<R> {
        let cos = cos.clamp(0.0, 1.0);
        let (x, m5) = (self.stretch.x(cos), fifth(cos));
        let base = self.grazing[0].mul_add(m5, polynomial(x, &self.base));
        let coloured = self.is_coloured();
        let extra = if coloured.any() {
            self.grazing[1].mul_add(m5, polynomial(x, &self.extra)).or_zero(coloured)
        } else {
            R::ZERO
        };
        (channels([base, extra], self.tint) * self.scale).map(|e| e.min(R::ONE))
    }

    /// E_avg = 2∫E µ dµ of this curve, in \[0, 1 − 1.2e-3\], so that 1 − E_avg can be divided by.
    ///
    /// Where E with its margin exceeded 1, [`Self::at`] returns 1, and the average of what it returns is less than that of the
    /// polynomial: T = 1 − E_avg is raised to T + d²/(d + T) with d = 1.2e-3, the margin. That is 2e-6 where half is reflected.
    #[inline(never)]
    pub fn avg(&self) -> Rgb<R> {
        let margin = R::lit(1.2e-3);
        let avg = (self.avg * self.scale).map(|e| e.min(R::ONE));
        avg.map(|e| (e - margin * margin / (margin + (R::ONE - e))).max(R::ZERO))
    }

    /// An upper bound of 1 − E over all cosines, for a base that is not Lambertian: at most 7e-3 above (where
    /// a narrow lobe has a valley at grazing). Costs 25 values of the curve.
    #[inline(never)]
    pub fn most_transmitted(&self) -> Rgb<R> {
        let mut least = Rgb::splat(R::ONE);
        // Evenly in the angle θ of x = cosθ, and symmetric at both ends. In a valley between two samples the curve is lower than
        // they are by an eighth of the second difference, were it a parabola: twice as much is taken.
        let at = |x: f64| self.at(self.stretch.cos(R::lit(x)));
        let [second, ..] = SAMPLES;
        let [.., last_but_one] = SAMPLES;
        let (mut before, mut here) = (at(second), at(1.0));
        for x in SAMPLES.into_iter().chain([-1.0, last_but_one]) {
            let after = at(x);
            let lower = |b: R, h: R, a: R| h - R::lit(0.25) * (b + a - (h + h)).max(R::ZERO);
            least.r = least.r.min(lower(before.r, here.r, after.r));
            least.g = least.g.min(lower(before.g, here.g, after.g));
            least.b = least.b.min(lower(before.b, here.b, after.b));
            (before, here) = (here, after);
        }
        least.map(|e| (R::ONE - e).clamp(0.0, 1.0))
    }

    /// Where the tint is not 0: elsewhere the second polynomial is none of the work.
    #[inline(always)]
    fn is_coloured(&self) -> R::Mask {
        !(self.tint[0].same(R::ZERO) & self.tint[1].same(R::ZERO))
    }
}

/// base + t·extra of each channel, in \[0, 1\].
#[inline(always)]
fn channels<R: Real>([base, extra]: [R; 2], [green, blue]: [R; 2]) -> Rgb<R> {
    Rgb::new(base, green.mul_add(extra, base), blue.mul_add(extra, base)).map(|e| e.clamp(0.0, 1.0))
}

/// (1 − cos)⁵.
#[inline(always)]
fn fifth<R: Real>(cos: R) -> R {
    let m = R::ONE - cos;
    let m2 = m * m;
    m2 * m2 * m
}

/// cos(kπ/24) for k = 1 … 23.
const SAMPLES: [f64; 23] = [
    0.991_444_861_374,
    0.965_925_826_289,
    0.923_879_532_511,
    0.866_025_403_784,
    0.793_353_340_291,
    core::f64::consts::FRAC_1_SQRT_2,
    0.608_761_429_009,
    0.5,
    0.382_683_432_365,
    0.258_819_045_103,
    0.130_526_192_22,
    0.0,
    -0.130_526_192_22,
    -0.258_819_045_103,
    -0.382_683_432_365,
    -0.5,
    -0.608_761_429_009,
    -core::f64::consts::FRAC_1_SQRT_2,
    -0.793_353_340_291,
    -0.866_025_403_784,
    -0.923_879_532_511,
    -0.965_925_826_289,
    -0.991_444_861_374,
];

#[cfg(test)]
mod tests;
