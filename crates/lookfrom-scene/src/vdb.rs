//! Files of volumes, in NanoVDB's format or in OpenVDB's: which of the two a file has is told by its first bytes.

use std::path::Path;

use crate::error::{Error, Location, Result};
use crate::files::LoadContext;
use crate::nanovdb::NanoVdb;
use crate::openvdb::{self, OpenVdb};
use crate::suggest;
use crate::volume::{GridClass, Volume};

/// Reads the first grid with this name: a fog volume, or one of no class.
///
/// # Errors
/// `Io`; `Syntax` for what is no such file; `Invalid` if it has no such grid, or values that are not finite; `Unsupported` for grids of
/// other versions, types, classes, maps and compressions; `Limit` for too many cells, or too little memory.
pub fn read(path: &Path, name: &str, context: &mut LoadContext<'_>) -> Result<Volume> {
    let bytes = context.read(path)?;
    let at = Location::file(path);
    let file = VdbFile::new(&bytes, &at)?;
    file.volume(name, GridClass::Fog, context)?.ok_or_else(|| file.without(name))
}

/// Whether a content begins as a file of volumes.
pub(crate) fn is_vdb(bytes: &[u8]) -> bool {
    bytes.starts_with(openvdb::MAGIC) || bytes.starts_with(b"NanoVDB")
}

/// The content of a file.
pub struct VdbFile<'a> {
    at: &'a Location,
    format: VdbFormat<'a>,
}

enum VdbFormat<'a> {
    Nano(NanoVdb<'a>),
    Open(OpenVdb<'a>),
}

impl<'a> VdbFile<'a> {
    /// The name of the grid of densities, by custom.
    pub const DENSITY: &'static str = "density";

    /// The content of a file, of which the directory is read; `at` is for messages.
    ///
    /// # Errors
    /// As [`read`].
    pub fn new(bytes: &'a [u8], at: &'a Location) -> Result<Self> {
        if !is_vdb(bytes) {
            let error = Error::syntax(at, "the file is of neither NanoVDB nor OpenVDB");
            return Err(error.hint("files of volumes end in .nvdb or .vdb"));
        }
        let format = match bytes.starts_with(openvdb::MAGIC) {
            true => VdbFormat::Open(OpenVdb::new(bytes, at)?),
            false => VdbFormat::Nano(NanoVdb::new(bytes, at)?),
        };
        Ok(Self { at, format })
    }

    /// The first grid with this name, if there is one, which has to be of a class.
    ///
    /// # Errors
    /// As [`read`].
    pub fn volume(
        &self,
        name: &str,
        class: GridClass,
        context: &mut LoadContext<'_>,
    ) -> Result<Option<Volume>> {
        match &self.format {
            VdbFormat::Nano(file) => file.volume(name, class, context),
            VdbFormat::Open(file) => file.volume(name, class, context),
        }
    }

    /// The names of the grids.
    pub fn names(&self) -> Vec<&str> {
        match &self.format {
            VdbFormat::Nano(file) => file.names(),
            VdbFormat::Open(file) => file.names(),
        }
    }

    /// The names of the grids of a class.
    pub fn names_of(&self, class: GridClass) -> Vec<&str> {
        match &self.format {
            VdbFormat::Nano(file) => file.names_of(class),
            VdbFormat::Open(file) => file.names_of(class),
        }
    }

    /// The error that there is no grid with this name.
    pub fn without(&self, name: &str) -> Error {
        let names = self.names();
        let found: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
        let (found, advice) = match &*found {
            [] => ("no grids".to_owned(), "write the file again, with its grids"),
            found => (found.join(", "), "name one of these grids"),
        };
        let error = Error::invalid(self.at, format!("no grid is called {name:?}; found {found}"));
        match suggest::nearest(name, names) {
            Some(near) => error.hint(format!("did you mean {near:?}?")),
            None => error.hint(advice),
        }
    }
}
