//! Image writers: PNG, JPEG, WebP and PPM for display, and HDR and PFM for linear light. EXR is in `openexr`.

use std::io::Write;

use ::image::codecs::hdr::HdrEncoder;
use ::image::codecs::jpeg::JpegEncoder;
use ::image::codecs::png::{CompressionType, FilterType, PngEncoder};
use ::image::codecs::webp::WebPEncoder;
use ::image::{ExtendedColorType, ImageEncoder, ImageResult, Rgb};

use super::metadata::Metadata;
use super::rgbe;
use crate::error::{Error, ErrorKind, Location, Result};

/// Colours in sRGB, row 0 on top; alpha is straight (not premultiplied).
#[derive(Clone, Copy, Debug)]
pub enum Pixels<'a> {
    /// Red, green, blue.
    Rgb8(&'a [u8]),
    /// Red, green, blue, alpha.
    Rgba8(&'a [u8]),
    /// Red, green, blue: of 65535.
    Rgb16(&'a [u16]),
    /// Red, green, blue, alpha: of 65535.
    Rgba16(&'a [u16]),
}

impl Pixels<'_> {
    fn color_type(&self) -> ExtendedColorType {
        match self {
            Self::Rgb8(_) => ExtendedColorType::Rgb8,
            Self::Rgba8(_) => ExtendedColorType::Rgba8,
            Self::Rgb16(_) => ExtendedColorType::Rgb16,
            Self::Rgba16(_) => ExtendedColorType::Rgba16,
        }
    }

    /// Encodes them, if they are as many as a size says.
    fn encode(
        &self,
        [width, height]: [u32; 2],
        encode: impl FnOnce(&[u8], ExtendedColorType) -> ImageResult<()>,
    ) -> Result<()> {
        let channels = match self {
            Self::Rgb8(_) | Self::Rgb16(_) => 3,
            Self::Rgba8(_) | Self::Rgba16(_) => 4,
        };
        let encoded = match self {
            Self::Rgb8(bytes) | Self::Rgba8(bytes) => {
                check_channels(width, height, bytes.len(), channels)?;
                encode(bytes, self.color_type())
            }
            Self::Rgb16(numbers) | Self::Rgba16(numbers) => {
                check_channels(width, height, numbers.len(), channels)?;
                let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_ne_bytes()).collect();
                encode(&bytes, self.color_type())
            }
        };
        encoded.map_err(|error| {
            Error::new(ErrorKind::Io, &Location::default(), format!("cannot encode: {error}"))
        })
    }
}

/// The bytes of a PNG of 8-bit sRGB colours, row 0 on top. The same input gives the same bytes.
///
/// # Errors
/// `Invalid` if `rgb` is not `3 * width * height` bytes.
pub fn encode_png(width: u32, height: u32, rgb: &[u8]) -> Result<Vec<u8>> {
    encode_png_of([width, height], Pixels::Rgb8(rgb), None)
}

/// The bytes of a PNG that is shown once and not kept: more bytes in less time than those of [`encode_png_of`].
///
/// # Errors
/// `Invalid` if there are not as many pixels as `size` (width and height) says.
pub fn encode_png_to_show(size: [u32; 2], pixels: Pixels) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write_png_by(CompressionType::Fast, size, pixels, None, &mut bytes)?;
    Ok(bytes)
}

/// The bytes of a PNG, and what is told of it. The same input gives the same bytes.
///
/// # Errors
/// `Invalid` if there are not as many pixels as `size` (width and height) says.
pub fn encode_png_of(size: [u32; 2], pixels: Pixels, metadata: Option<&Metadata>) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write_png(size, pixels, metadata, &mut bytes)?;
    Ok(bytes)
}

/// Writes the PNG that [`encode_png_of`] makes.
///
/// # Errors
/// As [`encode_png_of`], and `Io` where `out` fails.
pub fn write_png(
    size: [u32; 2],
    pixels: Pixels,
    metadata: Option<&Metadata>,
    out: &mut impl Write,
) -> Result<()> {
    write_png_by(CompressionType::Default, size, pixels, metadata, out)
}

fn write_png_by(
    compression: CompressionType,
    size: [u32; 2],
    pixels: Pixels,
    metadata: Option<&Metadata>,
    out: &mut impl Write,
) -> Result<()> {
    pixels.encode(size, |samples, color| {
        let mut encoder = PngEncoder::new_with_quality(out, compression, FilterType::Adaptive);
        Metadata::tell(metadata, &mut encoder)?;
        encoder.write_image(samples, size[0], size[1], color)
    })
}

/// The bytes of a JPEG (baseline, colours at full resolution) of a quality of 1 (small) to 100, and what is told of it. The same
/// input gives the same bytes.
///
/// # Errors
/// `Invalid` if `rgb` is not `3 * width * height` bytes, or a side is longer than the 65,535 pixels that the format has.
pub fn encode_jpeg(
    [width, height]: [u32; 2],
    rgb: &[u8],
    quality: u8,
    metadata: Option<&Metadata>,
) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write_jpeg([width, height], rgb, quality, metadata, &mut bytes)?;
    Ok(bytes)
}

