//! EON, the energy-preserving Oren–Nayar model of rough diffuse surfaces: clay, plaster, cloth, the moon.
//!
//! Portsmouth, Kutz & Hill 2025, "EON: A practical energy-preserving rough diffuse BRDF" (JCGT 14, 1), on Fujii's variant of
//! Oren & Nayar 1994 (FON). With roughness r in \[0, 1\], $s = \omega_o\cdot\omega_i - \mu_o\mu_i$ (which is $x_o x_i + y_o y_i$),
//! $t = \max(\mu_o, \mu_i)$ where $s > 0$ and 1 elsewhere, $A = 1/(1 + c_1 r)$:
//!
//! $$f = \frac{\rho}{\pi} A\\,(1 + r s/t) + \frac{\rho_{ms}}{\pi}\\,\frac{(1 - E_F(\mu_o))(1 - E_F(\mu_i))}{1 - \bar E_F},$$
//! $$E_F(\mu) = A(1 + r\\,G(\mu)/\pi), \quad \bar E_F = A(1 + c_2 r), \quad
//!   \rho_{ms} = \frac{\rho^2 \bar E_F}{1 - \rho(1 - \bar E_F)},$$
//! $c_1 = 1/2 - 2/(3\pi)$, $c_2 = 2/3 - 28/(15\pi)$. The second term returns what the first loses between facets.
//!
//! G is [`EonAlbedo::Analytic`], with an arc cosine, or [`EonAlbedo::Fitted`], a polynomial. Both are reciprocal. Exact, a white
//! surface returns exactly all light; fitted, within 2e-3 of it, above and below: energy is bounded only up to that. $r = 0$
//! is Lambert, at about five times its price. ρ is the albedo of single scattering; colours get a little darker and more
//! saturated as r grows.
//!
//! **No cancellation.** $1 - E_F = A r (c_1 - G/\pi)$, and $c_1$ is $G/\pi$ at grazing, so that $1 - E_F$ is formed as a sum of
//! terms that vanish there: $\pi(c_1 - G/\pi) = (1 - S)(\pi/2 - 2/3) + S\\,(\arcsin\mu + S\mu) - \tfrac23 S\mu(1 + S + S^2)/(1 + S)$
//! with $S = \sin\theta$ and $1 - S = \mu^2/(1 + S)$. For $s < 0$, $1 + s = (|t_o + t_i|^2 + \mu_o^2 + \mu_i^2)/2$ of the
//! tangential parts $t$. $f\mu_i$ holds $\mu_i/t \le 1$, never $1/t$.
//!
//! **Sampler.** The paper's: a clipped linearly transformed cosine (CLTC), whose matrix follows μ_o and r, mixed with a uniform
//! hemisphere. The paper's share of the latter goes as $r^{0.1}$; here it is $r^{1/8}$, three square roots. Weights are at most
//! [`LARGEST_WEIGHT`] times the albedo. About one sample in 10⁷ rounds into the horizon and fails.
//!
//! Cost of `eval`: 8 divisions and 6 square roots fitted, 12 and 6 exact.

use super::{Event, Lobe, Properties, Sample, Transport, Value};
use crate::frame::both_above;
use crate::math::{atan2_turns, sin_cos_turns};
use crate::model::{Parameters, REFLECTANCE, ROUGHNESS};
use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::vec3::Vec3;
use crate::warp::{pdf_uniform_sphere, sample_uniform_sphere};
use core::f64::consts::{FRAC_1_PI, FRAC_PI_2, TAU};

crate::choice! {
    /// How the directional albedo of single scattering is computed.
    pub enum EonAlbedo {
        /// By its closed form.
        Analytic = "analytic" | "exact",
        /// By the paper's polynomial of degree four: E_F is off by 1e-3 at most.
        Fitted = "fitted",
    }
}

