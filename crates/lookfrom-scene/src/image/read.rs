//! Image readers, to linear colours. The format is recognised by the content; the extension matters only for formats
//! without a signature (TGA). Of an animation the first image is read.

use std::io::Cursor;
use std::path::Path;

use ::image::error::{ImageError, LimitErrorKind};
use ::image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};

use super::{Encoding, Image, openexr, radiance};
#[cfg(feature = "images")]
use super::{ktx2, tiff};
use crate::budget::Reservation;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::{Limits, LoadContext};

/// The names of the readable formats, for messages.
pub(super) const KNOWN: &str = if cfg!(feature = "images") {
    "PNG, JPEG, HDR, EXR, BMP, TGA, PNM, PFM, WebP, GIF, TIFF, DDS (DXT1 to DXT5), KTX2"
} else {
    "PNG, JPEG, HDR, EXR, PFM, WebP, GIF"
};

/// The first bytes of every KTX 2 file.
pub(super) const KTX2_MAGIC: &[u8] = b"\xabKTX 20\xbb\r\n\x1a\n";

/// Whether these are a picture in a format whose reader was not compiled.
fn is_left_out(bytes: &[u8]) -> bool {
    let formats = [ImageFormat::Bmp, ImageFormat::Dds, ImageFormat::Pnm, ImageFormat::Tga, ImageFormat::Tiff];
    let is_one = |format| formats.contains(&format);
    !cfg!(feature = "images")
        && (bytes.starts_with(KTX2_MAGIC) || ::image::guess_format(bytes).is_ok_and(is_one))
}

/// The hint for a damaged file.
pub(super) const WHOLE: &str =
    "check that the file is whole; opening it in another program and saving it again may repair it";

/// Bytes that the colour profile and the texts of a PNG may take, unpacked: a few thousand bytes of them may stand for
/// gigabytes. A longer profile is ignored.
const BESIDE_PIXELS: u64 = 16 << 20;

/// Bytes of a texel for decoding 8 bits per channel, besides the decoder's result.
const SHALLOW: u64 = 6;

/// Bytes of a texel for decoding more than 8 bits per channel, besides the decoder's result.
const DEEP: u64 = 20;

/// Reads a colour image: 8- and 16-bit formats are taken to be sRGB-encoded and become linear, floating-point formats are
/// linear already. +∞ becomes very bright and other values that are not finite 0, with a warning.
///
/// # Errors
/// `Io` if the file cannot be read; `Syntax` if it is not a complete image; `Unsupported` if its format is not known;
/// `Limit` if it has more texels than [`Limits::texels`], or there is no memory
/// for it, which is checked before anything is decoded.
pub fn read(path: &Path, context: &mut LoadContext<'_>) -> Result<Image> {
    read_encoded(path, context, Encoding::Srgb)
}

/// Reads an image of data (bump maps, weights): as [`read`], but 8- and 16-bit values are linear in [0, 1].
///
/// # Errors
/// As [`read`].
pub fn read_data(path: &Path, context: &mut LoadContext<'_>) -> Result<Image> {
    read_encoded(path, context, Encoding::Linear)
}

/// Reads an image in any encoding: as [`read`], but `encoding` decodes 8- and 16-bit values, scaled to [0, 1].
///
/// # Errors
/// As [`read`].
pub fn read_encoded(path: &Path, context: &mut LoadContext<'_>, encoding: Encoding<'_>) -> Result<Image> {
    read_as(path, &Reading::new(encoding), context)
}

/// The interpretation of a picture file.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'a> {
    /// The encoding of 8- and 16-bit values.
    pub encoding: Encoding<'a>,
    /// The layer or part of an OpenEXR file; `None` is the first with colours.
    pub layer: Option<&'a str>,
    /// The program whose rules apply.
    pub by: By,
    /// Whether values that are not finite stay as they are.
    pub keeps_not_finite: bool,
}

/// The program whose rules apply where programs differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum By {
    /// The formats' own: the picture is an OpenEXR file's display window, light is divided by a Radiance picture's exposure,
    /// and white of other primaries becomes our white.
    #[default]
    Standard,
    /// pbrt-v4's for textures: the data window, and the exposure stays.
    PbrtTexture,
    /// pbrt-v4's for lights, and Mitsuba's for all pictures: the same, and white keeps its colour.
    PbrtLight,
}

