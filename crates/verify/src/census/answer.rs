//! What a backend says of a ray, and whether two such answers agree.

use super::aim::Ray;
use super::specimen::{Place, Specimen};
use super::standard::Standard;
use super::wide::wide;
use gonio_accel::{Accel, Hit, Hit8, Opacity, Ray8, RayKind};
use gonio_kernel::{F32x8, Mask8, Vec3};
use serde::Serialize;

/// What a backend says of one ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Answer {
    pub(crate) hit: Option<Hit>,
    pub(crate) blocked: bool,
    /// Blocked, although about half of all hits let light through.
    pub(crate) filtered: bool,
}

/// What a backend says of some packets.
pub(crate) struct Answers {
    hits: Vec<Hit8>,
    blocked: Vec<Mask8>,
    filtered: Vec<Mask8>,
}

/// How an answer is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// The ray passes a surface that must stop it.
    Leak,
    /// Only one of the two has a hit.
    HitOrMiss,
    /// Another triangle.
    Prim,
    /// Another distance.
    T,
    /// Another place in the triangle.
    Bary,
    /// Another answer about occlusion, or one that contradicts the nearest hit.
    Shadow,
}

/// Distances agree within this times (|t| + size of the scene): DESIGN's invariant on backends that are not ours.
const TOLERANCE: f64 = 1e-5;

impl Answer {
    /// Whether the ray gets through, as far as this backend is concerned.
    pub(crate) fn leaks(&self) -> bool {
        self.hit.is_none() || !self.blocked
    }
}

impl Answers {
    /// Asks three questions about every ray. `numbers` names each lane, so that the filter treats a ray alike wherever
    /// it stands.
    pub(crate) fn ask(accel: &dyn Accel, kind: RayKind, rays: &[Ray8], numbers: &[u64]) -> Self {
        let mut hits = vec![Hit8::miss(); rays.len()];
        accel.closest(kind, rays, &mut hits);
        let blocked = |filter: Option<&dyn Opacity>| {
            let mut blocked = vec![Mask8::first(0); rays.len()];
            accel.occluded(kind, rays, filter, &mut blocked);
            blocked
        };
        Self { hits, blocked: blocked(None), filtered: blocked(Some(&HalfOpen(numbers))) }
    }

    /// What is said of one lane.
    pub(crate) fn lane(&self, packet: usize, lane: usize) -> Answer {
        let [blocked, filtered] = [&self.blocked, &self.filtered].map(|masks| masks[packet].lane(lane));
        Answer { hit: self.hits[packet].lane(lane), blocked, filtered }
    }
}

/// A filter that lets about half of all hits through, by triangle and ray: an opacity texture's stand-in.
struct HalfOpen<'a>(&'a [u64]);

impl Opacity for HalfOpen<'_> {
    fn blocks(&self, ray: usize, hit: &Hit) -> bool {
        (hit.prim ^ hit.instance ^ (self.0[ray] as u32)).count_ones().is_multiple_of(2)
    }
}

/// How an answer differs from the one that is expected, if it does.
///
/// The exact standard asks for every bit. The close one asks for hit or miss, and for the triangle or the distance within
/// [`TOLERANCE`]. Where the triangle is the same its distance is compared all the same, within the tolerance over the
/// steepness (e₁ × e₂)·d / |e₁||e₂|, small where the ray grazes or the triangle is a needle, which is how an error of the
/// place becomes one of the distance; and the barycentrics must lead to the place that the distance leads to, on the triangle
/// that was named. `ordinary` says that no rounding decides the ray: only then must the close standard see the same triangles
/// through the opacity filter, for at an edge it depends on the triangle.
pub(crate) fn compare(
    standard: Standard,
    ordinary: bool,
    specimen: &Specimen,
    ray: &Ray,
    expected: &Answer,
    got: &Answer,
) -> Option<Kind> {
    let nearest = match (&expected.hit, &got.hit) {
        (None, None) => None,
        (Some(a), Some(b)) if standard == Standard::Exact => exact(a, b),
        (Some(a), Some(b)) => close(specimen, ray, a, b),
        _ => Some(Kind::HitOrMiss),
    };
    let filtered = expected.filtered == got.filtered || !(ordinary || standard == Standard::Exact);
    // A ray is blocked by anything exactly if it has a nearest hit, and a filter only takes away.
    let consistent = got.blocked == got.hit.is_some() && got.blocked >= got.filtered;
    nearest.or((got.blocked != expected.blocked || !filtered || !consistent).then_some(Kind::Shadow))
}

