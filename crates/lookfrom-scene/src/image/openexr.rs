//! OpenEXR files with any number of named channels of linear values (the format: openexr.com, "File Layout").
//!
//! Reading uses the crate `exr`: whole pictures as floats here, rows of any numbers in `rows`. Writing is done in `write`,
//! because that crate writes text attributes in a random order, and equal images should give equal bytes.

mod rows;
mod write;

use std::io::Cursor;
use std::path::Path;

use ::exr::error::Error as ExrError;
use ::exr::meta::MetaData;
use ::exr::meta::attribute::AttributeValue;
use ::exr::prelude::{ReadChannels, ReadLayers, read as exr_read};

use super::read::{Floats, check_size};
use crate::budget::Reservation;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;

pub use rows::ExrRows;
pub use write::{ExrChannel, ExrHeader, encode_exr, write_exr};

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

/// Reads every channel of an OpenEXR file whose parts all have the same size; channels are prefixed with their part's name
/// and a point.
///
/// # Errors
/// As [`super::read()`].
pub fn read_exr(path: &Path, context: &mut LoadContext<'_>) -> Result<Channels> {
    let bytes = context.read(path)?;
    let (channels, mut memory) = decode_channels(&bytes, &Location::file(path), context)?;
    memory.shrink(memory.bytes() / 2);
    context.kept.push(memory);
    Ok(channels)
}

/// The colours of an OpenEXR file: R, G, B if present, else Y, or its only channel.
pub(super) fn decode_rgb(bytes: &[u8], at: &Location, context: &LoadContext<'_>) -> Result<Floats> {
    let (found, memory) = decode_channels(bytes, at, context)?;
    let gray = match found.channels.as_slice() {
        [(_, only)] => Some(only.as_slice()),
        _ => found.channel("Y"),
    };
    let rgb = ["R", "G", "B"].map(|name| found.channel(name).or(gray));
    let [Some(r), Some(g), Some(b)] = rgb else {
        let names: Vec<&str> = found.channels.iter().map(|(name, _)| name.as_str()).collect();
        return Err(Error::invalid(
            at,
            format!("has the channels {}; expected R, G and B, or Y", names.join(", ")),
        )
        .hint("write the picture again with channels of these names"));
    };
    let texels = r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b]).collect();
    Ok(Floats { width: found.width, height: found.height, texels, alpha: Vec::new(), memory })
}

/// The channels, and the memory of twice their values: as the crate returns them, or with the colours of a picture.
fn decode_channels(
    bytes: &[u8],
    at: &Location,
    context: &LoadContext<'_>,
) -> Result<(Channels, Reservation)> {
    let limits = &context.limits;
    let fault = |error: &ExrError| fault(error, at);

    // The headers first: nothing larger than the limits is decoded.
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|error| fault(&error))?;
    let mut total = 0_u64;
    for header in &meta.headers {
        let (width, height) = (header.layer_size.0 as u64, header.layer_size.1 as u64);
        check_size(width, height, at, limits)?;
        total = total.saturating_add((width * height).saturating_mul(header.channels.list.len() as u64));
    }
    let channels: u64 = meta.headers.iter().map(|header| header.channels.list.len() as u64).sum();
    if channels > MOST_CHANNELS || total / 16 > limits.texels {
        return Err(Error::new(
            ErrorKind::Limit,
            at,
            format!("{channels} channels of {total} values in all are too many"),
        )
        .hint("make the picture smaller, or leave channels out"));
    }

    let memory = total.saturating_mul(2 * size_of::<f32>() as u64);
    let memory = context.budget.reserve(memory, &format!("a picture of {channels} channels"), at)?;

    let picture = exr_read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| fault(&error))?;
    let Some(size) = picture.layer_data.first().map(|layer| layer.size) else {
        return Err(Error::syntax(at, "an OpenEXR file without a picture"));
    };
    let mut found = Channels {
        width: u32::try_from(size.0).unwrap_or(u32::MAX),
        height: u32::try_from(size.1).unwrap_or(u32::MAX),
        channels: Vec::new(),
        attributes: Vec::new(),
    };
    for layer in &picture.layer_data {
        if layer.size != size {
            return Err(Error::new(
                ErrorKind::Unsupported,
                at,
                "the parts of this OpenEXR file differ in size",
            )
            .hint("write each part to a file of its own"));
        }
        let prefix = layer.attributes.layer_name.as_ref().map_or_else(String::new, |name| format!("{name}."));
        // The sums of a film are no picture (lookfrom's film files).
        let is_sum = |name: &str| name.starts_with("film.");
        for channel in layer.channel_data.list.iter().filter(|channel| !is_sum(&channel.name.to_string())) {
            let values: Vec<f32> = channel.sample_data.values_as_f32().collect();
            if values.len() != size.0 * size.1 {
                return Err(Error::new(
                    ErrorKind::Unsupported,
                    at,
                    format!("channel {} has fewer values than pixels (subsampling)", channel.name),
                ));
            }
            found.channels.push((format!("{prefix}{}", channel.name), values));
        }
        let texts = picture.attributes.other.iter().chain(&layer.attributes.other);
        found.attributes.extend(texts.filter_map(|(name, value)| match value {
            AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
            AttributeValue::I32(number) => Some((name.to_string(), number.to_string())),
            _ => None,
        }));
    }
    found.attributes.sort();
    found.attributes.dedup();
    Ok((found, memory))
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