impl<'a> Reading<'a> {
    /// The usual reading in this encoding.
    pub fn new(encoding: Encoding<'a>) -> Self {
        Self { encoding, layer: None, by: By::Standard, keeps_not_finite: false }
    }

    /// Whether the values are no colours.
    pub(super) fn is_data(&self) -> bool {
        matches!(self.encoding, Encoding::Linear)
    }
}

/// Reads an image as `reading` tells, else as [`read`].
///
/// # Errors
/// As [`read`]; `Invalid` if there is no such layer.
pub fn read_as(path: &Path, reading: &Reading<'_>, context: &mut LoadContext<'_>) -> Result<Image> {
    let bytes = context.read(path)?;
    decode_as(&bytes, &path.display().to_string(), reading, context)
}

/// Decodes an image file's content, as [`read_encoded`] does. `name` is the image's name and appears in messages.
///
/// # Errors
/// As [`read`], without `Io`.
pub fn decode(
    bytes: &[u8],
    name: &str,
    encoding: Encoding<'_>,
    context: &mut LoadContext<'_>,
) -> Result<Image> {
    decode_as(bytes, name, &Reading::new(encoding), context)
}

fn decode_as(
    bytes: &[u8],
    name: &str,
    reading: &Reading<'_>,
    context: &mut LoadContext<'_>,
) -> Result<Image> {
    let at = Location::file(Path::new(name));
    let encoding = reading.encoding;
    let is_exr = bytes.starts_with(&openexr::MAGIC);
    if let (Some(layer), false) = (reading.layer, is_exr) {
        return Err(Error::invalid(
            &at,
            format!("has no layer {layer:?}: only OpenEXR pictures have layers"),
        )
        .hint("leave `layer` out"));
    }
    // Formats that the crate `image` does not support are recognised by their first bytes.
    #[cfg(feature = "images")]
    if bytes.starts_with(KTX2_MAGIC) {
        let ktx2::Pixels { width, height, texels, memory } = ktx2::decode(bytes, &at, context)?;
        return Ok(kept(Image::from_bytes(name, width, height, texels, encoding), memory, context));
    }
    let floats = if is_exr {
        openexr::decode_rgb(bytes, &at, reading, context)?
    } else if is_pfm(bytes) {
        decode_pfm(bytes, &at, context)?
    } else if radiance::is(bytes) {
        radiance::decode(bytes, &at, reading, context)?
    } else {
        match decode_common(bytes, Path::new(name), &at, context)? {
            (picture, memory) if is_deep(&picture) => floats_of(picture, memory, encoding),
            (picture, memory) => {
                let (width, height, texels) = (picture.width(), picture.height(), shallow(&picture));
                drop(picture);
                return Ok(kept(Image::from_bytes(name, width, height, texels, encoding), memory, context));
            }
        }
    };
    let Floats { width, height, mut texels, mut alpha, to_rec709, memory } = floats;
    if !reading.keeps_not_finite {
        make_finite(&mut texels, &mut alpha, &at, context);
    }
    if let Some(matrix) = to_rec709 {
        recolor(&mut texels, &matrix);
    }
    Ok(kept(Image::from_linear_and_alpha(name, width, height, texels, alpha), memory, context))
}

/// Colours in other primaries, by the matrix to them.
pub(super) fn recolor(texels: &mut [[f32; 3]], matrix: &[[f32; 3]; 3]) {
    for texel in texels {
        *texel = matrix.map(|row| row[0] * texel[0] + row[1] * texel[1] + row[2] * texel[2]);
    }
}

/// The largest number of 16 bits: what is brighter overflows to +∞ in most files.
const LARGEST_HALF: f32 = 65504.0;

