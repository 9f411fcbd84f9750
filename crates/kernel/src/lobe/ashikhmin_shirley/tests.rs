use super::*;
use crate::testing::{Bare, Random, close};
use core::f64::consts::{PI, TAU};

/// The same in `f64`.
pub(in crate::lobe) fn double(w: Vec3<f32>) -> Vec3<f64> {
    Vec3::new(w.x.into(), w.y.into(), w.z.into())
}

/// A direction above the surface at this cosine.
pub(in crate::lobe) fn view(cos: f64, turns: f64) -> Vec3<f64> {
    let (sin_phi, cos_phi) = (turns * TAU).sin_cos();
    let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
    Vec3::new(sin * cos_phi, sin * sin_phi, cos)
}

/// Uniform, or near the horizon, and its partner anywhere or near the mirror direction.
pub(in crate::lobe) fn pair(random: &mut Random) -> [Vec3<f32>; 2] {
    let mut above = || {
        let (w, down) = (random.above(), random.unit());
        let z = if down < 0.5 { w.z } else { w.z * 10.0_f32.powf(-16.0 * (down - 0.5)) };
        Vec3::new(w.x, w.y, z.max(1e-12)).normalize()
    };
    let (wo, wi, offset) = (above(), above(), above());
    if random.unit() < 0.5 {
        return [wo, wi];
    }
    let near = Vec3::new(-wo.x, -wo.y, wo.z) + offset * 10.0_f32.powf(-6.0 * random.unit());
    [wo, Vec3::new(near.x, near.y, near.z.max(1e-12)).normalize()]
}

/// f_cos of one channel, and the density.
fn two<R: Real, L: Lobe<R>>(lobe: &L, wo: Vec3<R>, wi: Vec3<R>) -> [R; 2] {
    let value = lobe.value(wo, wi);
    [value.f_cos.g, value.pdf]
}

/// The error of `f32` against `f64` on the same numbers, in units of the larger of eps·f and of the largest change when one
/// component of a direction, or one parameter, moves by one unit in the last place.
pub(in crate::lobe) fn units<L>(lobe: &L, wo: Vec3<f32>, wi: Vec3<f32>) -> f64
where
    L: Lobe<f32> + Parameters<Real = f32, Of<f32> = L>,
    L::Of<f64>: Lobe<f64>,
{
    let exact = two(&lobe.to::<f64>(), double(wo), double(wi));
    let mut unit = exact.map(|f| (f * f64::from(f32::EPSILON)).max(1e-30));
    let mut compare = |there: [f64; 2]| {
        for i in 0..2 {
            unit[i] = unit[i].max((there[i] - exact[i]).abs());
        }
    };
    for up in [false, true] {
        let next = |x: f32| if up { x.next_up() } else { x.next_down() };
        for axis in 0..3 {
            let moved = |w: Vec3<f32>| {
                let mut w = <[f32; 3]>::from(w);
                w[axis] = next(w[axis]);
                double(Vec3::from(w))
            };
            compare(two(&lobe.to::<f64>(), moved(wo), double(wi)));
            compare(two(&lobe.to::<f64>(), double(wo), moved(wi)));
        }
        for which in 0..12 {
            let mut at = 0..;
            let moved = lobe.map(&mut |_, _, x| if at.next() == Some(which) { next(x) } else { x });
            compare(two(&moved.to::<f64>(), double(wo), double(wi)));
        }
    }
    let rough = two(lobe, wo, wi);
    (0..2).map(|i| (f64::from(rough[i]) - exact[i]).abs() / unit[i]).fold(0.0, f64::max)
}

