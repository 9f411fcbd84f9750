//! Totality: inside the domain the unguarded formulas are finite and non-negative; outside, a closure is exactly zero.
//!
//! Three sweeps. [`measure_inside`]: random parameters over their whole ranges and directions of every difficult kind, up to the edge
//! of the domain in length, eight at a time, through the unguarded lobe.
//! [`measure_special`]: through the guard, all pairs of 24 special numbers in all pairs of places of parameters, directions
//! and random numbers, the others ordinary; all places special at once; and random bits. (Those are a weak test: nearly all of
//! them are outside the domain and stop at the guard.) [`measure_probe`]: the same for any lobe as it is, which need not
//! be total outside its domain, but must not panic.

use crate::catalog::RandomValues;
use crate::directions::{any_above, partner, show};
use crate::finding::{Finding, Run};
use crate::probe::{Kind, Probe, demote, promote};
use crate::random::Random;
use crate::test_bsdf::{Answer, DynBsdf, Number, Question};
use crate::under_test::View;
use gonio_kernel::model::Role;
use gonio_kernel::{Value, Vec3};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Numbers at which floating-point code goes wrong: zeros, denormals, the borders of overflow, infinities, NaN.
pub(crate) const SPECIAL: [f32; 24] = [
    0.0,
    -0.0,
    f32::from_bits(1),
    -f32::from_bits(1),
    1e-40,
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    1e-30,
    1e-20,
    1e-12,
    1e-4,
    0.5,
    1.0 - f32::EPSILON / 2.0,
    1.0,
    1.0 + f32::EPSILON,
    -1.0,
    1.5,
    100.0,
    1e20,
    -1e20,
    f32::MAX,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

/// The cosines that make formulas underflow: a direction in the domain may graze as closely as `f32` can say.
const TINY: [f32; 12] =
    [1e-45, 1e-40, f32::MIN_POSITIVE, 1e-30, 1e-22, 1e-18, 2e-18, 1e-14, 1e-12, 2e-12, 1.1e-10, 1e-9];

/// Whether light passes through a lobe, and which of its numbers is the relative index at which it does.
fn passage(bsdf: &dyn DynBsdf, numbers: &[Number]) -> (bool, Option<usize>) {
    let values: Vec<f64> = numbers.iter().map(|number| f64::from(number.value)).collect();
    let transmits = bsdf.properties_at(&values).transmits;
    (transmits, numbers.iter().position(|number| number.is(Role::Index)).filter(|_| transmits))
}

/// How many lanes returned something that is not finite or negative, inside the domain.
pub(crate) fn measure_inside(bsdf: &dyn DynBsdf, run: &Run) -> Finding {
    let numbers = bsdf.numbers();
    let (transmits, index) = passage(bsdf, &numbers);
    let mut random = run.random();
    let mut finding = Finding::at_most(0.0, "unsound results without a guard, inside the domain ≤");
    let mut unsound = 0_usize;
    let mut first = String::new();
    // A quick run takes half as many pairs: a minute has no room for more of every variant.
    let rounds = run.by_effort(300_000, 1_250_000, 6_250_000);
    let mut random_values = RandomValues::new(bsdf);
    let mut lanes = vec![[0.0_f32; 8]; numbers.len()];
    for _ in 0..rounds {
        let questions: [Question; 8] = std::array::from_fn(|l| {
            let values = random_values.draw(&mut random);
            lanes.iter_mut().zip(&values).for_each(|(lanes, x)| lanes[l] = *x);
            let (wo, wi) = pair(transmits, index.map(|index| values[index]), &mut random);
            Question { wo, wi, u: [(); 3].map(|()| random.coarse() as f32) }
        });
        for (l, answer) in bsdf.answer_lanes(&lanes, &questions).into_iter().enumerate() {
            let Answer { value, sample, again, delta } = answer;
            if value.is_sound() && delta.is_sound() && again.is_sound() && is_nearly_direction(sample.wi) {
                continue;
            }
            unsound += 1;
            if first.is_empty() {
                let values: Vec<f32> = lanes.iter().map(|lanes| lanes[l]).collect();
                first = format!("parameters {values:?}, {:?}: {answer:?}", questions[l]);
            }
        }
    }
    finding.raise(unsound as f64, || first);
    finding.note(format!("{} pairs of directions", 8 * rounds));
    finding
}

/// A direction of the domain but for rounding: a sampler may keep the length of a wo at its very edge.
fn is_nearly_direction(w: Vec3<f32>) -> bool {
    (promote(w).length2() - 1.0).abs() <= 1e-3 + 16.0 * f64::from(f32::EPSILON)
}

/// Two directions of the domain: any kind, up to its edge in length, now and then with a tiny cosine or mirrored exactly.
/// From all sides if light passes through, and half the time within 10⁻³ of the critical angle of `eta`, if there is one.
fn pair(transmits: bool, eta: Option<f32>, random: &mut Random) -> (Vec3<f32>, Vec3<f32>) {
    let wo = any_above(random);
    let wi = partner(random, wo);
    let (mut wo, mut wi) = (demote(wo), demote(wi));
    if let Some(eta) = eta.filter(|_| random.bits().is_multiple_of(2)) {
        // sinθ of the critical angle is the lesser of η and 1/η.
        let sin = f64::from(eta.min(1.0 / eta)) + random.log_between(1e-9, 1e-3) * random.pick(&[-1.0, 0.0, 1.0]);
        let (sin, phi) = (sin.clamp(0.0, 1.0), random.between(0.0, std::f64::consts::TAU));
        let at = Vec3::new(sin * phi.cos(), sin * phi.sin(), (1.0 - sin * sin).sqrt());
        wo = demote(at);
    }
    if transmits {
        let turn = |w: Vec3<f32>, bits: u64| if bits.is_multiple_of(2) { Vec3::new(w.x, w.y, -w.z) } else { w };
        (wo, wi) = (turn(wo, random.bits()), turn(wi, random.bits()));
    }
    match random.bits() % 16 {
        0 => wo.z = random.pick(&TINY),
        1 => wi.z = random.pick(&TINY),
        2 => {
            // Mirror images at grazing: the half vector is (0, 0, 2z).
            let phi = random.between(0.0, std::f64::consts::TAU);
            wo = Vec3::new(phi.cos() as f32, phi.sin() as f32, random.pick(&TINY));
            let other = random.pick(&TINY);
            wi = Vec3::new(-wo.x, -wo.y, random.pick(&[wo.z, other]));
        }
        3 => wi = Vec3::new(-wo.x, -wo.y, wo.z),
        4 => wi = wo,
        5 => (wo, wi) = (-wo, wi),
        6 => (wo, wi) = (wo, -wi),
        _ => {}
    }
    // | |w|² − 1 | ≤ 1e-3: a length of 1 ± 4.9e-4.
    let mut stretch = |w: Vec3<f32>| {
        let s = if random.bits().is_multiple_of(4) { random.between(-4.9e-4, 4.9e-4) } else { 0.0 };
        let stretched = w * (1.0 + s) as f32;
        if stretched.is_direction() { stretched } else { w }
    };
    let (a, b) = (stretch(wo), stretch(wi));
    let fallback = Vec3::unit_z();
    (if a.is_direction() { a } else { fallback }, if b.is_direction() { b } else { fallback })
}

/// Broken promises of the guarded closure over special numbers.
pub(crate) fn measure_special(bsdf: &dyn DynBsdf, run: &Run) -> Finding {
    let numbers = bsdf.numbers();
    let (transmits, _) = passage(bsdf, &numbers);
    let mut random = run.random();
    let mut finding = Finding::at_most(0.0, "results of the closure that break its promise ≤");
    let mut broken = 0_usize;
    let mut first = String::new();
    let count = numbers.len();
    let places = count + 6 + 3;
    let mut random_values = RandomValues::new(bsdf);
    // Every special number beside every other, in every two places.
    let two: Vec<(usize, usize)> = (0..places).flat_map(|b| (0..b).map(move |a| (a, b))).collect();
    let products = two.len() * SPECIAL.len() * SPECIAL.len();
    let bits = run.by_effort(500_000, 2_000_000, 10_000_000);
    let all_special = bits / 10;
    for round in 0..products + all_special + bits {
        let mut x: Vec<f32> = Vec::with_capacity(places);
        if round < products {
            let (wo, wi) = pair(transmits, None, &mut random);
            x.extend(random_values.draw(&mut random));
            x.extend(<[f32; 3]>::from(wo).into_iter().chain(<[f32; 3]>::from(wi)));
            x.extend([(); 3].map(|()| random.coarse() as f32));
            let (a, b) = two[round / (SPECIAL.len() * SPECIAL.len())];
            x[a] = SPECIAL[round / SPECIAL.len() % SPECIAL.len()];
            x[b] = SPECIAL[round % SPECIAL.len()];
        } else if round < products + all_special {
            x.resize_with(places, || random.pick(&SPECIAL));
        } else {
            x.resize_with(places, || f32::from_bits(random.bits() as u32));
        }
        let (values, rest) = x.split_at(count);
        let question = Question {
            wo: Vec3::new(rest[0], rest[1], rest[2]),
            wi: Vec3::new(rest[3], rest[4], rest[5]),
            u: [rest[6], rest[7], rest[8]],
        };
        let judge = || judge_closure(bsdf, &numbers, values, &question);
        if let Some(what) = catch_unwind(AssertUnwindSafe(judge)).unwrap_or(Some("panics")) {
            broken += 1;
            if first.is_empty() {
                first = format!("{what}: parameters {values:?}, {question:?}");
            }
        }
    }
    finding.raise(broken as f64, || first);
    finding
        .note(format!("{products} products of special numbers, {all_special} all special, {bits} random bit patterns"));
    finding
}

/// Which promise a closure breaks at these parameters, wo, wi and u.
fn judge_closure(bsdf: &dyn DynBsdf, numbers: &[Number], values: &[f32], question: &Question) -> Option<&'static str> {
    let (value, sample) = bsdf.guarded(values, question);
    // Exactly +0: a weight 0/0 must not become −0/0 either.
    let is_zero = |numbers: &[f32]| numbers.iter().all(|x| x.to_bits() == 0);
    if !value.is_sound() {
        return Some("eval is not finite and non-negative");
    }
    // The domain as the lab understands it, not as the kernel computes it.
    // The millionth leaves room for the kernel's f32 arithmetic at the very edge.
    let outside = |w: Vec3<f32>| {
        let difference = promote(w).length2() - 1.0;
        difference.is_nan() || difference.abs() > 1e-3 + 1e-6
    };
    let off = |(number, &x): (&Number, &f32)| {
        let (x, quantity) = (f64::from(x), number.parameter.quantity);
        x.is_nan() || x < 0.99 * quantity.lo || x > f64::from(quantity.hi as f32)
    };
    let bad_parameter = numbers.iter().zip(values).any(off);
    let Value { f_cos, pdf } = value;
    if (outside(question.wo) || outside(question.wi) || bad_parameter) && !is_zero(&[f_cos.r, f_cos.g, f_cos.b, pdf]) {
        return Some("eval is not exactly zero outside the domain");
    }
    if outside(sample.wi) {
        return Some("sample returns no finite unit direction");
    }
    if (outside(question.wo) || bad_parameter) && !sample.event.failed {
        return Some("sample does not fail outside the domain");
    }
    let (f_cos, weight) = (sample.f_cos, sample.weight);
    if !(Value { f_cos, pdf: sample.pdf }).is_sound() || !(Value { f_cos: weight, pdf: 0.0 }).is_sound() {
        return Some("a sample's value or weight is not finite and non-negative");
    }
    let all = [f_cos.r, f_cos.g, f_cos.b, sample.pdf, weight.r, weight.g, weight.b];
    if sample.event.failed && !is_zero(&all) {
        return Some("a failed sample's value or weight is not exactly zero");
    }
    None
}

