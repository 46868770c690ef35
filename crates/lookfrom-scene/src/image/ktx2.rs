//! What does a KTX 2.0 file show: Basis Universal's formats (ETC1S, UASTC), and bytes as they are (Khronos, "KTX File
//! Format Specification", version 2.0, 2021)?
//!
//! Only the first picture is read, without its smaller versions. Whether its bytes are colours by the sRGB curve, those
//! who use it know. The crate `basisu` unpacks Basis Universal's formats; without the feature `basis` they are not read.
//! Formats of graphics cards other than these (BC7, ASTC …) are not, either.

use std::io::Read;

use super::read::check_size;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::Limits;

/// The first bytes of every file.
pub(super) const MAGIC: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";

/// Bytes of the header before the list of levels, and of one entry of that.
const HEADER: usize = 80;
const LEVEL: usize = 24;

const NOT_WHOLE: &str = "check that the file is whole; writing it again may repair it";

/// How the bytes of the first level are packed.
const PLAIN: u32 = 0;
const BASIS_LZ: u32 = 1;
const ZSTANDARD: u32 = 2;
const ZLIB: u32 = 3;

/// A decoded picture.
#[derive(Debug)]
pub(super) struct Pixels {
    pub(super) width: u32,
    pub(super) height: u32,
    /// Row by row from the top: red, green, blue, opacity.
    pub(super) texels: Vec<[u8; 4]>,
}

/// What a file says of itself.
struct Header {
    /// Vulkan's number of the format; 0 where Basis Universal is meant.
    format: u32,
    width: u32,
    height: u32,
    packing: u32,
    /// Of the first level.
    level: std::ops::Range<usize>,
    /// Bytes of that once it is unpacked.
    unpacked: u64,
}

/// Decodes a file that starts with [`MAGIC`].
///
/// # Errors
/// `Syntax` where it is not whole, `Unsupported` for other formats, `Limit` for more than [`Limits::texels`].
pub(super) fn decode(bytes: &[u8], at: &Location, limits: &Limits) -> Result<Pixels> {
    let header = header(bytes, at)?;
    let Header { format, width, height, packing, .. } = header;
    check_size(u64::from(width), u64::from(height), at, limits)?;
    let texels = match format {
        0 => basis(bytes, &header, at)?,
        _ => plain(bytes, &header, at)?,
    };
    if texels.len() as u64 != u64::from(width) * u64::from(height) {
        let message = format!("format {format}, packed by {packing}, gives {} texels", texels.len());
        return Err(Error::syntax(at, message).hint(NOT_WHOLE));
    }
    Ok(Pixels { width, height, texels })
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
        // Besides the first level: descriptor, keys and values, and what all levels share must be there.
        within(u64::from(field(48)?), u64::from(field(52)?))?;
        within(u64::from(field(56)?), u64::from(field(60)?))?;
        within(long(64)?, long(72)?)?;
        Some(Header {
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
        return Err(Error::new(ErrorKind::Unsupported, at, "a KTX 2 file of a solid, not of a picture"));
    }
    Ok(header)
}

/// The bytes of the first level, of which there must be `expected`.
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
            "its first level should have {expected} bytes, and has {} (it says {})",
            level.len(),
            header.unpacked
        );
        return Err(bad(message));
    }
    Ok(level)
}

/// Texels of one to four bytes.
fn plain(bytes: &[u8], header: &Header, at: &Location) -> Result<Vec<[u8; 4]>> {
    // Vulkan's formats of 8 bits a channel, linear and sRGB.
    let (size, is_reversed) = match header.format {
        9 | 15 => (1, false),
        16 | 22 => (2, false),
        23 | 29 => (3, false),
        30 | 36 => (3, true),
        37 | 43 => (4, false),
        44 | 50 => (4, true),
        other => {
            let message = format!("Vulkan's format {other} in KTX 2 is not read");
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

/// ETC1S, UASTC and their kin.
#[cfg(feature = "basis")]
fn basis(bytes: &[u8], header: &Header, at: &Location) -> Result<Vec<[u8; 4]>> {
    use basisu::{DecodeFlags, TargetFormat, Transcoder};

    let whole: Vec<u8>;
    let bytes = match header.packing {
        PLAIN | BASIS_LZ => bytes,
        // What is packed as a whole is unpacked here, within limits.
        _ => {
            let blocks = |length: u32| u64::from(length.div_ceil(4));
            let level = unpacked(bytes, header, 16 * blocks(header.width) * blocks(header.height), at)?;
            whole = alone(bytes, &level);
            &whole
        }
    };
    // The crate's arithmetic on damaged files may overflow or leave its slices; a panic of it is such a file's fault,
    // leaves nothing of ours half done, and must not take down whoever asked.
    let transcode = || Transcoder::new(bytes)?.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE);
    match std::panic::catch_unwind(transcode) {
        Ok(Ok(texels)) => Ok(texels.as_chunks().0.to_vec()),
        Ok(Err(error)) => {
            Err(Error::syntax(at, format!("the Basis Universal picture cannot be decoded: {error:?}"))
                .hint(NOT_WHOLE))
        }
        Err(_) => Err(Error::syntax(at, "the Basis Universal picture is damaged").hint(NOT_WHOLE)),
    }
}

/// Nothing can be decoded without the feature.
#[cfg(not(feature = "basis"))]
fn basis(_: &[u8], _: &Header, at: &Location) -> Result<Vec<[u8; 4]>> {
    Err(Error::new(ErrorKind::Unsupported, at, "compressed by Basis Universal, which this build cannot read")
        .hint("build with the feature `basis`, or write the picture as PNG or WebP"))
}

/// The same file with nothing but its first level, which is not packed, and its descriptor.
#[cfg(feature = "basis")]
fn alone(bytes: &[u8], level: &[u8]) -> Vec<u8> {
    let field = |offset: usize| {
        let field: [u8; 4] = std::array::from_fn(|i| bytes[offset + i]);
        u32::from_le_bytes(field) as usize
    };
    let descriptor = &bytes[field(48)..][..field(52)];
    let mut file = bytes[..HEADER + LEVEL].to_vec();
    let mut put = |offset: usize, value: u64, size: usize| {
        file[offset..offset + size].copy_from_slice(&value.to_le_bytes()[..size]);
    };
    let start = (HEADER + LEVEL + descriptor.len()).next_multiple_of(16);
    put(40, 1, 4);
    put(44, u64::from(PLAIN), 4);
    put(48, (HEADER + LEVEL) as u64, 4);
    // No keys and values, nothing shared.
    put(56, 0, 8);
    put(64, 0, 8);
    put(72, 0, 8);
    put(HEADER, start as u64, 8);
    put(HEADER + 8, level.len() as u64, 8);
    put(HEADER + 16, level.len() as u64, 8);
    file.extend_from_slice(descriptor);
    file.resize(start, 0);
    file.extend_from_slice(level);
    file
}

#[cfg(test)]
mod tests;
