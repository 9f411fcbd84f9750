//! Fresnel's equations: which part of unpolarised light a smooth interface reflects.
//!
//! Cosines are those between the direction and the (micro)normal, on wo's side. Results lie in [0, 1].

use crate::energy::{AlbedoCurve, facet_cosines};
use crate::metal::Metal;
use crate::model::{ETA, EXTINCTION, INDEX, REFLECTANCE};
use crate::real::{Mask, Real};
use crate::rgb::Rgb;

/// What an interface between two dielectrics does with unpolarised light.
#[derive(Clone, Copy, Debug)]
pub struct Interface<R> {
    /// The reflected part, in [0, 1].
    pub reflected: R,
    /// The transmitted part, 1 − reflected, but exact where that cancels.
    pub transmitted: R,
}

/// Cosine of the refracted direction by Snell's law, eta = η_t/η_i > 0 seen from wo's side; 0 in total reflection.
#[inline(always)]
pub fn refracted_cosine<R: Real>(cos_o: R, eta: R) -> R {
    let [cos_t] = R::named(
        "refracted_cosine",
        [cos_o, eta],
        #[inline(always)]
        |[cos_o, eta]| {
            // η² − sin²θ. Near η = 1 that cancels for grazing cosines, where (η − 1)(η + 1) + cos²θ does not.
            let sin2_o = (R::ONE - cos_o) * (R::ONE + cos_o);
            let near = eta.gt(R::lit(0.5)) & eta.lt(R::lit(2.0));
            let excess =
                R::select(near, (eta - R::ONE).mul_add(eta + R::ONE, cos_o * cos_o), eta.mul_add(eta, -sin2_o));
            [(excess / (eta * eta)).max(R::ZERO).sqrt()]
        },
    );
    cos_t
}

/// An interface between two dielectrics met under the angles of these cosines, in [0, 1], which obey Snell's law for
/// eta = η_t/η_i > 0; cos_t = 0 is total reflection.
///
/// Born & Wolf, Principles of Optics, section 1.5:
/// $r_\parallel = (\eta c_o - c_t)/(\eta c_o + c_t)$, $r_\perp = (c_o - \eta c_t)/(c_o + \eta c_t)$, reflected
/// $(r_\parallel^2 + r_\perp^2)/2$; and $1 - r^2 = 4 \eta c_o c_t/(\dots)^2$ for what is transmitted.
#[inline(always)]
pub fn interface<R: Real>(cos_o: R, cos_t: R, eta: R) -> Interface<R> {
    let [reflected, transmitted] = R::named(
        "interface",
        [cos_o, cos_t, eta],
        #[inline(always)]
        |[cos_o, cos_t, eta]| {
            let (along, across) = (eta.mul_add(cos_o, cos_t).recip(), eta.mul_add(cos_t, cos_o).recip());
            let parallel = (eta * cos_o - cos_t) * along;
            let perpendicular = (cos_o - eta * cos_t) * across;
            let half = R::lit(0.5);
            let through = R::lit(4.0) * eta * cos_o * cos_t;
            // Both cosines 0 or nearly: an index matched at grazing. Everything is reflected.
            let total = cos_t.le(R::ZERO) | !along.is_finite() | !across.is_finite();
            [
                R::select(total, R::ONE, (parallel.sqr() + perpendicular.sqr()) * half).min(R::ONE),
                ((through * along * along + through * across * across) * half).min(R::ONE).or_zero(!total),
            ]
        },
    );
    Interface { reflected, transmitted }
}

/// Reflectance of an interface between two dielectrics at cos_o in [0, 1], eta = η_t/η_i > 0 seen from wo's side. 1 beyond the
/// critical angle.
#[inline(always)]
pub fn dielectric<R: Real>(cos_o: R, eta: R) -> R {
    interface(cos_o, refracted_cosine(cos_o, eta), eta).reflected
}

/// Reflectance of a conductor of index η − ik seen from vacuum, for one wavelength or channel; cos_o in [0, 1], η > 0, k ≥ 0.
///
/// With a − ib = √((η − ik)² − sin²θ) (Born & Wolf, section 14.2):
/// R⊥ = ((a − cosθ)² + b²)/((a + cosθ)² + b²), R∥ = R⊥ · ((a cosθ − sin²θ)² + b²cos²θ)/((a cosθ + sin²θ)² + b²cos²θ).
#[inline(always)]
pub fn conductor<R: Real>(cos_o: R, eta: R, k: R) -> R {
    let (n, d) = ConductorAngle::new(cos_o, cos_o * cos_o).fraction(eta, k);
    (n / d).min(R::ONE)
}

