//! The scene's images, each decoded once.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::SceneError;
use crate::normal_map::NormalMap;
use crate::texture::Texture;

/// Images loaded so far.
#[derive(Default)]
pub(super) struct Textures {
    pub(super) list: Vec<Texture>,
    pub(super) normal_maps: Vec<NormalMap>,
    index: HashMap<PathBuf, usize>,
    normal_map_index: HashMap<PathBuf, usize>,
}

impl Textures {
    /// The index of an image of colours, which is decoded if it is new.
    ///
    /// # Errors
    /// The file cannot be read or decoded.
    pub(super) fn load(&mut self, path: &Path) -> Result<usize, SceneError> {
        once(&mut self.list, &mut self.index, path, Texture::load)
    }

    /// The index of an image of normals, which is decoded if it is new.
    ///
    /// # Errors
    /// The file cannot be read or decoded, or is grey.
    pub(super) fn load_normals(&mut self, path: &Path) -> Result<usize, SceneError> {
        once(&mut self.normal_maps, &mut self.normal_map_index, path, NormalMap::load)
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