/// Equal bits; −0 is not 0 here.
fn exact(a: &Hit, b: &Hit) -> Option<Kind> {
    if id(a) != id(b) {
        Some(Kind::Prim)
    } else if a.t.to_bits() != b.t.to_bits() {
        Some(Kind::T)
    } else {
        (a.bary.map(f32::to_bits) != b.bary.map(f32::to_bits)).then_some(Kind::Bary)
    }
}

fn close(specimen: &Specimen, ray: &Ray, a: &Hit, b: &Hit) -> Option<Kind> {
    let within = |difference: f64, limit: f64| difference <= limit; // never for a NaN
    let off = f64::from((a.t - b.t).abs());
    let tolerance = TOLERANCE * f64::from(a.t.abs() + specimen.size());
    let same = id(a) == id(b);
    if !same && !within(off, tolerance) {
        return Some(Kind::Prim);
    }
    if !specimen.has(b) {
        return Some(Kind::Prim); // names nothing that exists
    }
    let corners = specimen.corners(Place { instance: b.instance, prim: b.prim }).map(wide);
    let (e1, e2) = (corners[1] - corners[0], corners[2] - corners[0]);
    let dir = wide(ray.dir);
    let steepness = e1.cross(e2).dot(dir).abs() / (e1.length() * e2.length()).max(f64::MIN_POSITIVE);
    if same && !within(off * steepness, tolerance) {
        return Some(Kind::T);
    }
    let place = corners[0].along(b.bary[0].into(), e1).along(b.bary[1].into(), e2);
    let along = wide(ray.origin).along(b.t.into(), dir);
    let apart: Vec3<f64> = place - along;
    (!within(apart.length() * steepness, tolerance + rounding(ray))).then_some(Kind::Bary)
}

/// Places as far from the origin as the ray's own start are rounded.
fn rounding(ray: &Ray) -> f64 {
    8.0 * f64::from(f32::EPSILON) * wide(ray.origin).length()
}

fn id(hit: &Hit) -> [u32; 3] {
    [hit.prim, hit.mesh, hit.instance]
}

const _: () = assert!(F32x8::LANES == 8, "numbers name eight lanes per packet");

#[cfg(test)]
mod tests {
    use super::super::meshes::specimens;
    use super::*;

    #[test]
    fn every_way_of_being_wrong_has_its_name() {
        let specimens = specimens();
        let cube = specimens.iter().find(|s| s.name == "box").unwrap();
        // From the middle of the box upwards: the hit of brute.
        let ray = Ray {
            origin: Vec3::new(0.3, 0.0, 0.1),
            dir: Vec3::new(0.0, 1.0, 0.0),
            t_min: 0.0,
            t_max: f32::INFINITY,
            covered: false,
        };
        let eight = super::super::rays::pack(&[ray; 8], 0xff).ray;
        let brute = gonio_accel::Brute::new(&cube.geometry);
        let right = Answers::ask(&brute, RayKind::Coherent, &[eight], &[0; 8]).lane(0, 0);
        let hit = right.hit.unwrap();
        assert_eq!(hit.t, 1.0);
        let with = |hit: Hit| Answer { hit: Some(hit), ..right };
        let cases = [
            (right, None, None),
            (Answer { hit: None, ..right }, Some(Kind::HitOrMiss), Some(Kind::HitOrMiss)),
            (with(Hit { prim: hit.prim ^ 1, ..hit }), Some(Kind::Prim), Some(Kind::Bary)),
            (with(Hit { prim: 99, ..hit }), Some(Kind::Prim), Some(Kind::Prim)),
            (with(Hit { prim: hit.prim ^ 4, t: 1.1, ..hit }), Some(Kind::Prim), Some(Kind::Prim)),
            (with(Hit { t: 1.0_f32.next_up(), ..hit }), Some(Kind::T), None),
            (with(Hit { t: 1.001, ..hit }), Some(Kind::T), Some(Kind::T)),
            (with(Hit { t: f32::NAN, ..hit }), Some(Kind::T), Some(Kind::T)),
            (with(Hit { bary: [hit.bary[0].next_up(), hit.bary[1]], ..hit }), Some(Kind::Bary), None),
            (with(Hit { bary: [hit.bary[1], hit.bary[0]], ..hit }), Some(Kind::Bary), Some(Kind::Bary)),
            (Answer { blocked: false, ..right }, Some(Kind::Shadow), Some(Kind::Shadow)),
            (Answer { filtered: !right.filtered, ..right }, Some(Kind::Shadow), Some(Kind::Shadow)),
        ];
        for (got, exact, close) in cases {
            assert_eq!(compare(Standard::Exact, true, cube, &ray, &right, &got), exact, "{got:?}");
            assert_eq!(compare(Standard::Close, true, cube, &ray, &right, &got), close, "{got:?}");
        }
    }
}
