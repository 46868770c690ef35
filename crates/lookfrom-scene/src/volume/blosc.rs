//! Chunks of Blosc, as `README_HEADER.rst` and `blosc.c` of c-blosc 1.21 define them: blocks of a fixed length, each by LZ4 or
//! zlib, in one part or in one for each byte of a number, shuffled or not.
//!
//! NanoVDB and OpenVDB write LZ4 and shuffled bytes. Bits are not unshuffled, and BloscLZ, Snappy and Zstandard not unpacked.

use super::bytes::Bytes;
use super::zip;
use crate::error::{Error, ErrorKind, Result};

/// Bytes of the header of a chunk.
const HEADER: u64 = 16;

/// Bits of the flags.
const SHUFFLED: u8 = 1;
const STORED: u8 = 2;
const BITS_SHUFFLED: u8 = 4;
const WHOLE: u8 = 16;

/// The last version of the format of chunks: later ones are of Blosc 2.
const VERSION: u8 = 2;

/// Names of the codecs, by their numbers in the flags.
const CODECS: [&str; 8] = [
    "BloscLZ",
    "LZ4",
    "Snappy",
    "zlib",
    "Zstandard",
    "an unknown codec",
    "an unknown codec",
    "an unknown codec",
];

/// Numbers are divided into bytes if they have at most this many.
const MOST_PARTS: usize = 16;

/// Blocks are divided if their parts have at least this many bytes.
const LEAST_PART: usize = 128;

/// Longest block: c-blosc chooses at most a fourth of this.
const LONGEST_BLOCK: usize = 1 << 24;

/// The number of bytes that a chunk unpacks to, so far as its header tells.
///
/// # Errors
/// `Syntax` if it has no header.
pub(crate) fn length(chunk: Bytes<'_>) -> Result<u64> {
    chunk.slice(0, HEADER, "a chunk of Blosc")?;
    Ok(chunk.u32(4)?.into())
}

/// Unpacks a chunk to as many bytes as there is room for.
///
/// # Errors
/// `Syntax` if it is damaged, or has more or fewer; `Unsupported` for other codecs and filters.
pub(crate) fn unpack(chunk: Bytes<'_>, into: &mut [u8]) -> Result<()> {
    let found = length(chunk)?;
    if found != into.len() as u64 {
        let message = format!("a chunk of Blosc with {found} bytes, expected {}", into.len());
        return Err(damaged(chunk, 4, message));
    }
    let header = chunk.slice(0, HEADER, "a chunk of Blosc")?;
    let (version, flags, type_size) = (header[0], header[2], usize::from(header[3]));
    let unsupported = |at, what: &str| {
        let error =
            chunk.error(at, ErrorKind::Unsupported, format!("{what}, expected shuffled bytes by LZ4"));
        error.hint("write the file again by OpenVDB or NanoVDB")
    };
    if version > VERSION {
        return Err(unsupported(0, &format!("version {version} of Blosc's format")));
    }
    if flags & STORED != 0 {
        into.copy_from_slice(chunk.slice(HEADER, found, "a chunk of Blosc")?);
        return Ok(());
    }
    let codec = match flags >> 5 {
        1 => lz4,
        3 => zip::unpack,
        codec => return Err(unsupported(2, &format!("Blosc by {}", CODECS[usize::from(codec)]))),
    };
    if flags & BITS_SHUFFLED != 0 {
        return Err(unsupported(2, "Blosc with shuffled bits"));
    }
    let block = chunk.u32(8)? as usize;
    if block == 0 || block > LONGEST_BLOCK || type_size == 0 {
        let message = format!("blocks of {block} bytes and numbers of {type_size}");
        return Err(damaged(chunk, 3, message));
    }
    let is_divided = flags & WHOLE == 0 && type_size <= MOST_PARTS && block / type_size >= LEAST_PART;
    let starts = chunk.slice(HEADER, 4 * into.len().div_ceil(block) as u64, "the starts of blocks")?;
    let mut shuffled = Vec::new();
    for (into, start) in into.chunks_mut(block).zip(starts.as_chunks().0) {
        let start = u32::from_le_bytes(*start).into();
        // The last block is whole if it is shorter than the others.
        let parts = if is_divided && into.len() == block { type_size } else { 1 };
        if flags & SHUFFLED == 0 {
            unpack_block(chunk, start, into, parts, codec)?;
        } else {
            shuffled.resize(into.len(), 0);
            unpack_block(chunk, start, &mut shuffled, parts, codec)?;
            unshuffle(&shuffled, into, type_size);
        }
    }
    Ok(())
}

/// Unpacks the parts of a block, each of which follows its length; one that has not become shorter is stored.
fn unpack_block(
    chunk: Bytes<'_>,
    mut at: u64,
    into: &mut [u8],
    parts: usize,
    codec: fn(Bytes<'_>, &mut [u8]) -> Result<()>,
) -> Result<()> {
    if !into.len().is_multiple_of(parts) {
        return Err(damaged(chunk, 8, format!("blocks of {} bytes in {parts} parts", into.len())));
    }
    for part in into.chunks_mut(into.len() / parts) {
        let length = chunk.u32(at)?.into();
        let packed = chunk.part(at + 4, length, "a part of a block")?;
        if length == part.len() as u64 {
            part.copy_from_slice(packed.slice(0, length, "a part of a block")?);
        } else {
            codec(packed, part)?;
        }
        at += 4 + length;
    }
    Ok(())
}

/// Unpacks a block of LZ4 to as many bytes as there is room for.
fn lz4(packed: Bytes<'_>, into: &mut [u8]) -> Result<()> {
    let block = packed.slice(0, packed.length(), "a block of LZ4")?;
    let length = into.len();
    match lz4_flex::block::decompress_into(block, into) {
        Ok(count) if count == length => Ok(()),
        Ok(count) => Err(damaged(packed, 0, format!("a block of LZ4 with {count} bytes, expected {length}"))),
        Err(error) => Err(damaged(packed, 0, format!("a block of LZ4 that cannot be unpacked: {error}"))),
    }
}

/// Numbers of all first bytes, all second bytes and so on; what is less than a number at the end stays as it is.
fn unshuffle(shuffled: &[u8], into: &mut [u8], type_size: usize) {
    let count = into.len() / type_size;
    let (numbers, rest) = into.split_at_mut(count * type_size);
    for (index, number) in numbers.chunks_exact_mut(type_size).enumerate() {
        for (byte, into) in number.iter_mut().enumerate() {
            *into = shuffled[byte * count + index];
        }
    }
    rest.copy_from_slice(&shuffled[count * type_size..]);
}

fn damaged(chunk: Bytes<'_>, at: u64, message: String) -> Error {
    chunk.error(at, ErrorKind::Syntax, message).hint("the file may be damaged: write it again")
}

#[cfg(test)]
mod tests;
