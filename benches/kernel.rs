//! What a lobe costs: `eval` and `sample` of every lobe, one direction at a time in `f32` and eight at a time.
//!
//! ```text
//! cargo bench --bench kernel               criterion's rows, 4096 directions each, all within the second-level cache
//! cargo bench --bench kernel -- --ratio    the claim of `Conductor`: eight lanes against one direction at a time
//! cargo bench --bench kernel -- --serve    rows on demand, for a partner that takes turns: see `serve.rs`
//! ```
//!
//! Both paths are called the way a caller meets them: through a function that is not inlined, on input that the optimiser
//! cannot see through. Without that it would turn the scalar loop into a vector loop of its own, and compare lanes with lanes.

#[path = "scenes/random.rs"]
mod random;
mod serve;

use criterion::{Criterion, Throughput};
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::{Conductor, Dielectric, Eon, Lambert, Mirror, Phong, PhongNorm, RoughDielectric};
use gonio_kernel::microfacet::{Beckmann, Ggx, Reach};
use gonio_kernel::{F32x8, Lobe, Real, Rgb, Sample, Value, Vec3, for_each_lobe};
use random::Random;
use std::hint::black_box;
use std::process::ExitCode;
use std::time::Instant;

/// Directions per batch: with the results about 200 KB.
const BATCH: usize = 4096;
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

/// A lobe of everyday parameters.
trait Example {
    fn example() -> Self;
}
impl<R: Real> Example for Lambert<R> {
    fn example() -> Self {
        Self::new(Rgb::new(0.8, 0.5, 0.2).map(R::lit))
    }
}
impl<R: Real> Example for Mirror<R> {
    fn example() -> Self {
        Self::new(Rgb::new(0.9, 0.8, 0.7).map(R::lit))
    }
}
impl<R: Real> Example for Conductor<R> {
    /// Copper at 630, 532 and 465 nm (Johnson & Christy 1972), so no channel can stand for another.
    fn example() -> Self {
        let eta = Rgb::new(0.22, 0.96, 1.17).map(R::lit);
        let k = Rgb::new(3.68, 2.59, 2.46).map(R::lit);
        Self::new(Ggx { alpha_x: R::lit(0.3), alpha_y: R::lit(0.2) }, Fresnel::Conductor { eta, k })
    }
}

impl<R: Real> Example for Dielectric<R> {
    fn example() -> Self {
        Self::new(R::lit(1.5))
    }
}
impl<R: Real> Example for RoughDielectric<R> {
    fn example() -> Self {
        Self::new(Ggx { alpha_x: R::lit(0.3), alpha_y: R::lit(0.2) }, R::lit(1.5))
    }
}
impl<R: Real> Example for Phong<R> {
    fn example() -> Self {
        let (diffuse, glossy) = (Rgb::new(0.4, 0.3, 0.1).map(R::lit), Rgb::new(0.3, 0.3, 0.3).map(R::lit));
        Self { diffuse, glossy, exponent: R::lit(30.0), norm: PhongNorm::Lecture }
    }
}
impl<R: Real> Example for Eon<R> {
    fn example() -> Self {
        Self::new(Rgb::new(0.8, 0.5, 0.2).map(R::lit), R::lit(0.6))
    }
}

macro_rules! lobe_rows {
    ($($lobe:ident),*) => {
        fn rows(criterion: &mut Criterion) {
            let (one, eight) = (Scalars::new(), Lanes::new());
            $(
                let mut group = criterion.benchmark_group(stringify!($lobe));
                group.throughput(Throughput::Elements(BATCH as u64));
                let (scalar, lanes) = (<$lobe<f32>>::example(), <$lobe<F32x8>>::example());
                group.bench_function("eval/f32", |b| b.iter(|| one.eval(&scalar)));
                group.bench_function("eval/F32x8", |b| b.iter(|| eight.eval(&lanes)));
                group.bench_function("sample/f32", |b| b.iter(|| one.sample(&scalar)));
                group.bench_function("sample/F32x8", |b| b.iter(|| eight.sample(&lanes)));
                group.finish();
            )*
        }
    };
}
for_each_lobe!(lobe_rows);

