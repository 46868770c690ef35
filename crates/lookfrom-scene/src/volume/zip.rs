//! Streams of zlib (RFC 1950) of a known length.

use super::bytes::Bytes;
use crate::error::{ErrorKind, Result};

/// Unpacks a stream to as many bytes as there is room for.
///
/// # Errors
/// `Syntax` if it is damaged, or has more or fewer.
pub(crate) fn unpack(packed: Bytes<'_>, into: &mut [u8]) -> Result<()> {
    let stream = packed.slice(0, packed.length(), "a stream of zlib")?;
    let damaged = |message: String| {
        let error = packed.error(0, ErrorKind::Syntax, message);
        error.hint("the file may be damaged: write it again")
    };
    let length = into.len();
    match miniz_oxide::inflate::decompress_slice_iter_to_slice(into, [stream].into_iter(), true, false) {
        Ok(count) if count == length => Ok(()),
        Ok(count) => Err(damaged(format!("a stream of zlib with {count} bytes, expected {length}"))),
        Err(status) => Err(damaged(format!("a stream of zlib that cannot be unpacked: {status:?}"))),
    }
}
