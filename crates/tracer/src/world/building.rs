//! Building [`Surfaces`]: instance by instance.

use super::placement::{Placement, middle_of, normal_matrix, turn};
use super::surfaces::{Offset, Surfaces};
use super::triangle::{Triangle, unit_normal};
use crate::effects::{Effect, EffectSet};
use crate::scene::{Instance, Loading, Mesh, Stage};
use glam::DVec3;
use gonio_accel::{Geometry, GeometryError, Sharing};
use gonio_kernel::Vec3;
use std::borrow::Cow;

/// What placing depends on besides the meshes.
#[derive(Clone, Copy)]
pub(super) struct Placing<'s> {
    pub(super) instances: &'s [Instance],
    /// The scene's coordinates of the world's origin.
    pub(super) center: DVec3,
    /// Where each of the scene's materials went.
    pub(super) order: &'s [u32],
    /// Which lists are wanted.
    pub(super) effects: EffectSet,
    pub(super) sharing: Sharing,
}

/// Lists that grow.
struct Builder<'s> {
    placing: Placing<'s>,
    lists: Surfaces,
    casting: Vec<gonio_accel::Mesh>,
}

/// An instanced mesh, if it is stored already: its number, the middle of its box, and where it starts.
type Stored = Option<(u32, DVec3, Offset)>;

impl Placing<'_> {
    /// Places all instances; a mesh that is owned is freed once it is not needed any more.
    ///
    /// # Errors
    /// If they cannot be cast at.
    pub(super) fn place(
        self,
        mut meshes: Cow<'_, [Mesh]>,
        progress: &mut dyn FnMut(Loading),
    ) -> Result<Surfaces, GeometryError> {
        let mut uses = vec![0_usize; meshes.len()];
        self.instances.iter().for_each(|instance| uses[instance.mesh] += 1);
        let counts: Vec<usize> = meshes.iter().map(|mesh| mesh.triangles.len()).collect();
        let of = self.instances.iter().map(|instance| counts[instance.mesh]).sum::<usize>();
        if of > Geometry::MOST_TRIANGLES {
            return Err(GeometryError::TooMany(of));
        }
        let mut stored: Vec<Option<Stored>> =
            uses.iter().map(|&uses| self.sharing.shares(of, uses).then(Stored::default)).collect();
        let times = |mesh: usize| if stored[mesh].is_some() { uses[mesh].min(1) } else { uses[mesh] };
        let triangles = (0..meshes.len()).map(|mesh| times(mesh) * counts[mesh]).sum();
        let mut builder = Builder { placing: self, lists: Surfaces::with_room_for(triangles)?, casting: Vec::new() };

        let (mut instances, mut done) = (Vec::new(), 0);
        for instance in self.instances {
            let mesh = &meshes[instance.mesh];
            done += counts[instance.mesh] as u64;
            instances.push(match &mut stored[instance.mesh] {
                Some(stored) => builder.place_instanced(instance, mesh, stored),
                None => builder.flatten(instance, mesh),
            });
            uses[instance.mesh] -= 1;
            let is_done = uses[instance.mesh] == 0 || stored[instance.mesh].is_some();
            if let (Cow::Owned(meshes), true) = (&mut meshes, is_done) {
                meshes[instance.mesh] = Mesh::default();
            }
            progress(Loading { stage: Stage::Placing, done, of: of as u64 });
        }
        builder.lists.geometry = Geometry::new(builder.casting, instances)?;
        Ok(builder.lists)
    }
}

impl Builder<'_> {
    /// Appends an instance's triangles and says how rays meet them.
    fn flatten(&mut self, instance: &Instance, mesh: &Mesh) -> gonio_accel::Instance {
        let (to_world, center) = (instance.transform, self.placing.center);
        let place = |p: DVec3| (to_world.transform_point3(p) - center).as_vec3();
        let mirrored = to_world.matrix3.determinant() < 0.0;
        let front = |t: &[u32; 3]| if mirrored { [t[0], t[2], t[1]] } else { *t };
        let normal_matrix = normal_matrix(instance);
        let (offset, mesh) = self.append(mesh, place, front, |n| turn(normal_matrix, n));
        self.lists.offsets.push(offset);
        gonio_accel::Instance { mesh, transform: gonio_accel::Instance::IDENTITY }
    }

    /// Places an instanced mesh, and appends it if it is not stored yet.
    fn place_instanced(&mut self, instance: &Instance, mesh: &Mesh, stored: &mut Stored) -> gonio_accel::Instance {
        let (number, middle, offset) = *stored.get_or_insert_with(|| {
            let middle = middle_of(mesh.positions.iter().map(|&p| p.into()));
            let (offset, number) = self.append(mesh, |p| (p - middle).as_vec3(), |t| *t, Vec3::from);
            (number, middle, offset)
        });
        let matrix = instance.transform.matrix3;
        let start = instance.transform.transform_point3(middle) - self.placing.center;
        let row = |row: usize| {
            let m = matrix.row(row);
            [m.x, m.y, m.z, start[row]]
        };
        let cast = gonio_accel::Instance { mesh: number, transform: [row(0), row(1), row(2)] };
        let side = if matrix.determinant() < 0.0 { -1.0 } else { 1.0 };
        self.lists.offsets.push(Offset { placement: Some(self.lists.placements.len() as u32), ..offset });
        self.lists.placements.push(Placement { instance: cast, normal_matrix: normal_matrix(instance), side });
        cast
    }

    /// Appends a mesh to all lists; returns where it starts, and its number among those that rays are cast at.
    fn append(
        &mut self,
        mesh: &Mesh,
        place: impl Fn(DVec3) -> glam::Vec3,
        front: impl Fn(&[u32; 3]) -> [u32; 3],
        turn: impl Fn([f32; 3]) -> Vec3<f32>,
    ) -> (Offset, u32) {
        let offset =
            Offset { triangle: self.lists.triangles.len() as u32, vertex: self.lists.vertices, placement: None };
        let count = mesh.positions.len();
        self.lists.vertices += count;
        let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|&p| place(p.into()).to_array()).collect();
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(front).collect();
        let corners = triangles.iter().map(|t| t.map(|v| Vec3::from(positions[v as usize])));
        self.lists.triangles.extend(corners.zip(&mesh.materials).map(|(corners, &m)| Triangle {
            normal: unit_normal(&corners),
            corners,
            material: self.placing.order[m as usize],
        }));
        if self.placing.effects.has(Effect::SmoothNormals) {
            let turned = mesh.normals.iter().flatten().map(|&n| turn(n));
            let none = Vec3::new(0.0, 0.0, 0.0);
            self.lists.normals.extend(turned.chain(std::iter::repeat(none)).take(count));
        }
        if self.placing.effects.has_uvs() {
            let uvs = mesh.uvs.iter().flatten().copied();
            self.lists.uvs.extend(uvs.chain(std::iter::repeat([0.0; 2])).take(count));
        }
        self.casting.push(gonio_accel::Mesh { positions, triangles });
        (offset, self.casting.len() as u32 - 1)
    }
}
