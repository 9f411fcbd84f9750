//! The scene's images, each decoded once.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::SceneError;
use crate::texture::Texture;

/// Images loaded so far.
#[derive(Default)]
pub(super) struct Textures {
    pub(super) list: Vec<Texture>,
    index: HashMap<PathBuf, usize>,
}

impl Textures {
    /// The index of an image, which is decoded if it is new.
    ///
    /// # Errors
    /// The file cannot be read or decoded.
    pub(super) fn load(&mut self, path: &Path) -> Result<usize, SceneError> {
        if let Some(&index) = self.index.get(path) {
            return Ok(index);
        }
        let texture = Texture::load(path).map_err(|why| SceneError::file(path, format!("the image {why}")))?;
        self.list.push(texture);
        let index = self.list.len() - 1;
        self.index.insert(path.to_path_buf(), index);
        Ok(index)
    }
}