/// [`conductor`] of three channels, with one division for all; cos²θ is given too, since callers know it before its root.
#[inline(always)]
pub(crate) fn conductor_rgb<R: Real>(cos_o: R, cos2_o: R, eta: Rgb<R>, k: Rgb<R>) -> Rgb<R> {
    let angle = ConductorAngle::new(cos_o, cos2_o);
    let (r, g, b) = (angle.fraction(eta.r, k.r), angle.fraction(eta.g, k.g), angle.fraction(eta.b, k.b));
    let rg = r.1 * g.1;
    let product = rg * b.1;
    let inverse = product.recip();
    let (over_rg, over_b) = (b.1 * inverse, rg * inverse);
    let mut reflectance = Rgb::new(r.0 * (g.1 * over_rg), g.0 * (r.1 * over_rg), b.0 * over_b);
    // Denominators lie between 10⁻³² and 10¹³, the least at critical angles: where their product leaves `f32`, one by one. A
    // product of three above 10⁻¹⁸ has none below 10⁻³², and none of two.
    let ordinary = product.gt(R::lit(1e-18)) & product.lt(R::lit(1e38));
    if !ordinary.all() {
        reflectance = Rgb::select(ordinary, reflectance, Rgb::new(r.0 / r.1, g.0 / g.1, b.0 / b.1));
    }
    reflectance.map(|x| x.min(R::ONE))
}

/// What [`conductor`] needs of the angle, for all channels.
#[derive(Clone, Copy)]
struct ConductorAngle<R> {
    cos2: R,
    sin2: R,
    sin4: R,
    /// √2 cosθ.
    scaled_cos: R,
}

impl<R: Real> ConductorAngle<R> {
    #[inline(always)]
    fn new(cos: R, cos2: R) -> Self {
        let sin2 = R::ONE - cos2;
        Self { cos2, sin2, sin4: sin2 * sin2, scaled_cos: cos * R::lit(core::f64::consts::SQRT_2) }
    }

    /// Numerator and denominator of [`conductor`], the latter below 10¹⁴ for η and k up to 100.
    ///
    /// With s² = (|a² + b²| + |t|)/2 and t = a² − b² = η² − k² − sin²θ, as = s² and bs = ηk where t ≥ 0, the other way round
    /// elsewhere: neither a nor b is formed by subtraction, and multiplied by s no division is left.
    /// (R⊥ + R∥)/2 = ((as − s cosθ)² + (bs)²) q / ((sp + 2as cosθ)(sq + 2as cosθ sin²θ)) with p = a² + b² + cos²θ and
    /// q = (a² + b²)cos²θ + sin⁴θ; here with √2 s and both times 2. Only as − s cosθ cancels, for η near 1 and small k,
    /// where nothing else could say how much is reflected.
    #[inline(always)]
    fn fraction(self, eta: R, k: R) -> (R, R) {
        let args = [self.cos2, self.sin2, self.sin4, self.scaled_cos, eta, k];
        let [numerator, denominator] = R::named(
            "conductor_fraction",
            args,
            #[inline(always)]
            |[cos2, sin2, sin4, scaled_cos, eta, k]| {
                let (numerator, denominator) = Self { cos2, sin2, sin4, scaled_cos }.fraction_text(eta, k);
                [numerator, denominator]
            },
        );
        (numerator, denominator)
    }

    #[inline(always)]
    fn fraction_text(self, eta: R, k: R) -> (R, R) {
        // Of the material alone: η² − k² − 1, with which t does not cancel for η near 1; and where it is near −1, what rounding
        // it has lost, so that t does not cancel for small η either.
        let constant = (-k).mul_add(k, eta.mul_add(eta, -R::ONE));
        let lost = eta.mul_add(eta, (-k).mul_add(k, -(constant + R::ONE)));
        let lost = lost.or_zero(constant.gt(R::lit(-2.0)) & constant.lt(R::lit(-0.5)));
        let ab = R::lit(2.0) * eta * k;
        // At the critical angle of a lossless index s is 0, and so would be both parts of the fraction.
        let ab2 = (ab * ab).max(R::lit(1e-32));

        let t = constant + self.cos2 + lost;
        let a2b2 = t.mul_add(t, ab2).sqrt();
        let s2 = a2b2 + t.abs();
        let s = s2.sqrt();
        let inside = t.lt(R::ZERO);
        let (a_s, b_s) = (R::select(inside, ab, s2), R::select(inside, s2, ab));
        let difference = (-s).mul_add(self.scaled_cos, a_s);
        let twice = a_s * self.scaled_cos;
        let q = self.cos2.mul_add(a2b2, self.sin4);
        let numerator = difference.mul_add(difference, b_s * b_s) * (R::lit(0.5) * q);
        (numerator, s.mul_add(a2b2 + self.cos2, twice) * s.mul_add(q, twice * self.sin2))
    }
}

/// Schlick's approximation: f0 + (1 − f0)(1 − cosθ)⁵. Schlick 1994, "An Inexpensive BRDF Model for Physically-based Rendering".
#[inline(always)]
pub fn schlick<R: Real>(cos_o: R, f0: R) -> R {
    let [reflectance] = R::named(
        "schlick",
        [cos_o, f0],
        #[inline(always)]
        |[cos_o, f0]| {
            let m = (R::ONE - cos_o).max(R::ZERO);
            let m2 = m * m;
            [(R::ONE - f0).mul_add(m2 * m2 * m, f0)]
        },
    );
    reflectance
}

