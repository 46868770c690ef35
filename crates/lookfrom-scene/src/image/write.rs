//! Image writers: 8-bit PNG and PPM, and HDR and PFM for linear light. EXR is in `openexr`.

use std::io::Cursor;

use ::image::codecs::hdr::HdrEncoder;
use ::image::codecs::png::{CompressionType, FilterType, PngEncoder};
use ::image::{ExtendedColorType, ImageEncoder, Rgb};

use crate::error::{Error, ErrorKind, Location, Result};

/// The bytes of a PNG of 8-bit sRGB colours, row 0 on top. The same input gives the same bytes.
///
/// # Errors
/// `Invalid` if `rgb` is not `3 * width * height` bytes.
pub fn encode_png(width: u32, height: u32, rgb: &[u8]) -> Result<Vec<u8>> {
    check_bytes(width, height, rgb, 3)?;
    encode(width, height, rgb, ExtendedColorType::Rgb8)
}

/// The bytes of a PNG of 8-bit sRGB colours with straight (not premultiplied) alpha, row 0 on top. The same input gives the
/// same bytes.
///
/// # Errors
/// `Invalid` if `rgba` is not `4 * width * height` bytes.
pub fn encode_png_with_alpha(width: u32, height: u32, rgba: &[u8]) -> Result<Vec<u8>> {
    check_bytes(width, height, rgba, 4)?;
    encode(width, height, rgba, ExtendedColorType::Rgba8)
}

fn encode(width: u32, height: u32, bytes: &[u8], color: ExtendedColorType) -> Result<Vec<u8>> {
    let mut png = Cursor::new(Vec::new());
    PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive)
        .write_image(bytes, width, height, color)
        .map_err(|error| {
            Error::new(ErrorKind::Io, &Location::default(), format!("cannot encode: {error}"))
        })?;
    Ok(png.into_inner())
}

/// The bytes of a binary PPM (P6) of 8-bit sRGB colours, row 0 on top.
///
/// # Errors
/// `Invalid` if `rgb` is not `3 * width * height` bytes.
pub fn encode_ppm(width: u32, height: u32, rgb: &[u8]) -> Result<Vec<u8>> {
    check_bytes(width, height, rgb, 3)?;
    let mut bytes = format!("P6\n{width} {height}\n255\n").into_bytes();
    bytes.extend_from_slice(rgb);
    Ok(bytes)
}

/// The bytes of a Radiance HDR image of linear colours, row 0 on top: three 8-bit mantissas with a shared exponent.
///
/// # Errors
/// `Invalid` if `texels` are not `width * height` colours.
pub fn encode_hdr(width: u32, height: u32, texels: &[[f32; 3]]) -> Result<Vec<u8>> {
    check(width, height, texels.len())?;
    let mut bytes = Vec::new();
    let pixels: Vec<Rgb<f32>> = texels.iter().map(|&texel| Rgb(texel)).collect();
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

fn check_bytes(width: u32, height: u32, bytes: &[u8], a_pixel: usize) -> Result<()> {
    if bytes.len().is_multiple_of(a_pixel) {
        return check(width, height, bytes.len() / a_pixel);
    }
    Err(Error::invalid(&Location::default(), format!("{} bytes are not {a_pixel} per pixel", bytes.len())))
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
