//! Every method of every lobe, for every number, as a function of its own: `Conductor_eval_f32` and so on.
//!
//! The lobes are those of the kernel's own table, with parameters read from a source that the optimiser knows nothing about.

use crate::some;
use core::hint::black_box;
use gonio_kernel::lobe::{self, *};
use gonio_kernel::model::{Entry, Parameter, Parameters, Problem, Source, Words};
use gonio_kernel::{BsdfSample, Closure, F32x8, Lobe, Real, Rgb, Transport, Vec3, for_each_lobe};

/// Numbers, words and ways of which nothing is known.
struct Unknown;

impl<R: Real> Source<R> for Unknown {
    type Error = Option<Problem>;

    fn model(&self) -> &str {
        black_box("diffuse")
    }
    fn has(&self, _: &str) -> bool {
        black_box(true)
    }
    fn number(&mut self, parameter: &'static Parameter) -> Result<Option<R>, Self::Error> {
        Ok(black_box(true).then_some(some(parameter.quantity.typical)))
    }
    fn color(&mut self, parameter: &'static Parameter) -> Result<Option<Rgb<R>>, Self::Error> {
        Ok(black_box(true).then_some(Rgb::splat(some(parameter.quantity.typical))))
    }
    fn word(&mut self, _: &'static Words) -> Result<Option<usize>, Self::Error> {
        Ok(black_box(Some(1)))
    }
    fn refuse(&mut self, problem: Problem) -> Self::Error {
        Some(problem)
    }
    fn way(&mut self, _: &'static [&'static [Entry]]) -> Result<usize, Self::Error> {
        Ok(black_box(0))
    }
}

/// Any lobe, for all that the optimiser knows.
#[inline(always)]
pub(crate) fn unknown<R: Real, L: Parameters<Real = R>>() -> Option<L> {
    L::read(&mut Unknown).ok()
}

/// The wrapper of lobes, a mixture and a layer, each around others.
type TwoSided<R> = lobe::TwoSided<Conductor<R>>;
type Mix<R> = lobe::Mix<Lambert<R>, SmoothConductor<R>>;
type Weighted<R> = lobe::Weighted<R, Eon<R>>;
type Layer<R> = lobe::Layer<R, Conductor<R>, Lambert<R>>;

macro_rules! prove_lobes {
    ($($file:ident::$lobe:ident),* $(,)?) => {
        #[inline(always)]
        pub(crate) fn prove() {
            $( prove_lobe!($lobe, f32); prove_lobe!($lobe, f64); prove_lobe!($lobe, F32x8); )*
            prove_lobe!(Mix, f32);
            prove_lobe!(Mix, f64);
            prove_lobe!(Mix, F32x8);
            prove_lobe!(Layer, f32);
            prove_lobe!(Layer, f64);
            prove_lobe!(Layer, F32x8);
            prove_lobe!(TwoSided, f32);
            prove_lobe!(TwoSided, f64);
            prove_lobe!(TwoSided, F32x8);
            prove_lobe!(Weighted, f32);
            prove_lobe!(Weighted, f64);
            prove_lobe!(Weighted, F32x8);
        }

        /// One of each.
        #[inline(always)]
        pub(crate) fn examples<R: Real>() -> [Option<AnyLobe<'static, R>>; [$(stringify!($lobe)),*].len()] {
            [$( unknown::<R, $lobe<R>>().map(AnyLobe::from) ),*]
        }
    };
}

macro_rules! prove_lobe {
    ($lobe:ident, $real:ident) => {{
        #[unsafe(export_name = concat!(stringify!($lobe), "_read_", stringify!($real)))]
        #[inline(never)]
        fn read() -> Option<$lobe<$real>> {
            unknown()
        }
        if let Some(lobe) = black_box(read()) {
            prove_calls!($lobe, $real, lobe);
        }
    }};
}

macro_rules! prove_calls {
    ($lobe:ident, $real:ident, $it:ident) => {{
        #[unsafe(export_name = concat!(stringify!($lobe), "_eval_", stringify!($real)))]
        #[inline(never)]
        fn eval(lobe: &$lobe<$real>, wo: Vec3<$real>, transport: Transport, wi: Vec3<$real>) -> Value<$real> {
            lobe.eval(wo, &lobe.prepare(wo, transport), wi)
        }
        #[unsafe(export_name = concat!(stringify!($lobe), "_sample_", stringify!($real)))]
        #[inline(never)]
        fn sample(lobe: &$lobe<$real>, wo: Vec3<$real>, transport: Transport, u: [$real; 3]) -> Sample<$real> {
            lobe.sample(wo, &lobe.prepare(wo, transport), u)
        }
        #[unsafe(export_name = concat!(stringify!($lobe), "_delta_", stringify!($real)))]
        #[inline(never)]
        fn delta(lobe: &$lobe<$real>, wo: Vec3<$real>, transport: Transport, sample: &Sample<$real>) -> Value<$real> {
            lobe.delta(wo, &lobe.prepare(wo, transport), sample)
        }
        #[unsafe(export_name = concat!(stringify!($lobe), "_closure_", stringify!($real)))]
        #[inline(never)]
        fn closure(lobe: &$lobe<$real>, wo: Vec3<$real>, u: [$real; 3]) -> BsdfSample<$real> {
            Closure::new(lobe, wo).sample(u)
        }
        #[unsafe(export_name = concat!(stringify!($lobe), "_albedo_estimate_", stringify!($real)))]
        #[inline(never)]
        fn albedo_estimate(lobe: &$lobe<$real>, wo: Vec3<$real>) -> Rgb<$real> {
            lobe.albedo_estimate(wo)
        }
        #[unsafe(export_name = concat!(stringify!($lobe), "_claims_", stringify!($real)))]
        #[inline(never)]
        fn claims(lobe: &$lobe<$real>, wo: Vec3<$real>) -> (<$real as Real>::Mask, Properties<$real>, $real, $real) {
            (Lobe::<$real>::domain(lobe), lobe.properties(), lobe.largest_weight(wo), lobe.radiance_scale(wo))
        }
        let lobe = black_box($it);
        let (wo, wi) = (crate::direction(0.6, 0.0, 0.8), crate::direction(0.0, -0.6, 0.8));
        let u = [some(0.1), some(0.5), some(0.9)];
        let transport = if black_box(true) { Transport::Radiance } else { Transport::Importance };
        black_box(eval(&lobe, wo, transport, wi));
        let sample = black_box(sample(&lobe, wo, transport, u));
        black_box(delta(&lobe, wo, transport, &sample));
        black_box(closure(&lobe, wo, u));
        black_box(albedo_estimate(&lobe, wo));
        black_box(claims(&lobe, wo));
    }};
}

for_each_lobe!(prove_lobes);
