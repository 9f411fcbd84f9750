//! The anisotropic Phong model of Ashikhmin & Shirley: a glossy coat with stretched highlights over a diffuse base that shows less
//! towards grazing. Brushed or lacquered metal, plastic, varnished wood.
//!
//! Ashikhmin & Shirley 2000, "An Anisotropic Phong BRDF Model" (Journal of Graphics Tools 5, 2). With $h$ the half vector at the
//! azimuth $\varphi$ from the tangent, $c_h = n\cdot h$, $k = \omega_o\cdot h = \omega_i\cdot h$ and Schlick's
//! $F(k) = R_s + (1 - R_s)(1 - k)^5$:
//!
//! $$f = \frac{28\\,R_d}{23\pi}(1 - R_s)\\,t(c_o)\\,t(c_i) + \frac{p(h)}{4k}\\,\frac{F(k)}{\max(c_o, c_i)}, \quad
//!   t(c) = 1 - (1 - c/2)^5,$$
//! $$p(h) = \frac{\sqrt{(n_u + 1)(n_v + 1)}}{2\pi}\\,c_h^{\\,n_u\cos^2\varphi + n_v\sin^2\varphi}.$$
//!
//! | parameter | range | meaning | a feeling for values |
//! |---|---|---|---|
//! | `diffuse` | \[0, 1\] | $R_d$, reflectance of the base | the colour of the paint |
//! | `specular` | \[0, 1\] | $R_s$, reflectance of the coat at normal incidence | 0.04 is plastic, 0.9 silver |
//! | `exponent_u` | \[0, 1e7\] | $n_u$: highlights are narrow along the tangent | 10 is satin, 1000 polished |
//! | `exponent_v` | \[0, 1e7\] | $n_v$, the same along the bitangent | 10 and 1000: brushed along the tangent |
//!
//! **Laws.** Reciprocal. Conserves energy for all parameters, exactly: $k = |\omega_o + \omega_i|/2 \ge
//! (c_o + c_i)/2 > c_o/2$, so $F(k) < R_s + (1 - R_s)(1 - c_o/2)^5$; the glossy albedo is the mean of
//! $F(k) \min(1, c_i/c_o)$ over $p$, where $\omega_i$ is above the horizon, and thus below that; the diffuse albedo is exactly
//! $R_d(1 - R_s)(1 - (1 - c_o/2)^5)$; the two bounds add up to at most 1. Quadrature agrees: 1 is reached for $R_s = 1$ with
//! narrow highlights alone; with $R_d = 1$, $R_s = 0$ it is 31/32 along the normal and less elsewhere. Small exponents lose much: at
//! n = 0 a coat of $R_s = 1$ returns $(\sqrt2 - 1)/3 = 0.14$ along the normal.
//!
//! **Sampler.** The base is sampled by cosine, the coat by $p$ with $\omega_i$ mirrored in $h$: density $p(h)/(4k)$. Directions below
//! the horizon fail. The paper's four quadrants are one formula here: the tangential part of $h$ lies along
//! $v = (\cos 2\pi u/\sqrt{n_u + 1}, \sin 2\pi u/\sqrt{n_v + 1})$, and the exponent there is $1/|v|^2 - 1$, so that the map from the
//! square to $h$ is smooth and one to one. The coat is chosen in proportion to the luminance of F, averaged over the cosines $c_o$
//! and $c_o/2$. So no sample of a grey surface weighs more than 2 (measured: 1.18, where the base is sampled);
//! in colour that is multiplied by the largest channel of either part over its luminance.
//!
//! **Precision.** $\ln c_h = -\tfrac12\ln(1 + \tan^2\theta_h)$, and $1 - q^5 = (1 - q)(1 + q + q^2 + q^3 + q^4)$: nothing cancels. The
//! density has a pole at grazing, where $k \to 0$; k counts as at least 1e-30, so that it is finite.
//!
//! ```toml
//! type = "ashikhmin-shirley"
//! diffuse = [0.1, 0.02, 0.02]
//! specular = 0.05
//! exponent_u = 20
//! exponent_v = 500
//! ```
//!
//! Cost of `eval`: 4 divisions, 2 square roots, one logarithm, one exponential.

use super::{Event, Lobe, Properties, Sample, Transport, Value, share};
use crate::frame::both_above;
use crate::fresnel::schlick;
use crate::math::{exp_m1, exp_negative, flushed_square, ln, ln_1p, sin_cos_turns};
use crate::microfacet::reflect;
use crate::model::{EXPONENT, Parameters, REFLECTANCE};
use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::vec3::Vec3;
use crate::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere};
use core::f64::consts::FRAC_1_PI;

