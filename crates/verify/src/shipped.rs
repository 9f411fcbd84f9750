//! Scenes of the repository's `scenes/`, compiled in, so that an installed program has them too.

use crate::error::Error;
use gonio_tracer::scene::Scene;
use std::path::Path;

/// Name and text of a scene's files; the scene file comes first.
pub(crate) type Files = &'static [(&'static str, &'static str)];

/// A file of the repository's `scenes/`, to which the link of that name leads: so it is in the package too.
macro_rules! shipped {
    ($name:literal) => {
        ($name, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/", $name)))
    };
}
pub(crate) use shipped;

/// The Cornell box.
pub(crate) const CORNELL_BOX: Files = &[shipped!("cornell-box.toml"), shipped!("cornell-box.obj")];

/// Writes the files to a folder, which is made if it does not exist, and reads the scene.
///
/// # Errors
/// If the folder cannot be written to.
pub(crate) fn unpack(files: Files, folder: &Path) -> Result<Scene, Error> {
    std::fs::create_dir_all(folder).map_err(Error::file(folder, "made"))?;
    for (name, text) in files {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(Error::file(&path, "written"))?;
    }
    Ok(gonio_io::load(&folder.join(files[0].0))?)
}
