//! Comparison of a picture with a reference.

use lookfrom::core::math::luminance;
use lookfrom::film::{Film, Picture};
use lookfrom::post::develop::srgb8;
use lookfrom::session::Developed;
use lookfrom_scene::Result;
use lookfrom_scene::image::compare::MOST_STANDARD_ERRORS;
use lookfrom_scene::image::flip::{PIXELS_PER_DEGREE, flip};
use lookfrom_scene::image::{Image, Pixels, encode_png_to_show};

use crate::heat::{byte, heat};
use crate::message::Comparing;

/// The pictures of a comparison as PNGs: of a wipe both, else one.
///
/// # Errors
/// As those of encoding.
pub(crate) fn pictures(
    developed: &Developed,
    film: &Film,
    reference: &Image,
    comparing: Comparing,
) -> Result<Vec<Vec<u8>>> {
    let &Picture { width, height, ref pixels, .. } = &developed.picture;
    let other = resized(reference, width, height);
    let (exposure, tonemap) = (developed.development.exposure, developed.development.tonemap);
    let shown = |pixels: Vec<[f32; 3]>| {
        let picture = Picture { width, height, pixels, alpha: Vec::new() };
        encode_png_to_show([width, height], Pixels::Rgb8(&srgb8(&picture, exposure, tonemap)))
    };
    let colored = |colors: Vec<[f32; 3]>| {
        let bytes: Vec<u8> = colors.into_iter().flat_map(|color| color.map(byte)).collect();
        encode_png_to_show([width, height], Pixels::Rgb8(&bytes))
    };
    let pairs = || pixels.iter().zip(&other);
    Ok(match comparing {
        Comparing::Wipe => vec![shown(pixels.clone())?, shown(other)?],
        Comparing::Reference => vec![shown(other)?],
        Comparing::Difference => {
            let difference = |(a, b): (&[f32; 3], &[f32; 3])| std::array::from_fn(|c| (a[c] - b[c]).abs());
            vec![shown(pairs().map(difference).collect())?]
        }
        Comparing::Flip => {
            let scale = exposure.exp2();
            let errors = flip([pixels, &other], width as usize, scale, PIXELS_PER_DEGREE);
            vec![colored(errors.into_iter().map(heat).collect())?]
        }
        Comparing::Z => {
            let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let scores = pairs().zip(places).map(|((a, b), (x, y))| {
                let variance = luminance_variance(film, [x, y]) / film.samples(x, y).max(1) as f32;
                (luminance(*a) - luminance(*b)) / variance.sqrt().max(1e-12)
            });
            vec![colored(scores.map(signed).collect())?]
        }
    })
}

/// The variance of one sample's luminance.
pub(crate) fn luminance_variance(film: &Film, [x, y]: [u32; 2]) -> f32 {
    let [_, luminance, _] = film.variance(x, y);
    luminance
}

/// Blue for too dark, red for too bright, saturated where noise does not explain it.
fn signed(score: f32) -> [f32; 3] {
    let share = (score.abs() / MOST_STANDARD_ERRORS as f32).min(1.0);
    if score > 0.0 { [1.0, 1.0 - share, 1.0 - share] } else { [1.0 - share, 1.0 - share, 1.0] }
}

/// The texels of an image, or those nearest to the pixels of a coarse picture.
fn resized(image: &Image, width: u32, height: u32) -> Vec<[f32; 3]> {
    let place = |at: u32, of: u32, texels: u32| u64::from(at) * u64::from(texels) / u64::from(of);
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let index =
        |(x, y)| place(y, height, image.height) * u64::from(image.width) + place(x, width, image.width);
    pixels.map(|pixel| image.texel(index(pixel) as usize)).collect()
}
