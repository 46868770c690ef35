//! Development: from linear light to display bytes.
//!
//! The last step of a pixel: exposure, tone map, the curve of sRGB, eight bits. No dithering, so that equal light gives
//! equal bytes. Encoding to files is in `lookfrom_scene::image`.
//!
//! The tone maps are in `tonemap`. IEC 61966-2-1 (sRGB).

mod tonemap;

use std::sync::LazyLock;

use crate::core::parallel;
use crate::film::Picture;
use lookfrom_scene::settings::Tonemap;

/// The picture in sRGB, three bytes per pixel, row by row from the top left.
///
/// Light is multiplied by 2^`exposure` (clamped to ±128 stops; NaN is 0), mapped by `tonemap`, clamped to 0 … 1,
/// encoded by the exact sRGB curve and rounded to the nearest byte. NaN and negative light are black, infinite light is
/// white.
pub fn srgb8(picture: &Picture, exposure: f32, tonemap: Tonemap) -> Vec<u8> {
    srgb8_before(picture, [0.0; 3], exposure, tonemap)
}

/// As [`srgb8`], over a background of a linear colour in 0 … 1, composited by the picture's alpha. Exposure and tone
/// map do not change the background: where alpha is 0, the screen shows just this colour.
pub fn srgb8_before(picture: &Picture, background: [f32; 3], exposure: f32, tonemap: Tonemap) -> Vec<u8> {
    shown_before(picture, background, exposure, tonemap, byte)
}

/// As [`srgb8_before`], of 65535.
pub fn srgb16_before(picture: &Picture, background: [f32; 3], exposure: f32, tonemap: Tonemap) -> Vec<u16> {
    shown_before(picture, background, exposure, tonemap, sixteen_bits)
}

/// As [`srgb8`], with a fourth byte per pixel: alpha, linear from 0 to 255. The colours are divided by it first: PNG
/// has straight alpha. Pixels without an alpha are opaque.
pub fn srgba8(picture: &Picture, exposure: f32, tonemap: Tonemap) -> Vec<u8> {
    straight_rgba(picture, exposure, tonemap, byte, |alpha| (255.0 * alpha + 0.5) as u8)
}

/// As [`srgba8`], of 65535.
pub fn srgba16(picture: &Picture, exposure: f32, tonemap: Tonemap) -> Vec<u16> {
    straight_rgba(picture, exposure, tonemap, sixteen_bits, |alpha| (65535.0 * alpha + 0.5) as u16)
}

/// The display colours over a background, each component encoded.
fn shown_before<T: Copy + Default + Send>(
    picture: &Picture,
    background: [f32; 3],
    exposure: f32,
    tonemap: Tonemap,
    encode: impl Fn(f32) -> T + Sync,
) -> Vec<T> {
    let scale = scale(exposure);
    of_each_pixel(picture, |rgb, alpha| {
        let Some(alpha) = alpha else {
            return display(rgb, scale, tonemap).map(&encode);
        };
        let (straight, alpha) = straight(rgb, alpha);
        let shown = display(straight, scale, tonemap);
        [0, 1, 2].map(|c| encode(alpha * shown[c] + (1.0 - alpha) * background[c]))
    })
}

/// The straight display colours and alphas, each encoded.
fn straight_rgba<T: Copy + Default + Send>(
    picture: &Picture,
    exposure: f32,
    tonemap: Tonemap,
    encode: impl Fn(f32) -> T + Sync,
    encode_alpha: impl Fn(f32) -> T + Sync,
) -> Vec<T> {
    let scale = scale(exposure);
    of_each_pixel(picture, |rgb, alpha| {
        let (straight, alpha) = straight(rgb, alpha.unwrap_or(1.0));
        let [r, g, b] = display(straight, scale, tonemap).map(&encode);
        [r, g, b, encode_alpha(alpha)]
    })
}

/// `N` numbers of each pixel, by its light and its alpha, if it has one.
fn of_each_pixel<T: Copy + Default + Send, const N: usize>(
    picture: &Picture,
    numbers: impl Fn([f32; 3], Option<f32>) -> [T; N] + Sync,
) -> Vec<T> {
    const PIXELS: usize = 4096;
    let mut all = vec![[T::default(); N]; picture.pixels.len()];
    parallel::for_chunks_mut(&mut all, PIXELS, |chunk, all| {
        for (index, all) in (chunk * PIXELS..).zip(all) {
            *all = numbers(picture.pixels[index], picture.alpha.get(index).copied());
        }
    });
    all.into_flattened()
}

/// Straight colour from one premultiplied by alpha, and the alpha clamped to 0 … 1.
fn straight(rgb: [f32; 3], alpha: f32) -> ([f32; 3], f32) {
    let alpha = alpha.clamp(0.0, 1.0);
    (if alpha > 0.0 { rgb.map(|c| c / alpha) } else { [0.0; 3] }, alpha)
}

/// The byte of a linear value in 0 … 1: the number of thresholds that it has reached.
fn byte(value: f32) -> u8 {
    static THRESHOLDS: LazyLock<[f32; 255]> = LazyLock::new(thresholds);
    THRESHOLDS.partition_point(|&threshold| threshold <= value) as u8
}

/// The factor of an exposure in stops.
fn scale(exposure: f32) -> f64 {
    let stops = if exposure.is_nan() { 0.0 } else { f64::from(exposure).clamp(-128.0, 128.0) };
    libm::exp2(stops)
}

/// The display colour, linear in 0 … 1.
fn display(rgb: [f32; 3], scale: f64, tonemap: Tonemap) -> [f32; 3] {
    // A NaN is not greater than 0; the bound keeps infinities out of the quotients.
    let [r, g, b] = rgb.map(|light| if light > 0.0 { (f64::from(light) * scale).min(1e100) } else { 0.0 });
    tonemap::mapped([r, g, b], tonemap).map(|x| x.clamp(0.0, 1.0) as f32)
}

/// The byte of a linear value in 0 … 1, by the exact curve.
fn encode(value: f32) -> u8 {
    (255.0 * bent(value) + 0.5) as u8
}

/// As [`encode`], of 65535.
fn sixteen_bits(value: f32) -> u16 {
    (65535.0 * bent(value) + 0.5) as u16
}

/// The curve of sRGB.
fn bent(value: f32) -> f64 {
    let x = f64::from(value);
    if x <= 0.0031308 { 12.92 * x } else { 1.055 * libm::pow(x, 1.0 / 2.4) - 0.055 }
}

/// The least values that [`encode`] maps to the bytes 1, 2, … 255: the curve is monotonic, so they determine it.
fn thresholds() -> [f32; 255] {
    std::array::from_fn(|below| {
        // Bisect the bits of f32: those of positive numbers are in the order of the numbers.
        let (mut under, mut reached) = (0.0_f32.to_bits(), 1.0_f32.to_bits());
        while reached - under > 1 {
            let middle = under + (reached - under) / 2;
            if usize::from(encode(f32::from_bits(middle))) > below {
                reached = middle;
            } else {
                under = middle;
            }
        }
        f32::from_bits(reached)
    })
}

#[cfg(test)]
mod tests;