crate::model! {
    /// A rough diffuse reflector, the energy-preserving Oren–Nayar model.
    pub struct Eon<R> = "eon" {
        /// ρ, the albedo of single scattering.
        albedo("base_color"): Rgb<R> = 0.8 in REFLECTANCE,
        /// r: 0 is Lambert's law, 0.5 plaster.
        roughness: R = 0.5 in ROUGHNESS,
        /// How the directional albedo that it conserves is computed.
        directional("albedo"): EonAlbedo = Analytic,
    }
}

/// No sample weighs more than this times the largest channel of the albedo. Measured over a million pairs, at roughness down
/// to 1e-12 and grazing down to 1e-8: 1.54, near r = 0.6, forwards at 80°.
pub const LARGEST_WEIGHT: f64 = 1.6;

const C1: f64 = 0.5 - 2.0 / 3.0 * FRAC_1_PI;
const C2: f64 = 2.0 / 3.0 - 28.0 / 15.0 * FRAC_1_PI;

/// The paper's fit of G/π, of (1 − μ)¹ to (1 − μ)⁴.
const FIT: [f64; 4] = [0.057_108_528_9, 0.491_881_867, -0.332_181_442, 0.071_442_995_3];

/// c₁ less that fit, highest power of μ first: in powers of 1 − μ it would cancel at grazing.
const LOSS: [f64; 5] = [
    -FIT[3],
    FIT[2] + 4.0 * FIT[3],
    -(FIT[1] + 3.0 * FIT[2] + 6.0 * FIT[3]),
    FIT[0] + 2.0 * FIT[1] + 3.0 * FIT[2] + 4.0 * FIT[3],
    C1 - (FIT[0] + FIT[1] + FIT[2] + FIT[3]),
];

impl<R> Eon<R> {
    /// A rough diffuse reflector with the exact directional albedo.
    pub const fn new(albedo: Rgb<R>, roughness: R) -> Self {
        Self { albedo, roughness, directional: EonAlbedo::Analytic }
    }
}

impl<R: Real> Eon<R> {
    /// c₁ − G/π, which is (1 − E_F)/(A r), in \[0, c₁\].
    #[inline(always)]
    fn loss(&self, w: Vec3<R>) -> R {
        let loss = match self.directional {
            EonAlbedo::Analytic => {
                let s = w.x.mul_add(w.x, w.y * w.y).sqrt();
                let r = (R::ONE + s).recip();
                let arcsin = atan2_turns(w.z, s) * R::lit(TAU);
                let flat = w.z * r * R::lit(FRAC_PI_2 - 2.0 / 3.0);
                let cubic = s.mul_add(s, s) + R::ONE;
                // All terms but the arc sine share a factor μ.
                let rest = (cubic * r).mul_add(R::lit(-2.0 / 3.0), s);
                w.z.mul_add(s.mul_add(rest, flat), s * arcsin) * R::lit(FRAC_1_PI)
            }
            EonAlbedo::Fitted => LOSS.iter().fold(R::ZERO, |sum, &c| sum.mul_add(w.z, R::lit(c))),
        };
        // The fit goes below 0 by 5e-4 at grazing.
        loss.max(R::ZERO)
    }

    /// ρ_ms/(c₁ − c₂) of one channel. Times A r, of which 1 − E̅_F = A r (c₁ − c₂) holds one and the numerator two.
    #[inline(always)]
    fn multiple(&self, albedo: R) -> R {
        let r = self.roughness;
        let mean = R::lit(C2).mul_add(r, R::ONE);
        let left = R::lit(C1).mul_add(r, R::ONE) - albedo * r * R::lit(C1 - C2);
        albedo * albedo * mean * R::lit(1.0 / (C1 - C2)) / left
    }

    /// The share of uniform samples.
    #[inline(always)]
    fn uniform_share(&self, cos_o: R) -> R {
        let by_angle = [-0.290_822, 0.538_233, -0.372_058, 0.162_925];
        let by_angle = by_angle.iter().fold(R::ZERO, |sum, &c| sum.mul_add(cos_o, R::lit(c)));
        self.roughness.sqrt().sqrt().sqrt() * by_angle
    }
}

