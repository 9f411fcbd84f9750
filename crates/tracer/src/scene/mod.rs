//! The scene: everything a picture depends on, as plain data.
//!
//! A scene comes from a TOML scene file (`docs/scene-format.md` lists every key with its unit and default) or from an
//! OBJ file alone, which then gets an automatic camera and a white sky. Whatever leaves this module is checked: all
//! numbers are finite and in their ranges, all indices point at something, every mesh has a triangle with an area.
//! Bad input is a [`SceneError`] that names file and line; what a viewer would tolerate is loaded with a sentence in
//! [`Scene::warnings`].

use std::path::Path;

use glam::{DAffine3, DVec3};
use gonio_kernel::Rgb;

use crate::normal_map::NormalMap;
use crate::texture::Texture;

mod build;
mod camera;
mod document;
mod environment;
mod error;
mod file;
mod material;
mod mtl;
mod nesting;
mod obj;
mod paths;
mod textures;
mod transform;

pub use environment::{Environment, Sky, SkyMap};
pub use error::SceneError;
pub use gonio_kernel::energy::Compensation;
pub use gonio_kernel::lobe::PhongNorm;
pub use gonio_kernel::lobe::eon::Directional;
pub use gonio_kernel::microfacet::Masking;

/// Smallest microfacet width: below it, a mirror is what is meant.
pub(crate) const MIN_ALPHA: f32 = gonio_kernel::microfacet::ALPHA_MIN as f32;
/// Largest radiance a material or the environment may have: the film's range ends a little above.
pub(crate) const MAX_RADIANCE: f64 = 1e6;

impl Scene {
    /// Reads a scene file (`.toml`), or an OBJ file alone (`.obj`) under a white sky with an automatic camera.
    ///
    /// # Errors
    /// Anything that cannot be rendered as written, with file and line.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        Self::load_with(path, &mut |_| ())
    }

    /// Like [`Scene::load`]; `progress` is told how much of each OBJ file is read.
    ///
    /// # Errors
    /// Anything that cannot be rendered as written, with file and line.
    pub fn load_with(path: &Path, progress: &mut dyn FnMut(Loading)) -> Result<Self, SceneError> {
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        match extension.to_ascii_lowercase().as_str() {
            "toml" => file::read(&paths::read_text(path)?, path, progress),
            "obj" => Self::from_obj(path, progress),
            _ => Err(SceneError::file(path, "is neither a scene file (.toml) nor an OBJ file (.obj)")),
        }
    }

    /// Reads a scene file from its text; files it names are looked for beside `path`.
    ///
    /// # Errors
    /// Anything that cannot be rendered as written, with file and line.
    pub fn from_toml_str(text: &str, path: &Path) -> Result<Self, SceneError> {
        file::read(text, path, &mut |_| ())
    }

    fn from_obj(path: &Path, progress: &mut dyn FnMut(Loading)) -> Result<Self, SceneError> {
        let mut builder = build::Builder::default();
        let blame = |why: String| SceneError::at(path, 1, why);
        builder.place(path, &build::Assignment::default(), DAffine3::IDENTITY, blame, progress)?;
        let film = FilmSettings::default();
        let aspect = f64::from(film.width) / f64::from(film.height);
        let camera = camera::CameraSpec::default().complete(builder.bounds, aspect).map_err(blame)?;
        Ok(builder.finish(film, camera, IntegratorSettings::default(), Environment::constant(Rgb::splat(1.0))))
    }
}

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
    /// [`Scene::load_with`] reads an OBJ file; bytes. A scene of several files begins again for each.
    Reading,
    /// [`World::take`](crate::World::take) places the meshes; triangles.
    Placing,
    /// [`Backend::build_with`](crate::Backend::build_with) builds what rays are cast at; triangles.
    Building,
}

/// A scene, checked and ready to be planned and rendered.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Size of the picture and number of samples.
    pub film: FilmSettings,
    /// The pinhole camera.
    pub camera: Camera,
    /// Path length and random numbers.
    pub integrator: IntegratorSettings,
    /// Materials; a mesh names them by index. Never more than 65535.
    pub materials: Vec<Material>,
    /// Decoded images; [`Color::Texture`] names them by index.
    pub textures: Vec<Texture>,
    /// Decoded images of normals; [`NormalMapSpec`] names them by index.
    pub normal_maps: Vec<NormalMap>,
    /// Triangle meshes, each in its own coordinates. Never empty.
    pub meshes: Vec<Mesh>,
    /// Meshes placed in the world. Never empty.
    pub instances: Vec<Instance>,
    /// What lies behind everything.
    pub environment: Environment,
    /// What was loaded differently from how it was written: one sentence each.
    pub warnings: Vec<String>,
}

/// Size of the picture and number of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSettings {
    /// Pixels per row, 1 to 65536.
    pub width: u32,
    /// Rows, 1 to 65536.
    pub height: u32,
    /// Samples per pixel, 1 to 2²⁰.
    pub spp: u32,
    /// Exposure in stops (factor 2ˣ), applied to the PNG only.
    pub exposure: f32,
}