/// Replaces values that are no finite numbers, with a warning: +∞ is very bright, everything else 0.
fn make_finite(texels: &mut [[f32; 3]], alpha: &mut [f32], at: &Location, context: &mut LoadContext<'_>) {
    let finite = texels.as_flattened().iter().filter(|value| value.is_finite());
    let brightest = finite.fold(LARGEST_HALF, |most, &value| most.max(value));
    let (mut bright, mut bad) = (0_usize, 0_usize);
    for value in texels.as_flattened_mut().iter_mut().filter(|value| !value.is_finite()) {
        let is_bright = *value > 0.0;
        *value = if is_bright { brightest } else { 0.0 };
        *(if is_bright { &mut bright } else { &mut bad }) += 1;
    }
    for value in alpha.iter_mut().filter(|value| !value.is_finite()) {
        *value = 0.0;
        bad += 1;
    }
    if bright > 0 {
        context.warn(at, format!("{bright} values are infinite; each becomes {brightest}"));
    }
    if bad > 0 {
        context.warn(at, format!("{bad} values are not finite numbers; each becomes 0"));
    }
}

/// The texels of an image of at most 8 bits per channel, made at once from what the decoder returned.
fn shallow(picture: &DynamicImage) -> Vec<[u8; 4]> {
    let bytes = picture.as_bytes();
    match picture.color().channel_count() {
        1 => bytes.iter().map(|&grey| [grey, grey, grey, 255]).collect(),
        2 => bytes.as_chunks().0.iter().map(|&[grey, alpha]| [grey, grey, grey, alpha]).collect(),
        3 => bytes.as_chunks().0.iter().map(|&[r, g, b]| [r, g, b, 255]).collect(),
        _ => bytes.as_chunks().0.to_vec(),
    }
}

/// An image that stays; of the memory in which it was decoded only its own is kept.
fn kept(image: Image, mut memory: Reservation, context: &mut LoadContext<'_>) -> Image {
    memory.shrink(image.bytes());
    context.kept.push(memory);
    image
}

/// The opacity (alpha) of an image in grey, if it has one that is not 1 everywhere, by the rules of pbrt-v4: grey PNG files and those
/// with palettes have none. `encoding` is as in [`read_encoded`].
///
/// # Errors
/// As [`read`].
pub fn read_opacity(
    path: &Path,
    context: &mut LoadContext<'_>,
    encoding: Encoding<'_>,
) -> Result<Option<Image>> {
    let at = Location::file(path);
    let bytes = context.read(path)?;
    if bytes.starts_with(&openexr::MAGIC) {
        let reading = Reading { by: By::PbrtTexture, ..Reading::new(encoding) };
        let Floats { width, height, alpha, memory, .. } =
            openexr::decode_rgb(&bytes, &at, &reading, context)?;
        let texels: Vec<_> = alpha.into_iter().map(|alpha| [alpha; 3]).collect();
        let image = |texels| Image::from_linear(path.display().to_string(), width, height, texels);
        return Ok((!texels.is_empty()).then(|| kept(image(texels), memory, context)));
    }
    // The colour type in the header of a PNG file, of RGBA.
    const RGBA: u8 = 6;
    let is_png = bytes.starts_with(b"\x89PNG");
    if bytes.starts_with(KTX2_MAGIC)
        || is_pfm(&bytes)
        || radiance::is(&bytes)
        || is_png && bytes.get(25) != Some(&RGBA)
    {
        return Ok(None);
    }
    let (picture, memory) = decode_common(&bytes, path, &at, context)?;
    if !picture.color().has_alpha() {
        return Ok(None);
    }
    let (name, width, height) = (path.display().to_string(), picture.width(), picture.height());
    if is_deep(&picture) {
        let alphas: Vec<f32> = picture.into_rgba32f().pixels().map(|pixel| pixel.0[3]).collect();
        if alphas.iter().all(|&alpha| alpha == 1.0) {
            return Ok(None);
        }
        let texels = alphas.into_iter().map(|alpha| [encoding.decode(alpha); 3]).collect();
        return Ok(Some(kept(Image::from_linear(name, width, height, texels), memory, context)));
    }
    let texels = picture.into_rgba8();
    if texels.pixels().all(|pixel| pixel.0[3] == 255) {
        return Ok(None);
    }
    let texels = texels.pixels().map(|pixel| pixel.0[3]).map(|a| [a, a, a, 255]).collect();
    Ok(Some(kept(Image::from_bytes(name, width, height, texels, encoding), memory, context)))
}

