//! The world: a scene made ready to be traced.
//!
//! Everything is placed, recentred and rounded once. The middle of the scene becomes the origin while positions are still
//! `f64`, so a scene far from its own origin (georeferenced data) keeps its precision.
//!
//! Each instance's triangles are laid out in the world, as long as that takes little memory ([`Sharing::LARGE`] triangles): then
//! every lookup is one. In larger scenes a mesh that is placed more than once is kept once, about a middle of its own, and its
//! corners and normals are moved to the world wherever a ray meets them. The front of a mirrored instance stays the front: its
//! triangles swap two corners, or where a mesh is kept once, its normals turn.

use crate::error::WorldError;
use crate::fingerprint::Fingerprint;
use crate::light::{Emitter, Lights};
use crate::material::PreparedMaterial;
use crate::normal_map::NormalMap;
use crate::plan::Plan;
use crate::scene::{Camera, FilmSettings, Instance, Loading, Mesh, Scene, Stage};
use crate::texture::Texture;
use glam::{DMat3, DVec3};
use gonio_accel::{Geometry, GeometryError, Ray8, Sharing};
use gonio_kernel::{F32x8, Real, Rgb, Vec3};
use std::borrow::Cow;

/// A scene made ready: geometry, shading data, lights, camera and plan.
#[derive(Clone, Debug)]
pub struct World {
    pub(crate) film: FilmSettings,
    pub(crate) view: View,
    geometry: Geometry,
    /// Where each instance's triangles and vertices start in the lists below.
    offsets: Vec<Offset>,
    /// Those instances whose mesh is kept once.
    placements: Vec<Placement>,
    /// Vertices in the lists below; may outgrow what 32 bits count.
    vertices: usize,
    /// In the order (instance, prim) of what is laid out; a mesh that is kept once is there once, in its own coordinates.
    triangles: Vec<Triangle>,
    /// One entry per vertex if the plan has smooth normals, else empty; a zero normal means the geometric one.
    normals: Vec<Vec3<f32>>,
    /// One entry per vertex if something of the plan looks at them, else empty.
    pub(crate) uvs: Vec<[f32; 2]>,
    pub(crate) materials: Vec<PreparedMaterial>,
    pub(crate) textures: Vec<Texture>,
    pub(crate) normal_maps: Vec<NormalMap>,
    pub(crate) lights: Lights,
    plan: Plan,
    warnings: Vec<String>,
}

#[derive(Clone, Copy, Debug)]
struct Offset {
    triangle: u32,
    vertex: usize,
    /// Index into [`World::placements`] if what starts there is not laid out.
    placement: Option<u32>,
}

/// How a mesh that is kept once comes to the world.
#[derive(Clone, Debug)]
struct Placement {
    instance: gonio_accel::Instance,
    normal_matrix: DMat3,
    /// −1 if mirrored.
    side: f32,
}

impl Placement {
    /// A triangle of the mesh, in the world: with the very corners that rays are cast at.
    fn place(&self, triangle: &Triangle) -> Triangle {
        let corners = triangle.corners.map(|c| Vec3::from(self.instance.to_world(c.into())));
        Triangle { corners, normal: unit_normal(&corners) * self.side, ..*triangle }
    }
}

/// What shading needs of every triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    pub(crate) corners: [Vec3<f32>; 3],
    /// Geometric normal on the front of the winding, unit; 0 if the triangle is too small to have one.
    pub(crate) normal: Vec3<f32>,
    /// Index into [`World::materials`].
    pub(crate) material: u32,
}

/// The camera, ready to make rays: origin and the vectors to the middle and to the edges of a picture one unit away.
#[derive(Clone, Copy, Debug)]
pub struct View {
    origin: Vec3<f32>,
    pub(crate) forward: Vec3<f32>,
    right: Vec3<f32>,
    up: Vec3<f32>,
    /// Columns and rows of the picture.
    size: [f32; 2],
}

impl World {
    /// Places the scene. O(triangles).
    ///
    /// # Errors
    /// A material's lobes do not fit into a surface, or rays cannot be cast at the scene: see [`WorldError`].
    pub fn new(scene: &Scene) -> Result<Self, WorldError> {
        Self::by(scene, Sharing::default())
    }

    /// Places the scene; `sharing` says which meshes are kept once, and not laid out. O(triangles).
    ///
    /// # Errors
    /// As [`World::new`].
    pub fn by(scene: &Scene, sharing: Sharing) -> Result<Self, WorldError> {
        let images = (scene.textures.clone(), scene.normal_maps.clone());
        Self::place(scene, Cow::Borrowed(&scene.meshes[..]), images, sharing, &mut |_| ())
    }

