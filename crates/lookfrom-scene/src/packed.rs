//! Decompression of gzip files (RFC 1952): models and scenes of pbrt may be compressed.

use std::ffi::OsString;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::budget::{Budget, Reserved};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::{Limits, LoadContext};

/// The extension of gzip files.
const EXTENSION: &str = "gz";

/// The signature of gzip files.
const MAGIC: &[u8] = b"\x1f\x8b";

/// Room in bytes for what is unpacked, at first.
const LEAST_ROOM: usize = 1 << 16;

/// Messages call it so.
const WHAT: &str = "the unpacked file";

/// Maximum compression ratio: meshes compress to about a tenth, so a larger ratio is suspicious.
const MOST_UNPACKED: u64 = 250;

/// The name without `.gz`, whose extension identifies the format.
pub(crate) fn unpacked_name(path: &Path) -> PathBuf {
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case(EXTENSION) => path.with_extension(""),
        _ => path.to_owned(),
    }
}

/// A file's content, decompressed if it is compressed. If `x.ply` cannot be read, `x.ply.gz` is read instead.
///
/// # Errors
/// `Io` if neither can be read, `Syntax` if the compressed bytes are damaged, `Limit` if the content is too long or there is no memory for it.
pub(crate) fn read(path: &Path, context: &LoadContext<'_>) -> Result<Reserved<Vec<u8>>> {
    let (bytes, path) = match context.read(path) {
        Ok(bytes) => (bytes, path.to_owned()),
        Err(error) if error.kind == ErrorKind::Io && unpacked_name(path) == path => {
            let mut packed = OsString::from(path);
            packed.push(".");
            packed.push(EXTENSION);
            let packed = PathBuf::from(packed);
            match context.read(&packed) {
                Ok(bytes) => (bytes, packed),
                Err(other) if other.kind == ErrorKind::Io => return Err(error),
                Err(other) => return Err(other),
            }
        }
        Err(error) => return Err(error),
    };
    unpacked(bytes, &path, &context.limits, &context.budget)
}

/// The bytes, decompressed if they are compressed.
pub(crate) fn unpacked(
    packed: Reserved<Vec<u8>>,
    path: &Path,
    limits: &Limits,
    budget: &Budget,
) -> Result<Reserved<Vec<u8>>> {
    if !packed.starts_with(MAGIC) {
        return Ok(packed);
    }
    let at = Location::file(path);
    let plausible = (packed.len() as u64).saturating_mul(MOST_UNPACKED).saturating_add(1 << 20);
    let limit = limits.file_bytes.min(plausible);
    let mut reader = flate2::read::MultiGzDecoder::new(&**packed).take(limit.saturating_add(1));
    let mut bytes = Vec::new();
    let mut memory = budget.reserve(0, WHAT, &at)?;
    loop {
        // How long it is, only the end tells: room grows by halves, like the reservation.
        let room = (bytes.len() / 2).max(LEAST_ROOM);
        memory.join(budget.reserve(room as u64, WHAT, &at)?);
        bytes.reserve_exact(room);
        let found = reader.by_ref().take(room as u64).read_to_end(&mut bytes).map_err(|error| {
            Error::syntax(&at, format!("cannot be unpacked: {error}")).hint("check that the file is whole")
        })?;
        if found < room {
            break;
        }
    }
    if bytes.len() as u64 > limit {
        let error = Error::new(
            ErrorKind::Limit,
            &at,
            format!("unpacked it is longer than the limit of {limit} bytes"),
        );
        return Err(error.hint("unpack it with gunzip and name the unpacked file"));
    }
    Ok(Reserved::new(bytes, memory))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn packed(content: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(content).expect("memory");
        encoder.finish().expect("memory")
    }

    #[test]
    fn packed_files_are_unpacked() {
        let (path, limits, budget) = (Path::new("a.gz"), Limits::default(), Budget::default());
        let two = [packed(b"one "), packed(b"two")].concat();
        assert_eq!(*unpacked(two.clone().into(), path, &limits, &budget).expect("whole"), b"one two");
        assert_eq!(
            unpacked(two[..two.len() - 3].to_vec().into(), path, &limits, &budget).map_err(|e| e.kind).err(),
            Some(ErrorKind::Syntax)
        );
    }

    #[test]
    fn bombs_are_defused() {
        let bomb = packed(&vec![0; 100 << 20]);
        let read =
            |bomb: Vec<u8>, budget| unpacked(bomb.into(), Path::new("a.gz"), &Limits::default(), &budget);
        let error = read(bomb, Budget::default()).expect_err("too long");
        assert!(error.kind == ErrorKind::Limit && error.message.contains("longer than"), "{error}");
        let error = read(packed(&[0; 200]), Budget::new(100)).expect_err("no memory");
        assert!(error.kind == ErrorKind::Limit && error.message.contains("takes 64.0 KiB"), "{error}");
    }
}
