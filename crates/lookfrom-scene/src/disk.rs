//! The file system.

use std::collections::HashMap;
use std::io::{ErrorKind as IoKind, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::{FileId, Files, too_long};

/// The maximum number of bytes read from a stream of unknown length.
const MOST_OF_A_STREAM: u64 = 1 << 30;

/// The file system. What can be read only once, such as a pipe, is kept.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

/// Bytes that came from pipes and devices of this process, by path and [`FileId`]s: readers look at the beginning of a file before they
/// read it.
type Streams = HashMap<(PathBuf, Vec<FileId>), Vec<u8>>;

fn streams() -> MutexGuard<'static, Streams> {
    static STREAMS: LazyLock<Mutex<Streams>> = LazyLock::new(Mutex::default);
    STREAMS.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Disk {
    /// Bytes that were read before from a path that is no file: opening a pipe again would wait for another writer.
    fn kept(self, path: &Path, limit: u64) -> Option<Result<Vec<u8>>> {
        if std::fs::metadata(path).ok()?.is_file() {
            return None;
        }
        let streams = streams();
        let bytes = streams.get(&(path.to_owned(), self.identities(path)))?;
        let is_long = bytes.len() as u64 > limit;
        Some(if is_long { Err(too_long(&Location::file(path), limit)) } else { Ok(bytes.clone()) })
    }
}

impl Files for Disk {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        let at = Location::file(path);
        let io = |error: &std::io::Error| {
            let (message, hint) = match error.kind() {
                IoKind::NotFound => (
                    "no such file".to_owned(),
                    "check the name; names in a scene file are relative to that file",
                ),
                IoKind::IsADirectory => {
                    ("this is a folder, not a file".to_owned(), "name a scene or model file in it")
                }
                IoKind::PermissionDenied => ("permission denied".to_owned(), "check the file's permissions"),
                _ => (format!("cannot be read: {error}"), "check that the file exists and is whole"),
            };
            Error::new(ErrorKind::Io, &at, message).hint(hint)
        };
        if let Some(bytes) = self.kept(path, limit) {
            return bytes;
        }
        let file = match std::fs::File::open(path) {
            Err(error) if error.kind() == IoKind::NotFound => {
                let other = spelled_otherwise(path).ok_or_else(|| io(&error))?;
                std::fs::File::open(other)
            }
            opened => opened,
        };
        let file = file.map_err(|e| io(&e))?;
        let metadata = file.metadata().map_err(|e| io(&e))?;
        let length = metadata.len();
        if length > limit {
            return Err(too_long(&at, limit));
        }
        let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
        if metadata.is_file() {
            file.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(|e| io(&e))?;
            return if bytes.len() as u64 > limit { Err(too_long(&at, limit)) } else { Ok(bytes) };
        }
        // A device or a pipe reports length 0 and may never end: read at most one byte more than the limit.
        let limit = limit.min(MOST_OF_A_STREAM);
        file.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(|e| io(&e))?;
        if bytes.len() as u64 > limit {
            return Err(too_long(&at, limit));
        }
        streams().insert((path.to_owned(), self.identities(path)), bytes.clone());
        Ok(bytes)
    }

    fn length(&self, path: &Path) -> Option<u64> {
        std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file).map(|metadata| metadata.len())
    }

    fn identities(&self, path: &Path) -> Vec<FileId> {
        std::iter::once(FileId::Path(resolved(path))).chain(number(path)).collect()
    }
}

/// The number that the file system has for a file.
#[cfg(unix)]
fn number(path: &Path) -> Option<FileId> {
    use std::os::unix::fs::MetadataExt;
    let metadata = std::fs::metadata(path).ok()?;
    Some(FileId::Number { device: metadata.dev(), file: metadata.ino() })
}

/// None: file systems of this kind have no numbers that are always there.
#[cfg(not(unix))]
fn number(_: &Path) -> Option<FileId> {
    None
}

/// A file that there is, by a path with `\\` for `/`, or other cases of letters, as scenes from Windows name theirs; of several the first in
/// their order.
fn spelled_otherwise(path: &Path) -> Option<PathBuf> {
    let path = PathBuf::from(path.to_str()?.replace('\\', "/"));
    let mut found = PathBuf::new();
    for component in path.components() {
        let next = found.join(component);
        found = match (next.exists(), component) {
            (false, Component::Normal(name)) => {
                let name = name.to_str()?.to_lowercase();
                let folder = if found.as_os_str().is_empty() { Path::new(".") } else { &found };
                let names = std::fs::read_dir(folder)
                    .ok()?
                    .filter_map(|entry| entry.ok()?.file_name().into_string().ok());
                found.join(names.filter(|other| other.to_lowercase() == name).min()?)
            }
            _ => next,
        };
    }
    Some(found)
}

/// The absolute path without links, as far as the path exists.
fn resolved(path: &Path) -> PathBuf {
    if let Ok(resolved) = std::fs::canonicalize(path) {
        return resolved;
    }
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut resolved = PathBuf::new();
    for component in absolute.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => {
                resolved.pop();
            }
            other => {
                resolved.push(other);
                resolved = std::fs::canonicalize(&resolved).unwrap_or(resolved);
            }
        }
    }
    resolved
}
