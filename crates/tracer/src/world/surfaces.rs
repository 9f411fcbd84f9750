//! What shading knows of the triangles that rays hit: corners, normals, texture coordinates, materials.
//!
//! A scene is flattened (each instance's triangles lie in the world), as long as that takes little memory
//! ([`gonio_accel::Sharing::LARGE`] triangles): then a lookup is one access. In larger scenes a mesh that is placed more than once is
//! instanced: it is stored once, about the middle of its own box, and its corners and normals are transformed wherever a ray
//! hits them. The front of a mirrored instance stays the front: its triangles swap two corners, or where the mesh is instanced,
//! its normals turn.

use super::placement::{Placement, turn};
use super::triangle::Triangle;
use gonio_accel::{Geometry, GeometryError};
use gonio_kernel::Vec3;

/// The surfaces of a world.
#[derive(Clone, Debug)]
pub(crate) struct Surfaces {
    /// What rays are cast at.
    pub(super) geometry: Geometry,
    /// Where each instance's triangles and vertices start in the lists below.
    pub(super) offsets: Vec<Offset>,
    /// Those instances whose mesh is instanced.
    pub(super) placements: Vec<Placement>,
    /// Vertices in the lists below; may outgrow what 32 bits count.
    pub(super) vertices: usize,
    /// In the order (instance, prim) of what is flattened; an instanced mesh is there once, in its own coordinates.
    pub(super) triangles: Vec<Triangle>,
    /// One entry per vertex if the scene has smooth normals, else empty; a zero normal means the geometric one.
    pub(super) normals: Vec<Vec3<f32>>,
    /// One entry per vertex if something looks at them, else empty.
    pub(crate) uvs: Vec<[f32; 2]>,
}

/// Where an instance starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Offset {
    pub(super) triangle: u32,
    pub(super) vertex: usize,
    /// Index into [`Surfaces::placements`] if what starts there is instanced.
    pub(super) placement: Option<u32>,
}

impl Surfaces {
    /// None yet, with memory for so many triangles.
    pub(super) fn with_room_for(triangles: usize) -> Result<Self, GeometryError> {
        Ok(Self {
            geometry: Geometry::new(Vec::new(), Vec::new())?,
            offsets: Vec::new(),
            placements: Vec::new(),
            vertices: 0,
            triangles: Vec::with_capacity(triangles),
            normals: Vec::new(),
            uvs: Vec::new(),
        })
    }

    /// The material of a triangle that was hit.
    #[inline(always)]
    pub(crate) fn material(&self, instance: u32, prim: u32) -> u32 {
        self.triangles[(self.offsets[instance as usize].triangle + prim) as usize].material
    }

    /// A triangle that was hit.
    #[inline(always)]
    pub(crate) fn triangle(&self, instance: u32, prim: u32) -> Triangle {
        let offset = &self.offsets[instance as usize];
        let triangle = &self.triangles[(offset.triangle + prim) as usize];
        match offset.placement {
            None => *triangle,
            Some(placement) => self.placements[placement as usize].place(triangle),
        }
    }

    /// Instance and prim of all triangles, in order.
    pub(crate) fn places(&self) -> impl Iterator<Item = (u32, u32)> {
        let count = |instance: u32| {
            let mesh = self.geometry.instances()[instance as usize].mesh;
            self.geometry.meshes()[mesh as usize].triangles.len() as u32
        };
        let instances = 0..self.offsets.len() as u32;
        instances.flat_map(move |instance| (0..count(instance)).map(move |prim| (instance, prim)))
    }

    /// The places of a hit's three corners in the lists of vertices.
    #[inline(always)]
    pub(crate) fn vertex_indices(&self, instance: u32, mesh: u32, prim: u32) -> [usize; 3] {
        let first = self.offsets[instance as usize].vertex;
        self.geometry.meshes()[mesh as usize].triangles[prim as usize].map(|v| first + v as usize)
    }

    /// The shading normal of a vertex of an instance; 0 for the geometric one.
    #[inline(always)]
    pub(crate) fn normal(&self, instance: u32, vertex: usize) -> Vec3<f32> {
        let Some(&normal) = self.normals.get(vertex) else { return Vec3::new(0.0, 0.0, 0.0) };
        match self.offsets[instance as usize].placement {
            None => normal,
            Some(placement) => turn(self.placements[placement as usize].normal_matrix, normal.into()),
        }
    }
}
