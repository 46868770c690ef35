//! Stdin as a file, which is read once and kept: readers look at the begin of a file before they read it.

use std::io::Read;
use std::path::Path;
use std::sync::OnceLock;

use lookfrom_scene::files::FileId;
use lookfrom_scene::load::PIPE;
use lookfrom_scene::{Disk, Error, ErrorKind, Files, Location, Result};

/// The most bytes that are read from a pipe.
const MOST_BYTES: u64 = 1 << 30;

/// The content of stdin, or why it could not be read.
static STDIN: OnceLock<std::result::Result<Vec<u8>, String>> = OnceLock::new();

/// The files on disk, and stdin by the name [`PIPE`].
pub(crate) struct Piped;

impl Files for Piped {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        if path != Path::new(PIPE) {
            return Disk.read(path, limit);
        }
        let at = Location::file(path);
        let kept = STDIN.get_or_init(|| {
            let mut bytes = Vec::new();
            let read = std::io::stdin().lock().take(MOST_BYTES + 1).read_to_end(&mut bytes);
            read.map(|_| bytes).map_err(|error| error.to_string())
        });
        match kept {
            Err(error) => Err(Error::new(ErrorKind::Io, &at, format!("stdin cannot be read: {error}"))),
            Ok(bytes) if bytes.len() as u64 > limit.min(MOST_BYTES) => {
                Err(Error::new(ErrorKind::Limit, &at, "stdin is longer than a gibibyte").hint("write a file"))
            }
            Ok(bytes) => Ok(bytes.clone()),
        }
    }

    fn length(&self, path: &Path) -> Option<u64> {
        Disk.length(path)
    }

    fn identities(&self, path: &Path) -> Vec<FileId> {
        // Stdin is no file that could be overwritten.
        if path == Path::new(PIPE) { Vec::new() } else { Disk.identities(path) }
    }
}
