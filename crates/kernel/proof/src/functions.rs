//! Every free function of the kernel, for every number, as a function of its own: `sin_cos_turns_f32` and so on.
//!
//! `cargo xtask no-std` reads the kernel's sources for `pub fn name<R: Real>` and expects each name here.

use crate::{colour, direction, some};
use core::hint::black_box;
use gonio_kernel::energy::albedo as curve;
use gonio_kernel::fresnel::Interface;
use gonio_kernel::microfacet::{Masking, Reach};
use gonio_kernel::{F32x8, Mask, Mask8, Real, Rgb, Vec3, energy, frame, fresnel, math, microfacet, warp};

/// An argument that the optimiser knows nothing about.
trait Unknown {
    fn unknown() -> Self;
}
impl<R: Real> Unknown for Vec3<R> {
    fn unknown() -> Self {
        direction(0.6, 0.0, 0.8)
    }
}
impl<R: Real> Unknown for Rgb<R> {
    fn unknown() -> Self {
        colour(0.9)
    }
}
impl Unknown for Masking {
    fn unknown() -> Self {
        if black_box(true) { Masking::HeightCorrelated } else { Masking::Separable }
    }
}
impl<R: Real> Unknown for Reach<R> {
    fn unknown() -> Self {
        Self { depth: some(1.4), inverse: some(0.7) }
    }
}
impl Unknown for bool {
    fn unknown() -> Self {
        black_box(true)
    }
}
impl Unknown for Mask8 {
    fn unknown() -> Self {
        black_box(Mask8::splat(true))
    }
}
impl<R: Real> Unknown for [R; 2] {
    fn unknown() -> Self {
        [some(0.2), some(0.7)]
    }
}
macro_rules! unknown_number {
    ($($real:ident)*) => {$(
        impl Unknown for $real {
            fn unknown() -> Self {
                some(0.3)
            }
        }
    )*};
}
unknown_number!(f32 f64 F32x8);

macro_rules! export {
    ($real:ident: $($module:ident::$name:ident($($arg:ident: $type:ty),*) -> $out:ty;)*) => {$({
        #[unsafe(export_name = concat!(stringify!($name), "_", stringify!($real)))]
        #[inline(never)]
        fn exported($($arg: $type),*) -> $out {
            $module::$name($($arg),*)
        }
        // Called through an unknown pointer: the optimiser knows the result of a function that returns a constant.
        let exported: fn($($type),*) -> $out = black_box(exported);
        black_box(exported($(<$type>::unknown()),*));
    })*};
}

macro_rules! functions {
    ($real:ident) => {{
        type R = $real;
        type Truth = <R as Real>::Mask;
        export! { $real:
            energy::sample_multiple(alpha: R, u: [R; 2]) -> Vec3<R>;
            energy::pdf_multiple(alpha: R, cos: R) -> R;
            energy::missing_avg(alpha: R) -> R;
            energy::albedo(cos: R, alpha: R) -> R;
            energy::albedo_avg(alpha: R) -> R;
            curve::missing_factor(cos: R, alpha: R) -> R;
            curve::eta_basis(eta: R) -> [R; curve::IN_ETA];
            energy::multiple_fresnel(f: R, again: R) -> R;
            energy::scattered_again(alpha: R, missing_o: R, missing_i: R, missing_avg: R) -> R;
            energy::kulla_conty(missing_o: R, missing_i: R, missing_avg: R, f_ms: R) -> R;
            energy::effective_alpha(alpha_x: R, alpha_y: R) -> R;
            energy::turquin(f0: R, missing_o: R) -> R;
            energy::facet_cosines(alpha: R, cos_o: R, cos_i: R) -> [R; 2];
            frame::tangents(z: Vec3<R>) -> (Vec3<R>, Vec3<R>);
            frame::cos_theta(w: Vec3<R>) -> R;
            frame::sin2_theta(w: Vec3<R>) -> R;
            frame::both_above(wo: Vec3<R>, wi: Vec3<R>) -> Truth;
            frame::facing(n: Vec3<R>, geometric: Vec3<R>, wo: Vec3<R>) -> Vec3<R>;
            frame::on_its_side(geometric: Vec3<R>, wi: Vec3<R>, through: Truth) -> Truth;
            fresnel::refracted_cosine(cos_o: R, eta: R) -> R;
            fresnel::interface(cos_o: R, cos_t: R, eta: R) -> Interface<R>;
            fresnel::dielectric(cos_o: R, eta: R) -> R;
            fresnel::conductor(cos_o: R, eta: R, k: R) -> R;
            fresnel::schlick(cos_o: R, f0: R) -> R;
            fresnel::f82(cos_o: R, f0: R, tint: R) -> R;
            microfacet::vis_cos_i(masking: Masking, cos_o: R, s_o: R, cos_i: R, s_i: R) -> R;
            microfacet::pdf_visible_reflected(d: R, reach: Reach<R>) -> R;
            microfacet::reflect(wo: Vec3<R>, m: Vec3<R>) -> Vec3<R>;
            math::atan2_turns(y: R, x: R) -> R;
            math::sin_cos_turns(u: R) -> (R, R);
            math::exp(x: R) -> R;
            math::flushed_square(root: R, factor: R) -> R;
            math::exp_m1(x: R) -> R;
            math::ln(x: R) -> R;
            math::ln_1p(x: R) -> R;
            math::pow(x: R, y: R) -> R;
            math::erf(x: R) -> R;
            math::erf_inv(x: R) -> R;
            warp::sample_cosine_hemisphere(u: [R; 2]) -> Vec3<R>;
            warp::pdf_cosine_hemisphere(w: Vec3<R>) -> R;
            warp::sample_uniform_sphere(u: [R; 2]) -> Vec3<R>;
            warp::pdf_uniform_sphere() -> R;
            warp::sample_uniform_triangle(u: [R; 2]) -> [R; 2];
            warp::pdf_uniform_triangle() -> R;
        }
    }};
}

pub(crate) fn prove() {
    functions!(f32);
    functions!(f64);
    functions!(F32x8);
}
