//! Backends that are wrong on purpose, a few rays in a thousand: the census must notice each.

use gonio_accel::{Accel, Hit8, NO_HIT, Opacity, Ray8, RayKind};
use gonio_kernel::{F32x8, Mask8, U32x8};

/// Makes a right backend wrong.
pub(super) type Fault = fn(Box<dyn Accel>) -> Box<dyn Accel>;

/// Name and fault.
pub(super) const FAULTS: [(&str, Fault); 5] = [
    ("drops hits", drops_hits),
    ("t one ulp farther", |inner| Box::new(Wrong { inner, spoil: farther, lies: false })),
    ("another triangle", |inner| Box::new(Wrong { inner, spoil: another, lies: false })),
    ("barycentric one ulp larger", |inner| Box::new(Wrong { inner, spoil: sideways, lies: false })),
    ("forgets a shadow", |inner| Box::new(Wrong { inner, spoil: |_, _| (), lies: true })),
];

/// Turns a few hits into misses.
pub(super) fn drops_hits(inner: Box<dyn Accel>) -> Box<dyn Accel> {
    let spoil = |hit: &mut Hit8, lane| {
        hit.prim = with_lane_int(hit.prim, lane, NO_HIT);
        hit.t = with_lane(hit.t, lane, f32::INFINITY);
    };
    Box::new(Wrong { inner, spoil, lies: false })
}

fn farther(hit: &mut Hit8, lane: usize) {
    hit.t = with_lane(hit.t, lane, hit.t.to_array()[lane].next_up());
}

fn another(hit: &mut Hit8, lane: usize) {
    hit.prim = with_lane_int(hit.prim, lane, hit.prim.to_array()[lane] ^ 1);
}

fn sideways(hit: &mut Hit8, lane: usize) {
    hit.bary[1] = with_lane(hit.bary[1], lane, hit.bary[1].to_array()[lane].next_up());
}

/// A backend with a fault in about one hit of 250.
struct Wrong {
    inner: Box<dyn Accel>,
    spoil: fn(&mut Hit8, usize),
    /// Whether it says of about one packet of 30 that the first ray is free.
    lies: bool,
}

impl Accel for Wrong {
    fn name(&self) -> &'static str {
        "planted fault"
    }

    fn closest(&self, kind: RayKind, rays: &[Ray8], hits: &mut [Hit8]) {
        self.inner.closest(kind, rays, hits);
        for hit in hits {
            for lane in 0..F32x8::LANES {
                if hit.lane(lane).is_some_and(|h| h.t.to_bits() % 251 == 0) {
                    (self.spoil)(hit, lane);
                }
            }
        }
    }

    fn occluded(&self, kind: RayKind, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
        self.inner.occluded(kind, rays, filter, blocked);
        for (number, mask) in blocked.iter_mut().enumerate() {
            if self.lies && number % 31 == 0 {
                *mask = Mask8::from_bits(mask.to_bits() & !1);
            }
        }
    }
}

fn with_lane(x: F32x8, lane: usize, value: f32) -> F32x8 {
    let mut lanes = x.to_array();
    lanes[lane] = value;
    F32x8::new(lanes)
}

fn with_lane_int(x: U32x8, lane: usize, value: u32) -> U32x8 {
    let mut lanes = x.to_array();
    lanes[lane] = value;
    U32x8::new(lanes)
}
