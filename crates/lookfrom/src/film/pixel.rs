//! The sums of a pixel in fixed point: of light, or of what a sensor measures.

use super::BRIGHTEST;
use crate::core::fixed_point::{fixed_point, fixed_point_square};

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
}

/// Adds sums to others; they wrap.
pub(super) fn merge_sums(sums: &mut [i128; 3], add: &[i128; 3]) {
    sums.iter_mut().zip(add).for_each(|(sum, add)| *sum = sum.wrapping_add(*add));
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
