//! The sums of a pixel in fixed point.

use super::{BRIGHTEST, xyz};

pub(super) const TWO_TO_47: f64 = 140_737_488_355_328.0;
pub(super) const TWO_TO_48: f64 = 281_474_976_710_656.0;
pub(super) const TWO_TO_63: f64 = 9_223_372_036_854_775_808.0;
pub(super) const TWO_TO_64: f64 = 18_446_744_073_709_551_616.0;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Pixel {
    /// Multiples of 2⁻⁶⁴. Additions wrap, which keeps them independent of their order even where they overflow.
    pub(super) sums: [i128; 3],
    /// Multiples of 2⁻⁴⁸. Additions saturate, which is independent of their order, too, since nothing is negative.
    pub(super) squares: [u128; 3],
    pub(super) samples: u64,
}

impl Pixel {
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

    /// The variance of one sample, in X, Y and Z: the mean of the squares less the square of the mean, times n / (n −
    /// 1).
    pub(super) fn variance(&self) -> [f64; 3] {
        if self.samples < 2 {
            return [f64::INFINITY; 3];
        }
        let n = self.samples as f64;
        let mean = xyz(self.sums.map(|sum| sum as f64 / (n * TWO_TO_64)));
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

/// The square of a finite number, rounded to f64, as a multiple of 2⁻⁴⁸; saturates.
pub(super) fn fixed_point_square(value: f64) -> u128 {
    let square = value * value * TWO_TO_48;
    // The cast saturates; 63 bits nearly always suffice, and take a fraction of the time.
    if square < TWO_TO_63 { u128::from(square as i64 as u64) } else { square as u128 }
}

/// A finite number as a multiple of 2⁻⁶⁴, truncated towards zero.
pub(super) fn fixed_point(light: f32) -> i128 {
    // An f32 in f64 can be multiplied by a power of two exactly. From 2⁻²⁴ on it is a whole multiple of 2⁻⁴⁷: then,
    // which is nearly always, 64 bits suffice, and take a fraction of the time.
    let light = f64::from(light.clamp(-BRIGHTEST, BRIGHTEST));
    let upper = light * TWO_TO_47;
    let cut = upper as i64;
    if upper.abs() < TWO_TO_63 && cut as f64 == upper {
        i128::from(cut) << 17
    } else {
        (light * TWO_TO_64) as i128
    }
}