/// Writes the JPEG that [`encode_jpeg`] makes.
///
/// # Errors
/// As [`encode_jpeg`], and `Io` where `out` fails.
pub fn write_jpeg(
    [width, height]: [u32; 2],
    rgb: &[u8],
    quality: u8,
    metadata: Option<&Metadata>,
    out: &mut impl Write,
) -> Result<()> {
    check_side("JPEG", width.max(height), 65_535)?;
    Pixels::Rgb8(rgb).encode([width, height], |samples, color| {
        let mut encoder = JpegEncoder::new_with_quality(out, quality.clamp(1, 100));
        Metadata::tell(metadata, &mut encoder)?;
        encoder.write_image(samples, width, height, color)
    })
}

/// The bytes of a WebP without loss, of 8 bits a channel, and what is told of it. The same input gives the same bytes.
///
/// # Errors
/// `Invalid` if there are not as many pixels as `size` (width and height) says, or a side is longer than the 16,384 pixels that the format
/// has.
pub fn encode_webp(size: [u32; 2], pixels: Pixels, metadata: Option<&Metadata>) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write_webp(size, pixels, metadata, &mut bytes)?;
    Ok(bytes)
}

/// Writes the WebP that [`encode_webp`] makes.
///
/// # Errors
/// As [`encode_webp`], and `Io` where `out` fails.
pub fn write_webp(
    size: [u32; 2],
    pixels: Pixels,
    metadata: Option<&Metadata>,
    out: &mut impl Write,
) -> Result<()> {
    check_side("WebP", size[0].max(size[1]), 16_384)?;
    pixels.encode(size, |samples, color| {
        let mut encoder = WebPEncoder::new_lossless(out);
        Metadata::tell(metadata, &mut encoder)?;
        encoder.write_image(samples, size[0], size[1], color)
    })
}

/// The bytes of a binary PPM (P6) of 8-bit sRGB colours, row 0 on top.
///
/// # Errors
/// `Invalid` if `rgb` is not `3 * width * height` bytes.
pub fn encode_ppm(width: u32, height: u32, rgb: &[u8]) -> Result<Vec<u8>> {
    check_channels(width, height, rgb.len(), 3)?;
    let mut bytes = format!("P6\n{width} {height}\n255\n").into_bytes();
    bytes.extend_from_slice(rgb);
    Ok(bytes)
}

/// The bytes of a Radiance HDR image of linear colours, row 0 on top: three 8-bit mantissas with a shared exponent, the nearest to each
/// colour. A negative value, and what is no number, is 0; what is brighter than the format can say, also +∞, is the brightest that it can.
///
/// # Errors
/// `Invalid` if `texels` are not `width * height` colours.
pub fn encode_hdr(width: u32, height: u32, texels: &[[f32; 3]]) -> Result<Vec<u8>> {
    check(width, height, texels.len())?;
    let mut bytes = Vec::new();
    let pixels: Vec<Rgb<f32>> = texels.iter().map(|&texel| Rgb(rgbe::nearest(texel))).collect();
    HdrEncoder::new(&mut bytes).encode(&pixels, width as usize, height as usize).map_err(|error| {
        Error::new(ErrorKind::Io, &Location::default(), format!("cannot encode: {error}"))
    })?;
    Ok(bytes)
}

/// The bytes of a portable float map of linear colours, row 0 on top, without loss.
///
/// # Errors
/// `Invalid` if `texels` are not `width * height` colours.
pub fn encode_pfm(width: u32, height: u32, texels: &[[f32; 3]]) -> Result<Vec<u8>> {
    check(width, height, texels.len())?;
    let mut bytes = format!("PF\n{width} {height}\n-1.0\n").into_bytes();
    for row in texels.chunks_exact(width as usize).rev() {
        bytes.extend(row.as_flattened().iter().flat_map(|value| value.to_le_bytes()));
    }
    Ok(bytes)
}

/// The colours of pixels of red, green, blue and alpha.
pub fn without_alpha(rgba: &[u8]) -> Vec<u8> {
    rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
}

/// Checks the number of values of a picture with so many of them a pixel.
pub(super) fn check_channels(width: u32, height: u32, values: usize, channels: usize) -> Result<()> {
    if values.is_multiple_of(channels) {
        return check(width, height, values / channels);
    }
    Err(Error::invalid(&Location::default(), format!("{values} values are not {channels} per pixel")))
}

/// Checks the longer side of a picture against the longest of a format.
fn check_side(format: &str, side: u32, most: u32) -> Result<()> {
    if side <= most {
        return Ok(());
    }
    let message = format!("a {format} has at most {most} pixels a side, not {side}");
    Err(Error::invalid(&Location::default(), message).hint("write a PNG or an EXR"))
}

/// Checks that there is a value for each pixel, and at least one pixel.
pub(super) fn check(width: u32, height: u32, values: usize) -> Result<()> {
    if values == 0 || u64::from(width) * u64::from(height) != values as u64 {
        return Err(Error::invalid(
            &Location::default(),
            format!("a picture of {width}×{height} cannot be made of {values} pixels"),
        ));
    }
    Ok(())
}
