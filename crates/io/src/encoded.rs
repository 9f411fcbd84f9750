//! What the encoders of pictures have in common.

use std::path::Path;

use gonio_tracer::Picture;

use crate::ImageError;
use crate::whole_file::WholeFile;

/// Refuses a picture whose size does not fit its pixels.
pub(crate) fn check(picture: &Picture) -> Result<(), String> {
    let count = u64::from(picture.width) * u64::from(picture.height);
    if count == 0 || count != picture.rgb.len() as u64 {
        let (width, height, found) = (picture.width, picture.height, picture.rgb.len());
        return Err(format!("a picture of {width} x {height} cannot have {found} pixels"));
    }
    Ok(())
}

/// Puts an encoded picture in place of `path`, or changes nothing.
pub(crate) fn replace(path: &Path, encoded: Result<Vec<u8>, String>) -> Result<(), ImageError> {
    let bytes = encoded.map_err(|why| ImageError::of(path, why))?;
    WholeFile::write(path, &bytes).map_err(|error| ImageError::of(path, format!("cannot be written: {error}")))
}
