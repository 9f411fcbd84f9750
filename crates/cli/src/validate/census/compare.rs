//! Two backends, the same rays: how many answers differ, and which is the first.

use super::meshes::Specimen;
use super::rays;
use gonio_accel::{Accel, Hit, Hit8, Opacity, Ray8, RayKind};
use gonio_kernel::{F32x8, Mask, Mask8, Vec3};

/// Packets per call, so that backends that work on streams see some.
const STREAM: u64 = 64;

/// What a comparison found.
#[derive(Debug, Default)]
pub(super) struct Found {
    pub(super) rays: u64,
    pub(super) hits: u64,
    pub(super) disagreements: u64,
    /// The first disagreement, in words.
    pub(super) first: Option<String>,
}

/// A filter that lets about half of all hits through, by triangle and ray: an opacity texture's stand-in.
struct HalfOpen;

impl Opacity for HalfOpen {
    fn blocks(&self, ray: usize, hit: &Hit) -> bool {
        (hit.prim ^ hit.instance ^ (ray as u32)).count_ones().is_multiple_of(2)
    }
}

/// Casts `packets` packets of eight with both backends and compares every answer.
pub(super) fn compare(
    oracle: &dyn Accel,
    accel: &dyn Accel,
    kind: RayKind,
    packet: impl Fn(u64) -> Ray8,
    packets: u64,
) -> Found {
    let mut found = Found::default();
    let mut first = 0;
    while first < packets {
        let rays: Vec<Ray8> = (first..packets.min(first + STREAM)).map(&packet).collect();
        let [expected, got] = [oracle, accel].map(|accel| {
            let mut hits = vec![Hit8::miss(); rays.len()];
            accel.closest(kind, &rays, &mut hits);
            hits
        });
        let blocked = |accel: &dyn Accel, filter: Option<&dyn Opacity>| {
            let mut blocked = vec![Mask8::splat(false); rays.len()];
            accel.occluded(kind, &rays, filter, &mut blocked);
            blocked
        };
        let (plain, filtered) =
            ([oracle, accel].map(|a| blocked(a, None)), [oracle, accel].map(|a| blocked(a, Some(&HalfOpen))));
        for (i, ray) in rays.iter().enumerate() {
            for lane in 0..F32x8::LANES {
                let (a, b) = (expected[i].lane(lane), got[i].lane(lane));
                found.rays += u64::from(ray.mask.lane(lane));
                found.hits += u64::from(a.is_some());
                let [shadow, through] =
                    [&plain, &filtered].map(|masks| masks[0][i].lane(lane) == masks[1][i].lane(lane));
                let what = if !same(a.as_ref(), b.as_ref()) {
                    "different hits"
                } else if !shadow {
                    "blocked by one only"
                } else if !through {
                    "blocked by one only, through an opacity filter"
                } else if plain[1][i].lane(lane) != b.is_some() {
                    // A ray is blocked by anything exactly if it has a nearest hit.
                    "blocked without a hit, or hit without being blocked"
                } else {
                    continue;
                };
                found.disagreements += 1;
                found.first.get_or_insert_with(|| {
                    let number = (first + i as u64) * 8 + lane as u64;
                    format!(
                        "ray {number}: {what}: {} has {}, {} has {}; {}",
                        oracle.name(),
                        words(a.as_ref()),
                        accel.name(),
                        words(b.as_ref()),
                        describe(ray, lane),
                    )
                });
            }
        }
        first += STREAM;
    }
    found
}

/// How many rays that start inside of a closed specimen and are aimed at its edges and vertices leave it.
pub(super) fn leaks(accel: &dyn Accel, specimen: &Specimen, count: u64, seed: u64) -> (u64, String) {
    let (mut leaks, mut rays, mut first) = (0, 0, None);
    for number in 0..count / 8 {
        let ray = rays::from_inside(specimen, seed, number);
        let mut hits = [Hit8::miss()];
        accel.closest(RayKind::Incoherent, &[ray], &mut hits);
        for lane in (0..F32x8::LANES).filter(|&lane| ray.mask.lane(lane)) {
            rays += 1;
            if hits[0].lane(lane).is_none() {
                leaks += 1;
                first.get_or_insert_with(|| {
                    format!("ray {} leaves: {}", number * 8 + lane as u64, describe(&ray, lane))
                });
            }
        }
    }
    (leaks, first.unwrap_or_else(|| format!("{rays} rays")))
}

/// Equal bits; −0 is not 0 here.
fn same(a: Option<&Hit>, b: Option<&Hit>) -> bool {
    let bits =
        |hit: &Hit| [hit.t.to_bits(), hit.bary[0].to_bits(), hit.bary[1].to_bits(), hit.prim, hit.mesh, hit.instance];
    a.map(bits) == b.map(bits)
}

fn words(hit: Option<&Hit>) -> String {
    hit.map_or_else(|| "a miss".to_owned(), |h| format!("prim {} of instance {} at t = {:?}", h.prim, h.instance, h.t))
}

fn describe(ray: &Ray8, lane: usize) -> String {
    let get = |v: Vec3<F32x8>| [v.x, v.y, v.z].map(|x| x.to_array()[lane]);
    let (t_min, t_max) = (ray.t_min.to_array()[lane], ray.t_max.to_array()[lane]);
    format!("origin {:?}, dir {:?}, t from {t_min:?} to {t_max:?}", get(ray.origin), get(ray.dir))
}
