//! Reader for KTX 2.0 files, in Basis Universal formats (ETC1S, UASTC) and uncompressed (Khronos, "KTX File Format
//! Specification", version 2.0, 2021).
//!
//! Only the first image is read, without its mipmaps. Whether it is sRGB-encoded is decided by the caller. `basis` decodes
//! Basis Universal's formats; other GPU formats (BC7, ASTC …) are not supported.

use std::io::Read;

use super::basis;
use super::read::{check_size, room};
use crate::budget::Reservation;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;

/// Length of the header before the list of levels, in bytes.
const HEADER: usize = 80;

const NOT_WHOLE: &str = "check that the file is whole; writing it again may repair it";

/// Supercompression schemes.
const PLAIN: u32 = 0;
const BASIS_LZ: u32 = 1;
const ZSTANDARD: u32 = 2;
const ZLIB: u32 = 3;

/// Colour models of the data format descriptor.
const ETC1S: u8 = 163;
const UASTC: u8 = 166;

/// A decoded image.
#[derive(Debug)]
pub(super) struct Pixels {
    pub(super) width: u32,
    pub(super) height: u32,
    /// Row by row from the top: red, green, blue, alpha.
    pub(super) texels: Vec<[u8; 4]>,
    /// The memory in which it was decoded.
    pub(super) memory: Reservation,
}

/// The header of a file.
struct Header {
    /// The `VkFormat`; 0 for Basis Universal.
    format: u32,
    width: u32,
    height: u32,
    packing: u32,
    /// The number of images: layers × faces × levels.
    images: usize,
    descriptor: std::ops::Range<usize>,
    /// The supercompression global data.
    shared: std::ops::Range<usize>,
    /// The bytes of the first level.
    level: std::ops::Range<usize>,
    /// Uncompressed length of the first level in bytes.
    unpacked: u64,
}

/// Decodes a file that starts with [`KTX2_MAGIC`](super::read::KTX2_MAGIC).
///
/// # Errors
/// `Syntax` if it is damaged or cut off, `Unsupported` for other formats, `Limit` for more than [`crate::Limits::texels`] or there is memory for.
pub(super) fn decode(bytes: &[u8], at: &Location, context: &LoadContext<'_>) -> Result<Pixels> {
    let header = header(bytes, at)?;
    let Header { format, width, height, packing, .. } = header;
    check_size(u64::from(width), u64::from(height), at, &context.limits)?;
    // Not more than five bytes for a texel before it is transcoded, or as it is.
    let memory = room([width, height], 9, at, context)?;
    let texels = match format {
        0 => basis(bytes, &header, at)?,
        _ => plain(bytes, &header, at)?,
    };
    if texels.len() as u64 != u64::from(width) * u64::from(height) {
        let message = format!("format {format}, packed by {packing}, gives {} texels", texels.len());
        return Err(Error::syntax(at, message).hint(NOT_WHOLE));
    }
    Ok(Pixels { width, height, texels, memory })
}

