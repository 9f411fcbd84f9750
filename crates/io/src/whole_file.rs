//! Files that appear whole or not at all.
//!
//! A [`WholeFile`] is written under a temporary name beside its target and renamed at the end, so whoever looks at the
//! target sees the old file or the whole new one, and a full disk, an error or an interrupted run leaves the old one alone.
//! A target that exists and is not a regular file (`/dev/null`, a pipe) is written to directly.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};

/// The temporary files of this process: what [`discard_unfinished`] removes.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// A file that is being written.
#[derive(Debug)]
pub struct WholeFile {
    target: PathBuf,
    /// `None` if the target is written to directly, or is finished.
    temporary: Option<PathBuf>,
    writer: BufWriter<File>,
}

impl WholeFile {
    /// Begins the file.
    ///
    /// # Errors
    /// No file can be made in the target's folder, the target is a folder, or it names no file.
    pub fn create(target: &Path) -> io::Result<Self> {
        let found = fs::metadata(target);
        if found.as_ref().is_ok_and(|found| !found.is_file() && !found.is_dir()) {
            let writer = BufWriter::new(File::options().write(true).open(target)?);
            return Ok(Self { target: target.to_path_buf(), temporary: None, writer });
        }
        if found.is_ok_and(|found| found.is_dir()) {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"));
        }
        let name = target.file_name().ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "it names no file"))?;
        static COUNTER: AtomicU32 = AtomicU32::new(0); // two threads may write the same target
        let number = COUNTER.fetch_add(1, Ordering::Relaxed);
        let unique = format!(".{}.{}-{number}.tmp", name.to_string_lossy(), std::process::id());
        let temporary = target.with_file_name(unique);
        let writer = BufWriter::new(File::create_new(&temporary)?);
        unfinished(|list| list.push(temporary.clone()));
        Ok(Self { target: target.to_path_buf(), temporary: Some(temporary), writer })
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// The rest cannot be written (a full disk may only be noticed here), or the target cannot be replaced.
    pub fn finish(mut self) -> io::Result<()> {
        self.writer.flush()?;
        let Some(temporary) = &self.temporary else { return Ok(()) };
        self.writer.get_ref().sync_all()?;
        fs::rename(temporary, &self.target)?;
        let done = self.temporary.take();
        unfinished(|list| list.retain(|path| Some(path) != done.as_ref()));
        Ok(())
    }

    /// Writes all of a file at once.
    ///
    /// # Errors
    /// As [`WholeFile::create`] and [`WholeFile::finish`].
    pub fn write(target: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut file = Self::create(target)?;
        file.write_all(bytes)?;
        file.finish()
    }

    /// Finds out whether a file can appear at `target`, without touching what is there.
    ///
    /// # Errors
    /// As [`WholeFile::create`].
    pub fn probe(target: &Path) -> io::Result<()> {
        Self::create(target).map(drop)
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

impl Drop for WholeFile {
    fn drop(&mut self) {
        if let Some(temporary) = &self.temporary {
            let _ = fs::remove_file(temporary); // unfinished; there is nobody left to tell
            unfinished(|list| list.retain(|path| path != temporary));
        }
    }
}

/// Removes what is unfinished: for a process that ends at once. Files begun afterwards are not covered.
pub fn discard_unfinished() {
    unfinished(|list| {
        for path in list.drain(..) {
            let _ = fs::remove_file(path); // there is nobody left to tell
        }
    });
}

fn unfinished(change: impl FnOnce(&mut Vec<PathBuf>)) {
    change(&mut UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("gonio-whole-file-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        path
    }

    #[test]
    fn a_file_appears_at_the_end_and_an_unfinished_one_never() {
        let folder = folder("appears");
        let target = folder.join("a.txt");
        WholeFile::write(&target, b"old").unwrap();
        let mut file = WholeFile::create(&target).unwrap();
        file.write_all(b"new").unwrap();
        file.flush().unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"old");
        drop(file);
        assert_eq!(fs::read(&target).unwrap(), b"old");
        WholeFile::probe(&target).unwrap();
        WholeFile::write(&target, b"new").unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"new");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "no temporary file is left");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn what_cannot_be_a_file_is_refused() {
        let folder = folder("refused");
        let error = WholeFile::create(&folder).unwrap_err().to_string();
        assert_eq!(error, "it is a folder");
        assert!(WholeFile::create(&folder.join("absent/a.txt")).is_err());
        assert!(WholeFile::create("/".as_ref()).is_err());
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
        fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_is_written_to_directly_and_a_full_one_says_so() {
        WholeFile::write("/dev/null".as_ref(), b"gone").unwrap();
        let error = WholeFile::write("/dev/full".as_ref(), b"full").unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
    }
}
