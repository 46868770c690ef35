//! Variances in the sensor's channels, where they are not X, Y and Z: for the AOVs, as in pbrt-v4's `gbuffer` film.
//!
//! Sums of fixed-point numbers, as those of light. A pixel takes 112 bytes.

use super::pixel::merge_sums;
use super::stored::{Stored, Sums, channels_of, store_fields};
use super::{BRIGHTEST, TWO_TO_48, TWO_TO_64, fixed_point, fixed_point_square, unbiased_variance};

/// Sums over the samples of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ChannelSums {
    /// Multiples of 2⁻⁶⁴. Additions wrap.
    sums: [i128; 3],
    /// Multiples of 2⁻⁴⁸. Additions saturate.
    squares: [u128; 3],
    samples: u64,
}

store_fields!(ChannelSums {
    sums: [i128; 3] = ["sum.0", "sum.1", "sum.2"],
    squares: [u128; 3] = ["square.0", "square.1", "square.2"],
    samples: u64 = ["samples"],
});

impl ChannelSums {
    /// Adds one sample, unless it is not finite.
    pub(super) fn add(&mut self, channels: [f32; 3]) {
        if !channels.iter().all(|value| value.is_finite()) {
            return;
        }
        for (i, value) in channels.into_iter().enumerate() {
            let cut = f64::from(value.clamp(-BRIGHTEST, BRIGHTEST));
            self.sums[i] = self.sums[i].wrapping_add(fixed_point(value));
            self.squares[i] = self.squares[i].saturating_add(fixed_point_square(cut));
        }
        self.samples = self.samples.saturating_add(1);
    }

    pub(super) fn merge(&mut self, add: &Self) {
        merge_sums(&mut self.sums, &add.sums);
        for i in 0..3 {
            self.squares[i] = self.squares[i].saturating_add(add.squares[i]);
        }
        self.samples = self.samples.saturating_add(add.samples);
    }

    /// The variance of one sample; infinite with fewer than two.
    pub(super) fn variance(&self) -> [f32; 3] {
        if self.samples < 2 {
            return [f32::INFINITY; 3];
        }
        let n = self.samples as f64;
        std::array::from_fn(|i| {
            let mean = self.sums[i] as f64 / (n * TWO_TO_64);
            unbiased_variance(n, mean, self.squares[i] as f64 / (n * TWO_TO_48)) as f32
        })
    }
}