crate::model! {
    /// Ashikhmin and Shirley's anisotropic Phong model: a glossy coat over a diffuse base. Reflects on the side of the normal only.
    pub struct AshikhminShirley<R> = "ashikhmin-shirley" {
        /// R_d, the reflectance of the base.
        diffuse: Rgb<R> = 0.5 in REFLECTANCE,
        /// R_s, the reflectance of the coat at normal incidence: 0.04 is plastic, 0.9 silver.
        specular: Rgb<R> = 0.05 in REFLECTANCE,
        /// n_u: 10 is satin along the tangent, 1000 polished.
        exponent_u: R = 100.0 in EXPONENT,
        /// n_v: the same along the bitangent.
        exponent_v: R = 100.0 in EXPONENT,
    }
}

/// 28/23: with it the diffuse albedo is R_d (1 − R_s) t(cos_o).
const DIFFUSE: f64 = 28.0 / 23.0;

/// The half vector of two directions above the surface, and what densities of cosine powers need of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfVector<R> {
    /// The squares of its tangential components, at some length.
    tangential: [R; 2],
    /// −ln cosθ_h.
    fall: R,
    /// ω·h of the unit h: the same for both directions; at least 1e-30.
    pub(super) cos_m: R,
}

impl<R: Real> HalfVector<R> {
    #[inline(always)]
    pub(super) fn of(wo: Vec3<R>, wi: Vec3<R>) -> Self {
        let sum = wo + wi;
        let length2 = sum.length2();
        let (mut h, mut length) = (sum, length2.sqrt());
        // Both grazing and opposite: the squares would underflow.
        let tiny = length2.lt(R::lit(1e-12));
        if tiny.any() {
            let unit = sum.normalize_or(Vec3::unit_z());
            h = Vec3::select(tiny, unit, h);
            length = R::select(tiny, sum.dot(unit), length);
        }
        let tangential = [h.x * h.x, h.y * h.y];
        let tan = ((tangential[0] + tangential[1]).sqrt() / h.z).min(R::lit(1e38));
        // Beyond 1e18 the square might overflow, and ln(1 + tan²) is 2 ln tan.
        let steep = tan.gt(R::lit(1e18));
        let fall = ln_1p(R::select(steep, tan, tan * tan)) * R::select(steep, R::ONE, R::lit(0.5));
        Self { tangential, fall, cos_m: (R::lit(0.5) * length).max(R::lit(1e-30)) }
    }

    /// n_u cos²φ + n_v sin²φ.
    #[inline(always)]
    fn exponent(&self, n_u: R, n_v: R) -> R {
        let [x2, y2] = self.tangential;
        let sin2 = x2 + y2;
        (n_u.mul_add(x2, n_v * y2) / sin2).or_zero(sin2.gt(R::ZERO))
    }

    /// norm cosⁿθ_h/(4k): the density of the mirrored direction, where norm cosⁿθ_h is that of h \[1/sr\].
    #[inline(always)]
    pub(super) fn pdf_reflected(&self, exponent: R, norm: R) -> R {
        let root = exp_negative(exponent * self.fall * R::lit(-0.5));
        flushed_square(root, norm * R::lit(0.25) / self.cos_m)
    }
}

/// A half vector, of any length, with the density √((n_u + 1)(n_v + 1))/2π cosⁿθ, n = n_u cos²φ + n_v sin²φ.
#[inline(always)]
pub(super) fn sample_half_vector<R: Real>(n_u: R, n_v: R, u: [R; 2]) -> Vec3<R> {
    let (sin, cos) = sin_cos_turns(u[1]);
    let (x, y) = (cos / (n_u + R::ONE).sqrt(), sin / (n_v + R::ONE).sqrt());
    // 1/(n + 1); cosθ is its power of 1 − u, and tan²θ = 1/cos²θ − 1.
    let width2 = x.mul_add(x, y * y);
    let slope = (exp_m1(R::lit(-2.0) * width2 * ln(R::ONE - u[0])) / width2).max(R::ZERO).sqrt();
    Vec3::new(x * slope, y * slope, R::ONE)
}

/// t(c) = 1 − (1 − c/2)⁵, as a product that does not cancel.
#[inline(always)]
fn shown<R: Real>(cos: R) -> R {
    let half = R::lit(0.5) * cos;
    let q = R::ONE - half;
    let sum = (q + R::ONE).mul_add(q, R::ONE).mul_add(q, R::ONE).mul_add(q, R::ONE);
    half * sum
}

