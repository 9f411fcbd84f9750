//! Frames: orthonormal, right-handed, faithful to the normal and to the tangent's side, and their own inverse.
//!
//! Over normals of all octants and both zeros, at the poles, denormal, huge, not unit, not finite; tangents of the same
//! kinds, parallel to the normal included. Frames are tilted by normals of all those kinds too, and normals turned to face
//! viewers. What builds the frame is an argument, so that a wrong one can be planted.

use crate::finding::{Finding, Run};
use crate::probe::Dir;
use crate::random::Random;
use gonio_kernel::{Frame, Vec3, frame};

/// Builds a frame in `f32` from a normal and perhaps a tangent.
pub(crate) type Build = fn(Vec3<f32>, Option<Vec3<f32>>) -> Frame<f32>;

/// The kernel's frames.
pub(crate) fn kernel(normal: Vec3<f32>, tangent: Option<Vec3<f32>>) -> Frame<f32> {
    match tangent {
        Some(tangent) => Frame::from_normal_tangent(normal, tangent),
        None => Frame::from_normal(normal),
    }
}

/// Tilts a frame by a normal in its own coordinates.
pub(crate) type Tilt = fn(&Frame<f32>, Vec3<f32>) -> Frame<f32>;
/// Turns a normal to face a viewer: n, the geometric normal, wo.
pub(crate) type Face = fn(Vec3<f32>, Vec3<f32>, Vec3<f32>) -> Vec3<f32>;

/// The kernel's.
pub(crate) fn tilted(frame: &Frame<f32>, n: Vec3<f32>) -> Frame<f32> {
    frame.tilted(n)
}
/// The kernel's.
pub(crate) fn facing(n: Vec3<f32>, geometric: Vec3<f32>, wo: Vec3<f32>) -> Vec3<f32> {
    frame::facing(n, geometric, wo)
}

/// The worst departure of a tilted frame from orthonormal, the map's normal and the old tangent, in units of eps. Where the
/// normal is of no use, the frame must be the old one to the bit.
pub(crate) fn measure_tilted(tilt: Tilt, run: &Run) -> Finding {
    let mut random = run.random();
    // The normal is normalised twice and carried by a frame that is itself off by some eps: twice the bound of `measure`.
    let mut finding = Finding::at_most(32.0, "departure from the tilted basis, in eps ≤");
    let (mut kept, rounds) = (0, run.by_effort(100_000, 1_000_000, 10_000_000));
    for _ in 0..rounds {
        let flat = kernel(vector(&mut random), Some(vector(&mut random)));
        let n = vector(&mut random);
        let frame = tilt(&flat, n);
        let Some(exact) = exact_unit(n).filter(|w| w.z > 0.0 && (w.x != 0.0 || w.y != 0.0)) else {
            kept += 1;
            if frame != flat {
                finding.broken(|| format!("tilted by {n:?}: {flat:?} became {frame:?}"));
            }
            continue;
        };
        // What a denormal says beside a large number is lost in rounding: the frame may stay.
        if frame == flat && exact.x.abs().max(exact.y.abs()) < 1e-30 {
            continue;
        }
        let [x, y, z] = [flat.x, flat.y, flat.z].map(crate::probe::promote);
        let normal = (x * exact.x + y * exact.y + z * exact.z).normalize();
        let (error, what) = judge(frame, normal, Some(x), &mut random);
        finding.raise(error / f64::from(f32::EPSILON), || format!("{what}: {flat:?} tilted by {n:?}: {frame:?}"));
    }
    finding.note(format!("{rounds} frames, {kept} of them kept as they were"));
    finding
}

/// The worst departure of a normal that was turned to face a viewer from where it should be.
pub(crate) fn measure_facing(face: Face, run: &Run) -> Finding {
    let mut random = run.random();
    // Of the sum of two vectors that may nearly cancel: some eps over the length of what is left.
    let mut finding =
        Finding::at_most(16.0, "departure from the plane of normal and viewer, in eps over the sum's length ≤");
    let (mut turned, rounds) = (0, run.by_effort(100_000, 1_000_000, 10_000_000));
    for _ in 0..rounds {
        let geometric = kernel(vector(&mut random), None);
        let mut above =
            || geometric.to_world(crate::probe::demote(crate::directions::any_above(&mut random))).normalize();
        let (n, wo) = (above(), above());
        let shown = face(n, geometric.z, wo);
        let (up, seen) = (geometric.z.dot(wo), n.dot(wo));
        let text = || format!("{n:?} over {:?} seen from {wo:?} is shown as {shown:?}", geometric.z);
        let usable = n.dot(geometric.z) > 0.0 && up > 0.0;
        if usable && !(shown.dot(wo) > 0.0 && shown.dot(geometric.z) > 0.0) {
            finding.broken(|| format!("behind the viewer or the surface: {}", text()));
        }
        let least = up.min(frame::GRAZING as f32);
        if usable && seen >= least && shown != n {
            finding.broken(|| format!("turned although it can be seen: {}", text()));
        }
        // Where viewer and normal both lie in the horizon the sum may cancel, and the geometric normal must do.
        if usable && seen < least && (least >= 32.0 * f32::EPSILON || shown != geometric.z) {
            turned += 1;
            let [n, wo, shown] = [n, wo, shown].map(crate::probe::promote);
            let sum = n + wo * (f64::from(least) - n.dot(wo));
            let error = (shown - sum.normalize()).length() * sum.length();
            finding.raise(error / f64::from(f32::EPSILON), text);
        }
    }
    finding.note(format!("{rounds} normals, {turned} of them turned"));
    finding
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
        let n = exact_unit(normal).unwrap_or(Vec3::unit_z());
        let (error, what) = judge(frame, n, tangent.and_then(exact_unit), &mut random);
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

/// The largest error of a frame about the unit normal n and what it is an error of.
fn judge(frame: Frame<f32>, n: Dir, tangent: Option<Dir>, random: &mut Random) -> (f64, &'static str) {
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
    raise((z - n).length(), "another normal");
    if let Some(t) = tangent {
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
fn exact_unit(v: Vec3<f32>) -> Option<Dir> {
    let v = crate::probe::promote(v);
    let length = v.length();
    (length > 0.0 && length.is_finite()).then(|| v * (1.0 / length))
}
