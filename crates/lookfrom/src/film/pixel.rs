//! The sums of a pixel in fixed point: of light, or of what a sensor measures.

use super::{BRIGHTEST, xyz};
use crate::core::fixed_point::{TWO_TO_48, TWO_TO_64, fixed_point, fixed_point_square};

/// Sums of three numbers over the samples of a pixel, and of the squares of these numbers or of three others that they give.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Pixel {
    /// Multiples of 2⁻⁶⁴. Additions wrap, which keeps them independent of their order even where they overflow.
    pub(super) sums: [i128; 3],
    /// Multiples of 2⁻⁴⁸. Additions saturate, which is independent of their order, too, since nothing is negative.
    pub(super) squares: [u128; 3],
    pub(super) samples: u64,
}

impl Pixel {
    /// Adds the finite numbers of one sample, and the squares of those that `squared` makes of them.
    pub(super) fn add(&mut self, sample: [f32; 3], squared: impl FnOnce([f64; 3]) -> [f64; 3]) {
        for (sum, value) in self.sums.iter_mut().zip(sample) {
            *sum = sum.wrapping_add(fixed_point(value));
        }
        let cut = sample.map(|value| f64::from(value.clamp(-BRIGHTEST, BRIGHTEST)));
        for (sum, value) in self.squares.iter_mut().zip(squared(cut)) {
            *sum = sum.saturating_add(fixed_point_square(value));
        }
        self.samples = self.samples.saturating_add(1);
    }

    pub(super) fn merge(&mut self, add: &Self) {
        merge_sums(&mut self.sums, &add.sums);
        for (sum, add) in self.squares.iter_mut().zip(add.squares) {
            *sum = sum.saturating_add(add);
        }
        self.samples = self.samples.saturating_add(add.samples);
    }

    pub(super) fn mean(&self) -> [f32; 3] {
        mean(&self.sums, self.samples)
    }

    /// The variance of one sample of light, in X, Y and Z.
    pub(super) fn variance(&self) -> [f64; 3] {
        self.variance_of(xyz)
    }

    /// The variance of one sample in the numbers that were squared: the mean of the squares less the square of the mean, times n / (n −
    /// 1). Infinite with fewer than two.
    pub(super) fn variance_of(&self, squared: impl FnOnce([f64; 3]) -> [f64; 3]) -> [f64; 3] {
        if self.samples < 2 {
            return [f64::INFINITY; 3];
        }
        let n = self.samples as f64;
        let mean = squared(self.sums.map(|sum| sum as f64 / (n * TWO_TO_64)));
        std::array::from_fn(|channel| {
            unbiased_variance(n, mean[channel], self.squares[channel] as f64 / (n * TWO_TO_48))
        })
    }
}

/// Adds sums to others; they wrap.
pub(super) fn merge_sums(sums: &mut [i128; 3], add: &[i128; 3]) {
    sums.iter_mut().zip(add).for_each(|(sum, add)| *sum = sum.wrapping_add(*add));
}

/// The mean over a number of samples of sums in multiples of 2⁻⁶⁴, black where there are none.
pub(super) fn mean(sums: &[i128; 3], samples: u64) -> [f32; 3] {
    if samples == 0 {
        return [0.0; 3];
    }
    let scale = samples as f64 * TWO_TO_64;
    sums.map(|sum| (sum as f64 / scale) as f32)
}

/// The unbiased variance of one of `n` > 1 samples, by their mean and that of their squares.
pub(super) fn unbiased_variance(n: f64, mean: f64, mean_of_squares: f64) -> f64 {
    // For equal samples rounding leaves a small value of either sign.
    (mean_of_squares - mean * mean).max(0.0) * (n / (n - 1.0))
}

/// Any pixel, of numbers of any magnitude and with any number of zeros at their ends.
#[cfg(test)]
pub(super) fn any_pixel() -> impl proptest::strategy::Strategy<Value = Pixel> {
    use proptest::prelude::*;
    let number = (any::<i128>(), 0_u32..128, 0_u32..128)
        .prop_map(|(bits, above, below)| bits << above >> above >> below << below);
    let three = || prop::array::uniform3(number.clone());
    (three(), three(), any::<u64>(), 0_u32..64).prop_map(|(sums, squares, samples, above)| Pixel {
        sums,
        squares: squares.map(i128::cast_unsigned),
        samples: samples >> above,
    })
}