/// Eight lanes have the bits of one.
#[cfg(feature = "wide")]
pub(in crate::lobe) fn assert_lanes<L>(lobe: &L, random: &mut Random)
where
    L: Lobe<f32> + Parameters<Real = f32, Of<f32> = L>,
    L::Of<crate::F32x8>: Lobe<crate::F32x8>,
{
    use crate::F32x8;
    let pairs = [(); 8].map(|()| pair(random));
    let u = [(); 8].map(|()| [random.unit(), random.unit(), random.unit()]);
    let gather = |of: &dyn Fn(usize) -> Vec3<f32>| {
        let each = |component: fn(Vec3<f32>) -> f32| F32x8::from_fn(|i| component(of(i)));
        Vec3::new(each(|w| w.x), each(|w| w.y), each(|w| w.z))
    };
    let wide = L::gather([lobe; 8]);
    let (wo, wi) = (gather(&|i| pairs[i][0]), gather(&|i| pairs[i][1]));
    let value = wide.value(wo, wi);
    let sample = wide.draw(wo, [0, 1, 2].map(|k| F32x8::from_fn(|i| u[i][k])));
    for i in 0..8 {
        let [wo, wi] = pairs[i];
        let (alone, drawn) = (lobe.value(wo, wi), lobe.draw(wo, u[i]));
        let wide = [value.f_cos.r, value.f_cos.g, value.f_cos.b, value.pdf, sample.wi.x, sample.wi.y, sample.wi.z];
        let single = [alone.f_cos.r, alone.f_cos.g, alone.f_cos.b, alone.pdf, drawn.wi.x, drawn.wi.y, drawn.wi.z];
        for (wide, single) in wide.into_iter().zip(single) {
            assert_eq!(wide.to_array()[i].to_bits(), single.to_bits(), "{wo:?} {wi:?} {:?}", u[i]);
        }
    }
}

/// ∫pdf over the hemisphere against 1 less the part of a grid of random numbers that fails, for one wo.
pub(in crate::lobe) fn assert_normalised<L: Lobe<f64>>(what: &str, lobe: &L, wo: Vec3<f64>) {
    let (rows, columns) = (1000, 1000);
    let (mut integral, mut failed) = (0.0, 0.0);
    let mut random = Random(95);
    for row in 0..rows {
        for column in 0..columns {
            let u = [row, column].map(|i| (f64::from(i) + 0.5) / 1000.0);
            // z = 1 − u²: finer towards the normal, where densities are large.
            let (z, stretch) = (1.0 - u[0] * u[0], 2.0 * u[0]);
            integral += lobe.value(wo, view(z, u[1])).pdf * stretch;
            let jitter = |i: i32, random: &mut Random| (f64::from(i) + f64::from(random.unit())) / 1000.0;
            let u = [random.unit().into(), jitter(row, &mut random), jitter(column, &mut random)];
            failed += if lobe.draw(wo, u).event.failed { 1.0 } else { 0.0 };
        }
    }
    let (integral, failed) = (integral * TAU / 1e6, failed / 1e6);
    // Stratified binomial: a standard deviation of at most √(q(1 − q)/n), and five of them; the quadrature has 1e-4.
    let tolerance = 5.0 * (failed * (1.0 - failed) / 1e6_f64).sqrt() + 1e-4;
    assert!(close(integral, 1.0 - failed, tolerance), "{what}: {integral}, failures {failed}");
}

fn grey<R: Real>(diffuse: f64, specular: f64, [n_u, n_v]: [f64; 2]) -> AshikhminShirley<R> {
    AshikhminShirley {
        diffuse: Rgb::splat(R::lit(diffuse)),
        specular: Rgb::splat(R::lit(specular)),
        exponent_u: R::lit(n_u),
        exponent_v: R::lit(n_v),
    }
}

const EXPONENTS: [[f64; 2]; 9] = [
    [0.0, 0.0],
    [0.3, 0.3],
    [3.0, 3.0],
    [50.0, 50.0],
    [0.0, 1e7],
    [1.0, 100.0],
    [1000.0, 10.0],
    [1e4, 1e4],
    [1e7, 1e7],
];

fn any_exponents(random: &mut Random) -> [f64; 2] {
    [(); 2].map(|()| match random.bits() % 8 {
        0 => 0.0,
        1 => 1e7,
        _ => 10.0_f64.powf(9.0 * f64::from(random.unit()) - 2.0),
    })
}