/// The clipped linearly transformed cosine for one wo: wi ∝ M·w with w cosine-distributed where M·w is above the horizon,
/// M = \[\[a, 0, b\], \[0, c, 0\], \[d, 0, 1\]\] in the frame whose x is wo's azimuth.
struct Cltc<R> {
    a: R,
    b: R,
    c: R,
    d: R,
    azimuth: [R; 2],
}

impl<R: Real> Cltc<R> {
    #[inline(always)]
    fn of(wo: Vec3<R>, r: R) -> Self {
        let mu = wo.z;
        // d is a quotient of two small numbers near the normal: both in 1 − μ, which f32 has exactly there.
        let m = R::ONE - mu;
        let a = R::lit(0.111_709).mul_add(mu, R::lit(-0.518_982)).mul_add(mu, R::lit(0.303_392))
            + R::lit(0.335_918).mul_add(mu, R::lit(-0.276_266)) * r;
        let b = R::lit(1.158_59).mul_add(mu, R::lit(-1.164_07)) + R::lit(-0.150_105).mul_add(mu, R::lit(0.150_815)) * r;
        let c = R::lit(0.261_777).mul_add(mu, R::lit(-0.506_373)).mul_add(mu, R::lit(0.200_13));
        let d = R::lit(0.475_392).mul_add(m, R::lit(0.065_466)).mul_add(m, R::lit(-0.000_006));
        let d_below = (m - R::lit(2.072_562_8)).mul_add(m, R::lit(-0.001_737_2));
        let length = wo.x.mul_add(wo.x, wo.y * wo.y).sqrt();
        let known = length.gt(R::ZERO);
        let scale = R::select(known, length, R::ONE).recip();
        Self {
            a: a.mul_add(r, R::ONE),
            b: b * r / (mu * mu).mul_add(mu, R::lit(-1.435_45)),
            c: c.mul_add(r, R::ONE),
            d: d * r / d_below,
            azimuth: [R::select(known, wo.x * scale, R::ONE), wo.y * scale],
        }
    }

    /// √(1 + d²): its inverse is the cosine of the plane at which the cosine is clipped.
    #[inline(always)]
    fn tilt(&self) -> R {
        self.d.mul_add(self.d, R::ONE).sqrt()
    }

    #[inline(always)]
    fn sample(&self, u: [R; 2]) -> Vec3<R> {
        let (sin, cos) = sin_cos_turns(u[1]);
        let radius = u[0].sqrt();
        let (x, y) = (radius * cos, radius * sin);
        // The disk, squeezed towards −x to the part that is kept.
        let s = R::lit(0.5) + R::lit(0.5) * self.tilt().recip();
        let edge = ((R::ONE - y) * (R::ONE + y)).max(R::ZERO).sqrt();
        let squeezed = -(s * (x - edge) + edge);
        // 1 − x² − y² = (edge + x)(edge − x) of the squeezed x.
        let z = (s * (edge - x) * (edge - squeezed)).max(R::ZERO).sqrt();
        let w = Vec3::new(self.a * squeezed + self.b * z, self.c * y, self.d * squeezed + z);
        let [ax, ay] = self.azimuth;
        Vec3::new(ax * w.x - ay * w.y, ay * w.x + ax * w.y, w.z).normalize_or(Vec3::unit_z())
    }

    /// Density of [`Cltc::sample`] \[1/sr\].
    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>) -> R {
        let [ax, ay] = self.azimuth;
        let (x, y) = (ax * wi.x + ay * wi.y, ax * wi.y - ay * wi.x);
        let inner = self.a - self.b * self.d;
        let determinant = self.c * inner;
        // The adjugate of M: wi back to the cosine, times |M|.
        let w = Vec3::new(self.c * (x - self.b * wi.z), inner * y, self.c * (self.a * wi.z - self.d * x));
        let ratio = determinant / w.length2();
        let tilt = self.tilt();
        ratio * ratio * w.z.max(R::ZERO) * (tilt / (tilt + R::ONE)) * R::lit(2.0 * FRAC_1_PI)
    }
}

impl<R: Real> Lobe<R> for Eon<R> {
    type Prepared = ();

