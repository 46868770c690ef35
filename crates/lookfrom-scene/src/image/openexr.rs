//! OpenEXR files with any number of named channels of linear values (the format: openexr.com, "File Layout").
//!
//! Reading uses the crate `exr`: whole pictures as floats here, rows of any numbers in `rows`. Writing is done in `write`,
//! because that crate writes text attributes in a random order, and equal images should give equal bytes.

mod colors;
mod rows;
mod subsampled;
mod windows;
mod write;

use std::io::Cursor;
use std::path::Path;

use ::exr::error::Error as ExrError;
use ::exr::meta::MetaData;
use ::exr::meta::attribute::{AttributeValue, Chromaticities};
use ::exr::meta::header::Header;
use ::exr::prelude::{ReadChannels, ReadLayers, read as exr_read};

use self::windows::{Window, Windows};
use super::read::check_size;
use crate::budget::Reservation;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;

pub(super) use colors::decode_rgb;
pub use rows::{ExrRowStream, ExrRows};
pub use write::{ExrChannel, ExrFill, ExrHeader, encode_exr, write_exr};

/// The signature of an OpenEXR file.
pub(super) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Maximum number of channels, more than any renderer writes; files with more are taken to be hostile.
const MOST_CHANNELS: u64 = 1024;

/// The channels and attributes of an OpenEXR file.
#[derive(Clone, Debug, PartialEq)]
pub struct Channels {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Names ("R", "albedo.R") and `width * height` values each, row 0 on top.
    pub channels: Vec<(String, Vec<f32>)>,
    /// The header's attributes with text or integer values, by name.
    pub attributes: Vec<(String, String)>,
}

impl Channels {
    /// The values of a channel.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|(n, _)| n == name).map(|(_, values)| values.as_slice())
    }
}

/// Reads every channel of an OpenEXR file, as far as the display window shows it; channels are prefixed with their part's
/// name and a point.
///
/// # Errors
/// As [`super::read()`].
pub fn read_exr(path: &Path, context: &mut LoadContext<'_>) -> Result<Channels> {
    let bytes = context.read(path)?;
    let at = Location::file(path);
    let Decoded { parts, size, attributes, mut memory, .. } = decode(&bytes, Windows::Display, &at, context)?;
    memory.shrink(memory.bytes() / 2);
    context.kept.push(memory);
    let several = parts.len() > 1;
    let channels = parts.into_iter().flat_map(|part| {
        let prefix = part.name.filter(|_| several);
        part.channels.into_iter().map(move |(name, values)| (full_name(prefix.as_deref(), &name), values))
    });
    Ok(Channels { width: size[0], height: size[1], channels: channels.collect(), attributes })
}

/// The name of a part's channel in the file.
fn full_name(part: Option<&str>, channel: &str) -> String {
    match part {
        Some(part) if !channel.strip_prefix(part).is_some_and(|rest| rest.starts_with('.')) => {
            format!("{part}.{channel}")
        }
        _ => channel.to_owned(),
    }
}

/// An OpenEXR file in memory.
struct Decoded {
    parts: Vec<Part>,
    /// Columns and rows of the picture.
    size: [u32; 2],
    /// The header's attributes with text or integer values, by name.
    attributes: Vec<(String, String)>,
    /// The colours that R, G and B stand for, if the file tells.
    chromaticities: Option<Chromaticities>,
    /// Memory of twice the values: as the crate returns them, or with the colours of a picture.
    memory: Reservation,
}

/// A part of a file: its name, and its channels with a value for each pixel of the picture, row 0 on top.
struct Part {
    name: Option<String>,
    channels: Vec<(String, Vec<f32>)>,
}

/// Decodes all channels, into the picture that `windows` selects.
fn decode(bytes: &[u8], windows: Windows, at: &Location, context: &mut LoadContext<'_>) -> Result<Decoded> {
    let fault = |error: &ExrError| subsampled::told(bytes, at).unwrap_or_else(|| fault(error, at));

    // The headers first: nothing larger than the limits is decoded.
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|error| fault(&error))?;
    let (Some(first), data) = (meta.headers.first(), meta.headers.iter().map(data_window)) else {
        return Err(Error::syntax(at, "an OpenEXR file without a picture"));
    };
    let picture = windows.picture(Window::of(first.shared_attributes.display_window), data, at, context);
    check_size(picture.width, picture.height, at, &context.limits)?;
    let mut total = 0_u64;
    for header in &meta.headers {
        let window = data_window(header);
        check_size(window.width, window.height, at, &context.limits)?;
        let pixels = (window.width * window.height).max(picture.width * picture.height);
        total = total.saturating_add(pixels.saturating_mul(header.channels.list.len() as u64));
    }
    let channels: u64 = meta.headers.iter().map(|header| header.channels.list.len() as u64).sum();
    if channels > MOST_CHANNELS || total / 16 > context.limits.texels {
        return Err(Error::new(
            ErrorKind::Limit,
            at,
            format!("{channels} channels of {total} values in all are too many"),
        )
        .hint("make the picture smaller, or leave channels out"));
    }

    let memory = total.saturating_mul(2 * size_of::<f32>() as u64);
    let memory = context.budget.reserve(memory, &format!("a picture of {channels} channels"), at)?;

    let found = exr_read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| fault(&error))?;
    let mut attributes = Vec::new();
    let mut parts = Vec::new();
    for layer in found.layer_data {
        let texts = found.attributes.other.iter().chain(&layer.attributes.other);
        attributes.extend(texts.filter_map(|(name, value)| match value {
            AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
            AttributeValue::I32(number) => Some((name.to_string(), number.to_string())),
            _ => None,
        }));
        let window = Window::new(layer.attributes.layer_position, layer.size);
        // The sums of a film are no picture (lookfrom's film files).
        let is_shown = |name: &str| !name.starts_with("film.");
        let mut channels = Vec::new();
        for channel in layer.channel_data.list {
            let name = channel.name.to_string();
            if is_shown(&name) {
                channels.push((name, window.placed(channel.sample_data.values_as_f32().collect(), picture)));
            }
        }
        parts.push(Part { name: layer.attributes.layer_name.map(|name| name.to_string()), channels });
    }
    attributes.sort();
    attributes.dedup();
    let size = [picture.width as u32, picture.height as u32];
    Ok(Decoded { parts, size, attributes, chromaticities: found.attributes.chromaticities, memory })
}

fn data_window(header: &Header) -> Window {
    Window::new(header.own_attributes.layer_position, header.layer_size)
}

/// The error of the crate `exr` as one of ours.
fn fault(error: &ExrError, at: &Location) -> Error {
    let (kind, message) = match error {
        ExrError::NotSupported(what) => (ErrorKind::Unsupported, format!("OpenEXR with {what} is not read")),
        ExrError::Invalid(what) => (ErrorKind::Syntax, format!("not a whole OpenEXR picture: {what}")),
        other => (ErrorKind::Syntax, format!("not a whole OpenEXR picture: {other}")),
    };
    Error::new(kind, at, message).hint("check that the file is whole, or save it again as plain scan lines")
}