/// A probe by itself: sound inside the domain, and no panic on special directions.
pub(crate) fn measure_probe(view: View, run: &Run) -> Finding {
    let mut random = run.random();
    let mut finding = Finding::at_most(0.0, "unsound results inside the domain, or panics outside ≤");
    let mut broken = 0_usize;
    let mut first = String::new();
    for round in 0..run.by_effort(50_000, 500_000, 2_500_000) {
        let (wo, wi) = pair(view.claims.properties.transmits, None, &mut random);
        let u = random.sampler_input(view.probe.single());
        let (mut o, mut i): ([f32; 3], [f32; 3]) = (wo.into(), wi.into());
        let special = round % 2 == 1;
        if special {
            let place = (random.bits() % 6) as usize;
            let x = random.pick(&SPECIAL);
            if place < 3 { o[place] = x } else { i[place - 3] = x }
        }
        let (wo, wi) = (Vec3::from(o.map(f64::from)), Vec3::from(i.map(f64::from)));
        let judged = catch_unwind(AssertUnwindSafe(|| judge_probe(view.probe, wo, wi, u)));
        let wrong = match judged {
            Err(_) => Some("panics"),
            Ok(wrong) => wrong.filter(|_| !special),
        };
        if let Some(what) = wrong {
            broken += 1;
            if first.is_empty() {
                first = format!("{what}: wo {}, wi {}, u {u:?}", show(wo), show(wi));
            }
        }
    }
    finding.raise(broken as f64, || first);
    finding
}

