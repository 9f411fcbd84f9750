//! The scene: everything a picture depends on, as plain data.
//!
//! A scene is built in code or read from files by the crate `gonio-io`. Each field states its range: all numbers are finite,
//! all indices point at something, every mesh has a triangle with an area.

use std::sync::Arc;

use glam::DAffine3;
use gonio_kernel::lobe::{AnyLobe, Layering};
use gonio_kernel::{Parameters, Rgb};

use crate::bsdf::CustomLobe;
use crate::light::delta::LightSource;
use crate::normal_map::NormalMap;
use crate::texture::Texture;

mod builder;
mod environment;
pub mod fields;
mod film;
mod integrator;
mod limits;

pub use crate::camera::{Camera, CameraError, CameraSpec};
pub use builder::{BuildError, SceneBuilder};
pub use environment::{Environment, Sky, SkyMap};
pub use film::FilmSettings;
pub use integrator::IntegratorSettings;
pub use limits::{EXTENT, MAX_INTENSITY, MAX_MATERIALS, MAX_RADIANCE, has_area};

/// How far a scene has come on its way to being rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Loading {
    /// What is being done.
    pub stage: Stage,
    /// How much of it is done, in the stage's unit.
    pub done: u64,
    /// How much there is to do; at least `done`.
    pub of: u64,
}

/// What is done between the scene file and the first ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// A mesh is read from its file; bytes. A scene of several files begins again for each.
    Reading,
    /// [`World::take`](crate::World::take) places the meshes; triangles.
    Placing,
    /// [`Backend::build_with`](crate::Backend::build_with) builds what rays are cast at; triangles.
    Building,
}

/// A scene, ready to be planned and rendered.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Size of the picture and number of samples.
    pub film: FilmSettings,
    /// The camera.
    pub camera: Camera,
    /// Path length and random numbers.
    pub integrator: IntegratorSettings,
    /// Materials; a mesh names them by index. Never more than 65535.
    pub materials: Vec<Material>,
    /// Decoded images; [`TexturedParameter`] names them by index.
    pub textures: Vec<Texture>,
    /// Decoded images of normals; [`NormalMapSpec`] names them by index.
    pub normal_maps: Vec<NormalMap>,
    /// Triangle meshes, each in its own coordinates. Never empty.
    pub meshes: Vec<Mesh>,
    /// Meshes placed in the world. Never empty.
    pub instances: Vec<Instance>,
    /// What lies behind everything.
    pub environment: Environment,
    /// Lights that are no triangles.
    pub lights: Vec<Arc<dyn LightSource>>,
    /// What was loaded differently from how it was written: one sentence each.
    pub warnings: Vec<String>,
}

/// A surface: the sum of its lobes, and its own light.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name it has in the scene or MTL file.
    pub name: String,
    /// Up to twelve lobes from the top down, of which at most three are coats.
    pub lobes: Vec<LobeSpec>,
    /// A lobe of the user's own, in place of `lobes`.
    pub custom: Option<CustomLobe>,
    /// Emitted radiance, linear Rec. 709, at least 0; leaves from the front of the winding.
    pub emission: Rgb<f32>,
    /// Whether the back scatters like the front; a one-sided material is black from behind.
    pub two_sided: bool,
    /// An image that tilts the shading normal; its meshes then have texture coordinates.
    pub normal_map: Option<NormalMapSpec>,
}

impl Material {
    /// A two-sided material of these lobes that emits nothing.
    pub fn new(name: &str, lobes: Vec<LobeSpec>) -> Self {
        let (emission, two_sided) = (Rgb::splat(0.0), true);
        Self { name: name.to_owned(), lobes, custom: None, emission, two_sided, normal_map: None }
    }
    /// A two-sided material that scatters by a lobe of the user's own.
    pub fn of_lobe(name: &str, lobe: CustomLobe) -> Self {
        Self { custom: Some(lobe), ..Self::new(name, Vec::new()) }
    }
}

/// An image of normals, and how steep it is taken to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMapSpec {
    /// Index into [`Scene::normal_maps`].
    pub map: usize,
    /// Factor on the normals' x and y, in [0, 10].
    pub scale: f32,
}

/// A lobe of a material. Its contribution adds to that of the others; below a coat it is attenuated by it.
#[derive(Clone, Debug, PartialEq)]
pub struct LobeSpec {
    /// Factor on the lobe's light, each channel in [0, 1].
    pub weight: Rgb<f32>,
    /// The scattering model with its parameters.
    pub lobe: AnyLobe<'static, f32>,
    /// Colours that are multiplied by an image.
    pub textures: Vec<TexturedParameter>,
    /// How it attenuates all lobes that come after it, if it is a coat.
    pub coat: Option<Layering>,
}

impl LobeSpec {
    /// A lobe with factor 1 and without textures.
    pub fn new(lobe: impl Into<AnyLobe<'static, f32>>) -> Self {
        Self { weight: Rgb::splat(1.0), lobe: lobe.into(), textures: Vec::new(), coat: None }
    }
    /// The same as a coat over all lobes that come after it.
    #[must_use]
    pub fn as_coat(self, layering: Layering) -> Self {
        Self { coat: Some(layering), ..self }
    }
    /// The same with the colour of that key multiplied by an image; unchanged if the lobe has no such colour.
    #[must_use]
    pub fn with_texture(mut self, key: &str, texture: usize) -> Self {
        let (mut at, mut first) = (0, None);
        let _: AnyLobe<f32> = self.lobe.map(&mut |parameter, channel, x| {
            if parameter.key == key && parameter.is_color && channel == 0 {
                first = Some(at);
            }
            at += 1;
            x
        });
        self.textures.extend(first.map(|at| TexturedParameter { at, texture }));
        self
    }
}

/// A colour of a lobe that is multiplied by an image at the hit's texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TexturedParameter {
    /// The place of its first channel among the lobe's numbers, in the order of [`Parameters::map`].
    pub at: usize,
    /// Index into [`Scene::textures`].
    pub texture: usize,
}

/// A triangle mesh in its own coordinates.
///
/// `positions`, `normals` and `uvs` have one entry per vertex; `triangles` index them, counter-clockwise seen from the
/// front. Positions are f64 because georeferenced data needs it: the renderer moves the origin before it rounds to f32.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The file's name, for messages.
    pub name: String,
    /// Vertex positions, finite.
    pub positions: Vec<[f64; 3]>,
    /// Unit shading normals per vertex; without them the geometric normal is used.
    pub normals: Option<Vec<[f32; 3]>>,
    /// Texture coordinates per vertex, finite, v = 0 at the bottom of the image.
    pub uvs: Option<Vec<[f32; 2]>>,
    /// Vertex indices of each triangle; no triangle has zero area.
    pub triangles: Vec<[u32; 3]>,
    /// Index into [`Scene::materials`] for each triangle.
    pub materials: Vec<u32>,
}

/// A mesh placed in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// The mesh's name, for messages.
    pub name: String,
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// From mesh to world coordinates (metres); invertible.
    pub transform: DAffine3,
}
