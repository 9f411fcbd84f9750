//! Batches for a partner in another program, which `benches/bsdfs.py` is: one line `ROW PASSES` on stdin is one answer on
//! stdout, the nanoseconds per direction of the median of that many passes over the batch.
//!
//! A batch is [`BATCH`](crate::lobes::BATCH) directions in arrays, read and written in eights within the second-level cache. The
//! parameters of the lobe are hidden from the optimiser once per pass, its kind is not: as in a kernel that a just-in-time
//! compiler made for one kind of material.

use crate::lobes::{BATCH, Lanes};
use gonio_kernel::closure::Unguarded;
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::{Conductor, Lambert, RoughDielectric};
use gonio_kernel::microfacet::{Beckmann, Ggx};
use gonio_kernel::{F32x8, Lobe, Real, Rgb, Transport, Vec3};
use std::hint::black_box;
use std::io::{BufRead, Write};
use std::process::ExitCode;
use std::time::Instant;

/// A row: its name, and the nanoseconds per direction of so many passes.
type Row = (&'static str, fn(&Lanes, usize) -> f64);

/// `weight` is what a path needs of a sample: direction, density and f_cos/pdf.
const ROWS: [Row; 15] = [
    ("lambert-eval", |batch, passes| value(batch, passes, lambert)),
    ("ggx-schlick-eval", |batch, passes| value(batch, passes, || Conductor::new(ggx(), schlick()))),
    ("ggx-f82-eval", |batch, passes| value(batch, passes, || Conductor::new(ggx(), f82()))),
    ("ggx-exact-eval", |batch, passes| value(batch, passes, || Conductor::new(ggx(), exact()))),
    ("ggx-pdf", |batch, passes| density(batch, passes, || Conductor::new(ggx(), exact()))),
    ("ggx-sample", |batch, passes| sample(batch, passes, || Conductor::new(ggx(), exact()))),
    ("ggx-weight", |batch, passes| weight(batch, passes, || Conductor::new(ggx(), exact()))),
    ("beckmann-exact-eval", |batch, passes| value(batch, passes, || Conductor::new(beckmann(), exact()))),
    ("beckmann-pdf", |batch, passes| density(batch, passes, || Conductor::new(beckmann(), exact()))),
    ("beckmann-sample", |batch, passes| sample(batch, passes, || Conductor::new(beckmann(), exact()))),
    ("beckmann-weight", |batch, passes| weight(batch, passes, || Conductor::new(beckmann(), exact()))),
    ("dielectric-eval", |batch, passes| value(batch, passes, dielectric)),
    ("dielectric-pdf", |batch, passes| density(batch, passes, dielectric)),
    ("dielectric-sample", |batch, passes| sample(batch, passes, dielectric)),
    ("dielectric-weight", |batch, passes| weight(batch, passes, dielectric)),
];

/// Answers until stdin ends.
pub(crate) fn serve() -> ExitCode {
    let mut above = Lanes::new();
    let mut both_sides = Lanes::new();
    let below = F32x8::new([1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0, -1.0]);
    both_sides.wi.iter_mut().for_each(|wi| wi.z *= below);
    for line in std::io::stdin().lock().lines() {
        let Ok(line) = line else { return ExitCode::FAILURE };
        let mut words = line.split_whitespace();
        let row = words.next().and_then(|name| ROWS.iter().find(|row| row.0 == name));
        let (Some((name, run)), Some(passes)) = (row, words.next().and_then(|n| n.parse().ok())) else {
            eprintln!("not a row and a number of passes: {line}");
            return ExitCode::FAILURE;
        };
        let batch = black_box(if name.starts_with("dielectric") { &mut both_sides } else { &mut above });
        println!("{}", run(batch, passes));
        if std::io::stdout().flush().is_err() {
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}

fn real(x: f32) -> F32x8 {
    black_box(F32x8::splat(x))
}
fn rgb(r: f32, g: f32, b: f32) -> Rgb<F32x8> {
    Rgb::new(real(r), real(g), real(b))
}
fn lambert() -> Lambert<F32x8> {
    Lambert::new(rgb(0.8, 0.5, 0.2))
}
fn ggx() -> Ggx<F32x8> {
    Ggx { alpha_x: real(0.3), alpha_y: real(0.2) }
}
fn beckmann() -> Beckmann<F32x8> {
    Beckmann { alpha_x: real(0.3), alpha_y: real(0.2) }
}
/// Copper, as in the rows of criterion: three different η and k.
fn exact() -> Fresnel<F32x8> {
    Fresnel::Conductor { eta: rgb(0.22, 0.96, 1.17), k: rgb(3.68, 2.59, 2.46) }
}
fn schlick() -> Fresnel<F32x8> {
    Fresnel::Schlick { f0: rgb(0.95, 0.64, 0.54) }
}
fn f82() -> Fresnel<F32x8> {
    Fresnel::F82 { f0: rgb(0.95, 0.64, 0.54), tint: rgb(0.9, 0.8, 0.7) }
}
fn dielectric() -> RoughDielectric<F32x8> {
    RoughDielectric::new(ggx(), real(1.5))
}

/// f_cos.
fn value<L: Lobe<F32x8>>(batch: &Lanes, passes: usize, lobe: impl Fn() -> L) -> f64 {
    timed(Rgb::zero(), passes, |out| {
        let lobe = lobe();
        for (out, (&wo, &wi)) in out.iter_mut().zip(batch.wo.iter().zip(&batch.wi)) {
            *out = at(&lobe, wo).eval(wi).f_cos;
        }
    })
}

/// Density alone.
fn density<L: Lobe<F32x8>>(batch: &Lanes, passes: usize, lobe: impl Fn() -> L) -> f64 {
    timed(F32x8::ZERO, passes, |out| {
        let lobe = lobe();
        for (out, (&wo, &wi)) in out.iter_mut().zip(batch.wo.iter().zip(&batch.wi)) {
            *out = at(&lobe, wo).eval(wi).pdf;
        }
    })
}

/// wi, and whether there is one.
fn sample<L: Lobe<F32x8>>(batch: &Lanes, passes: usize, lobe: impl Fn() -> L) -> f64 {
    timed((Vec3::unit_z(), F32x8::ZERO), passes, |out| {
        let lobe = lobe();
        for (out, (&wo, &u)) in out.iter_mut().zip(batch.wo.iter().zip(&batch.u)) {
            let sample = at(&lobe, wo).sample(u);
            *out = (sample.wi, F32x8::ONE.or_zero(!sample.event.failed));
        }
    })
}

/// wi, f_cos/pdf and pdf, zero where there is none.
fn weight<L: Lobe<F32x8>>(batch: &Lanes, passes: usize, lobe: impl Fn() -> L) -> f64 {
    timed((Vec3::unit_z(), Rgb::zero(), F32x8::ZERO), passes, |out| {
        let lobe = lobe();
        for (out, (&wo, &u)) in out.iter_mut().zip(batch.wo.iter().zip(&batch.u)) {
            let lobe = at(&lobe, wo);
            let sample = lobe.sample(u);
            let value = lobe.eval(sample.wi).or_zero(!sample.event.failed);
            let inverse = value.pdf.recip().or_zero(value.pdf.gt(F32x8::ZERO));
            *out = (sample.wi, value.f_cos * inverse, value.pdf);
        }
    })
}

/// A lobe without a guard, as Mitsuba's has none.
#[inline(always)]
fn at<L: Lobe<F32x8>>(lobe: &L, wo: Vec3<F32x8>) -> Unguarded<F32x8, &L> {
    Unguarded::new(lobe, wo, Transport::Radiance)
}

/// Nanoseconds per direction: the median pass, which no other program interrupted. What is written is read by somebody, as
/// far as the optimiser knows.
fn timed<T: Copy>(blank: T, passes: usize, pass: impl Fn(&mut [T])) -> f64 {
    let mut out = vec![blank; BATCH / F32x8::LANES];
    let mut seconds: Vec<f64> = (0..passes.max(1))
        .map(|_| {
            let start = Instant::now();
            pass(&mut out);
            black_box(&mut out);
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2] * 1e9 / BATCH as f64
}
