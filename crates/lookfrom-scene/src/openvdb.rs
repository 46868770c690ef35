//! Reader for OpenVDB's files (Museth 2013, "VDB: High-Resolution Sparse Volumes with Dynamic Topology").
//!
//! Files with the versions 219 to 226 of the format (OpenVDB 1 to 13), of which one grid is read: a tree of `float`, `double` or `half`, the first two also
//! stored as `half`, that is a fog volume, a level set or of no class, with a linear map. The layout is that of `io/Archive.cc`, `io/Compression.h` and the
//! `readTopology` and `readBuffers` of `tree/`. Statistics are not read: bounds are those of the active values.

mod cursor;
mod directory;
mod map;
mod mask;
mod numbers;
mod tree;
mod values;

use glam::DMat4;

use self::cursor::Cursor;
use self::directory::{Descriptor, Directory};
use self::numbers::Precision;
use self::tree::OpenTree;
use self::values::Packing;
use crate::error::{Location, Result};
use crate::files::LoadContext;
use crate::volume::bytes::Bytes;
use crate::volume::{GridClass, Volume, cells};

/// The first bytes of a file.
pub(crate) const MAGIC: &[u8] = b" BDV\0\0\0\0";

/// The content of a file.
pub(crate) struct OpenVdb<'a> {
    at: &'a Location,
    bytes: Bytes<'a>,
    directory: Directory,
}

/// The header of a grid.
struct Prelude<'a> {
    packing: Packing,
    world_from_index: DMat4,
    /// The name of its class, and where that stands.
    class: (String, u64),
    /// At the tree.
    cursor: Cursor<'a>,
}

impl<'a> OpenVdb<'a> {
    /// The content of a file, of which the directory is read; `at` is for messages.
    ///
    /// # Errors
    /// `Syntax` for what is no such file; `Unsupported` for other versions.
    pub(crate) fn new(bytes: &'a [u8], at: &'a Location) -> Result<Self> {
        let bytes = Bytes::new(bytes, at, "");
        Ok(Self { at, bytes, directory: Directory::read(bytes)? })
    }

    /// The first grid with this name, if there is one. One of several with the same name is called `name[0]`, `name[1]` and so on.
    ///
    /// # Errors
    /// As [`vdb::read`](crate::vdb::read).
    pub(crate) fn volume(
        &self,
        name: &str,
        expected: GridClass,
        context: &mut LoadContext<'_>,
    ) -> Result<Option<Volume>> {
        let named = |entry: &&Descriptor| entry.name() == name;
        let entries = &self.directory.entries;
        let entry = entries.iter().find(named);
        let Some(entry) = entry.or_else(|| entries.iter().find(|entry| entry.base() == name)) else {
            return Ok(None);
        };
        let mut precision = Precision::of(&entry.tree, self.bytes, entry.grid)?;
        let Prelude { mut packing, world_from_index, class, mut cursor } = self.prelude(entry)?;
        expected.check(&class.0, self.bytes, class.1)?;
        if let Some(parent) = &entry.parent {
            // Its tree is that of another grid.
            let parent = entries.iter().find(|entry| entry.unique == *parent).ok_or_else(|| {
                let message = format!("the grid {name:?} has the tree of another one, which is not there");
                cursor.damaged(message)
            })?;
            precision = Precision::of(&parent.tree, self.bytes, parent.grid)?;
            Prelude { packing, cursor, .. } = self.prelude(parent)?;
        }
        let mut tree = OpenTree::new(cursor, packing, precision, context, self.at)?;
        let OpenTree { nodes, masks, values, cursor, .. } = &mut tree;
        let read = |leaf: usize| values.read_leaf(cursor, masks[leaf]);
        let (grid, first) = cells::grid(nodes, read, context, self.at)?;
        Ok(Some(Volume { grid, first, world_from_index, bounds: nodes.bounds }))
    }

    /// The names of the grids.
    pub(crate) fn names(&self) -> Vec<&str> {
        self.directory.entries.iter().map(Descriptor::name).collect()
    }

    /// The names of the grids of a class, as far as they can be read.
    pub(crate) fn names_of(&self, class: GridClass) -> Vec<&str> {
        let is_of = |entry: &&Descriptor| {
            self.prelude(entry).is_ok_and(|prelude| GridClass::of_name(&prelude.class.0) == Some(class))
        };
        self.directory.entries.iter().filter(is_of).map(Descriptor::name).collect()
    }

    /// Reads what stands before a tree.
    fn prelude(&self, entry: &Descriptor) -> Result<Prelude<'a>> {
        let mut cursor = Cursor::new(self.bytes, entry.grid);
        let packing = match self.directory.packing {
            Some(packing) => packing,
            None => Packing::read(&mut cursor)?,
        };
        let mut class = ("unknown".to_owned(), entry.grid);
        cursor.metadata(|name, at, value| {
            if name == b"class" {
                class = (String::from_utf8_lossy(value).into_owned(), at);
            }
            Ok(())
        })?;
        let world_from_index = map::read(&mut cursor)?;
        Ok(Prelude { packing, world_from_index, class, cursor })
    }
}
