//! `Lobe`: the contract that every scattering model obeys. The kernel's models and combinations are one file each.
//!
//! A lobe has a continuous part, described by a density over directions, and may have a delta part, a set of single directions with
//! probabilities. [`Lobe::eval`] is the only author of value and density of the continuous part, [`Lobe::delta`] the only author of
//! weight and probability of the delta part, and [`Lobe::sample`] only chooses. So value and density cannot drift apart, and a lobe
//! that is all delta evaluates to 0, 0.
//!
//! **Everything that scatters is a lobe**: a model ([`Lambert`]), a weighted lobe ([`Weighted`]), two side by side ([`Mix`]), one over
//! another ([`Layer`]), a list ([`crate::Surface`]), an enum of lobes ([`AnyLobe`], or a user's own by
//! [`any_lobe!`](crate::any_lobe)), and a borrowed lobe. A user's lobe is mixed, layered, guarded, certified and rendered like ours.
//!
//! **Transport.** Values are those of radiance unless asked otherwise: light that crosses into a denser medium is compressed into a
//! narrower cone, so transmitted values carry 1/η² ([`Lobe::radiance_scale`]). Furnaces and albedos are about importance, which
//! does not. For radiance f(wo, wi) η_o² = f(wi, wo) η_i² holds after multiplication by that scale (Veach 1997, section 5.2).
//!
//! Inside the domain (unit directions to 1e-3 in |w|², parameters in range) every result is finite and non-negative with
//! no guard. Outside, a lobe may return anything but must not panic; [`crate::Closure`] turns that into exact zeros.
//!
//! A lobe of one's own, at its shortest:
//!
//! ```
//! use gonio_kernel::lobe::{Sample, Event, Value};
//! use gonio_kernel::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere};
//! use gonio_kernel::{Closure, Lobe, Mask, Real, Rgb, Transport, Vec3, frame::both_above};
//!
//! /// Reflects more of the light the steeper it leaves.
//! struct Dusty;
//! impl<R: Real> Lobe<R> for Dusty {
//!     type Prepared = ();
//!     fn prepare(&self, _wo: Vec3<R>, _transport: Transport) {}
//!     fn eval(&self, wo: Vec3<R>, _: &(), wi: Vec3<R>) -> Value<R> {
//!         let pdf = pdf_cosine_hemisphere(wi);
//!         Value { f_cos: Rgb::splat(pdf * wo.z * wi.z), pdf }.or_zero(both_above(wo, wi))
//!     }
//!     fn sample(&self, wo: Vec3<R>, _: &(), u: [R; 3]) -> Sample<R> {
//!         let wi = sample_cosine_hemisphere([u[1], u[2]]);
//!         Sample { wi, event: Event::reflected(!both_above(wo, wi)) }
//!     }
//!     fn delta(&self, _: Vec3<R>, _: &(), _: &Sample<R>) -> Value<R> {
//!         Value::zero()
//!     }
//!     fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
//!         Rgb::splat(wo.z * R::lit(2.0 / 3.0))
//!     }
//!     fn domain(&self) -> R::Mask {
//!         R::Mask::splat(true)
//!     }
//! }
//! let sample = Closure::new(Dusty, Vec3::new(0.6_f32, 0.0, 0.8)).sample([0.5; 3]);
//! assert!(sample.weight.g <= 1.0);
//! ```

/// The table of models, in the order in which a name is looked for: calls `$macro!` with the file and the name of each. The enum
/// [`AnyLobe`], the proof that the kernel cannot panic, the keys of material files, the catalog of the instruments and the
/// benchmarks are made from it.
#[macro_export]
macro_rules! for_each_lobe {
    ($macro:ident) => {
        $macro! {
            lambert::Lambert,
            mirror::Mirror,
            conductor::Conductor,
            smooth_conductor::SmoothConductor,
            rough_dielectric::RoughDielectric,
            dielectric::Dielectric,
            phong::Phong,
            eon::Eon,
            ashikhmin_shirley::AshikhminShirley,
            blinn_phong::BlinnPhong,
        }
    };
}

mod any;
mod ashikhmin_shirley;
mod blinn_phong;
mod coating;
mod combined;
mod conductor;
mod dielectric;
pub mod eon;
mod lambert;
mod layer;
mod mirror;
mod mix;
mod phong;
mod properties;
mod rough_dielectric;
mod smooth_conductor;
mod two_sided;
mod weighted;

