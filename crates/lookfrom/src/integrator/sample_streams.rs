//! The random numbers of the rays of a batch, and those of eight rays side by side.

use lookfrom_simd::{Simd, f32x8, mask32x8, prelude::*, u32x8, u64x8};

use crate::core::hash;
use crate::core::lanes::{LANES, bitmask, by_lane};
use crate::core::sampler::lanes::PixelSamplers;
use crate::core::sampler::{SampleId, Sampler};
use crate::integrator::{Path, SampleStream};

/// The random numbers of the paths of a batch.
#[derive(Clone, Copy, Debug)]
pub struct BatchStreams<'a> {
    /// The sampler of the picture.
    pub(crate) sampler: &'a Sampler,
    /// The samples of the batch, by slot.
    pub(crate) ids: &'a [SampleId],
}

impl BatchStreams<'_> {
    /// Those of a path.
    #[inline(always)]
    pub fn of(&self, path: &Path) -> SampleStream {
        let SampleId { pixel, sample } = self.ids[path.slot as usize];
        SampleStream { sampler: self.sampler.of_pixel(pixel), sample, address: path.address }
    }
}

/// [`SampleStream`] in lanes.
pub(in crate::integrator) struct SampleStreams<S: Simd> {
    samplers: PixelSamplers<S>,
    sample: u32x8<S>,
    /// Of the address, before the dimension.
    mixed: u64x8<S>,
    /// The camera rays.
    are_first: mask32x8<S>,
}

impl<S: Simd> SampleStreams<S> {
    #[inline(always)]
    pub(in crate::integrator) fn new(simd: S, streams: &[&SampleStream; LANES]) -> Self {
        let address = u64x8::load_array(simd, by_lane!(lane => streams[lane].address));
        Self {
            samplers: PixelSamplers::new(simd, &by_lane!(lane => streams[lane].sampler)),
            sample: u32x8::load_array(simd, by_lane!(lane => streams[lane].sample)),
            mixed: hash::mix(address + hash::GOLDEN),
            are_first: mask32x8::from_bitmask(
                simd,
                bitmask(&by_lane!(lane => streams[lane].address == Path::ROOT)).into(),
            ),
        }
    }

    /// As [`SampleStream::two`].
    #[inline(always)]
    pub(in crate::integrator) fn two(&self, dimension: u32) -> [f32x8<S>; 2] {
        self.samplers.two(self.sample, self.hashed(dimension))
    }

    /// As [`SampleStream::two_with_pixel`].
    #[inline(always)]
    pub(in crate::integrator) fn two_with_pixel(&self, dimension: u32) -> [f32x8<S>; 2] {
        self.samplers.two_with_pixel(self.sample, self.hashed(dimension), self.are_first)
    }

    #[inline(always)]
    fn hashed(&self, dimension: u32) -> u64x8<S> {
        hash::mix(self.mixed ^ u64::from(dimension)) & u64::from(u32::MAX)
    }
}
