//! What rays are cast at: triangle meshes, and instances that place them in the world.
//!
//! A mesh keeps `f32` positions in its own coordinates; an instance places it by an affine map in `f64`. World vertices are
//! formed in `f64` and rounded once, here and nowhere else, so that every backend and the shading see the same bits.

use crate::ray::NO_HIT;
use gonio_kernel::Vec3;
use thiserror::Error;

/// Triangles over shared vertices, in the mesh's own coordinates.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<[f32; 3]>,
    /// Three vertex indices per triangle; counter-clockwise from the front.
    pub triangles: Vec<[u32; 3]>,
}

/// A mesh placed in the world.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Which mesh.
    pub mesh: u32,
    /// Rows of the map [M | t]: world = M·local + t.
    pub transform: [[f64; 4]; 3],
}

/// Why a geometry was refused.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum GeometryError {
    /// An instance names a mesh that is not there.
    #[error("instance {instance} names mesh {mesh}, but there are only {meshes}")]
    NoSuchMesh {
        /// The instance.
        instance: usize,
        /// The mesh it names.
        mesh: u32,
        /// How many there are.
        meshes: usize,
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} of mesh {mesh} names vertex {vertex}, but there are only {vertices}")]
    NoSuchVertex {
        /// The mesh.
        mesh: usize,
        /// The triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A vertex is NaN or infinite in the world, or farther than 1e18 from the origin, where products overflow.
    #[error("vertex {vertex} of instance {instance} lies outside of what f32 rays can reach")]
    NotFinite {
        /// The instance.
        instance: usize,
        /// The vertex.
        vertex: usize,
    },
    /// More triangles than a 32-bit index can name.
    #[error("{0} triangles are more than the 2^29 that can be indexed")]
    TooMany(usize),
}

/// Meshes and instances, checked.
#[derive(Clone, Debug)]
pub struct Geometry {
    meshes: Vec<Mesh>,
    instances: Vec<Instance>,
    order: Order,
}

/// All triangles of all instances as one list, in the order (instance, prim), without a list: an entry per instance.
#[derive(Clone, Debug)]
pub(crate) struct Order {
    /// Where each instance's triangles start, and at the end, how many there are.
    starts: Vec<u32>,
    /// The mesh of each instance.
    meshes: Vec<u32>,
    /// Whether it has a transform.
    is_placed: Vec<bool>,
}

impl Order {
    /// How many triangles there are.
    pub(crate) fn count(&self) -> usize {
        self.starts.last().map_or(0, |&count| count as usize)
    }

    /// The places of an instance's triangles.
    pub(crate) fn places(&self, instance: usize) -> std::ops::Range<u32> {
        self.starts[instance]..self.starts[instance + 1]
    }

    /// The triangle at a place below the number of all.
    #[inline]
    pub(crate) fn id(&self, index: u32) -> TriangleId {
        let instance = match self.meshes.len() {
            1 => 0,
            _ => self.starts.partition_point(|&start| start <= index) - 1, // the first start is 0
        };
        TriangleId { prim: index - self.starts[instance], mesh: self.meshes[instance], instance: instance as u32 }
    }
}