    #[inline(always)]
    fn prepare(&self, _wo: Vec3<R>, _transport: Transport) {}

    #[inline]
    fn eval(&self, wo: Vec3<R>, _prepared: &(), wi: Vec3<R>) -> Value<R> {
        let r = self.roughness;
        let s = wo.x.mul_add(wi.x, wo.y * wi.y);
        // μ_i (1 + r s/t), for either sign of s.
        let towards = (r * s).mul_add(wi.z / wo.z.max(wi.z), wi.z);
        let (x, y) = (wo.x + wi.x, wo.y + wi.y);
        let one_plus_s = R::lit(0.5) * x.mul_add(x, y * y + (wo.z * wo.z + wi.z * wi.z));
        let away = wi.z * r.mul_add(one_plus_s, R::ONE - r);
        let single = R::select(s.gt(R::ZERO), towards, away);
        let multiple = r * self.loss(wo) * self.loss(wi) * wi.z;
        let scale = R::lit(FRAC_1_PI) / R::lit(C1).mul_add(r, R::ONE);
        let f_cos = self.albedo.map(|albedo| scale * albedo.mul_add(single, self.multiple(albedo) * multiple));
        let share = self.uniform_share(wo.z);
        let uniform = pdf_uniform_sphere::<R>() + pdf_uniform_sphere();
        let pdf = share.mul_add(uniform, (R::ONE - share) * Cltc::of(wo, r).pdf(wi));
        Value { f_cos, pdf }.or_zero(both_above(wo, wi))
    }

    #[inline]
    fn sample(&self, wo: Vec3<R>, _prepared: &(), u: [R; 3]) -> Sample<R> {
        let sphere = sample_uniform_sphere([u[1], u[2]]);
        let uniform = Vec3::new(sphere.x, sphere.y, sphere.z.abs());
        let cltc = Cltc::of(wo, self.roughness).sample([u[1], u[2]]);
        let wi = Vec3::select(u[0].lt(self.uniform_share(wo.z)), uniform, cltc);
        Sample { wi, event: Event::reflected(!both_above(wo, wi)) }
    }

