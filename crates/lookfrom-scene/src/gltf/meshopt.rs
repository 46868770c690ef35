//! Decoder for compressed buffer views (`EXT_meshopt_compression`, `KHR_meshopt_compression`).
//!
//! Written from the specifications' appendices (Kapoulkine 2016–2026). Streams are untrusted input: every read is
//! checked, and the result grows only as far as the stream has been decoded. The bytes are interpreted by `accessor`.

mod attributes;
mod filter;
mod indices;

use super::json;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::Limits;

/// The compression mode of a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    /// Elements of any kind, as deltas of bytes.
    Attributes,
    /// Indices of a triangle list.
    Triangles,
    /// Indices of any topology.
    Indices,
}

/// The filter applied to decoded elements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Filter {
    /// No filter.
    #[default]
    None,
    /// Unit vectors from octahedral encoding.
    Octahedral,
    /// Unit quaternions stored without their largest component.
    Quaternion,
    /// Floats stored as mantissa and exponent.
    Exponential,
    /// Colours stored as luma and chroma.
    Color,
}

/// The extension's properties of a buffer view.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CompressedView {
    /// Number of elements.
    pub(crate) count: u64,
    /// Bytes per element.
    pub(crate) stride: u64,
    /// The compression mode.
    pub(crate) mode: Mode,
    /// The filter applied after decoding.
    pub(crate) filter: Filter,
}

impl CompressedView {
    /// The layout of a buffer view's extension.
    ///
    /// # Errors
    /// `Unsupported` for a mode or filter that is not known.
    pub(crate) fn new(said: &json::Meshopt, at: &Location) -> Result<Self> {
        let unknown = |what: &str, word: &str| {
            Error::new(ErrorKind::Unsupported, at, format!("the meshopt {what} {word:?} is not known"))
        };
        let mode = match said.mode.as_str() {
            "ATTRIBUTES" => Mode::Attributes,
            "TRIANGLES" => Mode::Triangles,
            "INDICES" => Mode::Indices,
            word => return Err(unknown("mode", word)),
        };
        let filter = match said.filter.as_deref().unwrap_or("NONE") {
            "NONE" => Filter::None,
            "OCTAHEDRAL" => Filter::Octahedral,
            "QUATERNION" => Filter::Quaternion,
            "EXPONENTIAL" => Filter::Exponential,
            "COLOR" => Filter::Color,
            word => return Err(unknown("filter", word)),
        };
        Ok(Self { count: said.count.0, stride: said.byte_stride.0, mode, filter })
    }
}

/// The result of decoding; the error is its message.
type Decoded<T> = std::result::Result<T, &'static str>;

const TOO_SHORT: &str = "the compressed stream ends too early";
const LEFT_OVER: &str = "the compressed stream has bytes left over";

/// The `count · stride` bytes that `bytes` decode to.
///
/// # Errors
/// `Invalid` for a layout that the extension does not allow, `Syntax` for a stream that is not of its mode, too short or
/// too long, `Limit` for more elements than [`Limits::elements`].
pub(crate) fn decode(
    bytes: &[u8],
    layout: &CompressedView,
    at: &Location,
    limits: &Limits,
) -> Result<Vec<u8>> {
    let &CompressedView { count, stride, mode, filter } = layout;
    // The largest stride that the extension allows, times any count within the limits, does not overflow.
    let is_allowed = match mode {
        Mode::Attributes => stride.is_multiple_of(4) && (4..=256).contains(&stride),
        Mode::Triangles => count.is_multiple_of(3) && [2, 4].contains(&stride),
        Mode::Indices => [2, 4].contains(&stride),
    } && match filter {
        Filter::None => true,
        Filter::Octahedral | Filter::Color => mode == Mode::Attributes && [4, 8].contains(&stride),
        Filter::Quaternion => mode == Mode::Attributes && stride == 8,
        Filter::Exponential => mode == Mode::Attributes,
    };
    if !is_allowed {
        let found =
            format!("meshopt mode {mode:?} with filter {filter:?} cannot have {count} × {stride} bytes");
        return Err(Error::invalid(at, found)
            .hint("strides are 4, 8, … 256 for attributes, 2 or 4 for indices; triangles come in threes"));
    }
    if count > limits.elements {
        let found = format!("{count} elements are more than the limit of {}", limits.elements);
        return Err(Error::new(ErrorKind::Limit, at, found).hint("split the model into several files"));
    }
    let too_many = || Error::new(ErrorKind::Limit, at, "more elements than this machine can address");
    let count = usize::try_from(count).map_err(|_| too_many())?;
    let stride = usize::try_from(stride).map_err(|_| too_many())?;

    let decoded = match mode {
        Mode::Attributes => attributes::decode(bytes, count, stride),
        Mode::Triangles => indices::triangles(bytes, count).map(|all| packed(&all, stride)),
        Mode::Indices => indices::sequence(bytes, count).map(|all| packed(&all, stride)),
    };
    let mut decoded = decoded.map_err(|why| {
        Error::syntax(at, format!("{why} ({} bytes for {count} × {stride})", bytes.len()))
            .hint("the file may be cut short; write it again, or without meshopt compression")
    })?;
    filter::apply(filter, stride, &mut decoded);
    Ok(decoded)
}

/// Indices stored in 2 or 4 bytes each.
fn packed(indices: &[u32], stride: usize) -> Vec<u8> {
    indices.iter().flat_map(|index| index.to_le_bytes().into_iter().take(stride)).collect()
}

/// A reader of bytes in order.
struct Stream<'a> {
    rest: &'a [u8],
}

impl<'a> Stream<'a> {
    fn take(&mut self, length: usize) -> Decoded<&'a [u8]> {
        let (head, rest) = self.rest.split_at_checked(length).ok_or(TOO_SHORT)?;
        self.rest = rest;
        Ok(head)
    }

    fn byte(&mut self) -> Decoded<u8> {
        self.take(1).map(|byte| byte[0])
    }

    /// An unsigned integer in groups of 7 bits, the low ones first (LEB128), of at most five bytes.
    fn number(&mut self) -> Decoded<u32> {
        let mut number = 0;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            number |= u32::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(number);
            }
        }
        Err("a number in the compressed stream is longer than five bytes")
    }

    fn finish(&self) -> Decoded<()> {
        if self.rest.is_empty() { Ok(()) } else { Err(LEFT_OVER) }
    }
}

#[cfg(test)]
mod tests;