    /// Places the scene and takes its meshes and images out of it, each mesh freed once it is placed: for scenes that fill
    /// the memory. `progress` is told how many triangles are placed.
    ///
    /// # Errors
    /// A material's lobes do not fit into a surface, or rays cannot be cast at the scene: see [`WorldError`].
    pub fn take(scene: &mut Scene, progress: &mut dyn FnMut(Loading)) -> Result<Self, WorldError> {
        let images = (std::mem::take(&mut scene.textures), std::mem::take(&mut scene.normal_maps));
        let meshes = std::mem::take(&mut scene.meshes);
        Self::place(scene, Cow::Owned(meshes), images, Sharing::default(), progress)
    }

    fn place(
        scene: &Scene,
        mut meshes: Cow<'_, [Mesh]>,
        (textures, normal_maps): (Vec<Texture>, Vec<NormalMap>),
        sharing: Sharing,
        progress: &mut dyn FnMut(Loading),
    ) -> Result<Self, WorldError> {
        let center = center(&scene.instances, &meshes);
        let mut warnings = Vec::new();
        let (materials, order) = PreparedMaterial::prepare(scene)?;
        let mut plan = Plan {
            area_lights: false,
            environment: false,
            textures: materials.iter().any(|m| m.textured),
            smooth_normals: meshes.iter().any(|m| m.normals.is_some()),
            tangents: false,
            normal_maps: materials.iter().any(|m| m.normal_map.is_some()),
            one_sided: materials.iter().any(|m| !m.two_sided),
            discrete: materials.iter().any(|m| m.discrete),
            transmission: materials.iter().any(|m| m.transmits),
        };
        for mesh in meshes.iter() {
            let anisotropic = mesh.materials.iter().any(|&m| materials[order[m as usize] as usize].anisotropic);
            plan.tangents |= anisotropic && mesh.uvs.is_some();
            if anisotropic && mesh.uvs.is_none() {
                warnings.push(format!(
                    "mesh \"{}\" has an anisotropic material but no texture coordinates: its tangents are arbitrary",
                    mesh.name
                ));
            }
        }

        let mut world = Self {
            film: scene.film,
            view: View::new(&scene.camera, &scene.film, center),
            geometry: Geometry::new(Vec::new(), Vec::new())?,
            offsets: Vec::new(),
            placements: Vec::new(),
            vertices: 0,
            triangles: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            materials,
            textures,
            normal_maps,
            lights: Lights::default(),
            plan,
            warnings,
        };
        let mut uses = vec![0_usize; meshes.len()];
        scene.instances.iter().for_each(|instance| uses[instance.mesh] += 1);
        let of = scene.instances.iter().map(|instance| meshes[instance.mesh].triangles.len()).sum::<usize>();
        if of > Geometry::MOST_TRIANGLES {
            return Err(GeometryError::TooMany(of).into());
        }
        let mut kept: Vec<Option<Kept>> =
            uses.iter().map(|&uses| sharing.shares(of, uses).then(Kept::default)).collect();
        let times = |mesh: usize| if kept[mesh].is_some() { uses[mesh].min(1) } else { uses[mesh] };
        world.triangles.reserve_exact((0..meshes.len()).map(|mesh| times(mesh) * meshes[mesh].triangles.len()).sum());
        let (mut casting, mut instances, mut done) = (Vec::new(), Vec::new(), 0);
        for instance in &scene.instances {
            let mesh = &meshes[instance.mesh];
            instances.push(match &mut kept[instance.mesh] {
                Some(kept) => world.place_kept(instance, mesh, kept, center, &order, &mut casting),
                None => {
                    casting.push(world.lay_out(instance, mesh, center, &order));
                    let mesh = casting.len() as u32 - 1;
                    gonio_accel::Instance { mesh, transform: gonio_accel::Instance::IDENTITY }
                }
            });
            done += casting[instances[instances.len() - 1].mesh as usize].triangles.len() as u64;
            uses[instance.mesh] -= 1;
            let is_done = uses[instance.mesh] == 0 || kept[instance.mesh].is_some();
            if let (Cow::Owned(meshes), true) = (&mut meshes, is_done) {
                meshes[instance.mesh] = Mesh::default();
            }
            progress(Loading { stage: Stage::Placing, done, of: of as u64 });
        }
        world.geometry = Geometry::new(casting, instances)?;

        let emitter = |(instance, prim): (u32, u32)| {
            let radiance = world.materials[world.material(instance, prim) as usize].emission;
            (radiance.luminance() > 0.0).then(|| {
                let t = world.triangle(instance, prim);
                Emitter { corners: t.corners, normal: t.normal, radiance }
            })
        };
        let emitters = world.places().filter_map(emitter).collect();
        world.lights = Lights::new(emitters, &scene.environment);
        world.plan.environment = world.lights.has_sky();
        world.plan.area_lights = world.triangles.iter().any(|t| world.materials[t.material as usize].emits());
        Ok(world)
    }

