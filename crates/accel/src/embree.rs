//! The Embree backend: Intel's ray-tracing library, version 4 (Wald et al. 2014, "Embree: A Kernel Framework for Efficient CPU
//! Ray Tracing").
//!
//! Every instance becomes one triangle geometry of Embree with the world vertices that all backends see, over an index buffer
//! that the instances of a mesh share. Rays go through in the order in which they come, by [`EmbreeWidth`]. The scene is built
//! by one thread, so that the tree, and with it the triangle that a ray on a shared edge reports, is the same on every run;
//! which vector instructions Embree then uses it decides itself. The caller's floating-point mode stays as it is: Embree's
//! advice to flush denormals is for speed, and would change the caller's arithmetic.
//!
//! **Agreement.** Embree has its own triangle tests, so hits are not those of `Brute` to the last bit: t is, up to rounding, and
//! of triangles at equal t any may win. [`Intersect::Robust`] sets Embree's flag of that name: edge functions from exact
//! vertices, watertight. [`Intersect::Fast`] leaves it out: Möller and Trumbore's test with the same leaks as ours.
//! A ray whose origin lies exactly in a triangle's plane would hit it at t = 0, where our own test says no: on a floor at
//! y = 0 no rounding lifts the origins of secondary rays. So Embree is asked for hits beyond 1e-20; where
//! the plane is only met up to rounding, those origins are off it by more than that.
//!
//! This module and its files alone in the workspace have `unsafe`. What must hold for the calls:
//!
//! - the library is of a version whose records we know, asked at the start (`KNOWN`), built with one level of instances, as
//!   it is unless asked otherwise;
//! - records may be written beyond what the headers of our bindings say: since 4.3 a packet of hits ends with the instances'
//!   primitives, a query context too. [`Padded`], [`Query`] and [`Question`] have room for it;
//! - indices are in range and vertices are finite: [`Geometry::new`] checks. Vertex buffers, which Embree reads in steps of 16 bytes,
//!   are allocated by Embree itself, with room after the last;
//! - only rays that Embree understands are live: see [`live`].

#![warn(clippy::undocumented_unsafe_blocks)]

mod device;
mod error;
mod filter;
mod query;

use crate::Accel;
use crate::geometry::Geometry;
use crate::ray::{Hit8, NO_HIT, Opacity, Ray8, RayKind};
use crate::triangle::Intersect;
use device::{Device, Owned};
use embree4_sys::*;
pub use error::EmbreeError;
use filter::{Question, ask};
use gonio_kernel::{F32x8, Mask8, Real, U32x8};
use query::{Answer, Padded, Query, live};
use std::panic::resume_unwind;
use std::ptr::null_mut;
use std::sync::Arc;

/// How much time Embree takes to build its tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EmbreeQuality {
    /// Binned by the surface area heuristic.
    #[default]
    Medium,
    /// With spatial splits as well, unless the test is robust: then Embree builds as for medium.
    High,
}

/// How many rays Embree is asked about at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmbreeWidth {
    /// One, with functions of Embree's for single rays.
    One,
    /// A packet.
    Eight,
    /// Two packets.
    Sixteen,
}

/// What may be chosen.
#[derive(Clone, Copy, Debug, Default)]
pub struct EmbreeOptions {
    /// The test of rays with triangles.
    pub intersect: Intersect,
    /// The tree.
    pub quality: EmbreeQuality,
    /// How rays go through; if `None`, as measured best: coherent ones by sixteen where there is AVX-512, others by
    /// eight. Without AVX-512 sixteen are half as fast as eight.
    pub width: Option<EmbreeWidth>,
}

/// A scene of Embree, and which mesh each of its geometries shows.
#[derive(Debug)]
pub struct Embree {
    scene: Arc<Committed>,
    /// Mesh of each instance; the geometry's number is the instance's.
    meshes: Vec<u32>,
    /// For coherent rays, and for others.
    widths: [EmbreeWidth; 2],
}

