//! Questions to Embree, of 1, 8 or 16 rays: one record for all widths.
//!
//! Embree's records of N rays and of their hits are arrays of N words, field after field; only N differs. So one type with N as a
//! parameter stands for all of them, held to the bindings' own at compile time.

use crate::ray::{NO_HIT, Ray8};
use embree4_sys::*;
use gonio_kernel::{F32x8, Mask8, Real, U32x8, Vec3};
use std::mem::{MaybeUninit, offset_of};

/// Coordinates from here on are infinite to Embree.
const FAR: f32 = 1.8e18;

/// Hits must be beyond this: not 0, see embree.rs, and not the smallest normal number either. Embree multiplies t_min by twice
/// a triangle's area, and a product that is denormal costs the processor some hundred cycles.
const LEAST_T: f32 = 1e-20;

/// A record with room after it: newer libraries write more than the bindings say.
#[repr(C, align(64))]
pub(super) struct Padded<T> {
    record: T,
    room: [MaybeUninit<u32>; 64],
}

impl<T> Padded<T> {
    pub(super) fn new(record: T) -> Self {
        Self { record, room: [MaybeUninit::uninit(); 64] }
    }

    /// A pointer that may reach into the room.
    pub(super) fn as_mut_ptr(&mut self) -> *mut T {
        (&raw mut *self).cast()
    }
}

/// Lanes that are alive and that Embree understands: finite and not as far as it takes for infinite. Others hit nothing.
pub(super) fn live(ray: &Ray8) -> Mask8 {
    let near = |v: Vec3<F32x8>| {
        let limit = F32x8::splat(FAR);
        v.x.abs().lt(limit) & v.y.abs().lt(limit) & v.z.abs().lt(limit)
    };
    ray.mask & near(ray.origin) & near(ray.dir) & ray.t_min.le(ray.t_max)
}

/// N rays and their hits, as Embree reads and writes them; 64 bytes are the alignment that 16 rays need.
#[repr(C, align(64))]
pub(super) struct Query<const N: usize> {
    origin: [[f32; N]; 3],
    t_min: [f32; N],
    dir: [[f32; N]; 3],
    time: [f32; N],
    /// The nearest hit afterwards; −∞ if it is only asked whether there is one.
    t_max: [f32; N],
    mask: [u32; N],
    id: [u32; N],
    flags: [u32; N],
    normal: [[f32; N]; 3],
    bary: [[f32; N]; 2],
    prim: [u32; N],
    geometry: [u32; N],
    instance: [u32; N],
    /// For what newer libraries keep there: N words in 4.3 and 4.4.
    room: [[u32; N]; 16],
    /// Which rays Embree shall look at, as it wants to be told: −1 or 0.
    valid: Valid<N>,
}

/// Aligned as 16 rays need it.
#[repr(align(64))]
struct Valid<const N: usize>([u32; N]);

/// The record of hits begins where that of rays ends, and the room where the bindings' hits end.
const fn is_like<Ray, RayHit, const N: usize>() -> bool {
    offset_of!(Query<N>, normal) == size_of::<Ray>()
        && offset_of!(Query<N>, room) == size_of::<RayHit>()
        && align_of::<Query<N>>() >= align_of::<RayHit>()
}
const _: () = assert!(is_like::<RTCRay, RTCRayHit, 1>());
const _: () = assert!(is_like::<RTCRay8, RTCRayHit8, 8>());
const _: () = assert!(is_like::<RTCRay16, RTCRayHit16, 16>());
const _: () = assert!(offset_of!(RTCRay16, tfar) == offset_of!(Query<16>, t_max));
const _: () = assert!(offset_of!(RTCRay16, id) == offset_of!(Query<16>, id));
const _: () = assert!(offset_of!(RTCHit16, u) + size_of::<RTCRay16>() == offset_of!(Query<16>, bary));
const _: () = assert!(offset_of!(RTCHit16, geomID) + size_of::<RTCRay16>() == offset_of!(Query<16>, geometry));

/// What Embree says of the lanes of a packet.
#[derive(Clone, Copy)]
pub(super) struct Answer {
    pub(super) t: [f32; F32x8::LANES],
    pub(super) bary: [[f32; F32x8::LANES]; 2],
    pub(super) prim: [u32; F32x8::LANES],
    /// [`NO_HIT`] for none.
    pub(super) geometry: [u32; F32x8::LANES],
}

impl Answer {
    pub(super) const NONE: Self = {
        let (zero, none) = ([0.0; F32x8::LANES], [NO_HIT; F32x8::LANES]);
        Self { t: zero, bary: [zero; 2], prim: none, geometry: none }
    };
}

impl<const N: usize> Query<N> {
    /// How many packets a question is about.
    pub(super) const PACKETS: usize = if N < F32x8::LANES { 1 } else { N / F32x8::LANES };
    /// How many questions a packet takes.
    pub(super) const PARTS: usize = F32x8::LANES * Self::PACKETS / N;

