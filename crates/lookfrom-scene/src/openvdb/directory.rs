//! The header of a file, and its descriptions of grids: each stands before its grid.

use super::cursor::Cursor;
use super::values::Packing;
use crate::error::{ErrorKind, Result};
use crate::volume::bytes::Bytes;

/// Versions of the format: from maps of today's kinds on.
const VERSIONS: std::ops::RangeInclusive<u32> = 219..=226;
/// From this one on a file says whether its grids are packed, and from the next one on each grid says how.
const PACKING_OF_FILE: u32 = 220;
const PACKING_OF_GRID: u32 = 222;

/// Bytes of the magic number, of the version of the library, and of the identity of the file.
const MAGIC: u64 = 8;
const LIBRARY: u64 = 8;
const IDENTITY: u64 = 36;

/// Stands between the name of a grid and its number among those with the same name.
const SEPARATOR: char = '\u{1e}';

/// A grid of a file.
pub(super) struct Descriptor {
    /// Its name and, if there are several of that name, its number after a separator.
    pub(super) unique: String,
    /// The name for people: `name[number]`.
    shown: String,
    /// The type of its tree.
    pub(super) tree: String,
    /// The unique name of the grid whose tree it has.
    pub(super) parent: Option<String>,
    /// Its position.
    pub(super) grid: u64,
}

impl Descriptor {
    /// The name that no other grid has.
    pub(super) fn name(&self) -> &str {
        &self.shown
    }

    /// The name that others may have as well.
    pub(super) fn base(&self) -> &str {
        self.unique.split(SEPARATOR).next().unwrap_or_default()
    }
}

/// The header of a file and the descriptors of its grids.
pub(super) struct Directory {
    /// The compression of all grids; `None` from version 222 on, where each grid has its own.
    pub(super) packing: Option<Packing>,
    /// The grids, in order.
    pub(super) entries: Vec<Descriptor>,
}

impl Directory {
    /// # Errors
    /// `Syntax` for what is no such file; `Unsupported` for other versions, and files without positions.
    pub(super) fn read(bytes: Bytes<'_>) -> Result<Self> {
        let mut cursor = Cursor::new(bytes, MAGIC);
        let version = cursor.u32()?;
        if !VERSIONS.contains(&version) {
            let message = format!("version {version} of OpenVDB's format, expected 219 to 226");
            let error = bytes.error(MAGIC, ErrorKind::Unsupported, message);
            return Err(error.hint("write the file again by a version from 1 to 13 of OpenVDB"));
        }
        cursor.slice(LIBRARY, "the version of the library")?;
        if cursor.u8()? == 0 {
            let error = cursor.error(ErrorKind::Unsupported, "a stream of grids without their positions");
            return Err(error.hint("`openvdb::io::File` writes files with positions"));
        }
        let packing = match version {
            PACKING_OF_GRID.. => None,
            PACKING_OF_FILE.. => Some(Packing::of_file(cursor.u8()? != 0)),
            _ => Some(Packing::of_file(true)),
        };
        cursor.slice(IDENTITY, "the identity of the file")?;
        cursor.metadata(|_, _, _| Ok(()))?;
        let mut entries = Vec::new();
        for _ in 0..cursor.u32()? {
            let mut text = |what| Ok(String::from_utf8_lossy(cursor.text(what)?).into_owned());
            let unique = text("the name of a grid")?;
            let tree = text("the type of a grid")?;
            let parent = Some(text("the name of a grid")?).filter(|parent| !parent.is_empty());
            let shown = match unique.split_once(SEPARATOR) {
                Some((name, number)) => format!("{name}[{number}]"),
                None => unique.clone(),
            };
            let [grid, _, end] = [cursor.i64()?, cursor.i64()?, cursor.i64()?].map(i64::cast_unsigned);
            if end < cursor.at || end > bytes.length() {
                return Err(cursor.damaged(format!("the grid {shown:?} ends at byte {end}")));
            }
            cursor.at = end;
            entries.push(Descriptor { unique, shown, tree, parent, grid });
        }
        Ok(Self { packing, entries })
    }
}
