//! The Embree backend: Intel's ray-tracing library, version 4 (Wald et al. 2014, "Embree: A Kernel Framework for Efficient CPU
//! Ray Tracing").
//!
//! Every instance becomes one triangle geometry of Embree with the world vertices that all backends see, over an index buffer
//! that the instances of a mesh share. Rays go through eight at a time, as they come. The scene is built by one thread, so that
//! the tree, and with it the triangle that a ray on a shared edge reports, is the same on every run; which vector instructions
//! Embree then uses it decides itself. The caller's floating-point mode stays as it is: Embree's advice to flush denormals
//! is for speed, and would change the caller's arithmetic.
//!
//! **Agreement.** Embree has its own triangle tests, so hits are not those of `Brute` to the last bit: t is, up to rounding, and
//! of triangles at equal t any may win. [`Intersect::Robust`] sets Embree's flag of that name: edge functions from exact
//! vertices, watertight. [`Intersect::Fast`] leaves it out: Möller and Trumbore's test with the same leaks as ours.
//! A ray whose origin lies exactly in a triangle's plane would hit it at t = 0, where our own test says no: on a floor at
//! y = 0 no rounding lifts the origins of secondary rays. So Embree is asked for hits beyond the smallest normal number; where
//! the plane is only met up to rounding, those origins are off it by more than that.
//!
//! This is the only file of the workspace with `unsafe`. What must hold for the calls:
//!
//! - the library is of a version whose records we know, asked at the start ([`KNOWN`]), built with one level of instances, as
//!   it is unless asked otherwise;
//! - records may be written beyond what the headers of our bindings say: since 4.3 a packet of hits ends with the instances'
//!   primitives, a query context too. [`Padded`] and [`Question`] have room for it;
//! - indices are in range and vertices are finite: [`Geometry::new`] checks. Vertex buffers, which Embree reads in steps of 16 bytes,
//!   are allocated by Embree itself, with room after the last;
//! - only rays that Embree understands are live: see [`live`].

#![warn(clippy::undocumented_unsafe_blocks)]

use crate::Accel;
use crate::geometry::{Geometry, Instance, Mesh};
use crate::ray::{Hit, Hit8, NO_HIT, Opacity, Ray8, RayKind};
use crate::triangle::Intersect;
use embree4_sys::*;
use gonio_kernel::{F32x8, Mask8, Real, U32x8, Vec3};
use std::any::Any;
use std::ffi::CStr;
use std::mem::MaybeUninit;
use std::ops::RangeInclusive;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::ptr::null_mut;
use thiserror::Error;

/// Versions whose records and functions are those that we call, as 10000·major + 100·minor + patch.
const KNOWN: RangeInclusive<isize> = 40_200..=49_999;

/// One thread, so that building is deterministic; and nothing from the `.embree4` files that may lie about.
const CONFIG: &CStr = c"threads=1,set_affinity=0,ignore_config_files=1";

/// Coordinates from here on are infinite to Embree.
const FAR: f32 = 1.8e18;

/// Why Embree cannot be used.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum EmbreeError {
    /// The library that was found is too old or too new.
    #[error("the library is Embree {}.{}.{}, but 4.2 or a later 4 is needed", .0 / 10_000, .0 / 100 % 100, .0 % 100)]
    Version(isize),
    /// Embree refused something.
    #[error("Embree cannot {task}: {reason}")]
    Refused {
        /// What was asked for.
        task: &'static str,
        /// What it said.
        reason: &'static str,
    },
}

/// A scene of Embree, and which mesh each of its geometries shows.
#[derive(Debug)]
pub struct Embree {
    scene: Owned<RTCSceneTy>,
    /// Mesh of each instance; the geometry's number is the instance's.
    meshes: Vec<u32>,
}

// SAFETY: a committed scene is only asked, which Embree allows from any number of threads, and released once, from any.
unsafe impl Send for Embree {}
// SAFETY: as above; `&Embree` gives no way to change the scene.
unsafe impl Sync for Embree {}

