//! Segments of files: which grids there are, where, and how they are compressed.

use std::borrow::Cow;

use super::header::check_version;
use crate::budget::{Budget, Reserved};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::volume::bytes::Bytes;
use crate::volume::{blosc, zip};

/// The first bytes of a segment.
const MAGICS: [&[u8]; 2] = [b"NanoVDB0", b"NanoVDB2"];
/// The first bytes of a grid without a segment, from version 32.6 on.
const RAW: &[u8] = b"NanoVDB1";

/// Bytes of the header of a segment.
const SEGMENT: u64 = 16;
/// Bytes of what a segment tells of a grid, before its name.
const METADATA: u64 = 176;
/// Bytes of the length that stands before what is packed.
const PACKED: u64 = 8;
/// Offset of the class in it (`FileMetaData::gridClass`).
const CLASS: u64 = 36;

/// A grid of a file.
pub(super) struct Entry<'a> {
    pub(super) name: String,
    /// The number of its class.
    pub(super) class: u32,
    codec: u16,
    /// Bytes when it is unpacked.
    size: u64,
    stored: Bytes<'a>,
}

/// All grids of a file, in order.
pub(super) fn entries(bytes: Bytes<'_>) -> Result<Vec<Entry<'_>>> {
    let (mut entries, mut at) = (Vec::new(), 0);
    while at < bytes.length() || entries.is_empty() {
        let magic = bytes.slice(at, 8, "the header of a segment")?;
        if !MAGICS.contains(&magic) {
            return Err(no_segment(bytes, at, magic));
        }
        check_version(bytes, at + 8)?;
        let (count, codec) = (bytes.u16(at + 12)?, bytes.u16(at + 14)?);
        at += SEGMENT;
        let mut grids = Vec::new();
        for _ in 0..count {
            bytes.slice(at, METADATA, "the description of a grid")?;
            let [size, stored] = [bytes.u64(at)?, bytes.u64(at + 8)?];
            let length = u64::from(bytes.u32(at + 136)?);
            let name = bytes.slice(at + METADATA, length, "the name of a grid")?;
            let name = name.split(|&byte| byte == 0).next().unwrap_or_default();
            grids.push((String::from_utf8_lossy(name).into_owned(), bytes.u32(at + CLASS)?, size, stored));
            at += METADATA + length;
        }
        for (name, class, size, mut length) in grids {
            if matches!(codec, 1 | 2) {
                // Warp's writer does not count the eight bytes before what is packed.
                length = length.max(bytes.u64(at)?.saturating_add(PACKED));
            }
            let stored = bytes.part(at, length, &format!("the grid {name:?}"))?;
            entries.push(Entry { name, class, codec, size, stored });
            at += length;
        }
        if count == 0 {
            return Err(bytes.error(at, ErrorKind::Syntax, "a segment without grids"));
        }
    }
    Ok(entries)
}

fn no_segment(bytes: Bytes<'_>, at: u64, magic: &[u8]) -> Error {
    let unsupported = |message| bytes.error(at, ErrorKind::Unsupported, message);
    if at == 0 && magic == RAW {
        return unsupported("a grid without a segment around it")
            .hint("`nanovdb::io::writeGrid` writes files of segments");
    }
    bytes.error(at, ErrorKind::Syntax, "expected a segment, which begins with `NanoVDB0` or `NanoVDB2`")
}

impl<'a> Entry<'a> {
    /// The bytes of the grid.
    pub(super) fn unpacked(&self, at: &Location, budget: &Budget) -> Result<Reserved<Cow<'a, [u8]>>> {
        if self.codec == 0 {
            let grid = self.stored.slice(0, self.size, &format!("the grid {:?}", self.name))?;
            return Ok(Cow::Borrowed(grid).into());
        }
        let unpack = match self.codec {
            1 => zip::unpack,
            2 => blosc::unpack,
            codec => {
                let message = format!(
                    "the grid {:?} is compressed by the unknown codec {codec}, expected ZIP, BLOSC or none",
                    self.name
                );
                let error = Error::new(ErrorKind::Unsupported, at, message);
                return Err(error.hint("write it again with the codec BLOSC, ZIP or NONE of NanoVDB"));
            }
        };
        let memory = budget.reserve(self.size, "the unpacked grid", at)?;
        let mut unpacked = vec![0; self.size as usize];
        let (mut room, mut at) = (&mut *unpacked, 0);
        // One stream of zlib, or chunks of Blosc of a gibibyte each.
        while !room.is_empty() {
            let packed = self.stored.part(at + PACKED, self.stored.u64(at)?, "the packed grid")?;
            let size = if self.codec == 1 { self.size } else { blosc::length(packed)? };
            let (into, rest) = room.split_at_mut_checked(size as usize).ok_or_else(|| {
                let message = format!("the grid {:?} has more than {} bytes", self.name, self.size);
                self.stored.error(at, ErrorKind::Syntax, message)
            })?;
            unpack(packed, into)?;
            room = rest;
            at += PACKED + packed.length();
        }
        Ok(Reserved::new(unpacked.into(), memory))
    }
}
