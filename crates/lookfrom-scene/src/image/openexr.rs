//! OpenEXR files with any number of named channels of linear values (the format: openexr.com, "File Layout").
//!
//! Reading uses the crate `exr`. Writing is done here, because that crate writes text attributes in a random order, and
//! equal images should give equal bytes.

use std::io::Cursor;
use std::path::Path;

use ::exr::error::Error as ExrError;
use ::exr::meta::MetaData;
use ::exr::meta::attribute::AttributeValue;
use ::exr::prelude::{ReadChannels, ReadLayers, read as exr_read};

use super::read::{Floats, check_size};
use super::write::check;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::{Limits, LoadContext};

/// The signature of an OpenEXR file.
pub(super) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Number of rows that are compressed together.
const BLOCK_ROWS: usize = 16;

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
    decode_channels(&bytes, &Location::file(path), &context.limits)
}

/// The colours of an OpenEXR file: R, G, B if present, else Y.
pub(super) fn decode_rgb(bytes: &[u8], at: &Location, limits: &Limits) -> Result<Floats> {
    let found = decode_channels(bytes, at, limits)?;
    let rgb = ["R", "G", "B"].map(|name| found.channel(name).or_else(|| found.channel("Y")));
    let [Some(r), Some(g), Some(b)] = rgb else {
        let names: Vec<&str> = found.channels.iter().map(|(name, _)| name.as_str()).collect();
        return Err(Error::invalid(
            at,
            format!("has the channels {}; expected R, G and B, or Y", names.join(", ")),
        )
        .hint("write the picture again with channels of these names"));
    };
    let texels = r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b]).collect();
    Ok(Floats { width: found.width, height: found.height, texels, alpha: Vec::new() })
}

fn decode_channels(bytes: &[u8], at: &Location, limits: &Limits) -> Result<Channels> {
    let fault = |error: &ExrError| {
        let (kind, message) = match error {
            ExrError::NotSupported(what) => {
                (ErrorKind::Unsupported, format!("OpenEXR with {what} is not read"))
            }
            ExrError::Invalid(what) => (ErrorKind::Syntax, format!("not a whole OpenEXR picture: {what}")),
            other => (ErrorKind::Syntax, format!("not a whole OpenEXR picture: {other}")),
        };
        Error::new(kind, at, message)
            .hint("check that the file is whole, or save it again as plain scan lines")
    };

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
        .hint("leave channels out, or raise `Limits::texels`"));
    }

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
        for channel in &layer.channel_data.list {
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
    Ok(found)
}

/// The bytes of an OpenEXR file: one part of scan lines, 32-bit floats, lossless ZIP compression. The channels have their
/// names in the file ("R", "G", "B"; others as "albedo.R"); `attributes` are texts for the header, under names that the
/// format does not use itself. The same input gives the same bytes, whatever the order of the channels.
///
/// # Errors
/// `Invalid` if a channel has not `width * height` values, or a name is empty, too long, duplicate or reserved.
pub fn encode_exr(
    width: u32,
    height: u32,
    channels: &[(String, &[f32])],
    attributes: &[(String, String)],
) -> Result<Vec<u8>> {
    check_names(channels, attributes)?;
    for (_, values) in channels {
        check(width, height, values.len())?;
    }
    let mut channels: Vec<&(String, &[f32])> = channels.iter().collect();
    channels.sort_by(|a, b| a.0.as_bytes().cmp(b.0.as_bytes()));

    let mut bytes = MAGIC.to_vec();
    bytes.extend(2_i32.to_le_bytes());
    write_header(&mut bytes, width, height, &channels, attributes);

    // The offset table is filled in as the blocks are written.
    let (width, height) = (width as usize, height as usize);
    let table = bytes.len();
    let blocks = height.div_ceil(BLOCK_ROWS);
    bytes.resize(table + blocks * 8, 0);
    for block in 0..blocks {
        let offset = bytes.len() as u64;
        bytes[table + block * 8..][..8].copy_from_slice(&offset.to_le_bytes());
        let rows = block * BLOCK_ROWS..height.min((block + 1) * BLOCK_ROWS);
        let mut raw = Vec::with_capacity(rows.len() * width * channels.len() * 4);
        for row in rows.clone() {
            for (_, values) in &channels {
                raw.extend(values[row * width..][..width].iter().flat_map(|value| value.to_le_bytes()));
            }
        }
        let packed = compress(&raw);
        let stored = if packed.len() < raw.len() { &packed } else { &raw };
        bytes.extend((rows.start as i32).to_le_bytes());
        bytes.extend((stored.len() as i32).to_le_bytes());
        bytes.extend(stored);
    }
    Ok(bytes)
}

