//! File access within limits: from disk ([`Disk`](crate::Disk)), or from memory for tests and embedders. Nothing else opens a file.
//! [`Inputs`](crate::inputs::Inputs) wraps it and records the files that were read.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::budget::{Budget, Reservation, Reserved};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::variables::Variables;
use crate::warning::Warning;

/// Limits on the resources of a scene. Scene files are untrusted input; exceeding a limit is an [`ErrorKind::Limit`].
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Bytes of one file.
    pub file_bytes: u64,
    /// The maximum depth of nested imports.
    pub import_depth: u32,
    /// Triangles, vertices or spheres of one file.
    pub elements: u64,
    /// Texels of one image.
    pub texels: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { file_bytes: 8 << 30, import_depth: 16, elements: 1 << 30, texels: 1 << 28 }
    }
}

/// File access.
pub trait Files: Sync {
    /// The whole content of a file of at most `limit` bytes.
    ///
    /// # Errors
    /// `Io` if it cannot be read, `Limit` if it is longer than `limit`.
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>>;

    /// The number of bytes of a file, if that is known before it is read. By default it is not.
    fn length(&self, _path: &Path) -> Option<u64> {
        None
    }

    /// The identities of the file at a path, whether it exists or not: two paths with a common identity refer to the
    /// same file. By default, a file is identified by its path.
    fn identities(&self, path: &Path) -> Vec<FileId> {
        vec![FileId::Path(path.to_owned())]
    }
}

/// Files that are read again and again, by whoever may want to.
pub type SharedFiles = Arc<dyn Files + Send + Sync>;

/// An identity of a file. A file may have several.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FileId {
    /// The path; on disk it is absolute, with all links resolved.
    Path(PathBuf),
    /// The file system's number of the file: equal for hard links, and for names in any case if case is ignored.
    Number {
        /// The file system.
        device: u64,
        /// The file on it (inode).
        file: u64,
    },
}

pub(crate) fn too_long(at: &Location, limit: u64) -> Error {
    Error::new(ErrorKind::Limit, at, format!("longer than the limit of {limit} bytes"))
        .hint("divide the file")
}

/// Files in memory, by path: for tests and for embedders without a disk.
#[derive(Clone, Debug, Default)]
pub struct Memory(pub HashMap<PathBuf, Vec<u8>>);

impl Files for Memory {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        let at = Location::file(path);
        let bytes = self.0.get(path).ok_or_else(|| Error::new(ErrorKind::Io, &at, "no such file"))?;
        if bytes.len() as u64 > limit { Err(too_long(&at, limit)) } else { Ok(bytes.clone()) }
    }

    fn length(&self, path: &Path) -> Option<u64> {
        self.0.get(path).map(|bytes| bytes.len() as u64)
    }
}

/// Pointers of Git LFS are shorter than this (its specification, version 1).
const LONGEST_POINTER: usize = 1024;

/// The context of a load: file access, limits, memory, import options and warnings.
pub struct LoadContext<'a> {
    /// File access.
    pub files: &'a dyn Files,
    /// The limits.
    pub limits: Limits,
    /// The memory for all that is read.
    pub budget: Budget,
    /// The memory of what was read and stays.
    pub kept: Vec<Reservation>,
    /// The warnings so far.
    pub warnings: Vec<Warning>,
    /// Import options for files with several animations, variants, scenes or cameras.
    pub import: ImportOptions,
    /// Values for the variables of the scene.
    pub variables: Variables,
}

