//! Scenes built in code, checked as those from files are.

use super::{
    CameraError, CameraSpec, EXTENT, Environment, FilmSettings, Instance, IntegratorSettings, MAX_MATERIALS,
    MAX_RADIANCE, Material, Mesh, Scene, has_area,
};
use crate::light::delta::LightSource;
use crate::normal_map::NormalMap;
use crate::texture::Texture;
use glam::{DAffine3, DVec3};
use gonio_kernel::Rgb;
use std::mem::take;
use std::sync::Arc;
use thiserror::Error;

/// What is wrong with a scene that was built in code.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// Nothing is placed.
    #[error("no mesh is placed: there is nothing to render")]
    Empty,
    /// The picture's size or number of samples is out of range.
    #[error("the film is {width} x {height} pixels with {spp} samples; sizes are 1 to 65536, samples 1 to 1048576")]
    Film {
        /// Pixels per row.
        width: u32,
        /// Rows.
        height: u32,
        /// Samples per pixel.
        spp: u32,
    },
    /// The scene is too small or too large for `f32`.
    #[error("the scene is {0:e} m wide; it must be {min:e} to {max:e}", min = EXTENT.start(), max = EXTENT.end())]
    Extent(f64),
    /// The camera has no view.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// A mesh cannot be rendered.
    #[error("mesh \"{name}\": {why}")]
    Mesh {
        /// The mesh's name.
        name: String,
        /// What is wrong with it.
        why: String,
    },
    /// A material cannot be rendered.
    #[error("material \"{name}\": {why}")]
    Material {
        /// The material's name.
        name: String,
        /// What is wrong with it.
        why: String,
    },
    /// An instance cannot be placed.
    #[error("instance {number}: {why}")]
    Instance {
        /// Which one, from 1.
        number: usize,
        /// What is wrong with it.
        why: &'static str,
    },
}

/// A scene in the making: parts are added, and [`SceneBuilder::build`] says what is wrong with them.
///
/// ```
/// use glam::DAffine3;
/// use gonio_kernel::{Rgb, lobe::Lambert};
/// use gonio_tracer::scene::{LobeSpec, Material, Mesh, SceneBuilder};
///
/// let mut scene = SceneBuilder::new();
/// let chalk = scene.material(Material::new("chalk", vec![LobeSpec::new(Lambert::new(Rgb::splat(0.8)))]));
/// let mesh = scene.mesh(Mesh::of("square", [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]], [[0, 1, 2]], chalk));
/// scene.place(mesh, DAffine3::IDENTITY);
/// assert_eq!(scene.build()?.instances.len(), 1);
/// # Ok::<(), gonio_tracer::scene::BuildError>(())
/// ```
#[derive(Debug, Default)]
pub struct SceneBuilder {
    film: FilmSettings,
    camera: CameraSpec,
    integrator: IntegratorSettings,
    materials: Vec<Material>,
    textures: Vec<Texture>,
    normal_maps: Vec<NormalMap>,
    meshes: Vec<Mesh>,
    instances: Vec<(usize, DAffine3)>,
    environment: Option<Environment>,
    lights: Vec<Arc<dyn LightSource>>,
}

impl SceneBuilder {
    /// Nothing yet: usual film and integrator, a camera that sees everything, no light.
    pub fn new() -> Self {
        Self::default()
    }
    /// The size of the picture and the number of samples.
    pub fn film(&mut self, film: FilmSettings) -> &mut Self {
        self.film = film;
        self
    }
    /// The camera; what it leaves open follows from what is placed.
    pub fn camera(&mut self, camera: CameraSpec) -> &mut Self {
        self.camera = camera;
        self
    }
    /// Path length and random numbers.
    pub fn integrator(&mut self, integrator: IntegratorSettings) -> &mut Self {
        self.integrator = integrator;
        self
    }
    /// What lies behind everything.
    pub fn environment(&mut self, environment: Environment) -> &mut Self {
        self.environment = Some(environment);
        self
    }
    /// Adds a material; its index.
    pub fn material(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        self.materials.len() as u32 - 1
    }
    /// Adds an image; its index.
    pub fn texture(&mut self, texture: Texture) -> usize {
        self.textures.push(texture);
        self.textures.len() - 1
    }
    /// Adds an image of normals; its index.
    pub fn normal_map(&mut self, map: NormalMap) -> usize {
        self.normal_maps.push(map);
        self.normal_maps.len() - 1
    }
    /// Adds a mesh, which [`SceneBuilder::place`] puts into the world; its index.
    pub fn mesh(&mut self, mesh: Mesh) -> usize {
        self.meshes.push(mesh);
        self.meshes.len() - 1
    }
    /// Puts a mesh into the world, once or often; `transform` leads from its coordinates to the world's.
    pub fn place(&mut self, mesh: usize, transform: DAffine3) -> &mut Self {
        self.instances.push((mesh, transform));
        self
    }
    /// Adds a light: point, spot, distant, or a kind of one's own.
    pub fn light(&mut self, light: impl LightSource + 'static) -> &mut Self {
        self.lights.push(Arc::new(light));
        self
    }