    /// No rays yet.
    pub(super) fn new() -> Self {
        const { assert!(matches!(N, 1 | 8 | 16)) }
        let (zero, none) = ([0.0; N], [NO_HIT; N]);
        Self {
            origin: [zero; 3],
            t_min: zero,
            dir: [zero; 3],
            time: zero,
            t_max: zero,
            mask: [u32::MAX; N],
            id: std::array::from_fn(|lane| lane as u32),
            flags: [0; N],
            normal: [zero; 3],
            bary: [zero; 2],
            prim: none,
            geometry: none,
            instance: none,
            room: [[NO_HIT; N]; 16],
            valid: Valid([0; N]),
        }
    }

    /// Takes the rays of up to [`PACKETS`](Self::PACKETS) packets; of one lane, `part`, if N is 1. Whether any of them is live.
    #[inline(always)]
    pub(super) fn take(&mut self, rays: &[Ray8], live: &[Mask8; 2], part: usize) -> bool {
        if N == 1 && !live[0].lane(part) {
            return false;
        }
        let mut any = 0;
        for (packet, ray) in rays.iter().enumerate() {
            let (at, bits) = (packet * F32x8::LANES + part, live[packet].to_bits());
            any |= bits;
            let t_min = ray.t_min.max(F32x8::splat(LEAST_T));
            for (field, lanes) in self.origin.iter_mut().zip([&ray.origin.x, &ray.origin.y, &ray.origin.z]) {
                put(field, at, lanes);
            }
            for (field, lanes) in self.dir.iter_mut().zip([&ray.dir.x, &ray.dir.y, &ray.dir.z]) {
                put(field, at, lanes);
            }
            put(&mut self.t_min, at, &t_min);
            put(&mut self.time, at, &ray.time);
            put(&mut self.t_max, at, &ray.t_max);
            if N > 1 {
                let valid = U32x8::select(live[packet], U32x8::splat(u32::MAX), U32x8::splat(0));
                self.valid.0[at..at + F32x8::LANES].copy_from_slice(&valid.to_array());
            }
        }
        let given = rays.len() * F32x8::LANES;
        if given < N {
            self.valid.0[given..].fill(0);
        }
        if N == 1 {
            self.id[0] = part as u32;
        }
        self.geometry = [NO_HIT; N];
        any != 0
    }

    /// Asks for the nearest hits.
    ///
    /// # Safety
    /// The scene is committed; the arguments are filled and have room.
    #[inline(always)]
    pub(super) unsafe fn intersect(&mut self, scene: RTCScene, arguments: &mut Padded<RTCIntersectArguments>) {
        let (valid, query, arguments) = (self.valid.0.as_ptr().cast(), &raw mut *self, arguments.as_mut_ptr());
        // SAFETY: by the caller; the record is Embree's of this N by `is_like`, filled, aligned, and has room.
        unsafe {
            match N {
                1 => rtcIntersect1(scene, query.cast(), arguments),
                8 => rtcIntersect8(valid, scene, query.cast(), arguments),
                _ => rtcIntersect16(valid, scene, query.cast(), arguments),
            }
        }
    }

    /// Asks whether there are hits.
    ///
    /// # Safety
    /// As for [`Query::intersect`]; a filter's context lives.
    #[inline(always)]
    pub(super) unsafe fn occluded(&mut self, scene: RTCScene, arguments: &mut Padded<RTCOccludedArguments>) {
        let (valid, query, arguments) = (self.valid.0.as_ptr().cast(), &raw mut *self, arguments.as_mut_ptr());
        // SAFETY: as in `intersect`.
        unsafe {
            match N {
                1 => rtcOccluded1(scene, query.cast(), arguments),
                8 => rtcOccluded8(valid, scene, query.cast(), arguments),
                _ => rtcOccluded16(valid, scene, query.cast(), arguments),
            }
        }
    }

    /// Writes down what was answered to the question of these rays.
    #[inline(always)]
    pub(super) fn give(&self, answers: &mut [Answer], part: usize) {
        for (packet, answer) in answers.iter_mut().enumerate() {
            let at = packet * F32x8::LANES + part;
            get(&self.t_max, at, &mut answer.t);
            get(&self.bary[0], at, &mut answer.bary[0]);
            get(&self.bary[1], at, &mut answer.bary[1]);
            get(&self.prim, at, &mut answer.prim);
            get(&self.geometry, at, &mut answer.geometry);
        }
    }

    /// Writes down only how far rays go, which tells whether they are blocked.
    #[inline(always)]
    pub(super) fn give_t(&self, answers: &mut [Answer], part: usize) {
        for (packet, answer) in answers.iter_mut().enumerate() {
            get(&self.t_max, packet * F32x8::LANES + part, &mut answer.t);
        }
    }
}

/// Eight lanes into a field, from `at` on; lane `at` alone into a field of one.
#[inline(always)]
fn put<const N: usize>(field: &mut [f32; N], at: usize, lanes: &F32x8) {
    if N == 1 {
        field[0] = lanes.lane(at); // straight from the packet, which lies in memory
    } else {
        field[at..at + F32x8::LANES].copy_from_slice(&lanes.to_array());
    }
}

/// Eight lanes out of a field, from `at` on; lane `at` alone out of a field of one.
#[inline(always)]
fn get<T: Copy, const N: usize>(field: &[T; N], at: usize, lanes: &mut [T; F32x8::LANES]) {
    if N == 1 {
        lanes[at & 7] = field[0];
    } else {
        lanes.copy_from_slice(&field[at..at + F32x8::LANES]);
    }
}