/// What depends on wo alone.
#[derive(Clone, Copy, Debug)]
pub struct Prepared<R> {
    /// The diffuse albedo R_d (1 − R_s) t(cos_o).
    diffuse: Rgb<R>,
    /// The probability of the base: exactly 0 where it is black.
    p_diffuse: R,
    /// The probability of the coat, which as 1 less that of the base would lose its last digits where it is small.
    p_coat: R,
    /// √((n_u + 1)(n_v + 1))/2π.
    norm: R,
}

impl<R: Real> AshikhminShirley<R> {
    /// The diffuse albedo, and about that of the coat: at least half of F(cos_o/2), which F never exceeds.
    #[inline(always)]
    fn albedos(&self, wo: Vec3<R>) -> [Rgb<R>; 2] {
        let cos = wo.z.max(R::ZERO).min(R::ONE);
        let coat = |f0: R| R::lit(0.5) * (schlick(cos, f0) + schlick(R::lit(0.5) * cos, f0));
        let under = self.specular.map(|f0| R::ONE - f0);
        [self.diffuse * under * shown(cos), self.specular.map(coat)]
    }
}

impl<R: Real> Lobe<R> for AshikhminShirley<R> {
    type Prepared = Prepared<R>;

    #[inline(always)]
    fn prepare(&self, wo: Vec3<R>, _transport: Transport) -> Prepared<R> {
        let [diffuse, coat] = self.albedos(wo);
        let norm = ((self.exponent_u + R::ONE) * (self.exponent_v + R::ONE)).sqrt() * R::lit(0.5 * FRAC_1_PI);
        Prepared { diffuse, p_diffuse: share(diffuse, coat), p_coat: share(coat, diffuse), norm }
    }

    #[inline]
    fn eval(&self, wo: Vec3<R>, prepared: &Prepared<R>, wi: Vec3<R>) -> Value<R> {
        let Prepared { diffuse, p_diffuse, p_coat, norm } = *prepared;
        let half = HalfVector::of(wo, wi);
        let glossy = half.pdf_reflected(half.exponent(self.exponent_u, self.exponent_v), norm);
        let fresnel = self.specular.map(|f0| schlick(half.cos_m, f0));
        let cosine = pdf_cosine_hemisphere(wi);
        let f_cos = diffuse * (R::lit(DIFFUSE) * shown(wi.z) * cosine) + fresnel * (glossy * (wi.z / wi.z.max(wo.z)));
        let pdf = p_diffuse.mul_add(cosine, p_coat * glossy);
        Value { f_cos, pdf }.or_zero(both_above(wo, wi))
    }

    #[inline]
    fn sample(&self, wo: Vec3<R>, prepared: &Prepared<R>, u: [R; 3]) -> Sample<R> {
        let glossy = reflect(wo, sample_half_vector(self.exponent_u, self.exponent_v, [u[1], u[2]]));
        let diffuse = sample_cosine_hemisphere([u[1], u[2]]);
        let wi = Vec3::select(u[0].lt(prepared.p_diffuse), diffuse, glossy);
        Sample { wi, event: Event::reflected(!both_above(wo, wi)) }
    }

    #[inline(always)]
    fn delta(&self, _wo: Vec3<R>, _prepared: &Prepared<R>, _sample: &Sample<R>) -> Value<R> {
        Value::zero()
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
        let [diffuse, coat] = self.albedos(wo);
        diffuse + coat
    }

    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.in_domain()
    }

    #[inline(always)]
    fn properties(&self) -> Properties<R> {
        let base = self.diffuse * self.specular.map(|f0| R::ONE - f0);
        Properties {
            anisotropic: !self.exponent_u.same(self.exponent_v).all(),
            one_to_one: base.largest().same(R::ZERO).all(),
            ..Properties::LAWFUL
        }
    }

    /// F ≤ F(cos_o/2), and t(cos_i) ≤ 31/32.
    #[inline(always)]
    fn largest_weight(&self, wo: Vec3<R>) -> R {
        let [diffuse, coat] = self.albedos(wo);
        let (p_diffuse, p_coat) = (share(diffuse, coat), share(coat, diffuse));
        let bound = self.specular.map(|f0| schlick(R::lit(0.5) * wo.z.max(R::ZERO), f0));
        let base = (diffuse.largest() / p_diffuse).or_zero(p_diffuse.gt(R::ZERO)) * R::lit(DIFFUSE * 31.0 / 32.0);
        base.max(bound.largest() / p_coat)
    }
}

#[cfg(test)]
pub(super) mod tests;
