//! Files that were dropped on the page, or are a part of it.
//!
//! A file is known by its path in the folder or archive that it came from. Files that were dropped one by one have no folders: where
//! a scene names one in a folder that is not there, the only file of that name is meant.

use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};

use lookfrom_scene::{Error, ErrorKind, Files, Location, Result};

/// Files in memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Dropped {
    files: HashMap<PathBuf, Vec<u8>>,
}

impl Dropped {
    /// Adds a file, in place of one of the same path.
    pub(crate) fn add(&mut self, path: &str, bytes: Vec<u8>) {
        self.files.insert(plain(Path::new(&path.replace('\\', "/"))), bytes);
    }

    fn find(&self, path: &Path) -> Option<&Vec<u8>> {
        let path = plain(path);
        self.files.get(&path).or_else(|| {
            let name = path.file_name()?;
            let mut same = self
                .files
                .iter()
                .filter(|(known, _)| known.file_name().is_some_and(|known| known.eq_ignore_ascii_case(name)));
            let (_, bytes) = same.next()?;
            same.next().is_none().then_some(bytes)
        })
    }
}

impl Files for Dropped {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        let at = Location::file(path);
        let bytes = self.find(path).ok_or_else(|| {
            Error::new(ErrorKind::Io, &at, "no such file")
                .hint("drop it on the page together with the scene, or a zip of all")
        })?;
        match bytes.len() as u64 <= limit {
            true => Ok(bytes.clone()),
            false => {
                Err(Error::new(ErrorKind::Limit, &at, format!("longer than the limit of {limit} bytes")))
            }
        }
    }

    fn length(&self, path: &Path) -> Option<u64> {
        self.find(path).map(|bytes| bytes.len() as u64)
    }
}

/// A path without `.` and, as far as it has folders, `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in path.components() {
        match component {
            Component::ParentDir => drop(plain.pop()),
            Component::Normal(name) => plain.push(name),
            Component::CurDir | Component::RootDir | Component::Prefix(_) => {}
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dropped(paths: &[&str]) -> Dropped {
        let mut files = Dropped::default();
        paths.iter().for_each(|path| files.add(path, path.as_bytes().to_vec()));
        files
    }

    #[test]
    fn a_path_is_found_however_it_is_written() {
        let files = dropped(&["scene/a.obj", "scene\\textures\\wood.png"]);
        for path in
            ["scene/textures/wood.png", "scene/./textures/../textures/wood.png", "/scene/textures/wood.png"]
        {
            assert_eq!(files.read(Path::new(path), 100).expect(path), b"scene\\textures\\wood.png");
        }
    }

    #[test]
    fn a_file_without_its_folder_is_found_by_its_name_if_it_is_the_only_one() {
        let files = dropped(&["Wood.PNG", "scene.toml"]);
        assert_eq!(files.read(Path::new("textures/wood.png"), 100).expect("the only one"), b"Wood.PNG");
        let error = dropped(&["a/wood.png", "b/wood.png"]).read(Path::new("wood.png"), 100).expect_err("two");
        assert_eq!(error.kind, ErrorKind::Io);
        assert_eq!(files.length(Path::new("stone.png")), None);
    }

    #[test]
    fn limits_hold() {
        let error = dropped(&["scene.toml"]).read(Path::new("scene.toml"), 3).expect_err("ten bytes");
        assert_eq!(error.kind, ErrorKind::Limit);
    }
}
