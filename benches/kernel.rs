//! What a lobe costs: `eval`, its value alone, and `sample` of every lobe, one direction at a time in `f32` and eight at a time.
//!
//! ```text
//! cargo bench --bench kernel               criterion's rows, 4096 directions each, all within the second-level cache
//! cargo bench --bench kernel -- --ratio    the claim of `Conductor`: eight lanes against one direction at a time
//! cargo bench --bench kernel -- --serve    rows on demand, for a partner that takes turns: see `serve.rs`
//! ```

mod lobes;
#[path = "scenes/random.rs"]
mod random;
mod serve;

use criterion::{Criterion, Throughput};
use gonio_kernel::lobe::*;
use gonio_kernel::{F32x8, Parameters, for_each_lobe};
use lobes::{BATCH, Lanes, Scalars, beckmann_normal, eval, ggx_normal};
use random::Random;
use std::process::ExitCode;
use std::time::Instant;

/// Lanes against scalar at which `Conductor` must arrive. Eight is the most that eight lanes can give where the scalar
/// code uses one lane; the compiler vectorises parts of the three Fresnel channels of the scalar code by itself, and the
/// eight-wide divider and square root take twice as long as the narrow ones.
const LEAST_RATIO: f64 = 4.5;
/// Interleaved pairs of timings; their median is the result.
const ROUNDS: usize = 15;

fn main() -> ExitCode {
    if std::env::args().any(|argument| argument == "--ratio") {
        return ratio();
    }
    if std::env::args().any(|argument| argument == "--serve") {
        return serve::serve();
    }
    let mut criterion = Criterion::default().configure_from_args();
    rows(&mut criterion);
    visible_normal_rows(&mut criterion);
    criterion.final_summary();
    ExitCode::SUCCESS
}

macro_rules! lobe_rows {
    ($($file:ident::$lobe:ident),* $(,)?) => {
        fn rows(criterion: &mut Criterion) {
            let (one, eight) = (Scalars::new(), Lanes::new());
            $(
                let mut group = criterion.benchmark_group(stringify!($lobe));
                group.throughput(Throughput::Elements(BATCH as u64));
                let scalar = <$lobe<f32>>::typical().expect("typical values");
                let lanes = scalar.to::<F32x8>();
                group.bench_function("eval/f32", |b| b.iter(|| one.eval(&scalar)));
                group.bench_function("eval/F32x8", |b| b.iter(|| eight.eval(&lanes)));
                group.bench_function("value/f32", |b| b.iter(|| one.value(&scalar)));
                group.bench_function("value/F32x8", |b| b.iter(|| eight.value(&lanes)));
                group.bench_function("sample/f32", |b| b.iter(|| one.sample(&scalar)));
                group.bench_function("sample/F32x8", |b| b.iter(|| eight.sample(&lanes)));
                group.bench_function("closure-sample/f32", |b| b.iter(|| one.closure_sample(&scalar)));
                group.bench_function("closure-sample/F32x8", |b| b.iter(|| eight.closure_sample(&lanes)));
                group.finish();
            )*
        }
    };
}
for_each_lobe!(lobe_rows);

/// What choosing a visible normal costs by itself.
fn visible_normal_rows(criterion: &mut Criterion) {
    let (one, eight) = (Scalars::new(), Lanes::new());
    let mut group = criterion.benchmark_group("visible normal");
    group.throughput(Throughput::Elements(BATCH as u64));
    group.bench_function("beckmann sample/f32", |b| b.iter(|| one.normals(beckmann_normal)));
    group.bench_function("beckmann sample/F32x8", |b| b.iter(|| eight.normals(beckmann_normal)));
    group.bench_function("ggx sample/f32", |b| b.iter(|| one.normals(ggx_normal)));
    group.bench_function("ggx sample/F32x8", |b| b.iter(|| eight.normals(ggx_normal)));
    group.finish();
}

/// Prints how much faster `Conductor::eval` is in eight lanes; fails below [`LEAST_RATIO`] or on a value that differs.
fn ratio() -> ExitCode {
    let (one, eight) = (Scalars::new(), Lanes::new());
    let scalar = Conductor::<f32>::typical().expect("typical values");
    let lanes = scalar.to::<F32x8>();
    assert_same_values(&one, &scalar, &eight, &lanes);

    let nanoseconds = |run: &dyn Fn()| {
        let passes = 100;
        let start = Instant::now();
        (0..passes).for_each(|_| run());
        start.elapsed().as_secs_f64() * 1e9 / (passes * BATCH) as f64
    };
    println!("Conductor eval, exact Fresnel, ns per direction\n        f32  F32x8  ratio");
    let mut ratios: Vec<f64> = (1..=ROUNDS)
        .map(|round| {
            let f32 = nanoseconds(&|| one.eval(&scalar));
            let f32x8 = nanoseconds(&|| eight.eval(&lanes));
            println!("{round:4} {f32:6.2} {f32x8:6.2} {:6.2}", f32 / f32x8);
            f32 / f32x8
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ROUNDS / 2];
    println!("median of {ROUNDS} pairs: {median:.2} (at least {LEAST_RATIO}); all {BATCH} values equal bit for bit");
    if median < LEAST_RATIO { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

fn assert_same_values(one: &Scalars, scalar: &Conductor<f32>, eight: &Lanes, lanes: &Conductor<F32x8>) {
    for (i, (&wo, &wi)) in eight.wo.iter().zip(&eight.wi).enumerate() {
        let together = eval(lanes, wo, wi);
        for lane in 0..8 {
            let alone = eval(scalar, one.wo[8 * i + lane], one.wi[8 * i + lane]);
            let bits = |value: Value<f32>| [value.f_cos.r, value.f_cos.g, value.f_cos.b, value.pdf].map(f32::to_bits);
            let at = |x: F32x8| x.to_array()[lane];
            let together = Value { f_cos: together.f_cos.map(at), pdf: at(together.pdf) };
            assert_eq!(bits(alone), bits(together), "direction {} in lane {lane}", 8 * i + lane);
            assert!(alone.pdf > 0.0, "a value of zero proves nothing");
        }
    }
}
