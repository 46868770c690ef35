//! The denoiser: guided non-local means.
//!
//! Between the film and [`crate::post::develop`]: light in, light out. The noise of neighbouring pixels is independent,
//! their signal is not, so each pixel becomes a mean over those around it that show the same. That is tested in three
//! ways:
//!
//! - *Non-local means* (Buades, Coll & Morel 2005; for renderings Rousselle, Knaus & Zwicker 2012): the light of the 3
//!   × 3 pixels around both may differ by no more than their noise, which the film estimates. Where noise is small
//!   compared with the differences in the picture, only equal pixels are averaged: with more samples the result
//!   converges to the film's.
//! - *Features* (joint filtering: Rousselle, Manzi & Zwicker 2013): albedo, normal and position of the first hits may
//!   differ by little.
//! - Light is divided by the albedo first and multiplied by it afterwards, so that a texture is not taken for noise,
//!   nor blurred.
//!
//! A mean of *differences* to its neighbours is added to a pixel, so that where there are none nothing is changed, not
//! even by rounding. A pixel's result is a pure function of those around it, and sums have a fixed order: bits do not
//! depend on the number of threads, the SIMD width or the bands of rows that are filtered one after the other. `exp(−x)` is
//! replaced by `(1 − x/8)⁸`, and by 0 beyond x = 8.

mod filter;
mod planes;

use crate::film::{Film, Picture};
use filter::Changes;
use planes::Planes;

/// Number of rows that are filtered together: the memory of all that is known of their pixels is small beside that of the film.
const BAND: usize = 8 * filter::ROWS;

/// The radius of the filter in pixels, along each axis.
const RADIUS: usize = 5;

/// The radius of a patch around its pixel.
const PATCH: usize = 1;

/// `picture`, that of `film` (possibly without its fireflies), denoised: colours, and alpha where it has some.
///
/// Without the film's [features](Film::denoiser_features), textures and edges are distinguished from noise by light
/// alone. Pixels without samples, and those outside of [`Film::area`], stay as they are. The mean light of the picture
/// is preserved approximately, not exactly.
///
/// # Panics
/// If the picture has another size than the film.
pub fn denoised(film: &Film, picture: &Picture) -> Picture {
    let mut clean = picture.clone();
    denoise(film, &mut clean);
    clean
}

/// Denoises the picture of a film, as [`denoised`] does, in its own memory.
///
/// # Panics
/// If the picture has another size than the film.
pub fn denoise(film: &Film, picture: &mut Picture) {
    denoise_in_bands(film, picture, BAND);
}

/// [`denoise`] with this number of rows in a band, a multiple of [`filter::ROWS`].
fn denoise_in_bands(film: &Film, picture: &mut Picture, rows: usize) {
    assert_eq!((film.width(), film.height()), (picture.width, picture.height), "a picture of another film");
    if picture.alpha.is_empty() {
        filter_bands::<3>(film, picture, rows);
    } else {
        filter_bands::<4>(film, picture, rows);
    }
}

fn filter_bands<const N: usize>(film: &Film, picture: &mut Picture, rows: usize) {
    let height = (film.area().y1 - film.area().y0) as usize;
    let alpha_divisor = planes::alpha_divisor(film);
    // The planes of a band need rows of the one before as they were.
    let mut before: Option<Changes<N>> = None;
    for top in (0..height).step_by(rows) {
        let planes = Planes::<N>::new(film, picture, top..height.min(top + rows), alpha_divisor);
        if let Some(changes) = before.take() {
            changes.apply(picture);
        }
        before = Some(planes.changes());
    }
    if let Some(changes) = before {
        changes.apply(picture);
    }
}

#[cfg(test)]
mod tests;
