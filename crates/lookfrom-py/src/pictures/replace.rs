//! Files that are written whole or not at all.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;

/// Writes files, by [`replace`]. Where one cannot be written, all that were there are as before, and it is an `OSError`.
#[pyfunction]
pub(crate) fn replace_files(py: Python<'_>, files: Vec<(PathBuf, PyBackedBytes)>) -> PyResult<()> {
    let files: Vec<(&Path, &[u8])> = files.iter().map(|(path, bytes)| (&**path, &**bytes)).collect();
    py.detach(|| replace(&files)).map_err(|(path, error)| {
        // The class of the exception follows from the code: the second place is for that of Windows.
        let code = error.raw_os_error().unwrap_or(0);
        PyOSError::new_err((code, error.to_string(), path.to_path_buf(), code))
    })
}

/// Writes temporary files beside all `files`, and when all are on the disk, renames each to its path. At any moment, there
/// is the old file or the new one, whole. Symbolic links stay, and what they point at is replaced.
///
/// # Errors
/// The path that cannot be written, and why.
pub(super) fn replace<'a>(files: &[(&'a Path, &[u8])]) -> Result<(), (&'a Path, io::Error)> {
    let mut written = Vec::new();
    for (path, bytes) in files {
        written.push((*path, Partial::write(path, bytes).map_err(|error| (*path, error))?));
    }
    let mut folders = BTreeSet::new();
    for (path, partial) in written {
        let Some(partial) = partial else { continue };
        fs::rename(&partial.path, &partial.target).map_err(|error| (path, error))?;
        folders.insert(partial.path.with_file_name("."));
    }
    // New names are on disk only when their folder is; systems that cannot sync folders need not.
    for folder in folders {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
    Ok(())
}

/// A temporary file, which is removed when it is dropped.
struct Partial {
    path: PathBuf,
    target: PathBuf,
}

impl Partial {
    /// Writes the temporary file of `path`. `None` where `path` is no regular file, such as a pipe: the bytes are in it.
    fn write(path: &Path, bytes: &[u8]) -> io::Result<Option<Self>> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        // A link to a file that is not there yet has no canonical path.
        let linked = |_| fs::read_link(path).map(|to| path.with_file_name(to));
        let target = fs::canonicalize(path).or_else(linked).unwrap_or_else(|_| path.to_path_buf());
        let old = fs::metadata(&target).ok();
        if old.as_ref().is_some_and(|old| !old.is_file()) {
            return fs::write(&target, bytes).map(|()| None);
        }
        if old.is_some() {
            // A file that must not be written stays.
            OpenOptions::new().write(true).open(&target)?;
        }
        let name = target.file_name().unwrap_or_default().to_string_lossy();
        let short: String = name.chars().take(50).collect();
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        // Not a `.partial` of the command, which removes those that nobody holds a lock on: there may be more files than can
        // be open at a time.
        let path = target.with_file_name(format!(".{short}-{}-{count}.new", std::process::id()));
        let mut file = OpenOptions::new().write(true).create_new(true).open(&path)?;
        let partial = Self { path, target };
        if let Some(old) = old {
            // Some file systems have no permissions.
            let _ = file.set_permissions(old.permissions());
        }
        file.write_all(bytes)?;
        file.sync_all()?;
        Ok(Some(partial))
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        // After it was renamed, there is none.
        let _ = fs::remove_file(&self.path);
    }
}
