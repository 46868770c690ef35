//! OpenEXR files with any number of named channels of linear values (the format: openexr.com, "File Layout").
//!
//! Reading uses the crate `exr`: whole pictures as floats here, rows of any numbers in `rows`. Writing is done in `write`,
//! because that crate writes text attributes in a random order, and equal images should give equal bytes.

mod colors;
mod rows;
mod subsampled;
mod values;
mod windows;
mod write;

use std::io::Cursor;
use std::path::Path;

use ::exr::error::Error as ExrError;
use ::exr::image::read::any_channels::ReadAnyChannels;
use ::exr::image::read::layers::ReadChannels;
use ::exr::image::{AnyChannels, Layer};
use ::exr::meta::MetaData;
use ::exr::meta::attribute::{AttributeValue, ChannelDescription, Chromaticities};
use ::exr::meta::header::Header;
use ::exr::prelude::ReadLayers;

use self::colors::Colors;
use self::values::{ShownValues, is_shown};
use self::windows::{Window, Windows};
use super::read::{Reading, check_size, recolor};
use crate::budget::Reservation;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::image::Encoding;

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

/// The contents of an OpenEXR file by its header.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrContents {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The names of [`Channels::channels`].
    pub channels: Vec<String>,
    /// As [`Channels::attributes`].
    pub attributes: Vec<(String, String)>,
}

/// Reads every channel of an OpenEXR file, as far as the display window shows it; channels are prefixed with their part's
/// name and a point.
///
/// # Errors
/// As [`super::read()`].
pub fn read_exr(path: &Path, context: &mut LoadContext<'_>) -> Result<Channels> {
    let bytes = context.read(path)?;
    let at = Location::file(path);
    Ok(decode(&bytes, Windows::Display, &at, context)?.into_channels(context))
}

/// As [`read_exr`], with the colours of a layer as the channels R, G and B in linear Rec. 709, and its alpha as A: of the finished picture,
/// which [`super::read()`] reads, where `layer` is `None`. The other channels are as they are in the file.
///
/// # Errors
/// As [`super::read_as`].
pub fn read_exr_layer(path: &Path, layer: Option<&str>, context: &mut LoadContext<'_>) -> Result<Channels> {
    let bytes = context.read(path)?;
    let at = Location::file(path);
    let mut decoded = decode(&bytes, Windows::Display, &at, context)?;
    let Colors { mut texels, alpha, to_rec709 } =
        colors::take_colors(&mut decoded, &at, &Reading { layer, ..Reading::new(Encoding::Srgb) }, context)?;
    if let Some(matrix) = to_rec709 {
        recolor(&mut texels, &matrix);
    }
    let named = ["R", "G", "B"].iter().enumerate();
    let mut channels: Vec<_> = named
        .map(|(c, name)| ((*name).to_owned(), texels.iter().map(|texel| texel[c]).collect()))
        .chain(alpha.map(|alpha| ("A".to_owned(), alpha)))
        .collect();
    let mut all = decoded.into_channels(context);
    all.channels
        .retain(|(name, values)| !values.is_empty() && !["R", "G", "B", "A"].contains(&name.as_str()));
    channels.append(&mut all.channels);
    Ok(Channels { channels, ..all })
}