fn judge_probe(probe: &dyn Probe, wo: Vec3<f64>, wi: Vec3<f64>, u: [f64; 3]) -> Option<&'static str> {
    let value = probe.eval(wo, wi);
    let draw = probe.sample(wo, u);
    let again = probe.eval(wo, draw.wi);
    if !value.is_sound() || !again.is_sound() {
        return Some("eval is not finite and non-negative");
    }
    let unit = (draw.wi.length2() - 1.0).abs() <= 2e-3; // false for NaN
    if !unit {
        return Some("sample returns no finite unit direction");
    }
    match draw.kind {
        Kind::Delta(value, _) if !value.is_sound() => Some("delta is not finite and non-negative"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_pairs_are_within_a_thousandth_of_grazing_mirror_retro_or_critical_angle() {
        for (transmits, eta) in [(false, None), (true, Some(1.5_f32))] {
            let mut random = Random::new(7);
            let count = 100_000;
            let near = (0..count).filter(|_| {
                let (wo, wi) = pair(transmits, eta, &mut random);
                let apart = |a: Vec3<f32>, b: Vec3<f32>| (a - b).length();
                let grazing = wo.z.abs() <= 1e-3 || wi.z.abs() <= 1e-3;
                let sin = wo.x.hypot(wo.y);
                let critical = eta.is_some_and(|eta| (sin - eta.min(1.0 / eta)).abs() <= 1e-3);
                let mirror = apart(wi, Vec3::new(-wo.x, -wo.y, wo.z));
                grazing || critical || mirror.min(apart(wi, wo)).min(apart(wi, -wo)) <= 1e-3
            });
            let share = near.count() as f64 / f64::from(count);
            assert!(share >= 0.5, "{share}, transmits {transmits}");
        }
    }
}
