//! Estimates of a pixel's light from samples with filter weights of both signs.
//!
//! A filter with negative lobes gives its samples weights of one magnitude c, which are 1 on average. The mean of w L is right in the mean, but
//! noisy where L is bright: also where it is the same all over the filter. So each sample is compared with the mean of the others,
//! mᵢ = Σ_{j ≠ i} Lⱼ / (n − 1), which does not depend on its weight: the mean of mᵢ + wᵢ (Lᵢ − mᵢ) is right in the mean, too, and has no noise
//! of equal samples. It needs Σ w, Σ w L and Σ |w| L.

use super::light_paths::LightPathSums;
use super::pixel::Pixel;
use super::stored::{Stored, Sums, channels_of, store_fields};
use super::{Film, xyz};
use crate::core::fixed_point::{TWO_TO_48, TWO_TO_64, fixed_point, nearest_f64, nearest_f64_of_squares};

/// The sums of the filter weights of a pixel's samples, in multiples of 2⁻⁶⁴. Additions wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct WeightSums {
    pub(super) sum: i128,
    pub(super) magnitude: i128,
}

store_fields!(WeightSums { sum: i128 = ["sum"], magnitude: i128 = ["magnitude"] });

impl WeightSums {
    /// Adds the weight of a sample, which is finite.
    pub(super) fn add(&mut self, weight: f32) {
        self.merge(&Self { sum: fixed_point(weight), magnitude: fixed_point(weight.abs()) });
    }

    pub(super) fn merge(&mut self, add: &Self) {
        self.sum = self.sum.wrapping_add(add.sum);
        self.magnitude = self.magnitude.wrapping_add(add.magnitude);
    }
}

/// The filter weights of a pixel's samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights {
    /// Number of samples.
    pub(super) samples: f64,
    /// Their mean, and that of their magnitudes; `None` where all are 1.
    means: Option<[f64; 2]>,
}

/// Sums of numbers times their weights and, where these differ, times the magnitudes of their weights; in multiples of 2⁻⁶⁴.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weighted {
    pub(super) signed: i128,
    pub(super) unsigned: Option<i128>,
}

impl Weights {
    pub(super) fn new(samples: u64, sums: Option<WeightSums>) -> Self {
        let samples = samples as f64;
        let mean = |sum: i128| nearest_f64(sum) / (samples * TWO_TO_64);
        Self { samples, means: sums.map(|WeightSums { sum, magnitude }| [mean(sum), mean(magnitude)]) }
    }

    /// The mean of w L, and that of L where weights differ.
    fn means(self, Weighted { signed, unsigned }: Weighted) -> [f64; 2] {
        let mean = |sum: i128| nearest_f64(sum) / (self.samples * TWO_TO_64);
        let signed = mean(signed);
        match (unsigned, self.means) {
            (Some(unsigned), Some([_, magnitude])) => [signed, mean(unsigned) / magnitude],
            _ => [signed, signed],
        }
    }

    /// The estimate of the numbers: where weights do not differ their mean, exact up to one rounding for the sum and one for the quotient. 0
    /// without samples.
    pub(super) fn mean(self, sums: Weighted) -> f64 {
        let n = self.samples;
        let [signed, plain] = self.means(sums);
        match self.means {
            _ if n == 0.0 => 0.0,
            None => signed,
            // One has no others: its weight would be all of its noise.
            Some(_) if n < 2.0 => plain,
            Some([weight, _]) => signed + ((1.0 - weight) * n * plain - plain + signed) / (n - 1.0),
        }
    }

