//! The types that carry state, each with its methods in one function per number: `Closure_f32`, `Frame_f32` and so on.

use crate::{colour, direction, lobes, some};
use core::hint::black_box;
use gonio_kernel::lobe::{AnyLobe, Layering, Lobe};
use gonio_kernel::surface::SurfaceError;
use gonio_kernel::units::{Area, Flux, Radiance, SolidAngle};
use gonio_kernel::{
    BsdfSample, Closure, F32x8, Frame, Mask, Mask8, Parameters, Properties, Real, Rgb, Sample, Surface, Table,
    Transport, U32x8, Value, Vec3, closure::Unguarded,
};

macro_rules! types {
    ($real:ident) => {{
        type R = $real;

        /// Twelve lobes, three of them coats.
        type Many = Surface<R, AnyLobe<'static, R>, 12, 3>;

        #[unsafe(export_name = concat!("Surface_", stringify!($real)))]
        #[inline(never)]
        fn surface(weight: Rgb<R>, lobes: &[Option<AnyLobe<'static, R>>]) -> Result<Many, SurfaceError> {
            let layering = if black_box(true) { Layering::Reciprocal } else { Layering::FurnacePreserving };
            lobes.iter().flatten().try_fold(Many::empty(), |surface, &lobe| match black_box(true) {
                true => surface.coat(weight, lobe, layering),
                false => surface.with(weight, lobe),
            })
        }

        #[unsafe(export_name = concat!("Closure_", stringify!($real)))]
        #[inline(never)]
        fn closure(surface: &Many, wo: Vec3<R>, wi: Vec3<R>, u: [R; 3]) -> (Value<R>, BsdfSample<R>) {
            let transport = if black_box(true) { Transport::Radiance } else { Transport::Importance };
            let closure = Closure::with_transport(surface, wo, transport);
            (closure.eval(wi), closure.sample(u))
        }

        #[unsafe(export_name = concat!("Unguarded_", stringify!($real)))]
        #[inline(never)]
        fn unguarded(surface: &Many, wo: Vec3<R>, wi: Vec3<R>, sample: &Sample<R>) -> (Value<R>, Value<R>) {
            let mixture = Unguarded::new(surface, wo, Transport::Radiance);
            (mixture.eval(wi), mixture.delta(sample))
        }

        #[unsafe(export_name = concat!("Surface_claims_", stringify!($real)))]
        #[inline(never)]
        fn claims(surface: &Many, wo: Vec3<R>) -> (Properties<R>, R, R, Many) {
            let same = surface.map(&mut |parameter, _, x| parameter.quantity.clamp(x));
            (surface.properties(), surface.largest_weight(wo), surface.radiance_scale(wo), same)
        }

        #[unsafe(export_name = concat!("Frame_", stringify!($real)))]
        #[inline(never)]
        fn frame(n: Vec3<R>, tangent: Vec3<R>, v: Vec3<R>) -> (Vec3<R>, Vec3<R>) {
            (Frame::from_normal(n).to_local(v), Frame::from_normal_tangent(n, tangent).tilted(v).to_world(v))
        }

        #[unsafe(export_name = concat!("Rgb_", stringify!($real)))]
        #[inline(never)]
        fn rgb(a: Rgb<R>, b: Rgb<R>) -> (R, R) {
            (Rgb::select(a.within(0.0, 1.0), a, b).luminance(), (a + b * a).largest())
        }

        #[unsafe(export_name = concat!("units_", stringify!($real)))]
        #[inline(never)]
        fn units(x: Flux<R>, omega: SolidAngle<R>, area: Area<R>, l: Radiance<Rgb<R>>) -> (R, R, R) {
            ((x / omega).0, (x / area).0, l.photometric().0)
        }

        #[unsafe(export_name = concat!("Table_", stringify!($real)))]
        #[inline(never)]
        fn table(table: Table<'_>, x: R) -> (R, R) {
            (table.linear(x), R::lookup(table, x.to_int()))
        }

        let (wo, wi) = (direction(0.6, 0.0, 0.8), direction(0.0, -0.6, 0.8));
        if let Ok(surface) = black_box(surface(colour(0.3), black_box(&lobes::examples()))) {
            let (_, sample) = black_box(closure(&surface, wo, wi, [some(0.1), some(0.5), some(0.9)]));
            black_box(unguarded(&surface, wo, wi, &Sample { wi: sample.wi, event: sample.event }));
            black_box(claims(&surface, wo));
        }
        black_box(frame(wo, wi, direction(1.0, 2.0, 3.0)));
        black_box(rgb(colour(0.5), colour(0.2)));
        black_box(table(Table::new(black_box(&[0.5, 0.25]), 0), some(0.7)));
        black_box(units(Flux(some(1.0)), SolidAngle(some(2.0)), Area(some(3.0)), Radiance(colour(0.5))));
    }};
}

/// What only lanes have: a count of active lanes and a lane's number are as unknown as any input.
#[unsafe(no_mangle)]
#[inline(never)]
fn lanes(count: usize, lane: usize, bits: u32, table: &[f32; 8]) -> (bool, u32, U32x8, f32) {
    let mask = Mask8::first(count) | Mask8::from_bits(bits);
    let reals = F32x8::from_fn(|i| table[(i + lane) & 7]);
    let truth = mask.lane(lane) & mask.any();
    (truth, mask.to_bits(), U32x8::splat(bits) >> bits, reals.lane(lane))
}

pub(crate) fn prove() {
    types!(f32);
    types!(f64);
    types!(F32x8);
    black_box(lanes(black_box(5), black_box(9), black_box(77), black_box(&[0.5; 8])));
}