/// The contents that [`read_exr`] would read, without the values.
///
/// # Errors
/// As [`read_exr`], for a header.
pub fn exr_contents(bytes: &[u8], at: &Location, context: &mut LoadContext<'_>) -> Result<ExrContents> {
    let Opened { meta, picture } = open(bytes, Windows::Display, at, context)?;
    let several = meta.headers.len() > 1;
    let channels = meta.headers.iter().flat_map(|header| {
        let part = header.own_attributes.layer_name.as_ref().filter(|_| several).map(ToString::to_string);
        let shown = header.channels.list.iter().filter(|channel| is_shown(channel));
        shown.map(move |channel| full_name(part.as_deref(), &channel.name.to_string()))
    });
    Ok(ExrContents {
        width: picture.width as u32,
        height: picture.height as u32,
        channels: channels.collect(),
        attributes: texts(&meta),
    })
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

impl Decoded {
    /// The channels by their names in the file; their memory is the context's.
    fn into_channels(self, context: &mut LoadContext<'_>) -> Channels {
        let Self { parts, size: [width, height], attributes, mut memory, .. } = self;
        memory.shrink(memory.bytes() / 2);
        context.kept.push(memory);
        let several = parts.len() > 1;
        let channels = parts.into_iter().flat_map(|part| {
            let prefix = part.name.filter(|_| several);
            part.channels.into_iter().map(move |(name, values)| (full_name(prefix.as_deref(), &name), values))
        });
        Channels { width, height, channels: channels.collect(), attributes }
    }
}

/// A part of a file: its name, and its channels with a value for each pixel of the picture, row 0 on top.
struct Part {
    name: Option<String>,
    channels: Vec<(String, Vec<f32>)>,
}

/// The headers of a file within the limits.
struct Opened {
    meta: MetaData,
    /// The window that is the picture.
    picture: Window,
}

/// Reads the headers: nothing larger than the limits is decoded.
fn open(bytes: &[u8], windows: Windows, at: &Location, context: &mut LoadContext<'_>) -> Result<Opened> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false)
        .map_err(|error| unreadable(&error, bytes, at))?;
    let (Some(first), data) = (meta.headers.first(), meta.headers.iter().map(data_window)) else {
        return Err(Error::syntax(at, "an OpenEXR file without a picture"));
    };
    let picture = windows.picture(Window::of(first.shared_attributes.display_window), data, at, context);
    check_size(picture.width, picture.height, at, &context.limits)?;
    for header in &meta.headers {
        let window = data_window(header);
        check_size(window.width, window.height, at, &context.limits)?;
    }
    let opened = Opened { meta, picture };
    let (channels, values) = opened.size(|_| true);
    if channels > MOST_CHANNELS || values / 16 > context.limits.texels {
        return Err(Error::new(
            ErrorKind::Limit,
            at,
            format!("{channels} channels of {values} values in all are too many"),
        )
        .hint("make the picture smaller, or leave channels out"));
    }
    Ok(opened)
}

impl Opened {
    /// The number of those channels that `counts` selects, and of their values: of the file or of the picture, whichever has more.
    fn size(&self, counts: impl Fn(&ChannelDescription) -> bool) -> (u64, u64) {
        let of_header = |header: &Header| {
            let window = data_window(header);
            let pixels = (window.width * window.height).max(self.picture.width * self.picture.height);
            let channels = header.channels.list.iter().filter(|channel| counts(channel)).count() as u64;
            (channels, pixels.saturating_mul(channels))
        };
        let sizes = self.meta.headers.iter().map(of_header);
        sizes.fold((0, 0), |(channels, values), (more, of_them)| {
            (channels + more, values.saturating_add(of_them))
        })
    }
}

/// The headers' attributes with text or integer values, by name.
fn texts(meta: &MetaData) -> Vec<(String, String)> {
    let others = meta
        .headers
        .iter()
        .flat_map(|header| header.shared_attributes.other.iter().chain(&header.own_attributes.other));
    let mut texts: Vec<_> = others
        .filter_map(|(name, value)| match value {
            AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
            AttributeValue::I32(number) => Some((name.to_string(), number.to_string())),
            _ => None,
        })
        .collect();
    texts.sort();
    texts.dedup();
    texts
}

/// Decodes the channels of pictures, into the picture that `windows` selects.
fn decode(bytes: &[u8], windows: Windows, at: &Location, context: &mut LoadContext<'_>) -> Result<Decoded> {
    let opened = open(bytes, windows, at, context)?;
    let (channels, values) = opened.size(is_shown);
    let memory = values.saturating_mul(2 * size_of::<f32>() as u64);
    let memory = context.budget.reserve(memory, &format!("a picture of {channels} channels"), at)?;
    let found = ReadAnyChannels { read_samples: ShownValues }
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| unreadable(&error, bytes, at))?;
    let Opened { meta, picture } = opened;
    let part = |layer: Layer<AnyChannels<Option<Vec<f32>>>>| {
        let window = Window::new(layer.attributes.layer_position, layer.size);
        let channels = layer.channel_data.list.into_iter().filter_map(|channel| {
            Some((channel.name.to_string(), window.placed(channel.sample_data?, picture)))
        });
        let name = layer.attributes.layer_name.map(|name| name.to_string());
        Part { name, channels: channels.collect() }
    };
    Ok(Decoded {
        parts: found.layer_data.into_iter().map(part).collect(),
        size: [picture.width as u32, picture.height as u32],
        attributes: texts(&meta),
        chromaticities: found.attributes.chromaticities,
        memory,
    })
}

/// The error of a file that the crate does not read: of subsampled channels in our own words.
fn unreadable(error: &ExrError, bytes: &[u8], at: &Location) -> Error {
    subsampled::told(bytes, at).unwrap_or_else(|| fault(error, at))
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
