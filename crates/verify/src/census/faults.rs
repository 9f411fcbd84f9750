//! Backends that are wrong on purpose, most of them a few rays in a thousand: the census must notice each.

use super::standard::Standard;
use gonio_accel::{Accel, Hit8, NO_HIT, Opacity, Ray8, RayKind};
use gonio_kernel::{F32x8, Mask8, U32x8};

/// A way of being wrong.
#[derive(Clone, Copy)]
pub struct Fault {
    /// What it does.
    pub name: &'static str,
    /// Makes a right backend wrong, at the given scale.
    pub(crate) plant: fn(Box<dyn Accel>, f64) -> Box<dyn Accel>,
    /// The laxest standard by which it must be noticed.
    pub(crate) noticed_by: Standard,
}

/// Scales at which the faults are looked for; one of them is wrong at the last only.
pub(crate) const SCALES: [f64; 2] = [1.0, 1e4];

/// Everything that can be planted.
pub static FAULTS: [Fault; 10] =
    [
        fault("drops hits on shared edges", |inner, _| wrong(inner, drop_at_edges, Lie::AsItsHits)),
        fault("returns the second nearest hit", |inner, _| wrong(inner, second_nearest, Lie::None)),
        fault("names another triangle", |inner, _| wrong(inner, another_triangle, Lie::None)),
        fault("t off by 1e-3", |inner, _| wrong(inner, off_by_a_thousandth, Lie::None)),
        fault("exchanges the barycentrics", |inner, _| wrong(inner, exchanged, Lie::None)),
        fault("ignores t_max", |inner, _| wrong(inner, |_, _, _, _| (), Lie::NoEnd)),
        fault("drops hits at one scale", |inner, scale| {
            if scale == SCALES[1] { wrong(inner, drop_some, Lie::AsItsHits) } else { inner }
        }),
        fault("forgets a shadow", |inner, _| wrong(inner, |_, _, _, _| (), Lie::Forgets)),
        exact_fault("t one ulp farther", |inner, _| wrong(inner, one_ulp_farther, Lie::None)),
        exact_fault("barycentric one ulp larger", |inner, _| wrong(inner, one_ulp_aside, Lie::None)),
    ];

const fn fault(name: &'static str, plant: fn(Box<dyn Accel>, f64) -> Box<dyn Accel>) -> Fault {
    Fault { name, plant, noticed_by: Standard::Close }
}

const fn exact_fault(name: &'static str, plant: fn(Box<dyn Accel>, f64) -> Box<dyn Accel>) -> Fault {
    Fault { name, plant, noticed_by: Standard::Exact }
}

/// What becomes of a lane's hit, which is one.
type Spoil = fn(&Wrong, &Ray8, &mut Hit8, usize);

/// How occlusion is wrong.
#[derive(Clone, Copy, PartialEq)]
enum Lie {
    /// It is right.
    None,
    /// As the wrong nearest hits would have it.
    AsItsHits,
    /// No ray ends: nor for the nearest hit.
    NoEnd,
    /// The first ray of every 31st packet is free.
    Forgets,
}

struct Wrong {
    inner: Box<dyn Accel>,
    spoil: Spoil,
    lie: Lie,
}

fn wrong(inner: Box<dyn Accel>, spoil: Spoil, lie: Lie) -> Box<dyn Accel> {
    Box::new(Wrong { inner, spoil, lie })
}

impl Wrong {
    fn rays(&self, rays: &[Ray8]) -> Vec<Ray8> {
        let end = |ray: &Ray8| if self.lie == Lie::NoEnd { F32x8::splat(f32::INFINITY) } else { ray.t_max };
        rays.iter().map(|ray| Ray8 { t_max: end(ray), ..*ray }).collect()
    }
}