    /// The scene. Triangles without an area are left out, with a warning.
    ///
    /// # Errors
    /// The first thing that is wrong: see [`BuildError`].
    pub fn build(mut self) -> Result<Scene, BuildError> {
        let FilmSettings { width, height, spp, .. } = self.film;
        if !(1..=65_536).contains(&width) || !(1..=65_536).contains(&height) || !(1..=1 << 20).contains(&spp) {
            return Err(BuildError::Film { width, height, spp });
        }
        for material in &self.materials {
            self.check_material(material).map_err(|why| BuildError::Material { name: material.name.clone(), why })?;
        }
        let mut warnings = Vec::new();
        for mesh in &self.meshes {
            self.check_mesh(mesh).map_err(|why| BuildError::Mesh { name: mesh.name.clone(), why })?;
        }
        for mesh in &mut self.meshes {
            let flat = leave_out_flat(mesh);
            if flat > 0 {
                warnings.push(format!("mesh \"{}\": {flat} triangles without an area are left out", mesh.name));
            }
        }
        let instances = self.place_all()?;
        let bounds = self.bounds();
        let extent = (bounds[1] - bounds[0]).max_element();
        if !EXTENT.contains(&extent) {
            return Err(BuildError::Extent(extent));
        }
        let camera = self.camera.complete(bounds, f64::from(width) / f64::from(height))?;
        Ok(Scene {
            film: self.film,
            camera,
            integrator: self.integrator,
            materials: self.materials,
            textures: self.textures,
            normal_maps: self.normal_maps,
            meshes: self.meshes,
            instances,
            environment: self.environment.unwrap_or(Environment::constant(Rgb::splat(0.0))),
            lights: self.lights,
            warnings,
        })
    }

    fn check_material(&self, material: &Material) -> Result<(), String> {
        let emission = <[f32; 3]>::from(material.emission);
        if !emission.iter().all(|&x| (0.0..=MAX_RADIANCE).contains(&f64::from(x))) {
            return Err(format!("emits {emission:?}; each channel is 0 to {MAX_RADIANCE:e}"));
        }
        let textures = material.lobes.iter().flat_map(|lobe| &lobe.textures);
        if let Some(missing) = textures.map(|t| t.texture).find(|&texture| texture >= self.textures.len()) {
            return Err(format!("names texture {missing}; there are {}", self.textures.len()));
        }
        match material.normal_map {
            Some(map) if map.map >= self.normal_maps.len() => {
                Err(format!("names normal map {}; there are {}", map.map, self.normal_maps.len()))
            }
            _ if self.materials.len() > MAX_MATERIALS => Err(format!("is one of more than {MAX_MATERIALS}")),
            _ => Ok(()),
        }
    }

    fn check_mesh(&self, mesh: &Mesh) -> Result<(), String> {
        let count = mesh.positions.len();
        if let Some(at) = mesh.positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(format!("position {at} is not finite"));
        }
        for (what, n) in [("normals", mesh.normals.as_ref().map(Vec::len)), ("uvs", mesh.uvs.as_ref().map(Vec::len))] {
            if let Some(n) = n.filter(|&n| n != count) {
                return Err(format!("has {n} {what} for {count} positions"));
            }
        }
        if mesh.materials.len() != mesh.triangles.len() {
            return Err(format!("has {} materials for {} triangles", mesh.materials.len(), mesh.triangles.len()));
        }
        for (at, (triangle, &material)) in mesh.triangles.iter().zip(&mesh.materials).enumerate() {
            if let Some(vertex) = triangle.iter().find(|&&v| v as usize >= count) {
                return Err(format!("triangle {at} names vertex {vertex}; there are {count}"));
            }
            let Some(material) = self.materials.get(material as usize) else {
                return Err(format!("triangle {at} names material {material}; there are {}", self.materials.len()));
            };
            if material.normal_map.is_some() && mesh.uvs.is_none() {
                return Err(format!("needs texture coordinates for the normal map of \"{}\"", material.name));
            }
        }
        Ok(())
    }

    fn place_all(&self) -> Result<Vec<Instance>, BuildError> {
        let instance = |(number, &(mesh, transform)): (usize, &(usize, DAffine3))| {
            let refuse = |why| BuildError::Instance { number, why };
            let placed = self.meshes.get(mesh).ok_or_else(|| refuse("there is no such mesh"))?;
            if !transform.is_finite() || !transform.matrix3.inverse().is_finite() {
                return Err(refuse("its transform cannot be inverted"));
            }
            Ok(Instance { name: placed.name.clone(), mesh, transform })
        };
        let instances = (1..).zip(&self.instances).map(instance).collect::<Result<Vec<_>, _>>()?;
        let is_empty = instances.iter().all(|instance| self.meshes[instance.mesh].triangles.is_empty());
        if is_empty { Err(BuildError::Empty) } else { Ok(instances) }
    }

    /// The least and the largest coordinates of what is placed.
    fn bounds(&self) -> [DVec3; 2] {
        let corners = self.instances.iter().flat_map(|&(mesh, transform)| {
            self.meshes[mesh].positions.iter().map(move |&p| transform.transform_point3(p.into()))
        });
        corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[lo, hi], p| [lo.min(p), hi.max(p)])
    }
}

