//! The scene's images, each decoded once.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use gonio_tracer::normal_map::NormalMap;
use gonio_tracer::texture::Texture;

use crate::SceneError;
use crate::bitmap::{read_normal_map, read_texture};

/// Images loaded so far.
#[derive(Default)]
pub(crate) struct Textures {
    pub(crate) list: Vec<Texture>,
    pub(crate) normal_maps: Vec<NormalMap>,
    index: HashMap<PathBuf, usize>,
    normal_map_index: HashMap<PathBuf, usize>,
}

impl Textures {
    /// The index of an image of colours, which is decoded if it is new.
    ///
    /// # Errors
    /// The file cannot be read or decoded.
    pub(crate) fn load(&mut self, path: &Path) -> Result<usize, SceneError> {
        once(&mut self.list, &mut self.index, path, read_texture)
    }

    /// The index of an image of normals, which is decoded if it is new.
    ///
    /// # Errors
    /// The file cannot be read or decoded, or is grey.
    pub(crate) fn load_normals(&mut self, path: &Path) -> Result<usize, SceneError> {
        once(&mut self.normal_maps, &mut self.normal_map_index, path, read_normal_map)
    }
}

fn once<T>(
    list: &mut Vec<T>,
    index: &mut HashMap<PathBuf, usize>,
    path: &Path,
    load: impl Fn(&Path) -> Result<T, String>,
) -> Result<usize, SceneError> {
    if let Some(&index) = index.get(path) {
        return Ok(index);
    }
    list.push(load(path).map_err(|why| SceneError::file(path, format!("the image {why}")))?);
    index.insert(path.to_path_buf(), list.len() - 1);
    Ok(list.len() - 1)
}