/// Checks the size in a header before memory is allocated.
pub(super) fn check_size(width: u64, height: u64, at: &Location, limits: &Limits) -> Result<()> {
    if width == 0 || height == 0 {
        return Err(Error::invalid(at, format!("a picture of {width}×{height} has no texels")));
    }
    if width.checked_mul(height).is_none_or(|texels| texels > limits.texels) {
        return Err(Error::new(
            ErrorKind::Limit,
            at,
            format!("{width}×{height} texels are more than the limit of {}", limits.texels),
        )
        .hint("make the picture smaller"));
    }
    Ok(())
}

/// Memory for decoding a picture, by the bytes that a texel takes.
pub(super) fn room(
    [width, height]: [u32; 2],
    bytes: u64,
    at: &Location,
    context: &LoadContext<'_>,
) -> Result<Reservation> {
    let total = (u64::from(width) * u64::from(height)).saturating_mul(bytes);
    context.budget.reserve(total, &format!("a picture of {width}×{height} texels"), at)
}

/// An image of 32-bit floats; `alpha` is empty if it is opaque.
pub(super) struct Floats {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) texels: Vec<[f32; 3]>,
    pub(super) alpha: Vec<f32>,
    /// To linear Rec. 709, unless these are the colours.
    pub(super) to_rec709: Option<[[f32; 3]; 3]>,
    /// The memory in which it was decoded.
    pub(super) memory: Reservation,
}

fn is_pfm(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PF") || bytes.starts_with(b"Pf")
}

fn decode_common(
    bytes: &[u8],
    path: &Path,
    at: &Location,
    context: &mut LoadContext<'_>,
) -> Result<(DynamicImage, Reservation)> {
    #[cfg(feature = "images")]
    if tiff::is(bytes) {
        return tiff::decode(bytes, at, context);
    }
    let limits = &context.limits;
    let fault = |error: &ImageError| wrong(error, bytes, at, limits);
    let mut reader = ImageReader::new(Cursor::new(bytes));
    if let Ok(format) = ImageFormat::from_path(path)
        && format != ImageFormat::Tiff
    {
        reader.set_format(format);
    }
    let mut reader = reader.with_guessed_format().map_err(|error| fault(&ImageError::IoError(error)))?;

    // Memory for the pixels, the result of conversion, and the decoders themselves. Of a PNG the pixels do not count, but
    // all that is packed beside them does.
    let mut crate_limits = ::image::Limits::default();
    crate_limits.max_alloc = Some(match reader.format() {
        Some(ImageFormat::Png) => BESIDE_PIXELS,
        _ => limits.texels.saturating_mul(32).saturating_add(64 << 20),
    });
    reader.limits(crate_limits);

    let decoder = reader.into_decoder().map_err(|error| fault(&error))?;
    let (width, height) = decoder.dimensions();
    check_size(width.into(), height.into(), at, limits)?;
    // As the decoder returns it, and what the decoder needs or what it is converted to.
    let decoded = u64::from(decoder.color_type().bytes_per_pixel());
    let channels = u64::from(decoder.color_type().channel_count());
    let converted = if decoded > channels { DEEP } else { SHALLOW };
    let memory = room([width, height], decoded + converted, at, context)?;
    DynamicImage::from_decoder(decoder).map(|picture| (picture, memory)).map_err(|error| fault(&error))
}

/// Whether an image has more than 8 bits per channel.
fn is_deep(picture: &DynamicImage) -> bool {
    !matches!(
        picture,
        DynamicImage::ImageLuma8(_)
            | DynamicImage::ImageLumaA8(_)
            | DynamicImage::ImageRgb8(_)
            | DynamicImage::ImageRgba8(_)
    )
}

/// Linear colours; `encoding` applies to integer formats.
fn floats_of(picture: DynamicImage, memory: Reservation, encoding: Encoding<'_>) -> Floats {
    let (width, height) = (picture.width(), picture.height());
    let has_alpha = picture.color().has_alpha();
    let (mut texels, mut alpha) = (Vec::new(), Vec::new());
    if matches!(picture, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_)) {
        if has_alpha {
            let pixels = picture.into_rgba32f();
            texels.extend(pixels.pixels().map(|pixel| [pixel.0[0], pixel.0[1], pixel.0[2]]));
            alpha.extend(pixels.pixels().map(|pixel| pixel.0[3]));
        } else {
            texels.extend(picture.into_rgb32f().pixels().map(|pixel| pixel.0));
        }
        return Floats { width, height, texels, alpha, to_rec709: None, memory };
    }
    let table: Vec<f32> = (0..=u16::MAX).map(|value| encoding.decode(f32::from(value) / 65535.0)).collect();
    let pixels = picture.into_rgba16();
    let color = |[r, g, b, _]: [u16; 4]| [r, g, b].map(|value| table[usize::from(value)]);
    texels.extend(pixels.pixels().map(|pixel| color(pixel.0)));
    if has_alpha {
        alpha.extend(pixels.pixels().map(|pixel| f32::from(pixel.0[3]) / 65535.0));
    }
    Floats { width, height, texels, alpha, to_rec709: None, memory }
}

