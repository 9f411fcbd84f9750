//! Lanes against scalar: lane i of eight equals the scalar `f32` result bit for bit, any NaN equal to any NaN.
//!
//! Each lane has its own parameters, directions and random numbers, so a lane that leaks into its neighbour shows.
//! Ordinary inputs, ordinary ones with one or two special numbers, and all special. The unguarded lobe is compared:
//! behind the guard most extreme inputs would compare zero with zero.

use crate::catalog::random_value;
use crate::finding::{Finding, Run};
use crate::random::Random;
use crate::test_bsdf::{Answer, DynBsdf, Number, Question};
use crate::totality::SPECIAL;
use gonio_kernel::frame::{Frame, facing};
use gonio_kernel::{F32x8, Real, Sample, Vec3, fresnel, math, warp};

/// Whether two floats are the same: the same bits, or both NaN.
pub(crate) fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// A generator of eight inputs, each of `count` numbers: ordinary, or with special numbers mixed in.
fn eight(count: usize, random: &mut Random, ordinary: &mut dyn FnMut(&mut Random) -> Vec<f32>) -> [Vec<f32>; 8] {
    let class = random.bits() % 4;
    std::array::from_fn(|_| {
        let mut x = ordinary(random);
        match class {
            0 => {}
            3 => x.fill_with(|| random.pick(&SPECIAL)),
            few => (0..few).for_each(|_| x[(random.bits() % count as u64) as usize] = random.pick(&SPECIAL)),
        }
        x
    })
}

/// Eight inputs side by side, from number `at` on.
fn pack(x: &[Vec<f32>; 8], at: usize) -> F32x8 {
    F32x8::new(std::array::from_fn(|l| x[l][at]))
}
fn vec3(x: &[f32], at: usize) -> Vec3<f32> {
    Vec3::new(x[at], x[at + 1], x[at + 2])
}

/// A lobe, each lane with numbers of its own: at random, and where it is a given one, half of the time the lobe's.
pub(crate) fn measure(bsdf: &dyn DynBsdf, given: bool, run: &Run) -> Finding {
    let numbers = bsdf.numbers();
    let count = numbers.len();
    let mut ordinary = |random: &mut Random| {
        let own = given && random.bits().is_multiple_of(2);
        let value = |n: &Number, random: &mut Random| if own { n.value } else { random_value(n.parameter, random) };
        let mut x: Vec<f32> = numbers.iter().map(|number| value(number, random)).collect();
        let wo = crate::directions::any_above(random);
        let wi = crate::directions::partner(random, wo);
        for w in [wo, wi] {
            x.extend([w.x as f32, w.y as f32, w.z as f32]);
        }
        x.extend([(); 3].map(|()| random.coarse() as f32));
        x
    };
    let question = |x: &[f32]| Question {
        wo: vec3(x, count),
        wi: vec3(x, count + 3),
        u: [x[count + 6], x[count + 7], x[count + 8]],
    };
    let mut finding = compare(
        run,
        count + 9,
        &mut ordinary,
        |x, out| {
            let questions = std::array::from_fn(|l| question(&x[l]));
            let gathered: [Vec<f32>; 8] = std::array::from_fn(|l| x[l][..count].to_vec());
            for (out, answer) in out.iter_mut().zip(bsdf.answer_gathered(&gathered, &questions)) {
                push(&answer, out);
            }
        },
        |x, out| push(&bsdf.answer(&x[..count], &question(x)), out),
    );
    finding.note("each lane with numbers of its own".to_owned());
    finding
}

fn push(Answer { value, sample, again, delta }: &Answer, out: &mut Vec<f32>) {
    for value in [value, again, delta] {
        out.extend([value.f_cos.r, value.f_cos.g, value.f_cos.b, value.pdf]);
    }
    let truth = |x: bool| f32::from(u8::from(x));
    let Sample { wi, event } = sample;
    out.extend([
        wi.x,
        wi.y,
        wi.z,
        event.lobe as f32,
        truth(event.transmitted),
        truth(event.is_delta),
        truth(event.failed),
    ]);
}

