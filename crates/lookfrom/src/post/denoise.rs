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
//! depend on the number of threads or the SIMD width. `exp(−x)` is replaced by `(1 − x/8)⁸`, and by 0 beyond x = 8.

mod filter;
mod planes;

use crate::film::{Film, Picture};
use planes::Planes;

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
    assert_eq!((film.width(), film.height()), (picture.width, picture.height), "a picture of another film");
    let mut clean = picture.clone();
    if picture.alpha.is_empty() {
        Planes::<3>::new(film, picture).filter_into(&mut clean);
    } else {
        Planes::<4>::new(film, picture).filter_into(&mut clean);
    }
    clean
}

#[cfg(test)]
mod tests;
