//! Every method of every lobe, for every number, as a function of its own: `Conductor_eval_f32` and so on.
//!
//! The lobes are those of the kernel's own table. A lobe without an [`Example`] here does not compile.

use crate::{colour, direction, some};
use core::hint::black_box;
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::eon::Directional;
use gonio_kernel::lobe::{
    self, AnyLobe, Conductor, Dielectric, Eon, Lambert, Mirror, Phong, PhongNorm, RoughDielectric,
};
use gonio_kernel::microfacet::{Beckmann, Ggx, Masking, Microfacets};
use gonio_kernel::{Event, F32x8, Lobe, Real, Rgb, Sample, Value, Vec3, for_each_lobe};

/// A lobe with parameters that the optimiser knows nothing about.
pub(crate) trait Example {
    fn example() -> Self;
}

impl<R: Real> Example for Lambert<R> {
    #[inline(always)]
    fn example() -> Self {
        Self::new(colour(0.8))
    }
}
impl<R: Real> Example for Mirror<R> {
    #[inline(always)]
    fn example() -> Self {
        Self::new(colour(0.9))
    }
}
impl<R: Real> Example for Conductor<R> {
    #[inline(always)]
    fn example() -> Self {
        let fresnel = match black_box(0) {
            0 => Fresnel::Conductor { eta: colour(0.2), k: colour(3.9) },
            1 => Fresnel::Schlick { f0: colour(0.7) },
            2 => Fresnel::F82 { f0: colour(0.7), tint: colour(0.9) },
            _ => Fresnel::Dielectric { eta: some(1.5) },
        };
        Self::new(microfacets(), fresnel).with_masking(masking())
    }
}
impl<R: Real> Example for Dielectric<R> {
    #[inline(always)]
    fn example() -> Self {
        Self::new(some(1.5))
    }
}
impl<R: Real> Example for RoughDielectric<R> {
    #[inline(always)]
    fn example() -> Self {
        Self::new(microfacets(), some(1.5)).with_masking(masking())
    }
}

/// The wrapper of lobes, around one of them.
type TwoSided<R> = lobe::TwoSided<Conductor<R>>;
impl<R: Real> Example for TwoSided<R> {
    #[inline(always)]
    fn example() -> Self {
        lobe::TwoSided(Conductor::example())
    }
}

/// A distribution, masking: any of them, for all that the optimiser knows.
#[inline(always)]
fn microfacets<R: Real>() -> Microfacets<R> {
    let (alpha_x, alpha_y) = (some(0.3), some(0.1));
    if black_box(true) { Ggx { alpha_x, alpha_y }.into() } else { Beckmann { alpha_x, alpha_y }.into() }
}
#[inline(always)]
fn masking() -> Masking {
    if black_box(true) { Masking::HeightCorrelated } else { Masking::Separable }
}

impl<R: Real> Example for Phong<R> {
    #[inline(always)]
    fn example() -> Self {
        let norm = if black_box(true) { PhongNorm::Lecture } else { PhongNorm::Lafortune };
        Self { diffuse: colour(0.4), glossy: colour(0.5), exponent: some(30.0), norm }
    }
}
impl<R: Real> Example for Eon<R> {
    #[inline(always)]
    fn example() -> Self {
        let directional = if black_box(true) { Directional::Exact } else { Directional::Fitted };
        Self { directional, ..Self::new(colour(0.8), some(0.6)) }
    }
}

macro_rules! prove_lobes {
    ($($lobe:ident),*) => {
        #[inline(always)]
        pub(crate) fn prove() {
            $( prove_lobe!($lobe, f32); prove_lobe!($lobe, f64); prove_lobe!($lobe, F32x8); )*
            prove_lobe!(TwoSided, f32);
            prove_lobe!(TwoSided, f64);
            prove_lobe!(TwoSided, F32x8);
        }

        /// One of each.
        #[inline(always)]
        pub(crate) fn examples<R: Real>() -> [AnyLobe<R>; [$(stringify!($lobe)),*].len()] {
            [$( AnyLobe::$lobe($lobe::example()) ),*]
        }
    };
}

macro_rules! prove_lobe {
    ($lobe:ident, $real:ident) => {{
        #[unsafe(export_name = concat!(stringify!($lobe), "_eval_", stringify!($real)))]
        #[inline(never)]
        fn eval(lobe: &$lobe<$real>, wo: Vec3<$real>, wi: Vec3<$real>) -> Value<$real> {
            lobe.eval(wo, wi)
        }
        #[unsafe(export_name = concat!(stringify!($lobe), "_sample_", stringify!($real)))]
        #[inline(never)]
        fn sample(lobe: &$lobe<$real>, wo: Vec3<$real>, u: [$real; 3]) -> Sample<$real> {
            lobe.sample(wo, u)
        }
        #[unsafe(export_name = concat!(stringify!($lobe), "_discrete_", stringify!($real)))]
        #[inline(never)]
        fn discrete(lobe: &$lobe<$real>, wo: Vec3<$real>, event: &Event<$real>) -> Value<$real> {
            lobe.discrete(wo, event)
        }
        #[unsafe(export_name = concat!(stringify!($lobe), "_albedo_estimate_", stringify!($real)))]
        #[inline(never)]
        fn albedo_estimate(lobe: &$lobe<$real>, wo: Vec3<$real>) -> Rgb<$real> {
            lobe.albedo_estimate(wo)
        }
        #[unsafe(export_name = concat!(stringify!($lobe), "_domain_", stringify!($real)))]
        #[inline(never)]
        fn domain(lobe: &$lobe<$real>) -> <$real as Real>::Mask {
            Lobe::<$real>::domain(lobe)
        }
        let lobe = black_box($lobe::<$real>::example());
        let (wo, wi) = (direction(0.6, 0.0, 0.8), direction(0.0, -0.6, 0.8));
        black_box(eval(&lobe, wo, wi));
        let sample = black_box(sample(&lobe, wo, [some(0.1), some(0.5), some(0.9)]));
        black_box(discrete(&lobe, wo, &sample.event));
        black_box(albedo_estimate(&lobe, wo));
        black_box(domain(&lobe));
    }};
}

for_each_lobe!(prove_lobes);
