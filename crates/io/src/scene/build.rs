//! Meshes, materials and images put together: every name becomes an index.

use std::collections::HashMap;
use std::mem::take;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use gonio_kernel::Rgb;
use gonio_kernel::lobe::Lambert;
use gonio_tracer::light::LightSource;
use gonio_tracer::scene::{
    BuildError, Camera, EXTENT, Environment, FilmSettings, Instance, IntegratorSettings, Loading, LobeSpec,
    MAX_MATERIALS, Material, Mesh, Scene, Stage,
};

use crate::SceneError;
use crate::mtl::Library;
use crate::obj::{self, ObjFile};
use crate::paths;
use crate::textures::Textures;

/// Albedo of a surface whose material is not known.
const GREY: f32 = 0.5;

/// Which scene materials a mesh asks for.
#[derive(Default)]
pub(super) struct Assignment {
    /// One material for everything.
    pub(super) all: Option<u32>,
    /// Materials for names in the OBJ file.
    pub(super) renamed: Vec<(String, u32)>,
}

/// A scene in the making.
pub(super) struct Builder {
    pub(super) textures: Textures,
    /// World bounds of what was placed so far.
    pub(super) bounds: [DVec3; 2],
    materials: Vec<Material>,
    /// The first of `materials`, defined by the scene file.
    defined: usize,
    grey: Option<u32>,
    meshes: Vec<Mesh>,
    instances: Vec<Instance>,
    warnings: Vec<String>,
    objects: HashMap<PathBuf, Object>,
    libraries: Vec<(PathBuf, Library)>,
    /// Materials already converted, by library and place in it.
    converted: HashMap<(usize, usize), u32>,
}

/// An OBJ file that was read, and what was made of it.
struct Object {
    file: ObjFile,
    /// The meshes that took the geometry of the file's parts; others copy theirs.
    first: Vec<usize>,
    /// Indices into [`Builder::libraries`]; `None` until a material is looked for.
    libraries: Option<Vec<usize>>,
    /// For each assignment of materials, the meshes that were made.
    meshes: HashMap<Vec<u32>, Vec<usize>>,
}

impl Default for Builder {
    fn default() -> Self {
        Self {
            textures: Textures::default(),
            bounds: [DVec3::INFINITY, DVec3::NEG_INFINITY],
            materials: Vec::new(),
            defined: 0,
            grey: None,
            meshes: Vec::new(),
            instances: Vec::new(),
            warnings: Vec::new(),
            objects: HashMap::new(),
            libraries: Vec::new(),
            converted: HashMap::new(),
        }
    }
}

impl Builder {
    /// Adds a material of the scene file.
    ///
    /// # Errors
    /// A sentence: there are too many.
    pub(super) fn define(&mut self, material: Material) -> Result<(), String> {
        self.add(material)?;
        self.defined = self.materials.len();
        Ok(())
    }

    /// The index of a material of the scene file.
    pub(super) fn defined(&self, name: &str) -> Option<u32> {
        self.defined_names().position(|candidate| candidate == name).map(|index| index as u32)
    }

    pub(super) fn defined_names(&self) -> impl Iterator<Item = &str> {
        self.materials[..self.defined].iter().map(|material| material.name.as_str())
    }

    fn add(&mut self, material: Material) -> Result<u32, String> {
        let index = self.materials.len();
        if index >= MAX_MATERIALS {
            return Err(format!("more than {MAX_MATERIALS} materials"));
        }
        self.materials.push(material);
        Ok(index as u32)
    }

