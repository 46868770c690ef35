//! Reader for NanoVDB files (Museth 2021, "NanoVDB: A GPU-Friendly and Portable VDB Data Structure For Real-Time Rendering And
//! Simulation").
//!
//! Files of segments with grids of version 32 of the format, of `float` or quantised (`Fp4`, `Fp8`, `Fp16`, `FpN`), that are fog volumes, level sets or of no
//! class. Offsets are those of `PNanoVDB.h`. Checksums and statistics are not read.

mod directory;
mod header;
mod leaf;
mod tree;

use self::directory::Entry;
use self::header::{Header, class_name};
use self::tree::Tree;
use crate::error::{Location, Result};
use crate::files::LoadContext;
use crate::volume::bytes::Bytes;
use crate::volume::{GridClass, Volume, cells};

/// The content of a file.
pub(crate) struct NanoVdb<'a> {
    at: &'a Location,
    entries: Vec<Entry<'a>>,
}

impl<'a> NanoVdb<'a> {
    /// The content of a file, of which the directory is read; `at` is for messages.
    ///
    /// # Errors
    /// `Syntax` for what is no such file; `Unsupported` for other versions.
    pub(crate) fn new(bytes: &'a [u8], at: &'a Location) -> Result<Self> {
        let entries = directory::entries(Bytes::new(bytes, at, ""))?;
        Ok(Self { at, entries })
    }

    /// The first grid with this name, if there is one.
    ///
    /// # Errors
    /// As [`vdb::read`](crate::vdb::read).
    pub(crate) fn volume(
        &self,
        name: &str,
        class: GridClass,
        context: &mut LoadContext<'_>,
    ) -> Result<Option<Volume>> {
        let Some(entry) = self.entries.iter().find(|entry| entry.name == name) else { return Ok(None) };
        let unpacked = entry.unpacked(self.at, &context.budget)?;
        let bytes = Bytes::new(&unpacked, self.at, " of the grid");
        let header = Header::new(bytes, class)?;
        let Tree { nodes, leaves, kind, .. } = Tree::new(bytes, header.kind)?;
        let (grid, first) = cells::grid(&nodes, |leaf| Ok(kind.values(leaves[leaf])), context, self.at)?;
        Ok(Some(Volume { grid, first, world_from_index: header.world_from_index, bounds: nodes.bounds }))
    }

    /// The names of the grids.
    pub(crate) fn names(&self) -> Vec<&str> {
        self.entries.iter().map(|entry| &*entry.name).collect()
    }

    /// The names of the grids of a class.
    pub(crate) fn names_of(&self, class: GridClass) -> Vec<&str> {
        let is_of = |entry: &&Entry<'_>| GridClass::of_name(&class_name(entry.class)) == Some(class);
        self.entries.iter().filter(is_of).map(|entry| &*entry.name).collect()
    }
}
