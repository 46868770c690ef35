//! Sums of spectral radiance in the buckets of a spectral film.
//!
//! A sample has light at four wavelengths of uniform density, or after dispersion at one that counts for four. The mean of a bucket is
//! over the wavelengths that fell into it, as in pbrt-v4: where light does not depend on the wavelength it has no noise of its own.
//! Fixed-point numbers as those of all light ([`super::Pixel`]); a pixel takes 32 bytes for each bucket.

use super::Film;
use super::stored::{Stored, Sums, channels_of, store_fields};
use crate::core::fixed_point::{TWO_TO_64, fixed_point};

/// The sums of a bucket over the samples of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct BucketSums {
    /// Multiples of 2⁻⁶⁴. Additions wrap.
    sum: i128,
    /// Number of wavelengths.
    wavelengths: u64,
}

store_fields!(BucketSums { sum: i128 = ["sum"], wavelengths: u64 = ["wavelengths"] });

impl BucketSums {
    /// Adds the radiance at one wavelength that counts for `count`; a number that is not finite counts as 0.
    pub(super) fn add(&mut self, radiance: f32, count: u32) {
        let radiance = if radiance.is_finite() { fixed_point(radiance) } else { 0 };
        self.sum = self.sum.wrapping_add(radiance.wrapping_mul(count.into()));
        self.wavelengths = self.wavelengths.saturating_add(count.into());
    }

    pub(super) fn merge(&mut self, add: &Self) {
        self.sum = self.sum.wrapping_add(add.sum);
        self.wavelengths = self.wavelengths.saturating_add(add.wavelengths);
    }

    /// The mean, 0 where there are no wavelengths.
    pub(super) fn mean(&self) -> f32 {
        match self.wavelengths {
            0 => 0.0,
            count => (self.sum as f64 / (count as f64 * TWO_TO_64)) as f32,
        }
    }
}

impl Film {
    /// The mean spectral radiance of a pixel in each bucket of a spectral film, by wavelength: over the wavelengths that its samples had
    /// in the bucket, 0 where there were none and outside of [`Film::area`]. The light of D65 of luminance 1 has the mean 1 over all
    /// wavelengths, weighted by the luminous efficiency.
    pub fn spectrum(&self, x: u32, y: u32) -> impl Iterator<Item = f32> {
        self.buckets.iter().map(move |bucket| self.sums_of(bucket, x, y).map_or(0.0, |sums| sums.mean()))
    }

    /// The number of buckets of a spectral film; 0 of another one.
    pub fn buckets(&self) -> usize {
        self.buckets.len()
    }
}