impl Accel for Wrong {
    fn name(&self) -> &'static str {
        "planted fault"
    }

    fn closest(&self, kind: RayKind, rays: &[Ray8], hits: &mut [Hit8]) {
        self.inner.closest(kind, &self.rays(rays), hits);
        for (ray, hit) in rays.iter().zip(hits) {
            for lane in (0..F32x8::LANES).filter(|&lane| hit.lane(lane).is_some()).collect::<Vec<_>>() {
                (self.spoil)(self, ray, hit, lane);
            }
        }
    }

    fn occluded(&self, kind: RayKind, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
        self.inner.occluded(kind, &self.rays(rays), filter, blocked);
        match self.lie {
            Lie::AsItsHits if filter.is_none() => {
                let mut hits = vec![Hit8::miss(); rays.len()];
                self.closest(kind, rays, &mut hits);
                for (mask, hit) in blocked.iter_mut().zip(&hits) {
                    *mask = !hit.prim.same(U32x8::splat(NO_HIT));
                }
            }
            Lie::Forgets => {
                let forgotten = blocked.iter_mut().step_by(31);
                forgotten.for_each(|mask| *mask = Mask8::from_bits(mask.to_bits() & !1));
            }
            _ => {}
        }
    }
}

/// One hit in 251, by the bits of its distance.
fn chosen(hit: &Hit8, lane: usize) -> bool {
    hit.t.lane(lane).to_bits().is_multiple_of(251)
}

fn drop_at_edges(_: &Wrong, _: &Ray8, hit: &mut Hit8, lane: usize) {
    let [b1, b2] = hit.bary.map(|b| b.lane(lane));
    if b1.min(b2).min(1.0 - b1 - b2) < 1e-6 {
        drop_hit(hit, lane);
    }
}

fn drop_some(_: &Wrong, _: &Ray8, hit: &mut Hit8, lane: usize) {
    if chosen(hit, lane) {
        drop_hit(hit, lane);
    }
}

fn drop_hit(hit: &mut Hit8, lane: usize) {
    set_int(&mut hit.prim, lane, NO_HIT);
    set(&mut hit.t, lane, f32::INFINITY);
}

fn second_nearest(wrong: &Wrong, ray: &Ray8, hit: &mut Hit8, lane: usize) {
    if chosen(hit, lane) {
        let mut beyond = [Hit8::miss()];
        let t_min = F32x8::splat(hit.t.lane(lane).next_up());
        wrong.inner.closest(RayKind::Incoherent, &[Ray8 { t_min, ..*ray }], &mut beyond);
        if let Some(second) = beyond[0].lane(lane) {
            set(&mut hit.t, lane, second.t);
            hit.bary.iter_mut().zip(second.bary).for_each(|(b, value)| set(b, lane, value));
            set_int(&mut hit.prim, lane, second.prim);
            set_int(&mut hit.mesh, lane, second.mesh);
            set_int(&mut hit.instance, lane, second.instance);
        }
    }
}

fn another_triangle(_: &Wrong, _: &Ray8, hit: &mut Hit8, lane: usize) {
    if chosen(hit, lane) {
        let other = hit.prim.lane(lane) ^ 1;
        set_int(&mut hit.prim, lane, other);
    }
}

fn off_by_a_thousandth(_: &Wrong, _: &Ray8, hit: &mut Hit8, lane: usize) {
    if chosen(hit, lane) {
        let t = hit.t.lane(lane) * 1.001;
        set(&mut hit.t, lane, t);
    }
}

fn exchanged(_: &Wrong, _: &Ray8, hit: &mut Hit8, lane: usize) {
    let [b1, b2] = hit.bary.map(|b| b.lane(lane));
    set(&mut hit.bary[0], lane, b2);
    set(&mut hit.bary[1], lane, b1);
}

fn one_ulp_farther(_: &Wrong, _: &Ray8, hit: &mut Hit8, lane: usize) {
    if chosen(hit, lane) {
        let t = hit.t.lane(lane).next_up();
        set(&mut hit.t, lane, t);
    }
}

fn one_ulp_aside(_: &Wrong, _: &Ray8, hit: &mut Hit8, lane: usize) {
    if chosen(hit, lane) {
        let b = hit.bary[1].lane(lane).next_up();
        set(&mut hit.bary[1], lane, b);
    }
}

fn set(x: &mut F32x8, lane: usize, value: f32) {
    let mut lanes = x.to_array();
    lanes[lane] = value;
    *x = F32x8::new(lanes);
}

fn set_int(x: &mut U32x8, lane: usize, value: u32) {
    let mut lanes = x.to_array();
    lanes[lane] = value;
    *x = U32x8::new(lanes);
}
