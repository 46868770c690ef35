//! Sums of spectral radiance in the buckets of a spectral film.
//!
//! A sample has light at four wavelengths of uniform density, or after dispersion at one that counts for four. The mean of a bucket is
//! over the wavelengths that fell into it, as in pbrt-v4: where light does not depend on the wavelength it has no noise of its own.
//! Fixed-point numbers as those of all light ([`super::Pixel`]); a pixel takes 32 bytes for each bucket.

use super::Film;
use super::stored::{Stored, Sums, channels_of, store_fields};
use super::weighted::{Weighted, Weights};
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
        self.sum = self.sum.wrapping_add(counted(radiance, count));
        self.wavelengths = self.wavelengths.saturating_add(count.into());
    }

    pub(super) fn merge(&mut self, add: &Self) {
        self.sum = self.sum.wrapping_add(add.sum);
        self.wavelengths = self.wavelengths.saturating_add(add.wavelengths);
    }

    /// The mean, 0 where there are no wavelengths; where filter weights differ, by the estimate of the sum of the samples.
    fn mean(&self, unsigned: Option<i128>, weights: Weights) -> f32 {
        let sum = match unsigned {
            None => self.sum as f64 / TWO_TO_64,
            Some(_) => weights.mean(Weighted { signed: self.sum, unsigned }) * weights.samples,
        };
        if self.wavelengths == 0 { 0.0 } else { (sum / self.wavelengths as f64) as f32 }
    }
}

/// The radiance at one wavelength that counts for `count`, in multiples of 2⁻⁶⁴; 0 where it is not finite.
pub(super) fn counted(radiance: f32, count: u32) -> i128 {
    let radiance = if radiance.is_finite() { fixed_point(radiance) } else { 0 };
    radiance.wrapping_mul(count.into())
}

impl Film {
    /// The mean spectral radiance of a pixel in each bucket of a spectral film, by wavelength: over the wavelengths that its samples had
    /// in the bucket, 0 where there were none and outside of [`Film::area`]. The light of D65 of luminance 1 has the mean 1 over all
    /// wavelengths, weighted by the luminous efficiency.
    pub fn spectrum(&self, x: u32, y: u32) -> impl Iterator<Item = f32> {
        let weights = self.weights(x, y);
        self.buckets.iter().enumerate().map(move |(index, bucket)| {
            let unsigned = self.unsigned_buckets.get(index).and_then(|plane| self.sums_of(plane, x, y));
            self.sums_of(bucket, x, y).map_or(0.0, |sums| sums.mean(unsigned, weights))
        })
    }

    /// The number of buckets of a spectral film; 0 of another one.
    pub fn buckets(&self) -> usize {
        self.buckets.len()
    }
}