/// What choosing a visible normal costs by itself.
fn visible_normal_rows(criterion: &mut Criterion) {
    fn beckmann<R: Real>() -> Beckmann<R> {
        Beckmann { alpha_x: R::lit(0.3), alpha_y: R::lit(0.2) }
    }
    fn ggx_normal<R: Real>(wo: Vec3<R>, u: [R; 2]) -> Vec3<R> {
        let ggx = Ggx { alpha_x: R::lit(0.3), alpha_y: R::lit(0.2) };
        let s_o = ggx.smith_length(wo);
        ggx.sample_visible(wo, s_o, Reach::whole(wo, s_o), u)
    }
    let (one, eight) = (Scalars::new(), Lanes::new());
    let mut group = criterion.benchmark_group("visible normal");
    group.throughput(Throughput::Elements(BATCH as u64));
    group.bench_function("beckmann sample/f32", |b| b.iter(|| one.normals(|wo, u| beckmann().sample_visible(wo, u))));
    group.bench_function("beckmann sample/F32x8", |b| {
        b.iter(|| eight.normals(|wo, u| beckmann().sample_visible(wo, u)))
    });
    group.bench_function("ggx sample/f32", |b| b.iter(|| one.normals(ggx_normal)));
    group.bench_function("ggx sample/F32x8", |b| b.iter(|| eight.normals(ggx_normal)));
    group.finish();
}

/// A batch of input, one direction after the other or eight side by side.
struct Batch<R> {
    wo: Vec<Vec3<R>>,
    wi: Vec<Vec3<R>>,
    u: Vec<[R; 3]>,
}
type Scalars = Batch<f32>;
type Lanes = Batch<F32x8>;

impl Scalars {
    /// Directions uniform over the upper hemisphere, from a fixed seed.
    fn new() -> Self {
        let mut random = Random(1);
        let mut direction = || {
            let w = gonio_kernel::warp::sample_uniform_sphere([random.next(), random.next()]);
            Vec3::new(w.x, w.y, w.z.abs().max(1e-3))
        };
        let (wo, wi) = (0..BATCH).map(|_| (direction(), direction())).unzip();
        let u = (0..BATCH).map(|_| [random.next(), random.next(), random.next()]).collect();
        Self { wo, wi, u }
    }
}

impl Lanes {
    /// The same directions.
    fn new() -> Self {
        let batch = Scalars::new();
        let eight = |of: &dyn Fn(usize) -> f32| F32x8::new(std::array::from_fn(of));
        let directions = |v: &[Vec3<f32>]| {
            v.chunks_exact(8).map(|v| Vec3::new(eight(&|i| v[i].x), eight(&|i| v[i].y), eight(&|i| v[i].z))).collect()
        };
        let u = batch.u.chunks_exact(8).map(|u| std::array::from_fn(|j| eight(&|i| u[i][j]))).collect();
        Self { wo: directions(&batch.wo), wi: directions(&batch.wi), u }
    }
}

impl<R: Real> Batch<R> {
    fn eval(&self, lobe: &impl Lobe<R>) {
        for (&wo, &wi) in self.wo.iter().zip(&self.wi) {
            black_box(eval(lobe, black_box(wo), black_box(wi)));
        }
    }

    fn normals(&self, sample: impl Fn(Vec3<R>, [R; 2]) -> Vec3<R>) {
        for (&wo, &u) in self.wo.iter().zip(&self.u) {
            black_box(normal(&sample, black_box(wo), black_box([u[1], u[2]])));
        }
    }

    fn sample(&self, lobe: &impl Lobe<R>) {
        for (&wo, &u) in self.wo.iter().zip(&self.u) {
            black_box(sample(lobe, black_box(wo), black_box(u)));
        }
    }
}

#[inline(never)]
fn eval<R: Real>(lobe: &impl Lobe<R>, wo: Vec3<R>, wi: Vec3<R>) -> Value<R> {
    lobe.eval(wo, wi)
}

#[inline(never)]
fn normal<R: Real>(sample: &impl Fn(Vec3<R>, [R; 2]) -> Vec3<R>, wo: Vec3<R>, u: [R; 2]) -> Vec3<R> {
    sample(wo, u)
}

#[inline(never)]
fn sample<R: Real>(lobe: &impl Lobe<R>, wo: Vec3<R>, u: [R; 3]) -> Sample<R> {
    lobe.sample(wo, u)
}

/// Prints how much faster `Conductor::eval` is in eight lanes; fails below [`LEAST_RATIO`] or on a value that differs.
fn ratio() -> ExitCode {
    let (one, eight) = (Scalars::new(), Lanes::new());
    let (scalar, lanes) = (Conductor::<f32>::example(), Conductor::<F32x8>::example());
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