    #[inline(always)]
    fn delta(&self, _wo: Vec3<R>, _prepared: &Self::Prepared, _sample: &Sample<R>) -> Value<R> {
        Value::zero()
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
        let a = R::lit(C1).mul_add(self.roughness, R::ONE).recip();
        let lost = a * self.roughness * self.loss(wo);
        self.albedo.map(|albedo| {
            let multiple = self.multiple(albedo) * R::lit(C1 - C2);
            albedo.mul_add(R::ONE - lost, multiple * lost).max(R::ZERO)
        })
    }

    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.in_domain()
    }

    /// The fit bounds energy to 2e-3 only.
    #[inline(always)]
    fn properties(&self) -> Properties<R> {
        let analytic = self.directional == EonAlbedo::Analytic;
        let Rgb { r, g, b } = self.albedo;
        let white = (r.same(R::ONE) & g.same(R::ONE) & b.same(R::ONE)).all();
        let known = analytic && (white || self.roughness.same(R::ZERO).all());
        Properties {
            excess: if analytic { 0.0 } else { 2e-3 },
            albedo: known.then_some(self.albedo),
            // The closed form holds for unit directions, and those of f32 are unit to its precision only.
            albedo_error: 1e-7,
            symmetric: true,
            ..Properties::LAWFUL
        }
    }

    #[inline(always)]
    fn largest_weight(&self, _wo: Vec3<R>) -> R {
        R::lit(LARGEST_WEIGHT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lobe::Lambert;
    use crate::testing::{Bare, Random, close};

    const BOTH: [EonAlbedo; 2] = [EonAlbedo::Analytic, EonAlbedo::Fitted];

    fn white<R: Real>(roughness: R, directional: EonAlbedo) -> Eon<R> {
        Eon { directional, ..Eon::new(Rgb::splat(R::ONE), roughness) }
    }

    fn double(w: Vec3<f32>) -> Vec3<f64> {
        Vec3::new(f64::from(w.x), w.y.into(), w.z.into()).normalize()
    }

    #[test]
    fn without_roughness_it_is_lambert() {
        let mut random = Random(31);
        let colour = Rgb::new(0.8_f64, 0.5, 0.2);
        for directional in BOTH {
            let (eon, lambert) = (Eon { directional, ..Eon::new(colour, 0.0) }, Lambert::new(colour));
            for _ in 0..1000 {
                let (wo, wi) = (double(random.above()), double(random.above()));
                let (a, b) = (eon.value(wo, wi), lambert.value(wo, wi));
                assert!(close(a.f_cos.g, b.f_cos.g, 1e-6) && close(a.pdf, b.pdf, 1e-6), "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn a_white_surface_returns_all_light_exactly_or_to_two_per_mille() {
        // Midpoints of the disk: ∫ f cos dω = ∫ f dx dy.
        for (directional, tolerance) in [(EonAlbedo::Analytic, 1e-4), (EonAlbedo::Fitted, 2e-3)] {
            for roughness in [0.25_f64, 0.5, 1.0] {
                for cos in [1.0, 0.7, 0.3, 0.1_f64] {
                    let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                    let (eon, rows, columns) = (white(roughness, directional), 400, 400);
                    let mut sum = 0.0;
                    for row in 0..rows {
                        let z = (f64::from(row) + 0.5) / f64::from(rows);
                        for column in 0..columns {
                            let (sin, c) = ((f64::from(column) + 0.5) / f64::from(columns) * TAU).sin_cos();
                            let s = (1.0 - z * z).sqrt();
                            sum += eon.value(wo, Vec3::new(s * c, s * sin, z)).f_cos.r;
                        }
                    }
                    let albedo = sum * TAU / f64::from(rows) / f64::from(columns);
                    assert!(close(albedo, 1.0, tolerance), "{directional:?} {roughness} {cos}: {albedo}");
                    assert!(close(eon.albedo_estimate(wo).r, 1.0, 1e-12));
                }
            }
        }
    }

    #[test]
    fn light_takes_the_same_way_back() {
        let mut random = Random(32);
        for directional in BOTH {
            let eon = Eon { directional, ..Eon::new(Rgb::new(0.8_f32, 0.5, 0.2), 0.7) };
            for _ in 0..1000 {
                let (a, b) = (random.above(), random.above());
                let (there, back) = (eon.value(a, b).f_cos.g * a.z, eon.value(b, a).f_cos.g * b.z);
                assert!((there - back).abs() <= 1e-6 * there, "{a:?} {b:?}: {there} and {back}");
            }
        }
    }

    #[test]
    fn a_rough_surface_shines_back_to_where_the_light_comes_from() {
        let eon = white(1.0_f64, EonAlbedo::Analytic);
        let (wo, away) = (Vec3::new(0.8, 0.0, 0.6), Vec3::new(-0.8, 0.0, 0.6));
        assert!(eon.value(wo, wo).f_cos.r > 2.5 * eon.value(wo, away).f_cos.r);
    }

    #[test]
    fn no_sample_weighs_more_than_promised() {
        let (mut random, mut largest) = (Random(33), 0.0_f64);
        for directional in BOTH {
            for round in 0..400_000 {
                let roughness = if round % 4 == 0 { 10.0_f32.powf(-12.0 * random.unit()) } else { 1.0 - random.unit() };
                let eon = white(f64::from(roughness), directional);
                let mut grazing = |w: Vec3<f32>| {
                    let z = if random.unit() < 0.5 { w.z } else { w.z * 10.0_f32.powf(-8.0 * random.unit()) };
                    Vec3::new(f64::from(w.x), w.y.into(), z.into()).normalize()
                };
                let mut other = Random(round);
                let (wo, wi) = (grazing(other.above()), grazing(other.above()));
                let value = eon.value(wo, wi);
                largest = largest.max(value.f_cos.r / value.pdf);
            }
        }
        assert!(largest <= LARGEST_WEIGHT, "{largest}");
    }
}