impl Instance {
    /// The mesh where it is.
    pub const IDENTITY: [[f64; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

    /// Whether the map is [`Instance::IDENTITY`], to the sign of its zeros: −0 added to −0 is none of 0.
    fn is_identity(&self) -> bool {
        self.transform.as_flattened().iter().zip(Self::IDENTITY.as_flattened()).all(|(a, b)| a.to_bits() == b.to_bits())
    }

    /// The world position of a point of the mesh.
    pub fn to_world(&self, p: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = p.map(f64::from);
        self.transform.map(|[a, b, c, t]| (a * x + b * y + c * z + t) as f32)
    }
}

impl Geometry {
    /// Most triangles of all instances together: a tree over them then has fewer than 2³¹ nodes and leaves, which is what a
    /// word can name beside the bit that tells them apart.
    pub const MOST_TRIANGLES: usize = 1 << 29;

    /// Checks indices, finiteness and counts.
    ///
    /// # Errors
    /// See [`GeometryError`].
    pub fn new(meshes: Vec<Mesh>, instances: Vec<Instance>) -> Result<Self, GeometryError> {
        for (m, mesh) in meshes.iter().enumerate() {
            for (t, triangle) in mesh.triangles.iter().enumerate() {
                if let Some(&vertex) = triangle.iter().find(|&&v| v as usize >= mesh.positions.len()) {
                    let vertices = mesh.positions.len();
                    return Err(GeometryError::NoSuchVertex { mesh: m, triangle: t, vertex, vertices });
                }
            }
        }
        let mut count = 0_usize;
        let mut starts = vec![0];
        for (i, instance) in instances.iter().enumerate() {
            let Some(mesh) = meshes.get(instance.mesh as usize) else {
                return Err(GeometryError::NoSuchMesh { instance: i, mesh: instance.mesh, meshes: meshes.len() });
            };
            let reachable = |p: &[f32; 3]| instance.to_world(*p).iter().all(|x| x.abs() < 1e18);
            if let Some(vertex) = mesh.positions.iter().position(|p| !reachable(p)) {
                return Err(GeometryError::NotFinite { instance: i, vertex });
            }
            count = count.saturating_add(mesh.triangles.len());
            starts.push(u32::try_from(count).unwrap_or(u32::MAX));
        }
        if count > Self::MOST_TRIANGLES {
            return Err(GeometryError::TooMany(count));
        }
        let order = Order {
            starts,
            meshes: instances.iter().map(|instance| instance.mesh).collect(),
            is_placed: instances.iter().map(|instance| !instance.is_identity()).collect(),
        };
        Ok(Self { meshes, instances, order })
    }

    /// One mesh, where it is.
    ///
    /// # Errors
    /// See [`GeometryError`].
    pub fn of_mesh(mesh: Mesh) -> Result<Self, GeometryError> {
        Self::new(vec![mesh], vec![Instance { mesh: 0, transform: Instance::IDENTITY }])
    }

    /// The meshes.
    pub fn meshes(&self) -> &[Mesh] {
        &self.meshes
    }

    /// The instances.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// How many triangles all instances have together.
    pub fn triangle_count(&self) -> usize {
        self.order.count()
    }

    pub(crate) fn order(&self) -> &Order {
        &self.order
    }

    /// Triangle `index` in the order (instance, prim), below [`Geometry::triangle_count`], in the world.
    pub fn world_triangle(&self, index: u32) -> WorldTriangle {
        let id = self.order.id(index);
        let (instance, mesh) = (&self.instances[id.instance as usize], &self.meshes[id.mesh as usize]);
        let is_placed = self.order.is_placed[id.instance as usize];
        let corner = |v: u32| {
            let p = mesh.positions[v as usize];
            // Without a transform that is what `to_world` comes to: −0 becomes 0.
            Vec3::from(if is_placed { instance.to_world(p) } else { [p[0] + 0.0, p[1] + 0.0, p[2] + 0.0] })
        };
        let [a, b, c] = mesh.triangles[id.prim as usize];
        WorldTriangle { corners: [corner(a), corner(b), corner(c)], id }
    }

    /// All triangles of all instances in the world, in the order (instance, prim).
    pub fn world_triangles(&self) -> impl Iterator<Item = WorldTriangle> {
        (0..self.triangle_count() as u32).map(|index| self.world_triangle(index))
    }
}

/// A triangle in the world.
#[derive(Clone, Copy, Debug)]
pub struct WorldTriangle {
    /// Its vertices.
    pub corners: [Vec3<f32>; 3],
    /// Where it comes from.
    pub id: TriangleId,
}

/// Where a triangle comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TriangleId {
    /// Triangle within the mesh.
    pub prim: u32,
    /// Mesh within the geometry.
    pub mesh: u32,
    /// Instance within the geometry.
    pub instance: u32,
}

/// The id of a miss.
pub(crate) const NOTHING: TriangleId = TriangleId { prim: NO_HIT, mesh: NO_HIT, instance: NO_HIT };