    /// Places an OBJ file in the world; returns the material names it uses.
    ///
    /// # Errors
    /// The file or something it names cannot be used; `blame` makes an error of what is wrong with placing it.
    pub(super) fn place(
        &mut self,
        path: &Path,
        assignment: &Assignment,
        transform: DAffine3,
        blame: impl Fn(String) -> SceneError,
        progress: &mut dyn FnMut(Loading),
    ) -> Result<Vec<String>, SceneError> {
        let mut object = match self.objects.remove(path) {
            Some(object) => object,
            None => {
                let file = obj::load(path, &mut |done, of| progress(Loading { stage: Stage::Reading, done, of }))?;
                file.warnings.iter().for_each(|text| self.warn(text.clone()));
                Object { file, first: Vec::new(), libraries: None, meshes: HashMap::new() }
            }
        };
        let slots = self.resolve(path, &mut object, assignment).map_err(|error| match error {
            Refused::Scene(error) => error,
            Refused::Count(why) => blame(why),
        })?;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if !object.meshes.contains_key(&slots) {
            let made = self.make_meshes(&name, &mut object, &slots);
            object.meshes.insert(slots.clone(), made);
        }
        let meshes = &object.meshes[&slots];
        if let Some(material) = self.untilted(meshes) {
            let why = format!(
                "\"{name}\" has faces without texture coordinates (vt), which the normal map of \"{material}\" needs"
            );
            return Err(blame(why));
        }
        for &mesh in meshes.iter() {
            for &position in &self.meshes[mesh].positions {
                let world = transform.transform_point3(DVec3::from_array(position));
                self.bounds = [self.bounds[0].min(world), self.bounds[1].max(world)];
            }
            self.instances.push(Instance { name: name.clone(), mesh, transform });
        }
        let extent = (self.bounds[1] - self.bounds[0]).max_element();
        if !EXTENT.contains(&extent) {
            return Err(blame(BuildError::Extent(extent).to_string()));
        }
        let names = object.file.materials.iter().map(|(name, _)| name.clone()).collect();
        self.objects.insert(path.to_path_buf(), object);
        Ok(names)
    }

    /// A material with a normal map on one of the meshes, if that has no texture coordinates.
    fn untilted(&self, meshes: &[usize]) -> Option<&str> {
        let bare = meshes.iter().map(|&mesh| &self.meshes[mesh]).filter(|mesh| mesh.uvs.is_none());
        let mut materials = bare.flat_map(|mesh| &mesh.materials).map(|&m| &self.materials[m as usize]);
        materials.find(|material| material.normal_map.is_some()).map(|material| material.name.as_str())
    }

    /// Meshes of an OBJ file with these materials.
    fn make_meshes(&mut self, name: &str, object: &mut Object, slots: &[u32]) -> Vec<usize> {
        let first = self.meshes.len();
        for (at, part) in object.file.parts.iter_mut().enumerate() {
            let runs = part.materials.iter();
            let materials = runs.flat_map(|&(count, slot)| std::iter::repeat_n(slots[slot as usize], count as usize));
            let mut mesh = match object.first.get(at) {
                Some(&like) => Mesh { materials: Vec::new(), ..self.meshes[like].clone() },
                None => Mesh {
                    name: name.to_owned(),
                    positions: take(&mut part.positions),
                    normals: take(&mut part.normals),
                    uvs: take(&mut part.uvs),
                    triangles: take(&mut part.triangles),
                    materials: Vec::new(),
                },
            };
            mesh.materials.reserve_exact(mesh.triangles.len());
            mesh.materials.extend(materials);
            self.meshes.push(mesh);
        }
        let made: Vec<usize> = (first..self.meshes.len()).collect();
        if object.first.is_empty() {
            object.first.clone_from(&made);
        }
        made
    }

    /// The material of each slot of an OBJ file; unused slots are 0.
    fn resolve(&mut self, path: &Path, object: &mut Object, wanted: &Assignment) -> Result<Vec<u32>, Refused> {
        let mut used = vec![false; object.file.materials.len() + 1];
        for &(_, slot) in object.file.parts.iter().flat_map(|part| &part.materials) {
            used[slot as usize] = true;
        }
        let mut slots = vec![0; used.len()];
        for slot in (0..used.len()).filter(|&slot| used[slot]) {
            let named = slot.checked_sub(1).map(|index| object.file.materials[index].clone());
            let name = named.as_ref().map(|(name, _)| name.as_str());
            let rename = wanted.renamed.iter().find(|(from, _)| Some(from.as_str()) == name).map(|&(_, to)| to);
            let chosen = wanted.all.or(rename).or_else(|| name.and_then(|name| self.defined(name)));
            slots[slot] = match (chosen, named) {
                (Some(material), _) => material,
                (None, Some((name, line))) => self.library_material(path, object, &name, line)?,
                (None, None) => {
                    self.warn(format!("{}: faces without a material are drawn in grey", path.display()));
                    self.grey()?
                }
            };
        }
        Ok(slots)
    }

