//! Sums of the light by light-path expressions, for the layers of a picture.
//!
//! Fixed-point numbers as those of all light ([`super::Pixel`]): a layer that has every way is the picture. A pixel takes
//! 48 bytes for each layer.

use super::pixel::merge_sums;
use super::stored::{Stored, Sums, channels_of, store_fields};
use super::weighted::{Weights, weighted};
use crate::core::fixed_point::fixed_point;

/// The sums of a layer over the samples of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LightPathSums {
    /// Multiples of 2⁻⁶⁴. Additions wrap.
    pub(super) sums: [i128; 3],
}

store_fields!(LightPathSums { sums: [i128; 3] = ["sum.R", "sum.G", "sum.B"] });

impl LightPathSums {
    /// Adds the light of one sample; a number that is not finite counts as 0.
    pub(super) fn add(&mut self, rgb: [f32; 3]) {
        for (sum, light) in self.sums.iter_mut().zip(rgb) {
            *sum = sum.wrapping_add(if light.is_finite() { fixed_point(light) } else { 0 });
        }
    }

    pub(super) fn merge(&mut self, add: &Self) {
        merge_sums(&mut self.sums, &add.sums);
    }

    /// The estimate by the weights of samples, black where there are none.
    pub(super) fn mean(&self, unsigned: Option<Self>, weights: Weights) -> [f32; 3] {
        weighted(self.sums, unsigned).map(|sums| weights.mean(sums) as f32)
    }
}
