//! `Lobe`: the contract that every scattering model obeys. Its models are one file each.
//!
//! A lobe has a continuous part, described by a density over directions, and may have a discrete part, a set of single
//! directions with probabilities. [`Lobe::eval`] is the only author of value and density of the continuous part,
//! [`Lobe::discrete`] the only author of weight and probability of the discrete part, and [`Lobe::sample`] only chooses.
//! So value and density cannot drift apart, and a purely discrete lobe evaluates to 0, 0.
//!
//! **Transport.** Values are those of radiance: light that crosses into a denser medium is compressed into a narrower cone,
//! so transmitted values carry 1/η² ([`Lobe::compression`]). Furnaces and albedos are about importance, which does not.
//! For radiance f(wo, wi) η_i² = f(wi, wo) η_o², with η_o the index on wo's side (Veach 1997, section 5.2).
//!
//! Inside the domain (unit directions to 1e-3 in |w|², parameters in range) every result is finite and non-negative with
//! no guard. Outside, a lobe may return anything but must not panic; [`crate::Closure`] turns that into exact zeros.

mod conductor;
mod dielectric;
pub mod eon;
mod lambert;
mod mirror;
mod phong;
mod rough_dielectric;
mod two_sided;

pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use eon::Eon;
pub use lambert::Lambert;
pub use mirror::Mirror;
pub use phong::{Phong, PhongNorm};
pub use rough_dielectric::RoughDielectric;
pub use two_sided::TwoSided;

use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::vec3::Vec3;

/// What a pair of directions, or a discrete event, is worth.
#[derive(Clone, Copy, Debug)]
pub struct Value<R> {
    /// f·|cos_i| \[1/sr\]; for a discrete event its weight times its probability.
    pub f_cos: Rgb<R>,
    /// Density per solid angle \[1/sr\]; for a discrete event its probability. 0 means it cannot happen.
    pub pdf: R,
}

/// What a sample did.
#[derive(Clone, Copy, Debug)]
pub struct Event<R: Real> {
    /// Which lobe of a closure made it; 0 for a lobe of its own.
    pub lobe: R::Int,
    /// `wi` lies on the other side of the surface.
    pub transmitted: R::Mask,
    /// `wi` came from a discrete part: its worth is [`Lobe::discrete`], not [`Lobe::eval`].
    pub discrete: R::Mask,
    /// Nothing was sampled: `wi` is some finite unit direction, to be ignored.
    pub failed: R::Mask,
}

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct Sample<R: Real> {
    /// The direction, local, unit.
    pub wi: Vec3<R>,
    /// How it came about.
    pub event: Event<R>,
}

/// Up to five numbers of a lobe that depend on wo alone; what they mean is the lobe's own business.
#[derive(Clone, Copy, Debug)]
pub struct Prepared<R>(pub [R; 5]);

/// Which laws of physics a model claims to obey. What it does not claim, it breaks on purpose: instruments measure that too,
/// so a claim can be stale in either way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Properties {
    /// Light takes the same way back, f(wo, wi) = f(wi, wo), through an interface up to η²; else it measurably does not.
    pub reciprocal: bool,
    /// No directional albedo exceeds 1 + `excess`; else one measurably exceeds 1 (at parameters as bright as the domain allows).
    pub conserving: bool,
    /// How far above 1 the albedo may lie by the model's own admission, as that of a fitted model does; 0 for most.
    pub excess: f32,
    /// By how many units `f32` may differ from `f64` on the same numbers; a unit is the larger of eps·f and the largest change
    /// of f when one input moves by one unit in the last place. 8, unless a fitted function adds roundings of its own.
    pub units: f32,
}

impl Properties {
    /// Reciprocal, conserves energy exactly, and accurate to 8 units.
    pub const LAWFUL: Self = Self { reciprocal: true, conserving: true, excess: 0.0, units: 8.0 };
}

/// A scattering model with its parameters, in the local frame.
///
/// Implement [`Lobe::eval`] and [`Lobe::sample`]; or, where something expensive depends on wo alone, [`Lobe::prepare`] with
/// [`Lobe::eval_prepared`] and [`Lobe::sample_prepared`]. The one pair is made from the other.
pub trait Lobe<R: Real> {
    /// f·|cos_i| and density of the continuous part: 0, 0 for a purely discrete lobe.
    #[inline(always)]
    fn eval(&self, wo: Vec3<R>, wi: Vec3<R>) -> Value<R> {
        self.eval_prepared(wo, &self.prepare(wo), wi)
    }

    /// Chooses wi for wo. `u` are three uniform numbers in [0, 1); the first serves choices, the others positions.
    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R> {
        self.sample_prepared(wo, &self.prepare(wo), u)
    }

    /// What depends on wo alone: computed once where a closure is asked several times.
    #[inline(always)]
    fn prepare(&self, _wo: Vec3<R>) -> Prepared<R> {
        Prepared([R::ZERO; 5])
    }

    /// [`Lobe::eval`] with what [`Lobe::prepare`] returned for the same wo.
    #[inline(always)]
    fn eval_prepared(&self, wo: Vec3<R>, _prepared: &Prepared<R>, wi: Vec3<R>) -> Value<R> {
        self.eval(wo, wi)
    }

    /// [`Lobe::sample`] with what [`Lobe::prepare`] returned for the same wo.
    #[inline(always)]
    fn sample_prepared(&self, wo: Vec3<R>, _prepared: &Prepared<R>, u: [R; 3]) -> Sample<R> {
        self.sample(wo, u)
    }