fn header(bytes: &[u8], at: &Location) -> Result<Header> {
    let short = || Error::syntax(at, "the KTX 2 file is cut off").hint(NOT_WHOLE);
    let field = |offset: usize| {
        let bytes = bytes.get(offset..offset + 4)?;
        Some(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    };
    let long = |offset: usize| Some(u64::from(field(offset)?) | u64::from(field(offset + 4)?) << 32);
    let within = |offset: u64, length: u64| {
        let end = usize::try_from(offset.checked_add(length)?).ok()?;
        (end <= bytes.len()).then_some(offset as usize..end)
    };
    let read = || {
        // Keys and values are not read, but must lie within the file.
        within(u64::from(field(56)?), u64::from(field(60)?))?;
        let counts = [field(32)?, field(36)?, field(40)?];
        Some(Header {
            images: counts.iter().fold(1, |images, &count| images.saturating_mul(count.max(1) as usize)),
            descriptor: within(u64::from(field(48)?), u64::from(field(52)?))?,
            shared: within(long(64)?, long(72)?)?,
            format: field(12)?,
            width: field(20)?,
            height: field(24)?.max(1),
            packing: field(44)?,
            level: within(long(HEADER)?, long(HEADER + 8)?)?,
            unpacked: long(HEADER + 16)?,
        })
    };
    let header = read().ok_or_else(short)?;
    if field(28).ok_or_else(short)? > 1 {
        return Err(Error::new(
            ErrorKind::Unsupported,
            at,
            "a KTX 2 file of a 3D texture; expected a 2D texture",
        ));
    }
    Ok(header)
}

/// The uncompressed bytes of the first level, which must have the length `expected`.
fn unpacked(bytes: &[u8], header: &Header, expected: u64, at: &Location) -> Result<Vec<u8>> {
    let packed = &bytes[header.level.clone()];
    let bad = |what: String| Error::syntax(at, what).hint(NOT_WHOLE);
    let mut level = Vec::new();
    let most = expected.saturating_add(1);
    match header.packing {
        PLAIN => level.extend_from_slice(packed),
        ZSTANDARD => {
            ruzstd::decoding::StreamingDecoder::new(packed)
                .map_err(|error| bad(format!("its Zstandard stream is damaged: {error}")))?
                .take(most)
                .read_to_end(&mut level)
                .map_err(|error| bad(format!("its Zstandard stream is damaged: {error}")))?;
        }
        ZLIB => {
            flate2::read::ZlibDecoder::new(packed)
                .take(most)
                .read_to_end(&mut level)
                .map_err(|error| bad(format!("its zlib stream is damaged: {error}")))?;
        }
        other => {
            let message = format!("its supercompression {other} is not known");
            return Err(
                Error::new(ErrorKind::Unsupported, at, message).hint("use BasisLZ, Zstandard or none")
            );
        }
    }
    if level.len() as u64 != expected {
        let message = format!(
            "its first level should have {expected} bytes, and has {} (its header says {})",
            level.len(),
            header.unpacked
        );
        return Err(bad(message));
    }
    Ok(level)
}

/// Uncompressed formats of one to four bytes per texel.
fn plain(bytes: &[u8], header: &Header, at: &Location) -> Result<Vec<[u8; 4]>> {
    // The values of `VkFormat` with 8 bits per channel, linear and sRGB.
    let (size, is_reversed) = match header.format {
        9 | 15 => (1, false),
        16 | 22 => (2, false),
        23 | 29 => (3, false),
        30 | 36 => (3, true),
        37 | 43 => (4, false),
        44 | 50 => (4, true),
        other => {
            let message = format!("the Vulkan format {other} in KTX 2 is not supported");
            return Err(Error::new(ErrorKind::Unsupported, at, message)
                .hint("write it as Basis Universal (ETC1S, UASTC), as PNG or as WebP"));
        }
    };
    let expected = u64::from(header.width) * u64::from(header.height) * size as u64;
    let level = unpacked(bytes, header, expected, at)?;
    let texel = |bytes: &[u8]| {
        let channel = |index: usize| bytes.get(index).copied();
        let [r, g, b] = [0, 1, 2].map(|index| channel(index).unwrap_or(0));
        let alpha = channel(3).unwrap_or(255);
        if is_reversed { [b, g, r, alpha] } else { [r, g, b, alpha] }
    };
    Ok(level.chunks_exact(size).map(texel).collect())
}

/// Basis Universal: ETC1S and UASTC.
fn basis(bytes: &[u8], header: &Header, at: &Location) -> Result<Vec<[u8; 4]>> {
    let size = [header.width, header.height].map(|length| length as usize);
    let texels = match (bytes[header.descriptor.clone()].get(12), header.packing) {
        (Some(&ETC1S), BASIS_LZ) => {
            basis::etc1s(&bytes[header.shared.clone()], &bytes[header.level.clone()], header.images, size)
        }
        // The level may contain several images: layers and faces.
        (Some(&UASTC), PLAIN) => basis::uastc(&bytes[header.level.clone()], size),
        (Some(&UASTC), _) => {
            let [columns, rows] = size.map(|length| length.div_ceil(4) as u64);
            let level = unpacked(bytes, header, basis::BLOCK as u64 * columns * rows, at)?;
            basis::uastc(&level, size)
        }
        (model, packing) => {
            let model = model.map_or("no colour model".to_owned(), |model| format!("colour model {model}"));
            let message = format!("KTX 2 with {model} and supercompression {packing} is not supported");
            return Err(Error::new(ErrorKind::Unsupported, at, message)
                .hint("write it as Basis Universal's ETC1S or UASTC, as PNG or as WebP"));
        }
    };
    texels.map_err(|damage| {
        Error::syntax(at, format!("the Basis Universal picture is damaged: {damage}")).hint(NOT_WHOLE)
    })
}

#[cfg(test)]
mod tests;