    /// What was noticed while placing the scene: one sentence each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// What rays are cast at.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// The camera's rays.
    pub fn view(&self) -> View {
        self.view
    }

    /// The corners of every triangle that emits light, in the order (instance, prim).
    pub fn emitters(&self) -> impl Iterator<Item = [Vec3<f32>; 3]> {
        self.lights.emitters().iter().map(|emitter| emitter.corners)
    }

    /// Which effects the scene needs.
    pub fn plan(&self) -> Plan {
        self.plan
    }

    /// A fingerprint of everything that the picture depends on beside the settings: triangles, materials, images, lights, and
    /// the camera. Equal scenes have equal ones; half a second for ten million triangles.
    pub fn fingerprint(&self) -> String {
        let mut print = Fingerprint::new();
        for triangle in &self.triangles {
            let corners = triangle.corners.iter().flat_map(|c| [c.x, c.y, c.z]);
            corners.for_each(|x| print.bytes(&x.to_le_bytes()));
            print.bytes(&triangle.material.to_le_bytes());
        }
        for placement in &self.placements {
            print.bytes(format!("{:?}", placement.instance).as_bytes());
        }
        for normal in &self.normals {
            [normal.x, normal.y, normal.z].iter().for_each(|x| print.bytes(&x.to_le_bytes()));
        }
        self.uvs.iter().flatten().for_each(|x| print.bytes(&x.to_le_bytes()));
        for material in &self.materials {
            print.bytes(format!("{:?}", material.spec).as_bytes());
        }
        self.textures.iter().for_each(|texture| print.bytes(texture.texels().as_flattened()));
        let normals = self.normal_maps.iter().flat_map(NormalMap::texels).flatten();
        normals.for_each(|c| print.bytes(&c.to_le_bytes()));
        self.lights.describe_sky(&mut print);
        print.bytes(format!("{:?} {} {}", self.view, self.film.width, self.film.height).as_bytes());
        print.text()
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
    fn places(&self) -> impl Iterator<Item = (u32, u32)> {
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

    /// The largest distance of a corner from the camera's plane; at least 0.
    pub(crate) fn farthest_depth(&self) -> f32 {
        let depth = |corner: &Vec3<f32>| (*corner - self.view.origin).dot(self.view.forward);
        let corners = self.places().flat_map(|(instance, prim)| self.triangle(instance, prim).corners);
        corners.map(|corner| depth(&corner)).fold(0.0, f32::max)
    }

    /// Appends an instance's triangles and returns them as a mesh for casting.
    fn lay_out(&mut self, instance: &Instance, mesh: &Mesh, center: DVec3, order: &[u32]) -> gonio_accel::Mesh {
        let to_world = instance.transform;
        let place = |p: DVec3| (to_world.transform_point3(p) - center).as_vec3();
        let mirrored = to_world.matrix3.determinant() < 0.0;
        let front = |t: &[u32; 3]| if mirrored { [t[0], t[2], t[1]] } else { *t };
        let normal_matrix = normal_matrix(instance);
        let offset = self.append(mesh, order, place, front, |n| turn(normal_matrix, n));
        self.offsets.push(offset.0);
        offset.1
    }

    /// Places a mesh that is kept once, and appends it if it is not there yet.
    fn place_kept(
        &mut self,
        instance: &Instance,
        mesh: &Mesh,
        kept: &mut Kept,
        center: DVec3,
        order: &[u32],
        casting: &mut Vec<gonio_accel::Mesh>,
    ) -> gonio_accel::Instance {
        let (number, middle, offset) = *kept.get_or_insert_with(|| {
            let middle = middle_of(mesh.positions.iter().map(|&p| p.into()));
            let (offset, own) = self.append(mesh, order, |p| (p - middle).as_vec3(), |t| *t, Vec3::from);
            casting.push(own);
            (casting.len() as u32 - 1, middle, offset)
        });
        let matrix = instance.transform.matrix3;
        let start = instance.transform.transform_point3(middle) - center;
        let row = |row: usize| {
            let m = matrix.row(row);
            [m.x, m.y, m.z, start[row]]
        };
        let cast = gonio_accel::Instance { mesh: number, transform: [row(0), row(1), row(2)] };
        let side = if matrix.determinant() < 0.0 { -1.0 } else { 1.0 };
        self.offsets.push(Offset { placement: Some(self.placements.len() as u32), ..offset });
        self.placements.push(Placement { instance: cast, normal_matrix: normal_matrix(instance), side });
        cast
    }

    /// Appends a mesh to all lists; returns where it starts, and what rays are cast at.
    fn append(
        &mut self,
        mesh: &Mesh,
        order: &[u32],
        place: impl Fn(DVec3) -> glam::Vec3,
        front: impl Fn(&[u32; 3]) -> [u32; 3],
        turn: impl Fn([f32; 3]) -> Vec3<f32>,
    ) -> (Offset, gonio_accel::Mesh) {
        let offset = Offset { triangle: self.triangles.len() as u32, vertex: self.vertices, placement: None };
        let count = mesh.positions.len();
        self.vertices += count;
        let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|&p| place(p.into()).to_array()).collect();
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(front).collect();
        let corners = triangles.iter().map(|t| t.map(|v| Vec3::from(positions[v as usize])));
        self.triangles.extend(corners.zip(&mesh.materials).map(|(corners, &m)| Triangle {
            normal: unit_normal(&corners),
            corners,
            material: order[m as usize],
        }));
        if self.plan.smooth_normals {
            let turned = mesh.normals.iter().flatten().map(|&n| turn(n));
            let none = Vec3::new(0.0, 0.0, 0.0);
            self.normals.extend(turned.chain(std::iter::repeat(none)).take(count));
        }
        if self.plan.uvs() {
            let uvs = mesh.uvs.iter().flatten().copied();
            self.uvs.extend(uvs.chain(std::iter::repeat([0.0; 2])).take(count));
        }
        (offset, gonio_accel::Mesh { positions, triangles })
    }
}

/// A mesh that is kept once, once it is there: its number, the middle that it is kept about, and where it starts.
type Kept = Option<(u32, DVec3, Offset)>;

/// What normals are multiplied by.
fn normal_matrix(instance: &Instance) -> DMat3 {
    instance.transform.matrix3.inverse().transpose()
}

fn turn(normal_matrix: DMat3, n: [f32; 3]) -> Vec3<f32> {
    (normal_matrix * glam::Vec3::from(n).as_dvec3()).normalize_or_zero().as_vec3().to_array().into()
}

/// The unit normal on the front of a triangle's winding; 0 if it is too small to have one.
fn unit_normal([a, b, c]: &[Vec3<f32>; 3]) -> Vec3<f32> {
    (*b - *a).cross(*c - *a).normalize_or(Vec3::new(0.0, 0.0, 0.0))
}

/// The middle of everything that is placed.
fn center(instances: &[Instance], meshes: &[Mesh]) -> DVec3 {
    let corners = |i: &Instance| meshes[i.mesh].positions.iter();
    let placed = instances.iter().flat_map(|i| corners(i).map(move |&p| i.transform.transform_point3(p.into())));
    middle_of(placed)
}

/// The middle of the box of some points; the origin if there is none.
fn middle_of(points: impl Iterator<Item = DVec3>) -> DVec3 {
    let (lo, hi) = points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
    if lo.is_finite() && hi.is_finite() { lo * 0.5 + hi * 0.5 } else { DVec3::ZERO }
}

impl View {
    /// The view of a camera in a world whose origin is at `center` of the scene's coordinates.
    pub fn new(camera: &Camera, film: &FilmSettings, center: DVec3) -> Self {
        let forward = (camera.target - camera.origin).normalize();
        let right = forward.cross(camera.up).normalize();
        let up = right.cross(forward);
        let tan = (camera.vfov.to_radians() * 0.5).tan();
        let aspect = f64::from(film.width) / f64::from(film.height);
        let narrow = |v: DVec3| v.as_vec3().to_array().into();
        Self {
            origin: narrow(camera.origin - center),
            forward: narrow(forward),
            right: narrow(right * tan * aspect),
            up: narrow(up * tan),
            size: [film.width as f32, film.height as f32],
        }
    }

    /// Columns and rows of the picture.
    pub fn size(&self) -> [f32; 2] {
        self.size
    }

    /// The rays through places (x, y) of the picture in pixels, (0, 0) at the top left corner of the top left pixel.
    #[inline(always)]
    pub fn rays(&self, x: F32x8, y: F32x8) -> Ray8 {
        let [width, height] = self.size.map(F32x8::splat);
        let two = F32x8::splat(2.0);
        let (x, y) = (x * two / width - F32x8::ONE, F32x8::ONE - y * two / height);
        let forward = Vec3::broadcast(self.forward);
        let dir = forward.along(x, Vec3::broadcast(self.right)).along(y, Vec3::broadcast(self.up)).normalize();
        Ray8::new(Vec3::broadcast(self.origin), dir)
    }
}

/// The same colour in every lane.
#[inline(always)]
pub(crate) fn splat_rgb(c: Rgb<f32>) -> Rgb<F32x8> {
    c.map(F32x8::splat)
}
