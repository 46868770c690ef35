//! Files of a scene: those that Python made in memory, before those on disk.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use lookfrom::scene::files::FileId;
use lookfrom::scene::{Disk, Files, Memory, Result};

/// Files in memory, by their names, and all others on disk. Copies share them.
#[derive(Clone, Debug, Default)]
pub(super) struct Overlay(Arc<Memory>);

impl Overlay {
    pub(super) fn new(files: HashMap<PathBuf, Vec<u8>>) -> Self {
        Self(Arc::new(Memory(files)))
    }

    fn of(&self, path: &Path) -> &dyn Files {
        if self.0.0.contains_key(path) { &*self.0 } else { &Disk }
    }
}

impl Files for Overlay {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        self.of(path).read(path, limit)
    }

    fn length(&self, path: &Path) -> Option<u64> {
        self.of(path).length(path)
    }

    fn identities(&self, path: &Path) -> Vec<FileId> {
        self.of(path).identities(path)
    }
}