/// A scene that is only asked from here on.
#[derive(Debug)]
struct Committed(Owned<RTCSceneTy>);

// SAFETY: Embree allows a committed scene to be asked from any number of threads, and released once, from any.
unsafe impl Send for Committed {}
// SAFETY: as above; nobody who has a `&Committed` changes the scene.
unsafe impl Sync for Committed {}

impl Embree {
    /// Builds the scene with a tree of medium quality: O(n log n), deterministic, on the calling thread.
    ///
    /// # Errors
    /// If the library is of an unknown version, or refuses: for lack of memory, as a rule.
    pub fn new(geometry: &Geometry, intersect: Intersect) -> Result<Self, EmbreeError> {
        Self::with(geometry, EmbreeOptions { intersect, ..EmbreeOptions::default() })
    }

    /// Builds the scene: O(n log n), deterministic, on the calling thread.
    ///
    /// # Errors
    /// As [`Embree::new`].
    pub fn with(geometry: &Geometry, options: EmbreeOptions) -> Result<Self, EmbreeError> {
        let device = Device::new()?;
        // SAFETY: the device is live. The scene keeps it alive from here on.
        let scene = device.owned("make a scene", unsafe { rtcNewScene(device.handle()) }, rtcReleaseScene)?;
        let robust = match options.intersect {
            Intersect::Robust => RTCSceneFlags::ROBUST,
            Intersect::Fast => RTCSceneFlags::NONE,
        };
        let quality = match options.quality {
            EmbreeQuality::Medium => RTCBuildQuality::MEDIUM,
            EmbreeQuality::High => RTCBuildQuality::HIGH,
        };
        // SAFETY: the scene is live and not yet committed.
        unsafe {
            rtcSetSceneFlags(scene.handle, robust | RTCSceneFlags::FILTER_FUNCTION_IN_ARGUMENTS);
            rtcSetSceneBuildQuality(scene.handle, quality);
        }
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
        let meshes = geometry.instances().iter().map(|instance| instance.mesh).collect();
        let wide = if has_avx512() { EmbreeWidth::Sixteen } else { EmbreeWidth::Eight };
        let widths = options.width.map_or([wide, EmbreeWidth::Eight], |width| [width; 2]);
        Ok(Self { scene: Arc::new(Committed(scene)), meshes, widths })
    }

    /// The same scene, whose tree both share, asked by another width.
    pub fn by(&self, width: EmbreeWidth) -> Self {
        Self { scene: Arc::clone(&self.scene), meshes: self.meshes.clone(), widths: [width; 2] }
    }

    fn width(&self, kind: RayKind) -> EmbreeWidth {
        let [coherent, incoherent] = self.widths;
        if kind == RayKind::Coherent { coherent } else { incoherent }
    }
}

/// Whether the processor has what Embree's queries of sixteen rays are made for.
fn has_avx512() -> bool {
    #[cfg(target_arch = "x86_64")]
    let has = std::is_x86_feature_detected!("avx512f");
    #[cfg(not(target_arch = "x86_64"))]
    let has = false;
    has
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
        match self.width(kind) {
            EmbreeWidth::One => self.closest_by::<1>(kind, rays, hits),
            EmbreeWidth::Eight => self.closest_by::<8>(kind, rays, hits),
            EmbreeWidth::Sixteen => self.closest_by::<16>(kind, rays, hits),
        }
    }

    fn occluded(&self, kind: RayKind, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
        match self.width(kind) {
            EmbreeWidth::One => self.occluded_by::<1>(kind, rays, filter, blocked),
            EmbreeWidth::Eight => self.occluded_by::<8>(kind, rays, filter, blocked),
            EmbreeWidth::Sixteen => self.occluded_by::<16>(kind, rays, filter, blocked),
        }
    }
}