macro_rules! exported {
    ($($file:ident::$model:ident),* $(,)?) => { $(pub use $file::$model;)* };
}
for_each_lobe!(exported);

pub use any::AnyLobe;
pub use coating::Coating;
pub use combined::{Mix, Weighted};
pub use eon::EonAlbedo;
pub use layer::{Coat, Layer, Layering, NoCoat};
pub use phong::PhongNormalization;
pub use properties::Properties;
pub use two_sided::TwoSided;

pub(crate) use mix::{either_scale, rest_of, share};

use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::vec3::Vec3;
use core::fmt::Debug;

/// What a path carries from wi to wo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Radiance, as seen by a camera: scaled by 1/η² where it crosses into another medium.
    Radiance,
    /// Importance, or particles of light: energy as it is.
    Importance,
}

/// Value and density of a pair of directions, or of a delta event.
#[derive(Clone, Copy, Debug)]
pub struct Value<R> {
    /// f·|cos_i| \[1/sr\]; for a delta event its weight times its probability.
    pub f_cos: Rgb<R>,
    /// Density per solid angle \[1/sr\]; for a delta event its probability. 0 means it cannot happen.
    pub pdf: R,
}

/// What a sample did.
#[derive(Clone, Copy, Debug)]
pub struct Event<R: Real> {
    /// Which lobe of a combination made it, below [`Lobe::LOBES`].
    pub lobe: R::Int,
    /// `wi` lies on the other side of the surface.
    pub transmitted: R::Mask,
    /// `wi` came from a delta part: its value is [`Lobe::delta`], not [`Lobe::eval`].
    pub is_delta: R::Mask,
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

/// A scattering model with its parameters, in the local frame.
pub trait Lobe<R: Real> {
    /// What depends on wo alone; `()` where nothing does.
    type Prepared: Copy + Debug;

    /// How many numbers [`Event::lobe`] takes: 1 for a lobe that is no combination.
    const LOBES: u32 = 1;

    /// What depends on wo alone: computed once where a closure is asked several times. A lobe that transmits keeps here what
    /// `transport` makes of its values.
    fn prepare(&self, wo: Vec3<R>, transport: Transport) -> Self::Prepared;

    /// f·|cos_i| and density of the continuous part, with what [`Lobe::prepare`] returned for the same wo: 0, 0 for a lobe that is
    /// all delta.
    fn eval(&self, wo: Vec3<R>, prepared: &Self::Prepared, wi: Vec3<R>) -> Value<R>;

    /// Chooses wi for wo. `u` are three uniform numbers in [0, 1); the first serves choices, the others positions.
    fn sample(&self, wo: Vec3<R>, prepared: &Self::Prepared, u: [R; 3]) -> Sample<R>;

    /// Weight times probability, and probability, of a delta event that [`Lobe::sample`] returned for this wo.
    fn delta(&self, wo: Vec3<R>, prepared: &Self::Prepared, sample: &Sample<R>) -> Value<R>;

    /// About how much of the light from wo is scattered: steers the choice between lobes, never a result.
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R>;

    /// Whether the parameters lie in their domain.
    fn domain(&self) -> R::Mask;

    /// What the lobe claims of itself at these parameters.
    #[inline(always)]
    fn properties(&self) -> Properties<R> {
        Properties::LAWFUL
    }

    /// The largest weight that a sample for wo may have in any channel; infinite where none is promised.
    #[inline(always)]
    fn largest_weight(&self, _wo: Vec3<R>) -> R {
        R::lit(f64::INFINITY)
    }

    /// η² seen from wo, η = η_t/η_i: what transmitted radiance is divided by, and transmitted importance is not. 1 for lobes that only
    /// reflect.
    #[inline(always)]
    fn radiance_scale(&self, _wo: Vec3<R>) -> R {
        R::ONE
    }

    /// Whether the value is one constant over the hemisphere, that of Lambert: what lies above it then loses nothing in
    /// [`Layering::Reciprocal`].
    #[inline(always)]
    fn is_lambertian(&self) -> bool {
        false
    }

    /// This lobe times a colour in \[0, 1\].
    #[inline(always)]
    fn times(self, weight: Rgb<R>) -> Weighted<R, Self>
    where
        Self: Sized,
    {
        Weighted { weight, lobe: self }
    }

