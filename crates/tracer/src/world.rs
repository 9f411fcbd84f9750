//! The world: a scene made ready to be traced.
//!
//! Everything is placed, recentred and rounded once. The middle of the scene becomes the origin while positions are still
//! `f64`, so a scene far from its own origin (georeferenced data) keeps its precision. Each instance's triangles are laid
//! out in the world; triangles of a mirrored instance swap two corners, so that the front stays the front.

use crate::fingerprint::Fingerprint;
use crate::light::{Emitter, Lights};
use crate::material::PreparedMaterial;
use crate::normal_map::NormalMap;
use crate::plan::Plan;
use crate::scene::{Camera, FilmSettings, Instance, Loading, Mesh, Scene, SceneError, Stage};
use crate::texture::Texture;
use glam::{DMat3, DVec3};
use gonio_accel::{Geometry, GeometryError, Ray8};
use gonio_kernel::{F32x8, Real, Rgb, Vec3};
use std::borrow::Cow;
use std::path::Path;

/// A scene made ready: geometry, shading data, lights, camera and plan.
#[derive(Clone, Debug)]
pub struct World {
    pub(crate) film: FilmSettings,
    pub(crate) view: View,
    geometry: Geometry,
    /// Where each instance's triangles and vertices start in the lists below.
    offsets: Vec<Offset>,
    /// Vertices placed so far; may outgrow what 32 bits count, because instances share no memory.
    vertices: usize,
    /// In the order (instance, prim).
    pub(crate) triangles: Vec<Triangle>,
    /// One entry per vertex if the plan has smooth normals, else empty; a zero normal means the geometric one.
    pub(crate) normals: Vec<Vec3<f32>>,
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
    /// If the scene cannot be cast at: too many triangles, or positions that overflow `f32`.
    pub fn new(scene: &Scene) -> Result<Self, SceneError> {
        let images = (scene.textures.clone(), scene.normal_maps.clone());
        Self::place(scene, Cow::Borrowed(&scene.meshes[..]), images, &mut |_| ())
    }

    /// Places the scene and takes its meshes and images out of it, each mesh freed once it is placed: for scenes that fill
    /// the memory. `progress` is told how many triangles are placed.
    ///
    /// # Errors
    /// If the scene cannot be cast at: too many triangles, or positions that overflow `f32`.
    pub fn take(scene: &mut Scene, progress: &mut dyn FnMut(Loading)) -> Result<Self, SceneError> {
        let images = (std::mem::take(&mut scene.textures), std::mem::take(&mut scene.normal_maps));
        let meshes = std::mem::take(&mut scene.meshes);
        Self::place(scene, Cow::Owned(meshes), images, progress)
    }

    fn place(
        scene: &Scene,
        mut meshes: Cow<'_, [Mesh]>,
        (textures, normal_maps): (Vec<Texture>, Vec<NormalMap>),
        progress: &mut dyn FnMut(Loading),
    ) -> Result<Self, SceneError> {
        let refuse = |message: String| SceneError::file(Path::new("scene"), message);
        let center = center(&scene.instances, &meshes);
        let mut warnings = Vec::new();
        let (materials, order) = PreparedMaterial::prepare(scene);
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
            geometry: Geometry::new(Vec::new(), Vec::new()).map_err(|e| refuse(e.to_string()))?,
            offsets: Vec::new(),
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
            return Err(refuse(GeometryError::TooMany(of).to_string()));
        }
        world.triangles.reserve_exact(of);
        let mut placed = Vec::new();
        for instance in &scene.instances {
            placed.push(world.place_one(instance, &meshes[instance.mesh], center, &order));
            uses[instance.mesh] -= 1;
            if let (Cow::Owned(meshes), 0) = (&mut meshes, uses[instance.mesh]) {
                meshes[instance.mesh] = Mesh::default();
            }
            progress(Loading { stage: Stage::Placing, done: world.triangles.len() as u64, of: of as u64 });
        }
        let instances = (0..placed.len() as u32)
            .map(|mesh| gonio_accel::Instance { mesh, transform: gonio_accel::Instance::IDENTITY })
            .collect();
        world.geometry = Geometry::new(placed, instances).map_err(|e| refuse(e.to_string()))?;

        let emitters = world.triangles.iter().filter_map(|t| {
            let radiance = world.materials[t.material as usize].emission;
            (radiance.luminance() > 0.0).then_some(Emitter { corners: t.corners, normal: t.normal, radiance })
        });
        world.lights = Lights::new(emitters.collect(), &scene.environment);
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

    /// The place of a hit in the list of triangles.
    #[inline(always)]
    pub(crate) fn triangle_index(&self, instance: u32, prim: u32) -> usize {
        (self.offsets[instance as usize].triangle + prim) as usize
    }

    /// The places of a hit's three corners in the lists of vertices.
    #[inline(always)]
    pub(crate) fn vertex_indices(&self, instance: u32, prim: u32) -> [usize; 3] {
        let first = self.offsets[instance as usize].vertex;
        self.geometry.meshes()[instance as usize].triangles[prim as usize].map(|v| first + v as usize)
    }

    /// The largest distance of a corner from the camera's plane; at least 0.
    pub(crate) fn farthest_depth(&self) -> f32 {
        let depth = |corner: &Vec3<f32>| (*corner - self.view.origin).dot(self.view.forward);
        self.triangles.iter().flat_map(|t| &t.corners).map(depth).fold(0.0, f32::max)
    }

    /// Appends an instance's triangles and returns them as a mesh for casting.
    fn place_one(&mut self, instance: &Instance, mesh: &Mesh, center: DVec3, order: &[u32]) -> gonio_accel::Mesh {
        self.offsets.push(Offset { triangle: self.triangles.len() as u32, vertex: self.vertices });
        self.vertices += mesh.positions.len();
        let to_world = instance.transform;
        let positions: Vec<[f32; 3]> = mesh
            .positions
            .iter()
            .map(|&p| (to_world.transform_point3(p.into()) - center).as_vec3().to_array())
            .collect();
        let mirrored = to_world.matrix3.determinant() < 0.0;
        let normal_matrix = to_world.matrix3.inverse().transpose();
        let front = |t: &[u32; 3]| if mirrored { [t[0], t[2], t[1]] } else { *t };
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(front).collect();

        let corners = triangles.iter().map(|t| t.map(|v| Vec3::from(positions[v as usize])));
        self.triangles.extend(corners.zip(&mesh.materials).map(|(corners, &m)| Triangle {
            normal: unit_normal(&corners),
            corners,
            material: order[m as usize],
        }));
        let count = mesh.positions.len();
        if self.plan.smooth_normals {
            let turned = mesh.normals.iter().flatten().map(|&n| turn(normal_matrix, n));
            let none = Vec3::new(0.0, 0.0, 0.0);
            self.normals.extend(turned.chain(std::iter::repeat(none)).take(count));
        }
        if self.plan.uvs() {
            let uvs = mesh.uvs.iter().flatten().copied();
            self.uvs.extend(uvs.chain(std::iter::repeat([0.0; 2])).take(count));
        }
        gonio_accel::Mesh { positions, triangles }
    }
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
    let placed = instances
        .iter()
        .flat_map(|i| meshes[i.mesh].positions.iter().map(move |&p| i.transform.transform_point3(p.into())));
    let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for p in placed {
        lo = lo.min(p);
        hi = hi.max(p);
    }
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