/// A pinhole camera. `up` is not parallel to the view direction, and `target` is not `origin`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position, in metres.
    pub origin: DVec3,
    /// A point that appears at the centre of the picture, in metres.
    pub target: DVec3,
    /// Points towards the top of the picture; any length above 0.
    pub up: DVec3,
    /// Vertical field of view in degrees, above 0 and below 180.
    pub vfov: f64,
}

/// Path length and random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntegratorSettings {
    /// Number of scattering events after which a path ends; emission seen directly is depth 0.
    pub max_depth: u32,
    /// Whether paths that carry little end early by chance (unbiased).
    pub russian_roulette: bool,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// A surface: the sum of its lobes, and its own light.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name it has in the scene or MTL file.
    pub name: String,
    /// One to four lobes, whose contributions add.
    pub lobes: Vec<LobeSpec>,
    /// Emitted radiance, linear Rec. 709, at least 0; leaves from the front of the winding.
    pub emission: Rgb<f32>,
    /// Whether the back scatters like the front; a one-sided material is black from behind.
    pub two_sided: bool,
    /// An image that tilts the shading normal; its meshes then have texture coordinates.
    pub normal_map: Option<NormalMapSpec>,
}

/// An image of normals, and how steep it is taken to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMapSpec {
    /// Index into [`Scene::normal_maps`].
    pub map: usize,
    /// Factor on the normals' x and y, in [0, 10].
    pub scale: f32,
}

/// A lobe and its share.
#[derive(Clone, Debug, PartialEq)]
pub struct LobeSpec {
    /// Factor on the lobe's reflected light, in [0, 1].
    pub weight: f32,
    /// What it does with light.
    pub model: Model,
}

/// The reflection models a scene can name.
#[derive(Clone, Debug, PartialEq)]
pub enum Model {
    /// Lambert's law.
    Diffuse {
        /// Albedo, each channel in [0, 1].
        base_color: Color,
    },
    /// A perfectly smooth mirror.
    Mirror {
        /// Reflectance at every angle, each channel in [0, 1].
        reflectance: Color,
    },
    /// A rough diffuse surface: energy-preserving Oren–Nayar.
    Eon {
        /// Albedo, each channel in [0, 1].
        base_color: Color,
        /// Roughness in [0, 1]; 0 is Lambert's law.
        roughness: f32,
        /// Whether the albedo that it conserves is exact or a fit.
        directional: Directional,
    },
    /// The modified Phong model.
    Phong {
        /// k_d, each channel in [0, 1]; with `glossy` at most 1.
        diffuse: Color,
        /// k_s, each channel in [0, 1].
        glossy: Rgb<f32>,
        /// Exponent in [0, 1e7].
        exponent: f32,
        /// What the glossy part is multiplied by.
        norm: PhongNorm,
    },
    /// A rough metal, or the reflecting part of a dielectric.
    Conductor {
        /// What one facet reflects.
        fresnel: FresnelSpec,
        /// How rough it is.
        microfacets: MicrofacetSpec,
        /// What becomes of light that meets more than one facet.
        compensation: Compensation,
    },
    /// A dielectric that reflects and refracts.
    Dielectric {
        /// Index of the inside, where the winding's back is, over that of the outside, in [0.01, 100].
        ior: f32,
        /// How rough it is; smooth without.
        microfacets: Option<MicrofacetSpec>,
    },
}

/// A distribution of microfacets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MicrofacetSpec {
    /// Which distribution.
    pub distribution: Distribution,
    /// How masking and shadowing go together.
    pub masking: Masking,
    /// Width along the tangent, in [1e-8, 1].
    pub alpha_x: f32,
    /// Width along the bitangent, in [1e-8, 1].
    pub alpha_y: f32,
}

impl MicrofacetSpec {
    /// GGX with height-correlated masking.
    pub const fn ggx(alpha_x: f32, alpha_y: f32) -> Self {
        Self { distribution: Distribution::Ggx, masking: Masking::HeightCorrelated, alpha_x, alpha_y }
    }
}

/// The distributions of microfacets a scene can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Trowbridge–Reitz.
    Ggx,
    /// Gaussian slopes.
    Beckmann,
}

/// Reflectance of a facet against angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FresnelSpec {
    /// A metal's complex index of refraction per channel.
    Conductor {
        /// Index of refraction, above 0.
        eta: Rgb<f32>,
        /// Extinction coefficient, at least 0.
        k: Rgb<f32>,
    },
    /// Schlick's approximation, rising to 1 at grazing.
    Schlick {
        /// Reflectance at normal incidence, each channel in [0, 1].
        f0: Rgb<f32>,
    },
    /// Schlick's approximation with a dip at 82°.
    F82 {
        /// Reflectance at normal incidence, each channel in [0, 1].
        f0: Rgb<f32>,
        /// What is left of Schlick's value at 82°, each channel in [0, 1].
        tint: Rgb<f32>,
    },
    /// The reflection of a dielectric.
    Dielectric {
        /// Index behind the surface over that before it, in [0.01, 100].
        ior: f32,
    },
}

/// A colour that is the same everywhere or comes from an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Color {
    /// The same everywhere, linear Rec. 709.
    Constant(Rgb<f32>),
    /// Read from an image at the hit's texture coordinates.
    Texture {
        /// Index into [`Scene::textures`].
        texture: usize,
        /// Factor on the image, each channel in [0, 1].
        scale: Rgb<f32>,
    },
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
