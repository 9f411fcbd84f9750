//! Radiometric quantities as types: only the lawful products compile.
//!
//! `T` is a scalar or an [`Rgb`]; factors are scalars. The photometric twins follow by the luminous efficacy of 683 lm/W
//! (at 540 THz, where V(λ) ≈ 1): an [`Rgb`] is weighted to its luminance first.
//!
//! | law | in words |
//! |---|---|
//! | Φ = E · A | flux is irradiance times area |
//! | E = L · Ω⊥ | irradiance is radiance times projected solid angle |
//! | M = a · E | exitance is albedo times irradiance |
//! | I = Φ / Ω | intensity is flux per solid angle |
//! | I = L · A⊥ | intensity is radiance times projected area |
//!
//! ```
//! use gonio_kernel::units::*;
//!
//! let sky = Radiance(2.0_f32);
//! let ground = sky * ProjectedSolidAngle::<f32>::hemisphere();
//! let flux: Flux<f32> = ground * Area(3.0);
//! assert!((flux.0 - 2.0 * core::f32::consts::PI * 3.0).abs() < 1e-5);
//! assert_eq!((Flux(10.0_f32) / SolidAngle(2.0)).0, 5.0);
//! assert_eq!((Albedo(0.5_f32) * Irradiance(4.0)).0, 2.0);
//! assert_eq!(Flux(2.0_f32).photometric().0, 1366.0);
//! ```
//!
//! Adding radiance to irradiance does not compile:
//! ```compile_fail
//! use gonio_kernel::units::*;
//! let _ = Radiance(1.0_f32) + Irradiance(1.0_f32);
//! ```
//! Radiance times a plain solid angle is not an irradiance (the cosine is missing):
//! ```compile_fail
//! use gonio_kernel::units::*;
//! let _ = Radiance(1.0_f32) * SolidAngle(1.0_f32);
//! ```
//! Radiance times area is not a flux:
//! ```compile_fail
//! use gonio_kernel::units::*;
//! let _: Flux<f32> = Radiance(1.0_f32) * Area(1.0_f32);
//! ```
//! Watts are not lumens:
//! ```compile_fail
//! use gonio_kernel::units::*;
//! let _: LuminousFlux<f32> = Flux(1.0_f32);
//! ```

use crate::real::Real;
use crate::rgb::Rgb;
use core::ops::{Add, Div, Mul};

/// Luminous efficacy of monochromatic light at 540 THz \[lm/W\]: a defining constant of the SI.
pub const LUMINOUS_EFFICACY: f64 = 683.0;

/// A scalar or a colour, as far as its luminance goes.
pub trait Spectral {
    /// The scalar behind it.
    type Scalar: Real;
    /// The part that the eye weighs: the value itself, or the luminance of a colour.
    fn luminance(self) -> Self::Scalar;
}
impl Spectral for f32 {
    type Scalar = f32;
    fn luminance(self) -> f32 {
        self
    }
}
impl Spectral for f64 {
    type Scalar = f64;
    fn luminance(self) -> f64 {
        self
    }
}
impl<R: Real> Spectral for Rgb<R> {
    type Scalar = R;
    fn luminance(self) -> R {
        Rgb::luminance(self)
    }
}

macro_rules! quantities {
    ($($(#[$doc:meta])* $name:ident),*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[repr(transparent)]
        pub struct $name<T>(pub T);

        impl<T: Add<Output = T>> Add for $name<T> {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                Self(self.0 + other.0)
            }
        }
    )*};
}
quantities! {
    /// Radiant flux Φ \[W\].
    Flux,
    /// Irradiance E, arriving \[W/m²\].
    Irradiance,
    /// Exitance M, leaving \[W/m²\].
    Exitance,
    /// Radiant intensity I \[W/sr\].
    Intensity,
    /// Radiance L \[W/(m² sr)\].
    Radiance,
    /// Luminous flux \[lm\].
    LuminousFlux,
    /// Illuminance \[lx\].
    Illuminance,
    /// Luminous exitance \[lm/m²\].
    LuminousExitance,
    /// Luminous intensity \[cd\].
    LuminousIntensity,
    /// Luminance \[cd/m²\].
    Luminance,
    /// Area \[m²\].
    Area,
    /// Area times the cosine to a direction \[m²\].
    ProjectedArea,
    /// Solid angle Ω \[sr\].
    SolidAngle,
    /// Solid angle weighted by the cosine to the normal, Ω⊥ = ∫ cosθ dω \[sr\].
    ProjectedSolidAngle,
    /// Albedo a in [0, 1]: exitance per irradiance.
    Albedo
}

impl<R: Real> SolidAngle<R> {
    /// The full sphere, 4π.
    pub fn sphere() -> Self {
        Self(R::lit(4.0 * core::f64::consts::PI))
    }
}
impl<R: Real> ProjectedSolidAngle<R> {
    /// The hemisphere about the normal, π.
    pub fn hemisphere() -> Self {
        Self(R::lit(core::f64::consts::PI))
    }
}

macro_rules! law {
    ($a:ident * $b:ident = $c:ident) => {
        #[doc = concat!(stringify!($c), " = ", stringify!($a), " × ", stringify!($b), ".")]
        impl<T: Mul<S, Output = T>, S> Mul<$b<S>> for $a<T> {
            type Output = $c<T>;
            fn mul(self, other: $b<S>) -> $c<T> {
                $c(self.0 * other.0)
            }
        }
    };
    ($a:ident / $b:ident = $c:ident) => {
        #[doc = concat!(stringify!($c), " = ", stringify!($a), " / ", stringify!($b), ".")]
        #[allow(clippy::suspicious_arithmetic_impl)] // by one reciprocal, for colours too
        impl<S: Real, T: Mul<S, Output = T>> Div<$b<S>> for $a<T> {
            type Output = $c<T>;
            fn div(self, other: $b<S>) -> $c<T> {
                $c(self.0 * other.0.recip())
            }
        }
    };
}
law!(Irradiance * Area = Flux);
law!(Exitance * Area = Flux);
law!(Radiance * ProjectedSolidAngle = Irradiance);
law!(Radiance * ProjectedArea = Intensity);
law!(Intensity * SolidAngle = Flux);
law!(Flux / SolidAngle = Intensity);
law!(Flux / Area = Irradiance);
law!(Intensity / ProjectedArea = Radiance);
law!(Illuminance * Area = LuminousFlux);
law!(Luminance * ProjectedSolidAngle = Illuminance);
law!(Luminance * ProjectedArea = LuminousIntensity);
law!(LuminousIntensity * SolidAngle = LuminousFlux);
law!(LuminousFlux / SolidAngle = LuminousIntensity);

/// Exitance = albedo × irradiance.
impl<T: Mul<T, Output = T>> Mul<Irradiance<T>> for Albedo<T> {
    type Output = Exitance<T>;
    fn mul(self, e: Irradiance<T>) -> Exitance<T> {
        Exitance(self.0 * e.0)
    }
}

macro_rules! photometric {
    ($($radiometric:ident -> $twin:ident),*) => {$(
        impl<T: Spectral> $radiometric<T> {
            #[doc = concat!("The photometric twin, [`", stringify!($twin), "`], by 683 lm/W.")]
            pub fn photometric(self) -> $twin<T::Scalar> {
                $twin(self.0.luminance() * T::Scalar::lit(LUMINOUS_EFFICACY))
            }
        }
    )*};
}
photometric!(
    Flux -> LuminousFlux,
    Irradiance -> Illuminance,
    Exitance -> LuminousExitance,
    Intensity -> LuminousIntensity,
    Radiance -> Luminance
);
