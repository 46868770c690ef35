//! The random numbers of eight rays side by side.

use lookfrom_simd::{Simd, f32x8, prelude::*, u32x8, u64x8};

use crate::core::hash;
use crate::core::lanes::{LANES, by_lane};
use crate::core::sampler::lanes::PixelSamplers;
use crate::integrator::SampleStream;

/// [`SampleStream`] in lanes.
pub(in crate::integrator) struct SampleStreams<S: Simd> {
    samplers: PixelSamplers<S>,
    sample: u32x8<S>,
    /// Of the address, before the dimension.
    mixed: u64x8<S>,
}

impl<S: Simd> SampleStreams<S> {
    #[inline(always)]
    pub(in crate::integrator) fn new(simd: S, streams: &[&SampleStream; LANES]) -> Self {
        let address = u64x8::load_array(simd, by_lane!(lane => streams[lane].address));
        Self {
            samplers: PixelSamplers::new(simd, &by_lane!(lane => streams[lane].sampler)),
            sample: u32x8::load_array(simd, by_lane!(lane => streams[lane].sample)),
            mixed: hash::mix(address + hash::GOLDEN),
        }
    }

    /// As [`SampleStream::two`].
    #[inline(always)]
    pub(in crate::integrator) fn two(&self, dimension: u32) -> [f32x8<S>; 2] {
        let dimension = hash::mix(self.mixed ^ u64::from(dimension)) & u64::from(u32::MAX);
        self.samplers.two(self.sample, dimension)
    }
}
