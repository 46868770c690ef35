//! Random numbers of which nobody knows beforehand how many are needed: a sequence by a seed.
//!
//! Steele, Lea & Flood 2014 (SplitMix).

use crate::core::hash;

/// A sequence of random numbers that is a function of its seed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Random(u64);

impl Random {
    /// The sequence of a seed.
    pub(crate) fn new(seed: u64) -> Self {
        Self(hash::mix(seed.wrapping_add(hash::GOLDEN)))
    }

    /// The next number in [0, 1), a multiple of 2⁻²⁴.
    #[inline]
    pub(crate) fn one(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(hash::GOLDEN);
        (hash::mix(self.0) >> 40) as f32 * (1.0 / 16_777_216.0)
    }
}