    /// The unbiased variance of one sample, by the sum of squares in multiples of 2⁻⁴⁸, given the [means](Self::means). Infinite of fewer than two.
    fn variance(self, [signed, plain]: [f64; 2], squares: u128) -> f64 {
        let n = self.samples;
        if n < 2.0 {
            return f64::INFINITY;
        }
        let mean_of_squares = nearest_f64_of_squares(squares) / (n * TWO_TO_48);
        // Of w (L − m): the mean of its square less the square of its mean.
        let of_means = match self.means {
            None => signed * signed,
            Some([weight, magnitude]) => {
                let [rest, plain] = [signed - weight * plain, magnitude * plain];
                plain * plain + rest * rest
            }
        };
        // For equal samples rounding leaves a small value of either sign.
        (mean_of_squares - of_means).max(0.0) * (n / (n - 1.0))
    }

    /// The variance of one of the numbers.
    pub(super) fn variance_of(self, sums: Weighted, squares: u128) -> f64 {
        self.variance(self.means(sums), squares)
    }
}

/// The sums of a pixel, and the weights of its samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct WeightedPixel {
    pub(super) pixel: Pixel,
    pub(super) weights: Weights,
    /// Sums of light by the magnitudes of weights, where these differ.
    pub(super) unsigned: Option<LightPathSums>,
}

impl WeightedPixel {
    /// Number of samples.
    pub(super) fn samples(&self) -> u64 {
        self.pixel.samples
    }

    /// The estimate of the light.
    pub(super) fn mean(&self) -> [f32; 3] {
        weighted(self.pixel.sums, self.unsigned).map(|sums| self.weights.mean(sums) as f32)
    }

    /// The variance of one sample of light, in X, Y and Z.
    pub(super) fn variance(&self) -> [f64; 3] {
        self.variance_of(xyz)
    }

    /// The variance of one sample in the numbers that were squared.
    pub(super) fn variance_of(&self, squared: impl Fn([f64; 3]) -> [f64; 3]) -> [f64; 3] {
        let means = weighted(self.pixel.sums, self.unsigned).map(|sums| self.weights.means(sums));
        let [signed, plain] = [0, 1].map(|kind| squared(means.map(|means| means[kind])));
        std::array::from_fn(|c| self.weights.variance([signed[c], plain[c]], self.pixel.squares[c]))
    }
}

/// The sums of red, green and blue.
pub(super) fn weighted(sums: [i128; 3], unsigned: Option<LightPathSums>) -> [Weighted; 3] {
    std::array::from_fn(|c| Weighted { signed: sums[c], unsigned: unsigned.map(|unsigned| unsigned.sums[c]) })
}

impl Film {
    /// The weights of the samples of a pixel.
    pub(super) fn weights(&self, x: u32, y: u32) -> Weights {
        Weights::new(self.samples(x, y), self.sums_of(&self.weights, x, y))
    }

    /// The sums of a pixel; `None` outside of [`Film::area`].
    pub(super) fn pixel(&self, x: u32, y: u32) -> Option<WeightedPixel> {
        let pixel = self.sums_of(&self.pixels, x, y)?;
        let weights = Weights::new(pixel.samples, self.sums_of(&self.weights, x, y));
        let unsigned = self.unsigned_light.first().and_then(|plane| self.sums_of(plane, x, y));
        Some(WeightedPixel { pixel, weights, unsigned })
    }

    /// Calls `each` for the pixels of columns `x0` to `x1` (exclusive) of a row. They must be inside of [`Film::area`].
    pub(super) fn row(&self, y: u32, x0: u32, x1: u32, mut each: impl FnMut(WeightedPixel)) {
        let (mut weights, mut unsigned) = (Vec::new(), Vec::new());
        if let Some(plane) = self.unsigned_light.first() {
            self.weights.row(y, x0, x1, |sums| weights.push(sums));
            plane.row(y, x0, x1, |sums| unsigned.push(sums));
        }
        let (mut weights, mut unsigned) = (weights.into_iter(), unsigned.into_iter());
        self.pixels.row(y, x0, x1, |pixel| {
            let weights = Weights::new(pixel.samples, weights.next());
            each(WeightedPixel { pixel, weights, unsigned: unsigned.next() });
        });
    }
}
