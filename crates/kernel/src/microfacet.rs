//! Microfacets: distributions of normals, and what masking, shadowing and densities they all share.
//!
//! A distribution has a density of normals D(m) and Smith's masking (Smith 1967; Heitz 2014). Its Λ enters as the length
//!
//! $$ s(w) = |\cos\theta|\\,(1 + 2\Lambda(w)) $$
//!
//! which needs no division by a grazing cosine. (|cosθ| + s)/2 is the area of the microsurface that w sees, per area of the
//! surface. With c = |cosθ|:
//!
//! - masking $G_1 = 2c/(c + s)$,
//! - height-correlated $G_2/(4 c_o c_i) = 1/(2(c_i s_o + c_o s_i))$,
//! - separable $G_1 G_1/(4 c_o c_i) = 1/((c_o + s_o)(c_i + s_i))$,
//! - visible normals $D_o(m) = G_1(o)\\,D(m)\\,|o·m|/c_o = 2 D(m)\\,|o·m|/(c_o + s_o)$.

mod beckmann;
mod ggx;
mod visible;

pub use beckmann::Beckmann;
pub use ggx::Ggx;
pub use visible::{Reach, pdf_visible_reflected, reflect};

pub use crate::model::quantity::ALPHA_MIN;

use crate::model::{ALPHA, MICROFACET_ROUGHNESS};
use crate::real::Real;
use crate::vec3::Vec3;

crate::choice! {
    /// How masking of wo and shadowing of wi go together.
    pub enum Masking {
        /// Points that wo sees high up are seen by wi too: 1/(1 + Λ(wo) + Λ(wi)).
        HeightCorrelated = "correlated",
        /// G₁(wo) G₁(wi): darker, as if heights did not matter. What Walter et al. 2007 and Mitsuba use.
        Separable = "separable",
    }
}

crate::choice! {
    /// Which distribution of microfacet normals.
    pub enum Distribution {
        /// See [`Ggx`].
        Ggx = "ggx",
        /// See [`Beckmann`].
        Beckmann = "beckmann",
    }
}

crate::one_of! {
    /// How rough: alpha is the width of the distribution of slopes.
    pub struct Alphas<R> {
        /// Along the tangent.
        alpha_x: R in ALPHA,
        /// Along the bitangent.
        alpha_y: R in ALPHA,
    }
    or (
        /// Along both.
        alpha: R in ALPHA
    ) => Self { alpha_x: alpha, alpha_y: alpha };
    or (
        /// Its square is alpha: 0.1 is polished, 0.3 brushed, 0.7 sandblasted.
        roughness: R in MICROFACET_ROUGHNESS
    ) => Self { alpha_x: roughness * roughness, alpha_y: roughness * roughness };
    or () => Self { alpha_x: R::lit(0.3 * 0.3), alpha_y: R::lit(0.3 * 0.3) };
}

crate::group! {
    /// A distribution of microfacet normals.
    pub struct Microfacets<R> {
        /// Which distribution of normals.
        distribution: Distribution = Ggx,
        /// How rough.
        alphas: Alphas<R>,
    }
}

impl<R> From<Ggx<R>> for Microfacets<R> {
    #[inline(always)]
    fn from(Ggx { alpha_x, alpha_y }: Ggx<R>) -> Self {
        Self { distribution: Distribution::Ggx, alphas: Alphas { alpha_x, alpha_y } }
    }
}

impl<R> From<Beckmann<R>> for Microfacets<R> {
    #[inline(always)]
    fn from(Beckmann { alpha_x, alpha_y }: Beckmann<R>) -> Self {
        Self { distribution: Distribution::Beckmann, alphas: Alphas { alpha_x, alpha_y } }
    }
}

impl<R: Real> Microfacets<R> {
    #[inline(always)]
    fn ggx(&self) -> Ggx<R> {
        Ggx { alpha_x: self.alphas.alpha_x, alpha_y: self.alphas.alpha_y }
    }
    #[inline(always)]
    fn beckmann(&self) -> Beckmann<R> {
        Beckmann { alpha_x: self.alphas.alpha_x, alpha_y: self.alphas.alpha_y }
    }
    /// D of the normal along h (any length, h.z ≥ 0), with |h|² given \[1/sr\].
    #[inline(always)]
    pub fn d(&self, h: Vec3<R>, h_length2: R) -> R {
        match self.distribution {
            Distribution::Ggx => self.ggx().d(h, h_length2),
            Distribution::Beckmann => self.beckmann().d(h, h_length2),
        }
    }
    /// s(w) = |cosθ|(1 + 2Λ(w)).
    #[inline(always)]
    pub fn smith_length(&self, w: Vec3<R>) -> R {
        match self.distribution {
            Distribution::Ggx => self.ggx().smith_length(w),
            Distribution::Beckmann => self.beckmann().smith_length(w),
        }
    }
    /// Which visible normals reflectors sample: those that may reflect above the horizon, as far as that is known.
    #[inline(always)]
    pub fn reach(&self, wo: Vec3<R>, s_o: R) -> Reach<R> {
        match self.distribution {
            Distribution::Ggx => self.ggx().reach(wo, s_o),
            Distribution::Beckmann => Reach::whole(wo, s_o),
        }
    }
    /// A normal of any length, distributed as those visible from wo (above the surface) within reach, with s(wo) given.
    #[inline(always)]
    pub fn sample_visible(&self, wo: Vec3<R>, s_o: R, reach: Reach<R>, u: [R; 2]) -> Vec3<R> {
        match self.distribution {
            Distribution::Ggx => self.ggx().sample_visible(wo, s_o, reach, u),
            Distribution::Beckmann => self.beckmann().sample_visible(wo, u),
        }
    }
    /// alpha along tangent and bitangent.
    #[inline(always)]
    pub fn alphas(&self) -> [R; 2] {
        [self.alphas.alpha_x, self.alphas.alpha_y]
    }
    /// Whether both alphas are the same, in every lane.
    #[inline(always)]
    pub fn is_isotropic(&self) -> R::Mask {
        self.alphas.alpha_x.same(self.alphas.alpha_y)
    }
}

/// G₂/(4 cos_o), which is vis · cos_i; cosines positive, s(wo) and s(wi) given.
#[inline(always)]
pub fn vis_cos_i<R: Real>(masking: Masking, cos_o: R, s_o: R, cos_i: R, s_i: R) -> R {
    match masking {
        Masking::HeightCorrelated => {
            // The ratio stays finite where the products of denormal cosines and widths would underflow. 2⁶⁶, which rounds nothing.
            let lift = R::lit(73_786_976_294_838_206_464.0);
            let (cos_o, cos_i) = (cos_o * lift, cos_i * lift);
            R::lit(0.5) * cos_i / cos_i.mul_add(s_o, cos_o * s_i)
        }
        Masking::Separable => cos_i / ((cos_o + s_o) * (cos_i + s_i)),
    }
}
