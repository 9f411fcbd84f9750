//! Places from which no ray can escape: balls inside of closed surfaces.
//!
//! Whether a point is inside is decided by the winding number, the sum of the solid angles of all triangles of the closed
//! parts over 4π: an integer away from the surface, and not 0 inside (Jacobson, Kavan & Sorkine-Hornung 2013, "Robust
//! Inside-Outside Segmentation Using Generalized Winding Numbers"). The distance to the nearest triangle gives a ball that
//! the surface does not enter, so every point of it is inside. Both are computed in `f64` over all triangles; no ray caster
//! is trusted with the answer, one only proposes candidates. Centres lie on lines along an axis through a vertex or through a
//! point of an edge, so that rays along that axis meet them exactly.

use super::ball::Ball;
use super::dice::Dice;
use super::specimen::{Place, Specimen};
use super::wide::wide;
use gonio_accel::{Accel, Hit8, Ray8, RayKind};
use gonio_kernel::{F32x8, Vec3};
use std::f64::consts::PI;

/// Most balls per specimen.
const MOST: usize = 512;
/// How many candidates there are for each ball.
const PATIENCE: u64 = 4;
/// How many triangles may be looked at in all: about two seconds.
const BUDGET: u64 = 30_000_000;
/// The least number of candidates, whatever they cost.
const LEAST: u64 = 16;
/// The smallest useful radius in units of the reach (the size of the scene and its distance from the origin): well above the
/// rounding of places, 8·2⁻²⁴.
const SMALLEST: f64 = 1.0 / 4096.0;

/// Finds balls; none if nothing is closed, or only what is too thin or too small.
pub(crate) fn balls(specimen: &Specimen, scout: &dyn Accel, seed: u64) -> Vec<Ball> {
    let closed: Vec<u32> = (0..specimen.count()).filter(|&i| specimen.is_closed(specimen.place(i))).collect();
    if closed.is_empty() {
        return Vec::new();
    }
    let candidates = (BUDGET / u64::from(specimen.count())).clamp(LEAST, MOST as u64 * PATIENCE);
    let mut balls = Vec::new();
    for packet in 0..candidates.div_ceil(8) {
        for (centre, place, axis) in propose(specimen, scout, &closed, seed, packet) {
            if balls.len() < MOST
                && let Some(radius) = clearance(specimen, place.instance, centre)
            {
                balls.push(Ball { centre, radius, axis });
            }
        }
    }
    balls
}

/// Places halfway between a point of a closed surface and what lies opposite along an axis, each with a triangle of that
/// surface and the axis.
fn propose(
    specimen: &Specimen,
    scout: &dyn Accel,
    closed: &[u32],
    seed: u64,
    packet: u64,
) -> impl Iterator<Item = (Vec3<f32>, Place, usize)> {
    let starts: [_; 8] = std::array::from_fn(|lane| {
        let dice = Dice { specimen, seed, index: packet * 8 + lane as u64 };
        let place = specimen.place(closed[dice.pick(0, closed.len())]);
        let corners = specimen.corners(place);
        let first = dice.pick(1, 3);
        let (a, b) = (corners[first], corners[(first + 1) % 3]);
        let start = if dice.pick(2, 2) == 0 { a } else { a.along(dice.u(3), b - a) };
        let axis = dice.pick(4, 3);
        let mut dir = [0.0; 3];
        dir[axis] = if dice.pick(5, 2) == 0 { 1.0 } else { -1.0 };
        (start, Vec3::from(dir), place, axis)
    });
    let mut ray = Ray8::new(Vec3::from_lanes(|l| starts[l].0), Vec3::from_lanes(|l| starts[l].1));
    ray.t_min = F32x8::splat(specimen.size() * SMALLEST as f32);
    let mut hits = [Hit8::miss()];
    scout.closest(RayKind::Incoherent, &[ray], &mut hits);
    (0..8).filter_map(move |lane| {
        let (start, dir, place, axis) = starts[lane];
        let t = hits[0].lane(lane)?.t;
        Some((start + dir * (0.5 * t), place, axis))
    })
}