/// Mathematics, warps, frames and Fresnel: everything beneath the lobes that takes numbers.
pub(crate) fn measure_parts(run: &Run) -> Finding {
    let mut ordinary = |random: &mut Random| {
        (0..6).map(|i| if i < 3 { random.between(-1.0, 1.0) as f32 } else { random.coarse() as f32 }).collect()
    };
    compare(
        run,
        6,
        &mut ordinary,
        |x, out| {
            let numbers = parts::<F32x8>(std::array::from_fn(|i| pack(x, i)));
            for (l, out) in out.iter_mut().enumerate() {
                out.extend(numbers.iter().map(|n| n.to_array()[l]));
            }
        },
        |x, out| out.extend(parts::<f32>(std::array::from_fn(|i| x[i]))),
    )
}

fn parts<R: Real>(x: [R; 6]) -> Vec<R> {
    let v = Vec3::new(x[0], x[1], x[2]);
    let w = Vec3::new(x[3], x[4], x[5]);
    let mut out =
        vec![x[0].min(x[1]), x[0].max(x[1]), x[0].clamp(-0.5, 0.5), x[0].copysign(x[1]), x[3].sqrt(), x[0].abs()];
    let (sin, cos) = math::sin_cos_turns(x[0]);
    out.extend([
        sin,
        cos,
        math::atan2_turns(x[0], x[1]),
        fresnel::dielectric(x[3], x[4]),
        fresnel::conductor(x[3], x[4], x[5]),
        fresnel::schlick(x[3], x[4]),
    ]);
    for x in [x[0], x[3], x[4] * R::lit(200.0) - R::lit(100.0)] {
        let (mantissa, exponent) = x.split_exponent();
        out.extend([mantissa, exponent, mantissa.ldexp(exponent.round_to_int().1)]);
        out.extend([math::exp(x), math::exp_m1(x), math::ln(x), math::ln_1p(x), math::erf(x), math::erf_inv(x)]);
    }
    out.push(math::pow(x[3], x[4] * R::lit(200.0) - R::lit(100.0)));
    out.extend(warp::sample_uniform_triangle([x[3], x[4]]));
    let flat = Frame::from_normal_tangent(v, w);
    let frames = [Frame::from_normal(v), flat, flat.tilted(w)];
    let mut vectors = vec![
        warp::sample_cosine_hemisphere([x[3], x[4]]),
        warp::sample_uniform_sphere([x[3], x[4]]),
        v.normalize_or(w),
        v.cross(w),
        facing(v, w, flat.y),
    ];
    for f in frames {
        vectors.extend([f.x, f.y, f.z, f.to_local(w), f.to_world(w)]);
    }
    out.extend(vectors.into_iter().flat_map(|v| [v.x, v.y, v.z]));
    out
}

/// Counts differing numbers.
pub(crate) fn compare(
    run: &Run,
    count: usize,
    ordinary: &mut dyn FnMut(&mut Random) -> Vec<f32>,
    lanes: impl Fn(&[Vec<f32>; 8], &mut [Vec<f32>; 8]),
    scalar: impl Fn(&[f32], &mut Vec<f32>),
) -> Finding {
    let mut random = run.random();
    let mut finding = Finding::at_most(0.0, "numbers that differ in a bit ≤");
    let (mut differing, mut first) = (0_usize, String::new());
    let rounds = run.by_effort(4_000, 40_000, 100_000);
    let mut wide: [Vec<f32>; 8] = Default::default();
    let mut narrow = Vec::new();
    for _ in 0..rounds {
        let x = eight(count, &mut random, ordinary);
        wide.iter_mut().for_each(Vec::clear);
        lanes(&x, &mut wide);
        for (l, wide) in wide.iter().enumerate() {
            narrow.clear();
            scalar(&x[l], &mut narrow);
            for (i, (&a, &b)) in wide.iter().zip(&narrow).enumerate() {
                if !same(a, b) {
                    differing += 1;
                    if first.is_empty() {
                        first = format!("number {i} in lane {l}: {a:e} against {b:e} of the scalar, inputs {:?}", x[l]);
                    }
                }
            }
        }
    }
    finding.raise(differing as f64, || first);
    finding.note(format!("{} inputs", 8 * rounds));
    finding
}