impl Embree {
    /// Builds the scene: O(n log n), deterministic, on the calling thread.
    ///
    /// # Errors
    /// If the library is of an unknown version, or refuses: for lack of memory, as a rule.
    pub fn new(geometry: &Geometry, intersect: Intersect) -> Result<Self, EmbreeError> {
        // SAFETY: the string ends with a zero byte. A null device, which means failure, is refused by `of_device`.
        let device = Device::of(unsafe { rtcNewDevice(CONFIG.as_ptr()) })?;
        // SAFETY: the device is live.
        let version = unsafe { rtcGetDeviceProperty(device.handle(), RTCDeviceProperty::VERSION) };
        if !KNOWN.contains(&version) {
            return Err(EmbreeError::Version(version));
        }
        // SAFETY: the device is live. The scene keeps it alive from here on.
        let scene = device.owned("make a scene", unsafe { rtcNewScene(device.handle()) }, rtcReleaseScene)?;
        let robust = match intersect {
            Intersect::Robust => RTCSceneFlags::ROBUST,
            Intersect::Fast => RTCSceneFlags::NONE,
        };
        // SAFETY: the scene is live and not yet committed.
        unsafe { rtcSetSceneFlags(scene.handle, robust | RTCSceneFlags::FILTER_FUNCTION_IN_ARGUMENTS) };
        let mut indices: Vec<Option<Owned<RTCBufferTy>>> = geometry.meshes().iter().map(|_| None).collect();
        for (number, instance) in geometry.instances().iter().enumerate() {
            let (mesh, shared) = (&geometry.meshes()[instance.mesh as usize], &mut indices[instance.mesh as usize]);
            if mesh.triangles.is_empty() {
                continue;
            }
            let shared = match shared {
                Some(shared) => shared,
                None => shared.insert(device.index_buffer(mesh)?),
            };
            device.attach(&scene, number as u32, instance, mesh, shared)?;
        }
        // SAFETY: the scene is live, and no other thread knows it.
        unsafe { rtcCommitScene(scene.handle) };
        device.done("build its tree")?;
        Ok(Self { scene, meshes: geometry.instances().iter().map(|instance| instance.mesh).collect() })
    }
}

/// A reference to an object of Embree, given back when dropped.
#[derive(Debug)]
struct Owned<T> {
    handle: *mut T,
    release: unsafe extern "C" fn(*mut T),
}

impl<T> Drop for Owned<T> {
    fn drop(&mut self) {
        // SAFETY: the handle is not null and we own one reference to it, see `Device::owned`.
        unsafe { (self.release)(self.handle) }
    }
}

struct Device(Owned<RTCDeviceTy>);

impl Device {
    fn of(handle: RTCDevice) -> Result<Self, EmbreeError> {
        if handle.is_null() {
            return Err(refusal("start", null_mut()));
        }
        Ok(Self(Owned { handle, release: rtcReleaseDevice }))
    }

    fn handle(&self) -> RTCDevice {
        self.0.handle
    }

    /// Takes over a reference that Embree has just given us; null means that it could not.
    fn owned<T>(
        &self,
        task: &'static str,
        handle: *mut T,
        release: unsafe extern "C" fn(*mut T),
    ) -> Result<Owned<T>, EmbreeError> {
        if handle.is_null() { Err(refusal(task, self.handle())) } else { Ok(Owned { handle, release }) }
    }

    /// Whether everything so far went well.
    fn done(&self, task: &'static str) -> Result<(), EmbreeError> {
        // SAFETY: the device is live. A device of processors knows no other errors than those of the bindings.
        match unsafe { rtcGetDeviceError(self.handle()) } {
            RTCError::NONE => Ok(()),
            error => Err(EmbreeError::Refused { task, reason: reason(error) }),
        }
    }

    /// The triangles of a mesh, for all its instances.
    fn index_buffer(&self, mesh: &Mesh) -> Result<Owned<RTCBufferTy>, EmbreeError> {
        const TASK: &str = "hold the triangles";
        let bytes = size_of_val(mesh.triangles.as_slice());
        // SAFETY: the device is live.
        let buffer = self.owned(TASK, unsafe { rtcNewBuffer(self.handle(), bytes) }, rtcReleaseBuffer)?;
        // SAFETY: the buffer is live.
        let data = unsafe { rtcGetBufferData(buffer.handle) };
        self.done(TASK)?;
        // SAFETY: Embree has just allocated `bytes` for nobody else, aligned to 16.
        unsafe { data.cast::<[u32; 3]>().copy_from_nonoverlapping(mesh.triangles.as_ptr(), mesh.triangles.len()) };
        Ok(buffer)
    }