/// The distance from the nearest triangle of the instance's closed parts if the point is inside and that is far enough.
fn clearance(specimen: &Specimen, instance: u32, point: Vec3<f32>) -> Option<f32> {
    let reach = wide(specimen.lo).abs().length().max(wide(specimen.hi).abs().length()) + f64::from(specimen.size());
    let least = (SMALLEST * reach).powi(2);
    let topology = specimen.topology(instance);
    let mesh = specimen.geometry.instances()[instance as usize].mesh;
    let (mut angle, mut nearest2) = (0.0, f64::INFINITY);
    for prim in 0..specimen.geometry.meshes()[mesh as usize].triangles.len() as u32 {
        if topology.is_closed(prim) {
            let [a, b, c] = specimen.corners(Place { instance, prim }).map(|v| wide(v) - wide(point));
            nearest2 = nearest2.min(distance2(a, b, c));
            if nearest2 < least {
                return None;
            }
            angle += solid_angle(a, b, c);
        }
    }
    let winding = angle / (4.0 * PI);
    let inside = winding.abs() > 0.5 && (winding - winding.round()).abs() < 1e-3;
    inside.then(|| nearest2.sqrt() as f32)
}

/// The signed solid angle of a triangle, seen from the origin (Van Oosterom & Strackee 1983).
fn solid_angle(a: Vec3<f64>, b: Vec3<f64>, c: Vec3<f64>) -> f64 {
    let (x, y, z) = (a.length(), b.length(), c.length());
    let cosine = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
    2.0 * a.dot(b.cross(c)).atan2(cosine)
}

/// The squared distance of a triangle from the origin.
fn distance2(a: Vec3<f64>, b: Vec3<f64>, c: Vec3<f64>) -> f64 {
    let normal = (b - a).cross(c - a);
    let sides = [(a, b), (b, c), (c, a)];
    if normal.length2() > 0.0 && sides.iter().all(|&(p, q)| (q - p).cross(-p).dot(normal) >= 0.0) {
        return a.dot(normal).powi(2) / normal.length2();
    }
    let to_side = |(p, q): (Vec3<f64>, Vec3<f64>)| {
        let side = q - p;
        let t = (-p.dot(side) / side.length2().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        p.along(t, side).length2()
    };
    sides.into_iter().map(to_side).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::super::meshes::specimens;
    use super::*;

    #[test]
    fn solid_angles_of_a_closed_surface_add_up_to_the_whole_sphere() {
        let specimens = specimens();
        let cube = specimens.iter().find(|s| s.name == "box").unwrap();
        let angle = |p: Vec3<f64>| -> f64 {
            (0..12)
                .map(|i| cube.corners(cube.place(i)).map(|v| wide(v) - p))
                .map(|[a, b, c]| solid_angle(a, b, c))
                .sum()
        };
        assert!((angle(Vec3::new(0.3, -0.2, 0.9)).abs() - 4.0 * PI).abs() < 1e-12);
        assert!(angle(Vec3::new(1.3, -0.2, 0.9)).abs() < 1e-12);
    }

    #[test]
    fn distances_are_to_the_face_an_edge_or_a_corner() {
        let at = |x: f64, y: f64, z: f64| {
            let p = Vec3::new(x, y, z);
            let [a, b, c] = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]].map(|[x, y]| Vec3::new(x, y, 0.0) - p);
            distance2(a, b, c)
        };
        for (point, expected) in [((1.0, 1.0, 3.0), 9.0), ((2.0, -2.0, 0.0), 4.0), ((-1.0, -1.0, 1.0), 3.0)] {
            assert!((at(point.0, point.1, point.2) - expected).abs() < 1e-12, "{point:?}");
        }
        assert!((at(4.0, 4.0, 0.0) - 8.0).abs() < 1e-12);
    }

    #[test]
    fn balls_lie_inside_of_closed_specimens_at_every_scale_and_nowhere_else() {
        for specimen in specimens() {
            for scale in [1e-4_f32, 1.0, 1e6] {
                let scaled = specimen.scaled(scale.into()).unwrap();
                let balls = balls(&scaled, &gonio_accel::Brute::new(&scaled.geometry), 1);
                match specimen.name.as_str() {
                    "box" | "sphere" => {
                        assert!(balls.len() > 50, "{}", specimen.name);
                        let within = |b: &Ball| {
                            let [x, y, z] = <[f32; 3]>::from(b.centre.abs());
                            let out = if specimen.name == "box" { x.max(y).max(z) } else { b.centre.length() };
                            out + b.radius <= 1.00001 * scale
                        };
                        assert!(balls.iter().all(within));
                    }
                    "instances" => assert!(!balls.is_empty()),
                    _ => assert!(balls.is_empty(), "{} is not closed", specimen.name),
                }
            }
        }
    }
}