/// Import options: the animation, material variant, scene and camera of a file that has several, and subdivision.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// The animation, by name or number from 0, that poses the model; `None` is the first animation if `at` is given, and
    /// else the pose at rest.
    pub animation: Option<String>,
    /// The time in seconds from the beginning of all animations, of models and of a scene in our own format; `None` is 0.
    pub at: Option<f64>,
    /// The time that the shutter is open, in frames (of [`Variables::fps`]), from `at` on: what moves is blurred. `None` is that of
    /// the scene's camera.
    pub shutter: Option<f64>,
    /// The material variant, by name or number from 0.
    pub variant: Option<String>,
    /// The scene, by name or number from 0.
    pub scene: Option<String>,
    /// The camera.
    pub camera: CameraChoice,
    /// Levels of subdivision of meshes into Catmull–Clark surfaces, up to [`MOST_LEVELS`](crate::subdivision::MOST_LEVELS); 0
    /// leaves them as they are.
    pub subdivision: u32,
    /// Whether area lights in the objects of pbrt's scenes emit light, each instance on its own. In pbrt they do not.
    pub instanced_lights: bool,
}

impl ImportOptions {
    /// The warning about a time without an animation.
    pub(crate) const AT_REST: &str = "a time is given, but the file has no animations: it is at rest";
}

/// The selection of one of a file's cameras.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum CameraChoice {
    /// The first of the scene, if there is one.
    #[default]
    First,
    /// The one with this name, or with this number from 0.
    Named(String),
    /// No camera of the file: the scene is framed automatically, whatever its format.
    None,
}

impl<'a> LoadContext<'a> {
    /// A context over `files` with the default limits and the budget of this machine.
    pub fn new(files: &'a dyn Files) -> Self {
        Self::within(&Budget::default(), files)
    }

    /// A context over `files` with the default limits and this budget.
    pub fn within(budget: &Budget, files: &'a dyn Files) -> Self {
        Self {
            files,
            limits: Limits::default(),
            budget: budget.clone(),
            kept: Vec::new(),
            warnings: Vec::new(),
            import: ImportOptions::default(),
            variables: Variables::default(),
        }
    }

    /// The whole content of a file within the limits, in memory that is reserved while it is used.
    ///
    /// # Errors
    /// `Io` when it cannot be read, or is a pointer of Git LFS to a file that is elsewhere; `Limit` when it is too long.
    pub fn read(&self, path: &Path) -> Result<Reserved<Vec<u8>>> {
        const WHAT: &str = "the file";
        let at = Location::file(path);
        let length = self.files.length(path).filter(|&length| length <= self.limits.file_bytes);
        let ahead = length.map(|length| self.budget.reserve(length, WHAT, &at)).transpose()?;
        let most = length.unwrap_or_else(|| self.limits.file_bytes.min(self.budget.left()));
        let bytes = match self.files.read(path, self.limits.file_bytes.min(most)) {
            Err(error) if error.kind == ErrorKind::Limit && most < self.limits.file_bytes => {
                // Longer than it was, or than there is memory.
                self.budget.reserve(most.saturating_add(1), WHAT, &at)?;
                return Err(error);
            }
            read => read?,
        };
        let memory = match ahead {
            Some(memory) => memory,
            None => self.budget.reserve(bytes.len() as u64, WHAT, &at)?,
        };
        if bytes.len() < LONGEST_POINTER && bytes.starts_with(b"version https://git-lfs") {
            let message = "this is a pointer of Git LFS, not the file itself";
            return Err(Error::new(ErrorKind::Io, &Location::file(path), message)
                .hint("`git lfs pull` brings the file"));
        }
        Ok(Reserved::new(bytes, memory))
    }

    /// Counts memory of what stays, after the fact or before.
    ///
    /// # Errors
    /// `Limit` if there is not so much left.
    pub fn keep(&mut self, bytes: u64, what: &str, at: &Location) -> Result<()> {
        let memory = self.budget.reserve(bytes, what, at)?;
        match self.kept.last_mut() {
            Some(last) => last.join(memory),
            None => self.kept.push(memory),
        }
        Ok(())
    }

    /// Adds a warning: reading continues, but the picture may differ from the intended one.
    pub fn warn(&mut self, at: &Location, message: impl Into<String>) {
        self.warnings.push(Warning::new(at, message));
    }

    /// Adds a note: a harmless warning, the picture is the intended one.
    pub fn notice(&mut self, at: &Location, message: impl Into<String>) {
        self.warnings.push(Warning::notice(at, message));
    }
}