/// Our error for an error of the decoder.
fn wrong(error: &ImageError, bytes: &[u8], at: &Location, limits: &Limits) -> Error {
    match error {
        _ if bytes.is_empty() => Error::syntax(at, "the file is empty; expected a picture").hint(WHOLE),
        _ if is_left_out(bytes) => Error::new(
            ErrorKind::Unsupported,
            at,
            "this build has no reader for BMP, DDS, KTX2, PNM, TGA and TIFF",
        )
        .hint("build with the feature `images`, or save the picture as PNG, JPEG, WebP or EXR"),
        ImageError::Unsupported(_) => {
            Error::new(ErrorKind::Unsupported, at, format!("the picture format is not known: {error}"))
                .hint(format!("save it as one of {KNOWN}"))
        }
        ImageError::Limits(limit) => {
            let message = match limit.kind() {
                LimitErrorKind::DimensionError | LimitErrorKind::InsufficientMemory => {
                    format!("has more texels than the limit of {}", limits.texels)
                }
                _ => error.to_string(),
            };
            Error::new(ErrorKind::Limit, at, message).hint("make the picture smaller")
        }
        _ => Error::syntax(at, format!("not a complete picture: {error}")).hint(WHOLE),
    }
}

/// Portable float map: `PF` (colour) or `Pf` (grey), width, height, a factor whose sign gives the byte order, then
/// 32-bit numbers, bottom row first.
fn decode_pfm(bytes: &[u8], at: &Location, context: &LoadContext<'_>) -> Result<Floats> {
    let bad = |message: String| {
        Error::syntax(at, message)
            .hint("a PFM file starts with `PF`, width, height and scale, each before one space")
    };
    let mut rest = bytes;
    let mut word = || -> Option<&str> {
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let length = rest[start..].iter().position(u8::is_ascii_whitespace)?;
        let found = std::str::from_utf8(&rest[start..start + length]).ok()?;
        rest = &rest[start + length + 1..];
        Some(found)
    };
    let channels = match word() {
        Some("PF") => 3,
        Some("Pf") => 1,
        _ => return Err(bad("not a portable float map".to_owned())),
    };
    let width: u32 = word().and_then(|w| w.parse().ok()).ok_or_else(|| bad("has no width".to_owned()))?;
    let height: u32 = word().and_then(|w| w.parse().ok()).ok_or_else(|| bad("has no height".to_owned()))?;
    let scale: f32 = word().and_then(|w| w.parse().ok()).ok_or_else(|| bad("has no scale".to_owned()))?;
    check_size(width.into(), height.into(), at, &context.limits)?;

    let row = width as usize * channels * 4;
    if rest.len() / row < height as usize {
        return Err(bad(format!(
            "ends early: {} of {}",
            crate::plural::counted(rest.len(), "byte"),
            row * height as usize
        )));
    }
    let memory = room([width, height], size_of::<[f32; 3]>() as u64, at, context)?;
    let factor = if scale.is_finite() && scale != 0.0 { scale.abs() } else { 1.0 };
    let number = |b: &[u8]| {
        let b = [b[0], b[1], b[2], b[3]];
        factor * if scale < 0.0 { f32::from_le_bytes(b) } else { f32::from_be_bytes(b) }
    };
    let rows = rest[..row * height as usize].chunks_exact(row).rev();
    let texels = rows
        .flat_map(|row| row.chunks_exact(channels * 4))
        .map(|pixel| {
            let value = |channel: usize| number(&pixel[(channel % channels) * 4..]);
            [value(0), value(1), value(2)]
        })
        .collect();
    Ok(Floats { width, height, texels, alpha: Vec::new(), to_rec709: None, memory })
}
