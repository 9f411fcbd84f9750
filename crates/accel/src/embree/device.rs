//! Objects of Embree: references that are given back, a device, and what it holds of a mesh.

use super::error::EmbreeError;
use crate::geometry::{Instance, Mesh};
use embree4_sys::*;
use std::ffi::CStr;
use std::ops::RangeInclusive;
use std::ptr::null_mut;

/// Versions whose records and functions are those that we call, as 10000·major + 100·minor + patch.
const KNOWN: RangeInclusive<isize> = 40_200..=49_999;

/// One thread, so that building is deterministic; and nothing from the `.embree4` files that may lie about.
const CONFIG: &CStr = c"threads=1,set_affinity=0,ignore_config_files=1";

/// A reference to an object of Embree, given back when dropped.
#[derive(Debug)]
pub(super) struct Owned<T> {
    pub(super) handle: *mut T,
    release: unsafe extern "C" fn(*mut T),
}

impl<T> Drop for Owned<T> {
    fn drop(&mut self) {
        // SAFETY: the handle is not null and we own one reference to it, see `Device::owned`.
        unsafe { (self.release)(self.handle) }
    }
}

/// What makes everything else.
pub(super) struct Device(Owned<RTCDeviceTy>);

impl Device {
    /// A device of a version that we know.
    pub(super) fn new() -> Result<Self, EmbreeError> {
        // SAFETY: the string ends with a zero byte.
        let handle = unsafe { rtcNewDevice(CONFIG.as_ptr()) };
        if handle.is_null() {
            return Err(refusal("start", null_mut()));
        }
        let device = Self(Owned { handle, release: rtcReleaseDevice });
        // SAFETY: the device is live.
        let version = unsafe { rtcGetDeviceProperty(device.handle(), RTCDeviceProperty::VERSION) };
        if KNOWN.contains(&version) { Ok(device) } else { Err(EmbreeError::Version(version)) }
    }

    pub(super) fn handle(&self) -> RTCDevice {
        self.0.handle
    }

    /// Takes over a reference that Embree has just given us; null means that it could not.
    pub(super) fn owned<T>(
        &self,
        task: &'static str,
        handle: *mut T,
        release: unsafe extern "C" fn(*mut T),
    ) -> Result<Owned<T>, EmbreeError> {
        if handle.is_null() { Err(refusal(task, self.handle())) } else { Ok(Owned { handle, release }) }
    }

    /// Whether everything so far went well.
    pub(super) fn done(&self, task: &'static str) -> Result<(), EmbreeError> {
        // SAFETY: the device is live. A device of processors knows no other errors than those of the bindings.
        match unsafe { rtcGetDeviceError(self.handle()) } {
            RTCError::NONE => Ok(()),
            error => Err(EmbreeError::Refused { task, reason: reason(error) }),
        }
    }

    /// The triangles of a mesh, for all its instances.
    pub(super) fn index_buffer(&self, mesh: &Mesh) -> Result<Owned<RTCBufferTy>, EmbreeError> {
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
    pub(super) fn attach(
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
