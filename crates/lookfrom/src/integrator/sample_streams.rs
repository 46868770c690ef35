//! The random numbers of the rays of a batch, by path and at any width.

use lookfrom_simd::Bits;

use crate::core::hash;
use crate::core::lanes::width::{Lanes, Width};
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
    /// The random numbers of a path.
    #[inline(always)]
    pub fn of<S>(&self, path: &Path<S>) -> SampleStream {
        let SampleId { pixel, sample } = self.ids[path.slot as usize];
        SampleStream { sampler: self.sampler.of_pixel(pixel), sample, address: path.address }
    }
}

/// [`SampleStream`] at any width.
pub(in crate::integrator) struct SampleStreams<R: Lanes> {
    samplers: PixelSamplers<R>,
    sample: R::Bits,
    /// A hash of the address, before the dimension.
    mixed: R::Bits64,
    /// The camera rays.
    are_first: R::Mask,
}

impl<R: Lanes> SampleStreams<R> {
    #[inline(always)]
    pub(in crate::integrator) fn new(width: impl Width<Real = R>, streams: &[&SampleStream; LANES]) -> Self {
        let address = width.u64s(
            #[inline(always)]
            |lane| streams[lane].address,
        );
        let sample = width.u32s(
            #[inline(always)]
            |lane| streams[lane].sample,
        );
        let samplers = PixelSamplers::new(
            width,
            #[inline(always)]
            |lane| &streams[lane].sampler,
        );
        let are_first = bitmask(&by_lane!(lane => streams[lane].address == Path::ROOT));
        let mixed = hash::mix(address.wrapping_add(address.like(hash::GOLDEN)));
        Self { samplers, sample, mixed, are_first: width.mask(are_first) }
    }

    /// As [`SampleStream::two`].
    #[inline(always)]
    pub(in crate::integrator) fn two(&self, dimension: u32) -> [R; 2] {
        self.samplers.two(self.sample, self.hashed(dimension))
    }

    /// As [`SampleStream::two_with_pixel`].
    #[inline(always)]
    pub(in crate::integrator) fn two_with_pixel(&self, dimension: u32) -> [R; 2] {
        self.samplers.two_with_pixel(self.sample, self.hashed(dimension), self.are_first)
    }

    #[inline(always)]
    fn hashed(&self, dimension: u32) -> R::Bits64 {
        let mixed = self.mixed;
        hash::mix(mixed ^ mixed.like(u64::from(dimension))) & mixed.like(u64::from(u32::MAX))
    }
}