    /// Weight times probability, and probability, of a discrete event that [`Lobe::sample`] returned for this wo.
    fn discrete(&self, _wo: Vec3<R>, _event: &Event<R>) -> Value<R> {
        Value::zero()
    }

    /// About how much of the light from wo is scattered: steers the choice between lobes, never a result.
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R>;

    /// Whether the parameters lie in their domain.
    fn domain(&self) -> R::Mask;

    /// η² seen from wo, η = η_t/η_i: what transmitted radiance is divided by. Multiplied by it, a transmitted value is that of
    /// importance, which conserves energy. 1 for lobes that only reflect.
    #[inline(always)]
    fn compression(&self, _wo: Vec3<R>) -> R {
        R::ONE
    }

    /// Which laws the model claims to obey at these parameters.
    #[inline(always)]
    fn properties(&self) -> Properties {
        Properties::LAWFUL
    }
}

impl<R: Real> Value<R> {
    /// No light, cannot happen.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { f_cos: Rgb::zero(), pdf: R::ZERO }
    }
    /// self where `mask`, exact zeros elsewhere.
    #[inline(always)]
    pub fn or_zero(self, mask: R::Mask) -> Self {
        Self { f_cos: self.f_cos.or_zero(mask), pdf: self.pdf.or_zero(mask) }
    }
    /// Finite and non-negative throughout.
    #[inline(always)]
    pub fn is_sound(&self) -> R::Mask {
        let sound = |x: R| x.ge(R::ZERO) & x.is_finite();
        sound(self.f_cos.r) & sound(self.f_cos.g) & sound(self.f_cos.b) & sound(self.pdf)
    }
}

impl<R: Real> Event<R> {
    /// A continuous reflection that failed where `failed`.
    #[inline(always)]
    pub fn reflected(failed: R::Mask) -> Self {
        let no = R::Mask::splat(false);
        Self { lobe: R::int(0), transmitted: no, discrete: no, failed }
    }

    /// `yes` where `mask`, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        let choose = |yes: R::Mask, no: R::Mask| (mask & yes) | (!mask & no);
        Self {
            lobe: R::int_select(mask, yes.lobe, no.lobe),
            transmitted: choose(yes.transmitted, no.transmitted),
            discrete: choose(yes.discrete, no.discrete),
            failed: choose(yes.failed, no.failed),
        }
    }
}

/// The table of models: calls `$macro!` with the name of every lobe. The enum that closures hold, the proof that the
/// kernel cannot panic and the rows of the validation are made from it, so a lobe that is missing somewhere fails to build.
#[macro_export]
macro_rules! for_each_lobe {
    ($macro:ident) => {
        $macro! { Lambert, Mirror, Conductor, Dielectric, RoughDielectric, Phong, Eon }
    };
}

macro_rules! any_lobe {
    ($($model:ident),*) => {
        /// Any of the kernel's lobes.
        #[derive(Clone, Copy, Debug)]
        pub enum AnyLobe<R> {$(
            #[doc = concat!("See [`", stringify!($model), "`].")]
            $model($model<R>),
        )*}

        impl<R: Real> Lobe<R> for AnyLobe<R> {
            #[inline]
            fn eval(&self, wo: Vec3<R>, wi: Vec3<R>) -> Value<R> {
                match self {$( Self::$model(lobe) => lobe.eval(wo, wi), )*}
            }
            #[inline]
            fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R> {
                match self {$( Self::$model(lobe) => lobe.sample(wo, u), )*}
            }
            #[inline]
            fn prepare(&self, wo: Vec3<R>) -> Prepared<R> {
                match self {$( Self::$model(lobe) => lobe.prepare(wo), )*}
            }
            #[inline]
            fn eval_prepared(&self, wo: Vec3<R>, prepared: &Prepared<R>, wi: Vec3<R>) -> Value<R> {
                match self {$( Self::$model(lobe) => lobe.eval_prepared(wo, prepared, wi), )*}
            }
            #[inline]
            fn sample_prepared(&self, wo: Vec3<R>, prepared: &Prepared<R>, u: [R; 3]) -> Sample<R> {
                match self {$( Self::$model(lobe) => lobe.sample_prepared(wo, prepared, u), )*}
            }
            #[inline]
            fn discrete(&self, wo: Vec3<R>, event: &Event<R>) -> Value<R> {
                match self {$( Self::$model(lobe) => lobe.discrete(wo, event), )*}
            }
            #[inline]
            fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
                match self {$( Self::$model(lobe) => lobe.albedo_estimate(wo), )*}
            }
            #[inline(always)]
            fn domain(&self) -> R::Mask {
                match self {$( Self::$model(lobe) => lobe.domain(), )*}
            }
            #[inline(always)]
            fn compression(&self, wo: Vec3<R>) -> R {
                match self {$( Self::$model(lobe) => lobe.compression(wo), )*}
            }
            #[inline(always)]
            fn properties(&self) -> Properties {
                match self {$( Self::$model(lobe) => Lobe::<R>::properties(lobe), )*}
            }
        }

        $(impl<R> From<$model<R>> for AnyLobe<R> {
            fn from(lobe: $model<R>) -> Self {
                Self::$model(lobe)
            }
        })*
    };
}
for_each_lobe!(any_lobe);
