//! Sums of motion vectors, from the opening to the closing of the shutter.

use super::stored::{Stored, Sums, channels_of, store_fields};
use crate::core::fixed_point::{TWO_TO_64, fixed_point};

/// The sums over the samples of a pixel with a hit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct MotionSums {
    /// Pixels to the right and upwards, in multiples of 2⁻⁶⁴. Additions wrap.
    sums: [i128; 2],
    /// Number of samples.
    samples: u64,
}

store_fields!(MotionSums { sums: [i128; 2] = ["X", "Y"], samples: u64 = ["samples"] });

impl MotionSums {
    /// Adds the motion of one sample's first hit; one that is not finite is left out.
    pub(super) fn add(&mut self, motion: [f32; 2]) {
        if motion.iter().all(|pixels| pixels.is_finite()) {
            self.merge(&Self { sums: motion.map(fixed_point), samples: 1 });
        }
    }

    pub(super) fn merge(&mut self, add: &Self) {
        for (sum, add) in self.sums.iter_mut().zip(add.sums) {
            *sum = sum.wrapping_add(add);
        }
        self.samples = self.samples.saturating_add(add.samples);
    }

    /// The mean; 0 where there are no samples.
    pub(super) fn mean(&self) -> [f32; 2] {
        let scale = 1.0 / (self.samples.max(1) as f64 * TWO_TO_64);
        self.sums.map(|sum| (sum as f64 * scale) as f32)
    }
}
