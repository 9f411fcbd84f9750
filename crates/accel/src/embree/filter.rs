//! The opacity filter: Embree asks back for every hit of a shadow ray whether it counts.

use crate::ray::{Hit, NO_HIT, Opacity};
use embree4_sys::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What Embree hands back to [`ask`]: a query context with our own data behind it.
#[repr(C)]
pub(super) struct Question<'a> {
    context: RTCRayQueryContext,
    /// For what newer libraries keep there: 4 bytes in 4.3 and 4.4.
    room: [u32; 15],
    filter: &'a dyn Opacity,
    /// The number of the query's first ray.
    first: usize,
    meshes: &'a [u32],
    /// What the filter panicked with. A panic must not pass through Embree.
    pub(super) panic: Option<Box<dyn Any + Send>>,
}

impl<'a> Question<'a> {
    pub(super) fn new(filter: &'a dyn Opacity, first: usize, meshes: &'a [u32]) -> Self {
        let context = RTCRayQueryContext { instID: [RTC_INVALID_GEOMETRY_ID] };
        Self { context, room: [RTC_INVALID_GEOMETRY_ID; 15], filter, first, meshes, panic: None }
    }

    fn blocks(&mut self, lane: u32, t: f32, bary: [f32; 2], prim: u32, instance: u32) -> bool {
        let mesh = self.meshes.get(instance as usize).copied().unwrap_or(NO_HIT);
        let hit = Hit { t, bary: bary.map(|b| b.max(0.0)), prim, mesh, instance };
        let (filter, ray) = (self.filter, self.first + lane as usize);
        self.panic.is_some()
            || catch_unwind(AssertUnwindSafe(|| filter.blocks(ray, &hit))).unwrap_or_else(|panic| {
                self.panic = Some(panic);
                true
            })
    }
}

/// Embree's question whether hits count: lanes that do not get a 0. The records hold N rays side by side, field after field, in
/// the order of `Query`; our number of a ray is in its `id`.
pub(super) unsafe extern "C" fn ask(arguments: *const RTCFilterFunctionNArguments) {
    // SAFETY: Embree passes its arguments, and in them the context that `occluded` gave it: a `Question` that nothing
    // else refers to while the query runs, on the same thread.
    let (arguments, question) = unsafe { (&*arguments, &mut *(*arguments).context.cast::<Question<'_>>()) };
    let count = arguments.N as usize;
    let (ray, hit) = (arguments.ray.cast::<u32>(), arguments.hit.cast::<u32>());
    for lane in 0..count {
        // SAFETY: `valid` has N entries, a ray 12 fields of N words, and a hit at least 8.
        unsafe {
            let of_ray = |field: usize| ray.add(field * count + lane).read();
            let of_hit = |field: usize| hit.add(field * count + lane).read();
            let valid = arguments.valid.add(lane);
            if valid.read() != 0 {
                let (t, bary) = (f32::from_bits(of_ray(8)), [3, 4].map(|field| f32::from_bits(of_hit(field))));
                if !question.blocks(of_ray(10), t, bary, of_hit(5), of_hit(6)) {
                    valid.write(0);
                }
            }
        }
    }
}