/// Schlick's curve bent through `tint` times its own value at cosθ = 1/7 (82°):
/// schlick(cosθ) − b cosθ (1 − cosθ)⁶ with b = schlick(1/7)(1 − tint)/((1/7)(6/7)⁶), not below 0.
/// Kutz, Hašan & Edmondson 2021, "Novel aspects of the Adobe Standard Material", after Lazányi & Szirmay-Kalos 2005.
#[inline(always)]
pub fn f82<R: Real>(cos_o: R, f0: R, tint: R) -> R {
    let [reflectance] = R::named(
        "f82",
        [cos_o, f0, tint],
        #[inline(always)]
        |[cos_o, f0, tint]| {
            let m = (R::ONE - cos_o).max(R::ZERO);
            let m2 = m * m;
            let m5 = m2 * m2 * m;
            [(f82_bend(f0, tint) * cos_o * m).mul_add(-m5, (R::ONE - f0).mul_add(m5, f0)).max(R::ZERO)]
        },
    );
    reflectance
}

/// b of [`f82`]: by how much cosθ(1 − cosθ)⁶ bends Schlick's curve.
#[inline(always)]
fn f82_bend<R: Real>(f0: R, tint: R) -> R {
    const M5: f64 = 7776.0 / 16807.0; // (6/7)⁵
    (R::ONE - f0).mul_add(R::lit(M5), f0) * (R::ONE - tint) * R::lit(49.0 / (6.0 * M5))
}

crate::one_of! {
    /// What the reflecting interface is made of.
    pub enum Fresnel<R> {
        /// A conductor.
        Conductor {
            /// Index of refraction.
            eta: Rgb<R> in ETA,
            /// Extinction coefficient.
            k: Rgb<R> in EXTINCTION,
        },
        /// Schlick's curve.
        Schlick {
            /// Reflectance at normal incidence.
            f0: Rgb<R> in REFLECTANCE,
        },
        /// Schlick's curve with a dip at 82°, as metals have; see [`f82`].
        F82 {
            /// Reflectance at normal incidence.
            f0: Rgb<R> in REFLECTANCE,
            /// What is left of Schlick's value at 82°.
            tint("f82"): Rgb<R> in REFLECTANCE,
        },
        /// The reflection of a dielectric, whose transmitted light is not of interest.
        Dielectric {
            /// Index behind the interface over that before it.
            eta("ior"): R in INDEX,
        },
    }
    or (metal: Metal, " A metal whose index is known.") => metal.into();
}

impl<R: Real> From<Metal> for Fresnel<R> {
    fn from(metal: Metal) -> Self {
        let [eta, k] = metal.index();
        Self::Conductor { eta: eta.map(R::lit), k: k.map(R::lit) }
    }
}

impl<R: Real> Fresnel<R> {
    /// The reflectance of each channel at cos_o in [0, 1].
    #[inline(always)]
    pub fn reflectance(&self, cos_o: R) -> Rgb<R> {
        self.reflectance_of_squared(cos_o, cos_o * cos_o)
    }

    /// [`Fresnel::reflectance`] where the square of the cosine is known too.
    #[inline(always)]
    pub(crate) fn reflectance_of_squared(&self, cos_o: R, cos2_o: R) -> Rgb<R> {
        match *self {
            Self::Conductor { eta, k } => conductor_rgb(cos_o, cos2_o, eta, k),
            Self::Schlick { f0 } => f0.map(|f0| schlick(cos_o, f0)),
            Self::F82 { f0, tint } => {
                Rgb::new(f82(cos_o, f0.r, tint.r), f82(cos_o, f0.g, tint.g), f82(cos_o, f0.b, tint.b))
            }
            Self::Dielectric { eta } => Rgb::splat(dielectric(cos_o, eta)),
        }
    }

    /// The directional albedo of GGX facets of this material, or of a smooth interface for alpha = 0, as a curve that errs upwards; none
    /// for a material that nothing shines through. For an index beyond \[1, 3\] it is 1: nothing is let through.
    #[inline(always)]
    pub fn albedo_curve(&self, alpha: R) -> Option<AlbedoCurve<R>> {
        match *self {
            Self::Schlick { f0 } => Some(AlbedoCurve::schlick(alpha, f0)),
            Self::Dielectric { eta } => Some(AlbedoCurve::dielectric(alpha, eta)),
            Self::Conductor { .. } | Self::F82 { .. } => None,
        }
    }

    /// The mean reflectance of the facets that light meets which is scattered more than once: see [`facet_cosines`].
    #[inline(always)]
    pub fn of_facets(&self, alpha: R, cos_o: R, cos_i: R) -> Rgb<R> {
        let [steep, flat] = facet_cosines(alpha, cos_o, cos_i).map(|cos| self.reflectance(cos));
        (steep + flat) * R::lit(0.5)
    }
}

#[cfg(test)]
mod tests;