impl Mesh {
    /// A mesh of one material, with neither shading normals nor texture coordinates.
    pub fn of(
        name: &str,
        positions: impl Into<Vec<[f64; 3]>>,
        triangles: impl Into<Vec<[u32; 3]>>,
        material: u32,
    ) -> Self {
        let triangles = triangles.into();
        let materials = vec![material; triangles.len()];
        Self { name: name.to_owned(), positions: positions.into(), normals: None, uvs: None, triangles, materials }
    }
}

/// Leaves out triangles without an area; how many there were.
fn leave_out_flat(mesh: &mut Mesh) -> usize {
    let before = mesh.triangles.len();
    let all = take(&mut mesh.triangles).into_iter().zip(take(&mut mesh.materials));
    (mesh.triangles, mesh.materials) =
        all.filter(|(corners, _)| has_area(corners.map(|v| mesh.positions[v as usize].into()))).unzip();
    before - mesh.triangles.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::LobeSpec;
    use gonio_kernel::lobe::Lambert;

    const CORNERS: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 0.0, 0.0]];

    fn with(change: impl FnOnce(&mut SceneBuilder, &mut Mesh)) -> Result<Scene, String> {
        let mut scene = SceneBuilder::new();
        let chalk = scene.material(Material::new("chalk", vec![LobeSpec::new(Lambert::new(Rgb::splat(0.8)))]));
        let mut mesh = Mesh::of("corner", CORNERS, [[0, 1, 2], [0, 1, 3]], chalk);
        change(&mut scene, &mut mesh);
        let mesh = scene.mesh(mesh);
        scene.place(mesh, DAffine3::IDENTITY);
        scene.build().map_err(|error| error.to_string())
    }

    #[test]
    fn a_triangle_without_an_area_is_left_out_with_a_warning() {
        let scene = with(|_, _| ()).unwrap();
        assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
        assert_eq!(scene.warnings, ["mesh \"corner\": 1 triangles without an area are left out"]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let refused = |change: fn(&mut SceneBuilder, &mut Mesh)| with(change).unwrap_err();
        assert_eq!(
            refused(|_, mesh| mesh.triangles[1][2] = 9),
            "mesh \"corner\": triangle 1 names vertex 9; there are 4"
        );
        assert_eq!(
            refused(|_, mesh| mesh.materials[0] = 3),
            "mesh \"corner\": triangle 0 names material 3; there are 1"
        );
        assert_eq!(refused(|_, mesh| mesh.positions[2][1] = f64::NAN), "mesh \"corner\": position 2 is not finite");
        assert_eq!(refused(|_, mesh| mesh.uvs = Some(vec![])), "mesh \"corner\": has 0 uvs for 4 positions");
        assert_eq!(refused(|_, mesh| mesh.triangles.clear()), "mesh \"corner\": has 2 materials for 0 triangles");
        let emission = Rgb::splat(-1.0);
        assert!(with(|s, _| s.materials[0].emission = emission).unwrap_err().starts_with("material \"chalk\": emits"));
        assert_eq!(refused(|_, mesh| mesh.positions[1][0] = 2e9), "the scene is 2e9 m wide; it must be 1e-6 to 1e9");
        assert!(refused(|s, _| s.film.width = 0).starts_with("the film is 0 x 600 pixels"));
        assert_eq!(refused(|s, _| s.instances.push((7, DAffine3::IDENTITY))), "instance 1: there is no such mesh");
        assert_eq!(
            refused(|s, _| s.instances.push((0, DAffine3::ZERO))),
            "instance 1: its transform cannot be inverted"
        );
        assert!(refused(|s, _| s.camera.up = Some(DVec3::ZERO)).contains("\"up\" of the camera has no length"));
        assert_eq!(SceneBuilder::new().build().unwrap_err(), BuildError::Empty);
    }
}