/// The albedo: midpoints of the random numbers of either part, weighed with the part's probability.
fn albedo(lobe: &AshikhminShirley<f64>, wo: Vec3<f64>, steps: i32) -> f64 {
    let prepared = lobe.prepare(wo, Transport::Radiance);
    let mut sum = 0.0;
    for (which, p) in [(0.0, prepared.p_diffuse), (1.0 - f64::EPSILON, prepared.p_coat)] {
        if p == 0.0 {
            continue;
        }
        for i in 0..steps {
            for j in 0..steps {
                let u = [i, j].map(|i| (f64::from(i) + 0.5) / f64::from(steps));
                let sample = lobe.draw(wo, [which, u[0], u[1]]);
                let value = lobe.value(wo, sample.wi);
                sum += if sample.event.failed { 0.0 } else { p * value.f_cos.g / value.pdf };
            }
        }
    }
    sum / f64::from(steps * steps)
}

#[test]
fn it_is_the_formula_of_the_paper() {
    let mut random = Random(81);
    for _ in 0..20_000 {
        let [n_u, n_v] = [(); 2].map(|()| 1000.0 * f64::from(random.unit()).powi(3));
        let (r_d, r_s) = (f64::from(random.unit()), f64::from(random.unit()));
        let [wo, wi] = [double(random.above()).normalize(), double(random.above()).normalize()];
        let h = (wo + wi).normalize();
        let exponent = (n_u * h.x * h.x + n_v * h.y * h.y) / (1.0 - h.z * h.z);
        let f = r_s + (1.0 - r_s) * (1.0 - wo.dot(h)).powi(5);
        let density = ((n_u + 1.0) * (n_v + 1.0)).sqrt() / (2.0 * PI) * h.z.powf(exponent) / (4.0 * wo.dot(h));
        let t = |c: f64| 1.0 - (1.0 - c / 2.0).powi(5);
        let diffuse = 28.0 * r_d / (23.0 * PI) * (1.0 - r_s) * t(wo.z) * t(wi.z);
        let exact = (diffuse + density * f / wo.z.max(wi.z)) * wi.z;
        let value = grey::<f64>(r_d, r_s, [n_u, n_v]).value(wo, wi);
        assert!(close(value.f_cos.g, exact, 1e-9 * exact.max(1e-290)), "{wo:?} {wi:?}: {value:?} instead of {exact}");
        let coat = grey::<f64>(0.0, r_s, [n_u, n_v]).value(wo, wi).pdf;
        assert!(close(coat, density, 1e-9 * density.max(1e-290)), "{wo:?} {wi:?}: {coat} instead of {density}");
    }
}

#[test]
fn single_precision_is_within_eight_units() {
    let (mut random, mut worst) = (Random(82), 0.0_f64);
    for _ in 0..200_000 {
        let exponents = any_exponents(&mut random);
        let [r_d, r_s] = [(); 2].map(|()| f64::from(random.unit()).powi(if random.unit() < 0.5 { 1 } else { 9 }));
        let (lobe, [wo, wi]) = (grey::<f32>(r_d, 1.0 - r_s, exponents), pair(&mut random));
        let lobe =
            if random.unit() < 0.5 { lobe } else { AshikhminShirley { specular: Rgb::splat(r_s as f32), ..lobe } };
        let wo = if random.unit() < 0.9 { wo } else { Vec3::new(1e-3 * wo.x, 1e-3 * wo.y, 1.0).normalize() };
        worst = worst.max(units(&lobe, wo, wi));
    }
    assert!(worst <= 8.0, "{worst}");
}

