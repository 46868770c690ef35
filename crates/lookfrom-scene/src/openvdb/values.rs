//! Arrays of the values of nodes, as `io/Compression.h` defines them: those that are not active may be left out, and the rest may be packed.

use super::cursor::Cursor;
use super::mask::NodeMask;
use super::numbers::{Precision, number};
use crate::error::{ErrorKind, Result};
use crate::grid::BLOCK;
use crate::volume::{blosc, zip};

/// Flags of a grid.
const ZIP: u32 = 1;
const ACTIVE_ALONE: u32 = 2;
const BLOSC: u32 = 4;

/// The code of values that are all there.
const ALL: u8 = 6;

/// Bytes of the place of a leaf.
const PLACE: u64 = 12;

/// The compression of a grid's arrays (`io/Compression.h`).
#[derive(Clone, Copy)]
pub(super) struct Packing {
    flags: u32,
    /// Whether the values of each node have a code. Without one, those of inner nodes are not there in the places of children, and
    /// leaves begin with their places and the number of their arrays, of which the first alone is of use.
    has_codes: bool,
}

impl Packing {
    /// That of all grids of a file before version 222.
    pub(super) fn of_file(is_zipped: bool) -> Self {
        Self { flags: if is_zipped { ZIP } else { 0 }, has_codes: false }
    }

    /// # Errors
    /// `Unsupported` for unknown ones.
    pub(super) fn read(cursor: &mut Cursor<'_>) -> Result<Self> {
        let flags = cursor.u32()?;
        if flags & !(ZIP | ACTIVE_ALONE | BLOSC) == 0 {
            return Ok(Self { flags, has_codes: true });
        }
        let message = format!("a grid that is compressed by unknown means (flags {flags:#x})");
        let error = cursor.bytes.error(cursor.at - 4, ErrorKind::Unsupported, message);
        Err(error.hint("write it again with the compression BLOSC, ZIP or NONE of OpenVDB"))
    }

    fn has(self, flag: u32) -> bool {
        self.flags & flag != 0
    }
}

/// Reader of the values of nodes.
pub(super) struct NodeValues {
    packing: Packing,
    precision: Precision,
    background: f32,
    /// The bytes of an array, unpacked.
    unpacked: Vec<u8>,
}

impl NodeValues {
    /// Reads the background, which comes first.
    pub(super) fn new(cursor: &mut Cursor<'_>, packing: Packing, precision: Precision) -> Result<Self> {
        let background = number(cursor.slice(precision.single, "the background")?);
        Ok(Self { packing, precision, background, unpacked: Vec::new() })
    }

    pub(super) fn background(&self) -> f32 {
        self.background
    }

    /// A single value.
    pub(super) fn single(&self, cursor: &mut Cursor<'_>) -> Result<f32> {
        Ok(number(cursor.slice(self.precision.single, "a value")?))
    }

    /// Reads the values of a leaf whose active ones are known.
    pub(super) fn read_leaf(
        &mut self,
        cursor: &mut Cursor<'_>,
        active: NodeMask<'_>,
    ) -> Result<[f32; BLOCK]> {
        cursor.slice(active.bytes(), "the mask of a leaf")?;
        let mut arrays = 1;
        if !self.packing.has_codes {
            cursor.slice(PLACE, "the place of a leaf")?;
            arrays = cursor.u8()?;
        }
        let mut numbers = [0.0; BLOCK];
        self.read(cursor, active, None, &mut numbers)?;
        for _ in 1..arrays {
            self.read(cursor, active, None, &mut [0.0; BLOCK])?;
        }
        Ok(numbers)
    }

    /// Reads the values of a node whose active ones are known, and whose children, if it is an inner one.
    pub(super) fn read(
        &mut self,
        cursor: &mut Cursor<'_>,
        active: NodeMask<'_>,
        children: Option<NodeMask<'_>>,
        into: &mut [f32],
    ) -> Result<()> {
        let code = if self.packing.has_codes { cursor.u8()? } else { ALL };
        // Those that are not active: one value, another where a mask says so.
        let mut others = [if code == 0 { self.background } else { -self.background }, self.background];
        match code {
            0 | 1 | 3 | ALL => {}
            2 | 4 => others[0] = self.single(cursor)?,
            5 => others = [self.single(cursor)?, self.single(cursor)?],
            _ => {
                cursor.at -= 1;
                return Err(
                    cursor.damaged(format!("values that are not active by the code {code}, expected 0 to 6"))
                );
            }
        }
        let selected = match code {
            3..=5 => Some(NodeMask(cursor.slice(active.bytes(), "the mask of a node")?)),
            _ => None,
        };
        let are_all = code == ALL || !self.packing.has(ACTIVE_ALONE);
        let gaps = children.filter(|_| !self.packing.has_codes);
        let is_there =
            |index: usize| (are_all || active.has(index)) && !gaps.is_some_and(|gaps| gaps.has(index));
        let count = (0..into.len()).filter(|index| is_there(*index)).count();
        let width = self.precision.array as usize;
        let mut numbers = self.array(cursor, count)?.chunks_exact(width).map(number);
        for (index, into) in into.iter_mut().enumerate() {
            let stored = if is_there(index) { numbers.next() } else { None };
            let other = || others[usize::from(selected.is_some_and(|mask| mask.has(index)))];
            *into = stored.unwrap_or_else(other);
        }
        Ok(())
    }

    /// The bytes of an array.
    fn array<'a, 'b: 'a>(&'a mut self, cursor: &mut Cursor<'b>, count: usize) -> Result<&'a [u8]> {
        let size = self.precision.array * count as u64;
        let is_packed = self.packing.has(ZIP | BLOSC);
        // Of none that would be halved nothing is written, of others a packed nothing.
        if !is_packed || (count == 0 && self.precision.array < self.precision.single) {
            return cursor.slice(size, "the values of a node");
        }
        let length = cursor.i64()?;
        let (is_stored, length) = (length <= 0, length.unsigned_abs());
        if is_stored {
            // It would not have become shorter.
            if length != size {
                return Err(cursor.damaged(format!("{length} bytes of values, expected {size}")));
            }
            return cursor.slice(size, "the values of a node");
        }
        let packed = cursor.bytes.part(cursor.at, length, "the values of a node")?;
        cursor.at += length;
        self.unpacked.clear();
        self.unpacked.resize(size as usize, 0);
        let unpack = if self.packing.has(BLOSC) { blosc::unpack } else { zip::unpack };
        unpack(packed, &mut self.unpacked)?;
        Ok(&self.unpacked)
    }
}
