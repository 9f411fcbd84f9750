//! Frames: orthonormal, right-handed, faithful to the normal and to the tangent's side, and their own inverse.
//!
//! Over normals of all octants and both zeros, at the poles, denormal, huge, not unit, not finite; tangents of the same
//! kinds, parallel to the normal included. What builds the frame is an argument, so that a wrong one can be planted.

use crate::finding::{Finding, Run};
use crate::random::Random;
use gonio_kernel::{Frame, Vec3};

/// Builds a frame in `f32` from a normal and perhaps a tangent.
pub(crate) type Build = fn(Vec3<f32>, Option<Vec3<f32>>) -> Frame<f32>;

/// The kernel's frames.
pub(crate) fn kernel(normal: Vec3<f32>, tangent: Option<Vec3<f32>>) -> Frame<f32> {
    match tangent {
        Some(tangent) => Frame::from_normal_tangent(normal, tangent),
        None => Frame::from_normal(normal),
    }
}

/// The worst departure, in units of eps.
pub(crate) fn measure(build: Build, run: &Run) -> Finding {
    let mut random = run.random();
    // Each number of a basis takes about 4 roundings after the normalisation's 3, and a product of two vectors adds the
    // errors of both: 16 eps of f32 is within twice of what can add up.
    let mut finding = Finding::at_most(16.0, "departure from an orthonormal right-handed basis, in eps ≤");
    for _ in 0..run.by_effort(100_000, 1_000_000, 10_000_000) {
        let normal = vector(&mut random);
        let tangent = match random.bits() % 4 {
            0 => None,
            1 => Some(normal * random.pick(&[1.0, -1.0, 0.5, 3.0])),
            2 => Some(normal + vector(&mut random) * random.log_between(1e-8, 1.0) as f32),
            _ => Some(vector(&mut random)),
        };
        let frame = build(normal, tangent);
        let (error, what) = judge(frame, normal, tangent, &mut random);
        finding.raise(error / f64::from(f32::EPSILON), || {
            format!("{what}: normal {normal:?}, tangent {tangent:?}, {frame:?}")
        });
    }
    finding
}

/// A vector of any kind.
fn vector(random: &mut Random) -> Vec3<f32> {
    let scale = random.pick(&[1.0, 1.0, 1.0, 1e-3, 1e3, 1e-20, 1e20, 1e-38, 1e-42, 1e38]);
    let w = random.above();
    let sign = |random: &mut Random| random.pick(&[1.0_f64, -1.0]);
    let mut c = [w.x, w.y, w.z * sign(random)].map(|x| (x * scale) as f32);
    for x in &mut c {
        match random.bits() % 24 {
            0 => *x = 0.0,
            1 => *x = -0.0,
            2 => *x *= 1e-6,
            3 => *x *= 1e-30,
            _ => {}
        }
    }
    match random.bits() % 64 {
        0 => c = [0.0, -0.0, random.pick(&[1.0, -1.0])],
        1 => c = [0.0; 3],
        2 => c[(random.bits() % 3) as usize] = random.pick(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY]),
        3 => c = [random.pick(&[1e-45, -1e-45, 0.0]), random.pick(&[1e-45, 0.0]), 1e-45],
        _ => {}
    }
    Vec3::from(c)
}

/// The largest error of a frame and what it is an error of.
fn judge(frame: Frame<f32>, normal: Vec3<f32>, tangent: Option<Vec3<f32>>, random: &mut Random) -> (f64, &'static str) {
    let [x, y, z] = [frame.x, frame.y, frame.z].map(crate::probe::promote);
    let mut worst = (0.0, "");
    let mut raise = |error: f64, what| {
        let error = if error.is_nan() { f64::INFINITY } else { error };
        if error > worst.0 {
            worst = (error, what);
        }
    };
    for v in [x, y, z] {
        raise((v.length2() - 1.0).abs(), "not unit");
    }
    for (a, b) in [(x, y), (y, z), (z, x)] {
        raise(a.dot(b).abs(), "not orthogonal");
    }
    raise((x.cross(y) - z).length(), "not right-handed");
    let n = exact_unit(normal).unwrap_or(Vec3::new(0.0, 0.0, 1.0));
    raise((z - n).length(), "another normal");
    if let Some(t) = tangent.and_then(exact_unit) {
        let side = t - n * n.dot(t);
        // Nearer than this to the normal the direction of the rest is the rounding of the inputs. The tangent may be off
        // by the rounding of its projection: a few eps over its length.
        if side.length() > 1e-3 {
            raise((x - side.normalize()).length() * side.length(), "another tangent");
        }
    }
    let v = random.above();
    let single = crate::probe::demote(v);
    let there_and_back = crate::probe::promote(frame.to_world(frame.to_local(single)));
    raise((there_and_back - crate::probe::promote(single)).length(), "to_world does not invert to_local");
    let local = crate::probe::promote(frame.to_local(single));
    let right = Vec3::new(x.dot(v), y.dot(v), z.dot(v));
    raise((local - right).length(), "to_local is not the projection on x, y, z");
    worst
}

/// The unit vector along v, in `f64`; none for zero and what is not finite.
fn exact_unit(v: Vec3<f32>) -> Option<Vec3<f64>> {
    let v = crate::probe::promote(v);
    let length = v.length();
    (length > 0.0 && length.is_finite()).then(|| v * (1.0 / length))
}