    /// This lobe and another side by side: their light adds.
    #[inline(always)]
    fn plus<B: Lobe<R>>(self, other: B) -> Mix<Self, B>
    where
        Self: Sized,
    {
        Mix(self, other)
    }
}

/// A borrowed lobe is a lobe.
impl<R: Real, L: Lobe<R>> Lobe<R> for &L {
    type Prepared = L::Prepared;
    const LOBES: u32 = L::LOBES;
    #[inline(always)]
    fn prepare(&self, wo: Vec3<R>, transport: Transport) -> Self::Prepared {
        (**self).prepare(wo, transport)
    }
    #[inline(always)]
    fn eval(&self, wo: Vec3<R>, prepared: &Self::Prepared, wi: Vec3<R>) -> Value<R> {
        (**self).eval(wo, prepared, wi)
    }
    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, prepared: &Self::Prepared, u: [R; 3]) -> Sample<R> {
        (**self).sample(wo, prepared, u)
    }
    #[inline(always)]
    fn delta(&self, wo: Vec3<R>, prepared: &Self::Prepared, sample: &Sample<R>) -> Value<R> {
        (**self).delta(wo, prepared, sample)
    }
    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
        (**self).albedo_estimate(wo)
    }
    #[inline(always)]
    fn domain(&self) -> R::Mask {
        (**self).domain()
    }
    #[inline(always)]
    fn properties(&self) -> Properties<R> {
        (**self).properties()
    }
    #[inline(always)]
    fn largest_weight(&self, wo: Vec3<R>) -> R {
        (**self).largest_weight(wo)
    }
    #[inline(always)]
    fn radiance_scale(&self, wo: Vec3<R>) -> R {
        (**self).radiance_scale(wo)
    }
    #[inline(always)]
    fn is_lambertian(&self) -> bool {
        (**self).is_lambertian()
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
    /// The light times a colour.
    #[inline(always)]
    pub fn times(self, weight: Rgb<R>) -> Self {
        Self { f_cos: self.f_cos * weight, ..self }
    }
    /// `yes` where `mask`, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self { f_cos: Rgb::select(mask, yes.f_cos, no.f_cos), pdf: R::select(mask, yes.pdf, no.pdf) }
    }
    /// Finite and non-negative throughout.
    #[inline(always)]
    pub fn is_sound(&self) -> R::Mask {
        let Rgb { r, g, b } = self.f_cos;
        // A NaN on the left of `min` is passed over for what stands on the right, so the sum looks for it. The sum is infinite or
        // NaN where one is; and where it overflows, beyond any density that a direction of f32 can have.
        let least = r.min(g).min(b.min(self.pdf));
        let sum = (r + g) + (b + self.pdf);
        least.ge(R::ZERO) & sum.lt(R::lit(f64::INFINITY))
    }
}

impl<R: Real> Event<R> {
    /// A continuous reflection that failed where `failed`.
    #[inline(always)]
    pub fn reflected(failed: R::Mask) -> Self {
        let no = R::Mask::splat(false);
        Self { lobe: R::int(0), transmitted: no, is_delta: no, failed }
    }

    /// `yes` where `mask`, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        let choose = |yes: R::Mask, no: R::Mask| (mask & yes) | (!mask & no);
        Self {
            lobe: R::int_select(mask, yes.lobe, no.lobe),
            transmitted: choose(yes.transmitted, no.transmitted),
            is_delta: choose(yes.is_delta, no.is_delta),
            failed: choose(yes.failed, no.failed),
        }
    }
}

impl<R: Real> Sample<R> {
    /// Nothing was sampled.
    #[inline(always)]
    pub fn nothing() -> Self {
        Self { wi: Vec3::unit_z(), event: Event::reflected(R::Mask::splat(true)) }
    }
    /// `yes` where `mask`, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self { wi: Vec3::select(mask, yes.wi, no.wi), event: Event::select(mask, yes.event, no.event) }
    }
    /// The same with its lobe numbered `by` higher.
    #[inline(always)]
    pub(crate) fn renumbered(self, by: u32) -> Self {
        Self { event: Event { lobe: R::int_add(self.event.lobe, R::int(by)), ..self.event }, ..self }
    }
}