    fn library_material(&mut self, path: &Path, object: &mut Object, name: &str, line: u32) -> Result<u32, Refused> {
        let libraries = match &object.libraries {
            Some(libraries) => libraries,
            None => object.libraries.insert(self.open_libraries(path, &object.file)?),
        };
        let found = libraries.iter().find_map(|&library| Some((library, self.libraries[library].1.find(name)?)));
        let Some((library, index)) = found else {
            let text = format!("material \"{name}\" is not defined; drawn in grey");
            self.warn(SceneError::at(path, line, text).to_string());
            return self.grey();
        };
        if let Some(&material) = self.converted.get(&(library, index)) {
            return Ok(material);
        }
        let material = self.libraries[library].1.convert(index, &mut self.textures)?;
        let material = self.add(material)?;
        self.converted.insert((library, index), material);
        Ok(material)
    }

    /// Reads the libraries that an OBJ file names; what is missing becomes a warning.
    fn open_libraries(&mut self, path: &Path, file: &ObjFile) -> Result<Vec<usize>, SceneError> {
        let mut found = Vec::new();
        let mut missing = Vec::new();
        for (argument, line) in &file.libraries {
            if let Some(whole) = paths::find(path, argument) {
                found.push(whole);
                continue;
            }
            for name in split_names(argument) {
                match paths::find(path, &name) {
                    Some(library) => found.push(library),
                    None => missing.push((*line, name)),
                }
            }
        }
        // Writers that rename an OBJ file often forget the name inside it.
        let twin = path.with_extension("mtl");
        let twin_used = found.is_empty() && !missing.is_empty() && twin.is_file();
        for (line, name) in missing {
            let instead = if twin_used { format!("; {} is used instead", twin.display()) } else { String::new() };
            let text = format!("the material library \"{name}\" does not exist{instead}");
            self.warn(SceneError::at(path, line, text).to_string());
        }
        if twin_used {
            found.push(twin);
        }
        found.into_iter().map(|library| self.open_library(library)).collect()
    }

    fn open_library(&mut self, path: PathBuf) -> Result<usize, SceneError> {
        if let Some(index) = self.libraries.iter().position(|(known, _)| *known == path) {
            return Ok(index);
        }
        let library = Library::load(&path)?;
        self.libraries.push((path, library));
        Ok(self.libraries.len() - 1)
    }

    fn grey(&mut self) -> Result<u32, Refused> {
        if let Some(grey) = self.grey {
            return Ok(grey);
        }
        let grey = self.add(Material::new("grey", vec![LobeSpec::new(Lambert::new(Rgb::splat(GREY)))]))?;
        self.grey = Some(grey);
        Ok(grey)
    }

    /// Says something once, however often the file is placed.
    pub(super) fn warn(&mut self, text: String) {
        if !self.warnings.contains(&text) {
            self.warnings.push(text);
        }
    }

    /// The finished scene.
    pub(super) fn finish(
        mut self,
        film: FilmSettings,
        camera: Camera,
        integrator: IntegratorSettings,
        environment: Environment,
        lights: Vec<Arc<dyn LightSource>>,
    ) -> Scene {
        self.warnings.extend(self.libraries.into_iter().flat_map(|(_, library)| library.into_warnings()));
        let shines = |mesh: &Mesh| mesh.materials.iter().any(|&m| self.materials[m as usize].emission.largest() > 0.0);
        if lights.is_empty() && !self.meshes.iter().any(shines) {
            if environment.is_dark() {
                self.warnings.push("the scene has no light: the picture will be black".to_owned());
            } else if !environment.illuminates {
                self.warnings.push("the scene has no light: only its background will be seen".to_owned());
            }
        }
        Scene {
            film,
            camera,
            integrator,
            materials: self.materials,
            textures: self.textures.list,
            normal_maps: self.textures.normal_maps,
            meshes: self.meshes,
            instances: self.instances,
            environment,
            lights,
            warnings: self.warnings,
        }
    }
}

/// Why a material cannot be had: something is wrong with a file, or there are too many.
enum Refused {
    Scene(SceneError),
    Count(String),
}

impl From<SceneError> for Refused {
    fn from(error: SceneError) -> Self {
        Self::Scene(error)
    }
}

impl From<String> for Refused {
    fn from(why: String) -> Self {
        Self::Count(why)
    }
}

/// Splits `a.mtl b\ c.mtl` at spaces without a backslash.
fn split_names(argument: &str) -> Vec<String> {
    let marked = argument.replace("\\ ", "\0");
    marked.split_whitespace().map(|name| name.replace('\0', " ")).collect()
}