#[test]
fn no_albedo_exceeds_1_whatever_the_reflectances() {
    // The sum is linear in R_d and in R_s, so the ends of their ranges decide.
    let mut largest = [(0.0, 0.0, [0.0; 2]); 3];
    for exponents in EXPONENTS {
        for cos in [1e-4, 1e-2, 0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.0] {
            for turns in [0.0, 0.09, 0.25] {
                for (i, (r_d, r_s)) in [(1.0, 0.0), (0.0, 0.0), (0.0, 1.0)].into_iter().enumerate() {
                    let lobe = grey::<f64>(r_d, r_s, exponents);
                    let sum = albedo(&lobe, view(cos, turns), 128);
                    if sum > largest[i].0 {
                        largest[i] = (sum, cos, exponents);
                    }
                    let bound = |f0: f64| f0 + (1.0 - f0) * (1.0 - 0.5 * cos).powi(5);
                    let glossy = sum - r_d * (1.0 - r_s) * shown(cos);
                    assert!(glossy <= bound(r_s) * (1.0 + 1e-4), "{exponents:?} {cos} {r_d} {r_s}: {glossy}");
                }
            }
        }
    }
    assert!(largest.iter().all(|(sum, ..)| *sum <= 1.0 + 1e-4), "{largest:?}");
}

#[test]
fn along_the_normal_a_narrow_coat_adds_its_reflectance_to_31_32nds_of_the_base() {
    for (r_d, r_s) in [(1.0, 0.0), (0.5, 0.05), (0.3, 0.9), (1.0, 1.0)] {
        let (sum, exact) =
            (albedo(&grey(r_d, r_s, [1e7; 2]), Vec3::unit_z(), 256), r_s + r_d * (1.0 - r_s) * 31.0 / 32.0);
        assert!(close(sum, exact, 1e-4), "{r_d} {r_s}: {sum} instead of {exact}");
    }
}

#[test]
fn a_white_coat_of_exponent_0_returns_an_eighth_along_the_normal() {
    // ∫ cos_i over the uniform cosines c of h, cos_i = 2c² − 1 > 0: (√2 − 1)/3.
    let sum = albedo(&grey(0.0, 1.0, [0.0; 2]), Vec3::unit_z(), 512);
    assert!(close(sum, (2.0_f64.sqrt() - 1.0) / 3.0, 1e-5), "{sum}");
}

#[test]
fn densities_integrate_to_1_less_what_fails() {
    for exponents in [[0.0, 0.0], [0.5, 40.0], [30.0, 3.0], [60.0, 60.0]] {
        for (r_d, r_s) in [(0.0, 0.5), (0.5, 0.05)] {
            for cos in [1.0, 0.7, 0.2] {
                let what = std::format!("{exponents:?} {r_d} {r_s} {cos}");
                assert_normalised(&what, &grey(r_d, r_s, exponents), view(cos, 0.09));
            }
        }
    }
}

#[test]
fn the_sampler_of_the_coat_stretches_the_unit_square_by_its_density_in_all_four_quadrants() {
    let (mut random, step) = (Random(86), 1e-6);
    for exponents in [[0.0, 0.0], [0.0, 300.0], [20.0, 5.0], [1e4, 1e3]] {
        let lobe = grey::<f64>(0.0, 0.5, exponents);
        for round in 0..4000 {
            let mut inner = |from: f64, width: f64| from + width * (0.01 + 0.98 * f64::from(random.unit()));
            let (wo, u) =
                (view(inner(0.0, 1.0), inner(0.0, 1.0)), [inner(0.0, 1.0), inner(0.25 * f64::from(round % 4), 0.25)]);
            let at = |du: f64, dv: f64| lobe.draw(wo, [0.5, u[0] + du, u[1] + dv]);
            if [at(step, 0.0), at(-step, 0.0), at(0.0, step), at(0.0, -step)].iter().any(|s| s.event.failed) {
                continue;
            }
            let along = (at(step, 0.0).wi - at(-step, 0.0).wi) / (2.0 * step);
            let across = (at(0.0, step).wi - at(0.0, -step).wi) / (2.0 * step);
            let product = along.cross(across).length() * lobe.value(wo, at(0.0, 0.0).wi).pdf;
            assert!(close(product, 1.0, 1e-4), "{exponents:?} {wo:?} {u:?}: {product}");
        }
    }
}

