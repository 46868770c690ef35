//! SHA-256 (FIPS 180-4) of files, texts and data: whether two renders began with the same.

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use sha2::{Digest as _, Sha256};

use crate::error::Result;
use crate::files::{FileId, Files};

/// A digest in progress. As a [`fmt::Write`] it takes texts.
#[derive(Clone, Debug, Default)]
pub struct Digest(Sha256);

impl Digest {
    /// Adds bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// 64 hexadecimal digits.
    pub fn finish(self) -> String {
        self.0.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

impl fmt::Write for Digest {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.add(text.as_bytes());
        Ok(())
    }
}

/// The digest of bytes.
pub fn digest(bytes: &[u8]) -> String {
    let mut digest = Digest::default();
    digest.add(bytes);
    digest.finish()
}

/// The size and digest of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileDigest {
    /// Number of bytes.
    pub bytes: u64,
    /// SHA-256 as 64 hexadecimal digits.
    pub sha256: String,
}

/// Files that are digested as they are read.
pub struct Digested<'a> {
    files: &'a dyn Files,
    digests: Mutex<BTreeMap<PathBuf, FileDigest>>,
}

impl<'a> Digested<'a> {
    /// Wraps `files`.
    pub fn new(files: &'a dyn Files) -> Self {
        Self { files, digests: Mutex::default() }
    }

    /// The files that were read, by name, with their digests. Names are relative to `folder` where they are inside.
    pub fn digests(self, folder: &Path) -> Vec<(PathBuf, FileDigest)> {
        let digests = self.digests.into_inner().unwrap_or_else(PoisonError::into_inner);
        let relative = |(path, digest): (PathBuf, FileDigest)| {
            (path.strip_prefix(folder).map_or(path.clone(), Path::to_owned), digest)
        };
        digests.into_iter().map(relative).collect()
    }
}

impl Files for Digested<'_> {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        let bytes = self.files.read(path, limit)?;
        let digest = FileDigest { bytes: bytes.len() as u64, sha256: digest(&bytes) };
        self.digests.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_owned(), digest);
        Ok(bytes)
    }

    fn length(&self, path: &Path) -> Option<u64> {
        self.files.length(path)
    }

    fn identities(&self, path: &Path) -> Vec<FileId> {
        self.files.identities(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LoadContext, Memory};

    #[test]
    fn the_example_of_the_standard() {
        assert_eq!(digest(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }

    #[test]
    fn what_is_read_is_digested() {
        let memory = Memory([("a/b".into(), b"abc".to_vec()), ("c".into(), Vec::new())].into());
        let files = Digested::new(&memory);
        for path in ["c", "a/b", "missing"] {
            let _ = LoadContext::new(&files).read(Path::new(path));
        }
        let digests = files.digests(Path::new("a"));
        assert_eq!(digests[0], ("b".into(), FileDigest { bytes: 3, sha256: digest(b"abc") }));
        assert_eq!((digests.len(), &digests[1].0), (2, &PathBuf::from("c")));
    }
}
