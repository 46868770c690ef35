//! The denoiser: guided non-local means.
//!
//! Between the film and [`crate::post::develop`]: light in, light out. Noise of neighbouring pixels is independent, what they show is
//! not, so each pixel becomes a mean over those around it that show the same. That is tested in three ways:
//!
//! - *Non-local means* (Buades, Coll & Morel 2005, as Rousselle, Knaus & Zwicker 2012 have it for renderings): the light of the 3 × 3
//!   pixels around both may differ by no more than their noise, which the film knows. Where noise is small next to what is shown,
//!   only equals are left: with ever more samples the picture becomes that of the film.
//! - *Features* (joint filtering: Rousselle, Manzi & Zwicker 2013): albedo, normal and place of what the camera saw may differ
//!   by little.
//! - Light is divided by the albedo first and multiplied by it afterwards, so that a texture is not taken for noise, nor
//!   blurred.
//!
//! What is added to a pixel is a mean of *differences* to its neighbours, so that where there are none nothing is changed, not even by
//! rounding. A pixel's result is a pure function of those around it, and sums have a fixed order: bits do not depend on
//! threads or the machine's vectors. `exp(−x)` is replaced by `(1 − x/8)⁸`, which ends at 8.

mod filter;
mod planes;

use crate::film::{Film, Picture};
use planes::Planes;

/// The radius of the filter in pixels, along each axis.
const RADIUS: usize = 5;

/// How far a patch reaches around its pixel.
const PATCH: usize = 1;

/// `picture`, that of `film` (perhaps without its fireflies), with noise filtered out: colours, and alpha where it has some.
///
/// Works with what the film knows: without its [features](Film::denoiser_features), textures and edges must be told from noise by light alone. Pixels
/// without samples, and those outside of [`Film::area`], stay as they are. The mean light of the picture stays much the
/// same; it is not kept exactly.
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