#[test]
fn no_sample_weighs_more_than_promised_and_of_a_grey_surface_not_more_than_2() {
    let (mut random, mut closest) = (Random(83), 0.0_f32);
    for round in 0..400_000 {
        let exponents = any_exponents(&mut random);
        let mut lobe = grey::<f32>(random.unit().into(), random.unit().powi(3).into(), exponents);
        let colour = round % 2 == 0;
        if colour {
            lobe.diffuse.g = random.unit();
            lobe.specular.r = random.unit();
        }
        let [wo, _] = pair(&mut random);
        let sample = lobe.draw(wo, [random.unit(), random.unit(), random.unit()]);
        let (value, bound) = (lobe.value(wo, sample.wi), lobe.largest_weight(wo));
        if sample.event.failed {
            continue;
        }
        closest = closest.max(value.f_cos.largest() / value.pdf / bound);
        assert!(colour || bound <= 2.0 * (1.0 + 1e-5), "{lobe:?} {wo:?}: {bound}");
    }
    assert!(closest <= 1.0 + 1e-5, "{closest}");
}

#[test]
fn light_takes_the_same_way_back() {
    let mut random = Random(84);
    for _ in 0..10_000 {
        let lobe = grey::<f32>(0.4, 0.3, any_exponents(&mut random));
        let [a, b] = pair(&mut random);
        let (there, back) = (lobe.value(a, b).f_cos.g / b.z, lobe.value(b, a).f_cos.g / a.z);
        assert!((there - back).abs() <= 1e-6 * there, "{a:?} {b:?}: {there} and {back}");
    }
}

#[cfg(feature = "wide")]
#[test]
fn eight_lanes_have_the_bits_of_one() {
    let mut random = Random(85);
    for _ in 0..10_000 {
        let r = random.unit();
        assert_lanes(&grey::<f32>(random.unit().into(), r.into(), any_exponents(&mut random)), &mut random);
    }
}

#[test]
fn highlights_are_narrow_along_the_axis_of_the_larger_exponent() {
    let lobe = grey::<f64>(0.0, 0.5, [10.0, 1000.0]);
    let at = |turns: f64| lobe.value(Vec3::unit_z(), view(0.95, turns)).f_cos.g;
    assert!(at(0.0) > 100.0 * at(0.25));
    assert!(lobe.properties().anisotropic && !grey::<f64>(0.0, 0.5, [3.0; 2]).properties().anisotropic);
}

#[test]
fn grazing_and_opposite_directions_stay_finite_and_the_horizon_is_black() {
    let turn = |cos: f32, x: f32, y: f32| Vec3::new(x, y, cos);
    for exponents in EXPONENTS {
        for r in [0.0, 0.5, 1.0] {
            let lobe = grey::<f32>(1.0 - r, r, exponents);
            for cos_o in [1e-45, 1e-38, 1e-30, 1e-20, 1e-10, 1e-4] {
                for cos_i in [1e-45, 1e-38, 1e-30, 1e-20, 1e-10, 1e-4] {
                    for length in [0.9996, 1.0, 1.0004] {
                        let wo = turn(cos_o, length, 0.0);
                        for wi in [turn(cos_i, -length, 0.0), turn(cos_i, -1.0, 1e-20), turn(cos_i, 0.6, 0.8)] {
                            let value = lobe.value(wo, wi);
                            assert!(value.is_sound(), "{lobe:?} {wo:?} {wi:?}: {value:?}");
                        }
                    }
                }
                let (wo, below) = (turn(cos_o, 1.0, 0.0), turn(-0.6, 0.8, 0.0));
                assert_eq!((lobe.value(wo, below).pdf, lobe.value(wo, below).f_cos), (0.0, Rgb::zero()));
                assert_eq!((lobe.value(below, wo).pdf, lobe.value(wo, turn(0.0, 1.0, 0.0)).pdf), (0.0, 0.0));
                let sample = lobe.draw(wo, [0.99, 0.5, 0.3]);
                assert!(sample.wi.is_direction(), "{lobe:?} {wo:?}: {sample:?}");
            }
        }
    }
}