    /// Adds an instance to the scene, under its number.
    fn attach(
        &self,
        scene: &Owned<RTCSceneTy>,
        number: u32,
        instance: &Instance,
        mesh: &Mesh,
        indices: &Owned<RTCBufferTy>,
    ) -> Result<(), EmbreeError> {
        const TASK: &str = "hold the vertices";
        let (kind, triangles, vertices) = (RTCGeometryType::TRIANGLE, mesh.triangles.len(), mesh.positions.len());
        // SAFETY: the device is live.
        let shape = self.owned(TASK, unsafe { rtcNewGeometry(self.handle(), kind) }, rtcReleaseGeometry)?;
        let (index, vertex) = (RTCBufferType::INDEX, RTCBufferType::VERTEX);
        // SAFETY: the buffer has `triangles` records of 12 bytes from its start, and the geometry shares its ownership.
        unsafe { rtcSetGeometryBuffer(shape.handle, index, 0, RTCFormat::UINT3, indices.handle, 0, 12, triangles) };
        // SAFETY: the geometry is live; Embree allocates, and adds the room that its loads of 16 bytes need.
        let data = unsafe { rtcSetNewGeometryBuffer(shape.handle, vertex, 0, RTCFormat::FLOAT3, 12, vertices) };
        self.done(TASK)?;
        for (place, position) in mesh.positions.iter().enumerate() {
            // SAFETY: Embree has just allocated `vertices` records of 12 bytes for nobody else, aligned to 16.
            unsafe { data.cast::<[f32; 3]>().add(place).write(instance.to_world(*position)) };
        }
        // SAFETY: scene and geometry are live, and no other thread knows them. The scene keeps a reference of its own.
        unsafe {
            rtcCommitGeometry(shape.handle);
            rtcAttachGeometryByID(scene.handle, shape.handle, number);
        }
        self.done(TASK)
    }
}

/// What Embree says of its last failure; on a null device, of the last failure to make one.
fn refusal(task: &'static str, device: RTCDevice) -> EmbreeError {
    // SAFETY: null or live, which are the two that this function takes.
    EmbreeError::Refused { task, reason: reason(unsafe { rtcGetDeviceError(device) }) }
}

fn reason(error: RTCError) -> &'static str {
    match error {
        RTCError::NONE | RTCError::UNKNOWN => "it does not say why",
        RTCError::INVALID_ARGUMENT => "an argument is invalid",
        RTCError::INVALID_OPERATION => "the operation is invalid",
        RTCError::OUT_OF_MEMORY => "there is not enough memory",
        RTCError::UNSUPPORTED_CPU => "it does not support this processor",
        RTCError::CANCELLED => "it was cancelled",
    }
}

/// A record with room after it: newer libraries write more than the bindings say, by 32 bytes in 4.3 and 4.4.
#[repr(C, align(64))]
struct Padded<T> {
    record: T,
    room: [MaybeUninit<u32>; 64],
}

impl<T> Padded<T> {
    fn new(record: T) -> Self {
        Self { record, room: [MaybeUninit::uninit(); 64] }
    }

    /// A pointer that may reach into the room.
    fn as_mut_ptr(&mut self) -> *mut T {
        (&raw mut *self).cast()
    }
}

/// Lanes that are alive and that Embree understands: finite and not as far as it takes for infinite. Others hit nothing.
fn live(ray: &Ray8) -> Mask8 {
    let near = |v: Vec3<F32x8>| {
        let limit = F32x8::splat(FAR);
        v.x.abs().lt(limit) & v.y.abs().lt(limit) & v.z.abs().lt(limit)
    };
    ray.mask & near(ray.origin) & near(ray.dir) & ray.t_min.le(ray.t_max)
}

/// Which lanes Embree shall look at, as it wants to be told: −1 or 0, aligned.
#[repr(align(32))]
struct Valid([i32; F32x8::LANES]);

impl Valid {
    fn of(lanes: Mask8) -> Self {
        let bits = lanes.to_bits();
        Self(std::array::from_fn(|lane| -((bits >> lane & 1) as i32)))
    }
}

fn record(ray: &Ray8) -> RTCRay8 {
    RTCRay8 {
        org_x: ray.origin.x.to_array(),
        org_y: ray.origin.y.to_array(),
        org_z: ray.origin.z.to_array(),
        tnear: ray.t_min.max(F32x8::splat(f32::MIN_POSITIVE)).to_array(), // not 0, see the top of this file
        dir_x: ray.dir.x.to_array(),
        dir_y: ray.dir.y.to_array(),
        dir_z: ray.dir.z.to_array(),
        time: ray.time.to_array(),
        tfar: ray.t_max.to_array(),
        mask: [u32::MAX; F32x8::LANES],
        id: std::array::from_fn(|lane| lane as u32),
        flags: [0; F32x8::LANES],
    }
}

/// A record of hits before the question: no geometry.
fn no_hit() -> RTCHit8 {
    let (zero, none) = ([0.0; F32x8::LANES], [RTC_INVALID_GEOMETRY_ID; F32x8::LANES]);
    RTCHit8 { Ng_x: zero, Ng_y: zero, Ng_z: zero, u: zero, v: zero, primID: none, geomID: none, instID: [none] }
}