/// Attribute names reserved by the format.
const RESERVED: [&str; 10] = [
    "channels",
    "compression",
    "dataWindow",
    "displayWindow",
    "lineOrder",
    "pixelAspectRatio",
    "screenWindowCenter",
    "screenWindowWidth",
    "name",
    "type",
];

fn check_names(channels: &[(String, &[f32])], attributes: &[(String, String)]) -> Result<()> {
    let wrong = |message: String| Err(Error::invalid(&Location::default(), message));
    if channels.is_empty() {
        return wrong("an OpenEXR picture needs at least one channel".to_owned());
    }
    let channel_names = || channels.iter().map(|(name, _)| name.as_str());
    let attribute_names = || attributes.iter().map(|(name, _)| name.as_str());
    for name in channel_names().chain(attribute_names()) {
        if name.is_empty() || name.len() > 31 || name.contains('\0') {
            return wrong(format!("OpenEXR name {name:?} must have 1 to 31 bytes, none of them zero"));
        }
    }
    if let Some(name) = attribute_names().find(|name| RESERVED.contains(name)) {
        return wrong(format!("attribute {name:?} is one of OpenEXR's own"));
    }
    for mut names in [channel_names().collect::<Vec<_>>(), attribute_names().collect()] {
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return wrong(format!("OpenEXR name {:?} is given twice", pair[0]));
        }
    }
    Ok(())
}

fn write_header(
    bytes: &mut Vec<u8>,
    width: u32,
    height: u32,
    channels: &[&(String, &[f32])],
    attributes: &[(String, String)],
) {
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        for text in [name, kind] {
            bytes.extend(text.as_bytes());
            bytes.push(0);
        }
        bytes.extend((value.len() as i32).to_le_bytes());
        bytes.extend(value);
    };

    // Each channel: its name, pixel type 2 (32-bit float), not perceptually linear, no subsampling.
    let mut list = Vec::new();
    for (name, _) in channels {
        list.extend(name.as_bytes());
        list.push(0);
        for number in [2_i32, 0, 1, 1] {
            list.extend(number.to_le_bytes());
        }
    }
    list.push(0);
    let window: Vec<u8> =
        [0, 0, width as i32 - 1, height as i32 - 1].iter().flat_map(|edge| edge.to_le_bytes()).collect();
    let one = 1.0_f32.to_le_bytes();
    let zip_of_16_rows = [3];
    let rows_downwards = [0];
    attribute("channels", "chlist", &list);
    attribute("compression", "compression", &zip_of_16_rows);
    attribute("dataWindow", "box2i", &window);
    attribute("displayWindow", "box2i", &window);
    attribute("lineOrder", "lineOrder", &rows_downwards);
    attribute("pixelAspectRatio", "float", &one);
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &one);
    for (name, text) in attributes {
        attribute(name, "string", text.as_bytes());
    }
    bytes.push(0);
}

/// OpenEXR's ZIP: even and odd bytes separated, each as the difference from the previous one, then deflated.
fn compress(raw: &[u8]) -> Vec<u8> {
    let mut parted: Vec<u8> = raw.iter().step_by(2).chain(raw.iter().skip(1).step_by(2)).copied().collect();
    let mut before = parted.first().copied().unwrap_or(0);
    for byte in parted.iter_mut().skip(1) {
        let difference = byte.wrapping_sub(before).wrapping_add(128);
        before = *byte;
        *byte = difference;
    }
    miniz_oxide::deflate::compress_to_vec_zlib(&parted, 4)
}