impl Embree {
    fn closest_by<const N: usize>(&self, kind: RayKind, rays: &[Ray8], hits: &mut [Hit8]) {
        let mut arguments = Padded::new(RTCIntersectArguments {
            flags: flags(kind),
            feature_mask: EVERYTHING,
            context: null_mut(),
            filter: None,
            intersect: None,
        });
        let mut query = Query::<N>::new();
        let packets = Query::<N>::PACKETS;
        for (rays, hits) in rays.chunks(packets).zip(hits.chunks_mut(packets)) {
            let (alive, mut answers) = (lives(rays), [Answer::NONE; 2]);
            for part in 0..Query::<N>::PARTS {
                if query.take(rays, &alive, part) {
                    // SAFETY: the scene is committed, the arguments are filled.
                    unsafe { query.intersect(self.scene.0.handle, &mut arguments) };
                    query.give(&mut answers[..packets], part);
                }
            }
            for ((hit, answer), live) in hits.iter_mut().zip(&answers).zip(alive) {
                *hit = self.found(answer, live);
            }
        }
    }

    fn occluded_by<const N: usize>(
        &self,
        kind: RayKind,
        rays: &[Ray8],
        filter: Option<&dyn Opacity>,
        blocked: &mut [Mask8],
    ) {
        let mut query = Query::<N>::new();
        let packets = Query::<N>::PACKETS;
        for ((chunk, rays), blocked) in rays.chunks(packets).enumerate().zip(blocked.chunks_mut(packets)) {
            let first = chunk * packets * F32x8::LANES;
            let mut question = filter.map(|filter| Question::new(filter, first, &self.meshes));
            let asks = question.is_some();
            let mut arguments = Padded::new(RTCOccludedArguments {
                flags: if asks { flags(kind) | RTCRayQueryFlags::INVOKE_ARGUMENT_FILTER } else { flags(kind) },
                feature_mask: EVERYTHING,
                context: question.as_mut().map_or(null_mut(), |question| (&raw mut *question).cast()),
                filter: asks.then_some(ask),
                occluded: None,
            });
            let (alive, mut answers) = (lives(rays), [Answer::NONE; 2]);
            for part in 0..Query::<N>::PARTS {
                if query.take(rays, &alive, part) {
                    // SAFETY: as in `closest_by`. The question lives until the calls have returned, and only they use it.
                    unsafe { query.occluded(self.scene.0.handle, &mut arguments) };
                    query.give_t(&mut answers[..packets], part);
                }
            }
            if let Some(panic) = question.and_then(|question| question.panic) {
                resume_unwind(panic);
            }
            for ((blocked, answer), live) in blocked.iter_mut().zip(&answers).zip(alive) {
                // Embree says "blocked" by a t_max of −∞.
                *blocked = live & F32x8::new(answer.t).same(F32x8::splat(f32::NEG_INFINITY));
            }
        }
    }

    fn found(&self, answer: &Answer, live: Mask8) -> Hit8 {
        let none = U32x8::splat(NO_HIT);
        let instance = U32x8::new(answer.geometry); // RTC_INVALID_GEOMETRY_ID is NO_HIT
        let found = live & !instance.same(none);
        let mesh = U32x8::from_fn(|lane| self.meshes.get(answer.geometry[lane] as usize).copied().unwrap_or(NO_HIT));
        // Rounding may put a weight a little below 0.
        let weight = |w: [f32; F32x8::LANES]| F32x8::new(w).max(F32x8::ZERO).or_zero(found);
        Hit8 {
            t: F32x8::select(found, F32x8::new(answer.t), F32x8::splat(f32::INFINITY)),
            bary: answer.bary.map(weight),
            prim: U32x8::select(found, U32x8::new(answer.prim), none),
            mesh: U32x8::select(found, mesh, none),
            instance: U32x8::select(found, instance, none),
        }
    }
}

/// The live lanes of one packet or two.
fn lives(rays: &[Ray8]) -> [Mask8; 2] {
    let of = |packet: usize| rays.get(packet).map_or(Mask8::first(0), live);
    [of(0), of(1)]
}