fn flags(kind: RayKind) -> RTCRayQueryFlags {
    match kind {
        RayKind::Coherent => RTCRayQueryFlags::COHERENT,
        RayKind::Incoherent => RTCRayQueryFlags::INCOHERENT,
    }
}

const EVERYTHING: RTCFeatureFlags = RTCFeatureFlags(u32::MAX);

impl Accel for Embree {
    fn name(&self) -> &'static str {
        "embree"
    }

    fn closest(&self, kind: RayKind, rays: &[Ray8], hits: &mut [Hit8]) {
        let mut arguments = Padded::new(RTCIntersectArguments {
            flags: flags(kind),
            feature_mask: EVERYTHING,
            context: null_mut(),
            filter: None,
            intersect: None,
        });
        for (ray, hit) in rays.iter().zip(hits) {
            let live = live(ray);
            let valid = Valid::of(live);
            let mut query = Padded::new(RTCRayHit8 { ray: record(ray), hit: no_hit() });
            // SAFETY: the scene is committed; records are aligned, filled and have room, see the head of this file.
            unsafe {
                rtcIntersect8(valid.0.as_ptr(), self.scene.handle, query.as_mut_ptr(), arguments.as_mut_ptr());
            }
            *hit = self.found(&query.record, live);
        }
    }

    fn occluded(&self, kind: RayKind, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
        for ((packet, ray), blocked) in rays.iter().enumerate().zip(blocked) {
            let live = live(ray);
            let valid = Valid::of(live);
            let mut query = Padded::new(record(ray));
            let mut question = filter.map(|filter| Question::new(filter, packet * F32x8::LANES, &self.meshes));
            let asks = question.is_some();
            let mut arguments = Padded::new(RTCOccludedArguments {
                flags: if asks { flags(kind) | RTCRayQueryFlags::INVOKE_ARGUMENT_FILTER } else { flags(kind) },
                feature_mask: EVERYTHING,
                context: question.as_mut().map_or(null_mut(), |question| (&raw mut *question).cast()),
                filter: asks.then_some(ask),
                occluded: None,
            });
            // SAFETY: as in `closest`. The question lives until the call returns, and only the call uses it.
            unsafe {
                rtcOccluded8(valid.0.as_ptr(), self.scene.handle, query.as_mut_ptr(), arguments.as_mut_ptr());
            }
            if let Some(panic) = question.and_then(|question| question.panic) {
                resume_unwind(panic);
            }
            // Embree says "blocked" by a tfar of −∞.
            *blocked = live & F32x8::new(query.record.tfar).same(F32x8::splat(f32::NEG_INFINITY));
        }
    }
}

impl Embree {
    fn found(&self, query: &RTCRayHit8, live: Mask8) -> Hit8 {
        let (hit, none) = (&query.hit, U32x8::splat(NO_HIT));
        let instance = U32x8::new(hit.geomID); // RTC_INVALID_GEOMETRY_ID is NO_HIT
        let found = live & !instance.same(none);
        let mesh = U32x8::from_fn(|lane| self.meshes.get(hit.geomID[lane] as usize).copied().unwrap_or(NO_HIT));
        // Rounding may put a weight a little below 0.
        let weight = |w: [f32; F32x8::LANES]| F32x8::new(w).max(F32x8::ZERO).or_zero(found);
        Hit8 {
            t: F32x8::select(found, F32x8::new(query.ray.tfar), F32x8::splat(f32::INFINITY)),
            bary: [weight(hit.u), weight(hit.v)],
            prim: U32x8::select(found, U32x8::new(hit.primID), none),
            mesh: U32x8::select(found, mesh, none),
            instance: U32x8::select(found, instance, none),
        }
    }
}

/// What Embree hands back to [`ask`]: a query context with our own data behind it.
#[repr(C)]
struct Question<'a> {
    context: RTCRayQueryContext,
    /// For what newer libraries keep there: 4 bytes in 4.3 and 4.4.
    room: [u32; 15],
    filter: &'a dyn Opacity,
    /// The number of lane 0.
    first: usize,
    meshes: &'a [u32],
    /// What the filter panicked with. A panic must not pass through Embree.
    panic: Option<Box<dyn Any + Send>>,
}

impl<'a> Question<'a> {
    fn new(filter: &'a dyn Opacity, first: usize, meshes: &'a [u32]) -> Self {
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
/// the order of `RTCRay8` and `RTCHit8`; our number of a ray is in its `id`.
unsafe extern "C" fn ask(arguments: *const RTCFilterFunctionNArguments) {
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
