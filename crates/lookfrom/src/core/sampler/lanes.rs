//! Random numbers of as many samples as numbers have lanes.

use lookfrom_scene::settings::Sampler as Kind;
use lookfrom_simd::{Bits, Kernel, Real, Simd, dispatch, f32x8, level, prelude::*, u32x8, u64x8};

use super::{PixelSampler, Sampler, two, two_with_pixel};
use crate::core::hash::mix;
use crate::core::lanes::width::Width;
use crate::core::lanes::{LANES, by_lane};

/// The random numbers of a pixel in each lane; several may have the same.
#[derive(Clone, Copy)]
pub(crate) struct PixelSamplers<R: Real> {
    kind: Kind,
    keys: R::Bits64,
}

impl<R: Real> PixelSamplers<R> {
    /// From the samplers of one render.
    #[inline(always)]
    pub(crate) fn new<'a>(width: impl Width<Real = R>, sampler: impl Fn(usize) -> &'a PixelSampler) -> Self {
        let keys = width.u64s(
            #[inline(always)]
            |lane| sampler(lane).key,
        );
        Self { kind: sampler(0).kind, keys }
    }

    /// From pixels, their columns in the lower halves and their rows in the upper ones.
    #[inline(always)]
    pub(crate) fn of_pixels(sampler: &Sampler, pixels: R::Bits64) -> Self {
        Self { kind: sampler.kind, keys: mix(pixels ^ pixels.like(sampler.key)) }
    }

    /// As [`PixelSampler::two`], for a sample and a dimension (below 2³²) in each lane.
    #[inline(always)]
    pub(crate) fn two(&self, sample: R::Bits, dimension: R::Bits64) -> [R; 2] {
        two(self.kind, self.keys, sample, dimension)
    }

    /// As [`PixelSampler::two_with_pixel`] in the lanes of a mask, as [`PixelSampler::two`] in the others.
    #[inline(always)]
    pub(crate) fn two_with_pixel(&self, sample: R::Bits, dimension: R::Bits64, mask: R::Mask) -> [R; 2] {
        two_with_pixel(self.kind, self.keys, sample, dimension, mask)
    }
}

impl Sampler {
    /// Replaces `numbers` by [`Sampler::two`] of one dimension at each of `count` addresses (pixel and sample).
    pub(crate) fn two_of_each(
        &self,
        count: usize,
        address: impl Fn(usize) -> ([u32; 2], u32),
        dimension: u32,
        numbers: &mut Vec<[f32; 2]>,
    ) {
        numbers.resize(count, [0.0; 2]);
        dispatch(level(), Each { sampler: self, address, dimension, numbers });
    }
}

struct Each<'a, F> {
    sampler: &'a Sampler,
    address: F,
    dimension: u32,
    numbers: &'a mut [[f32; 2]],
}

impl<F: Fn(usize) -> ([u32; 2], u32)> Kernel for Each<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { sampler, address, dimension, numbers } = self;
        let count = numbers.len();
        let dimension = u64x8::splat(simd, u64::from(dimension));
        for (block, numbers) in numbers.chunks_mut(LANES).enumerate() {
            let first = block * LANES;
            // Unused lanes of the last batch repeat the last address.
            let addresses = by_lane!(lane => address((first + lane).min(count - 1)));
            let pixels =
                by_lane!(lane => u64::from(addresses[lane].0[0]) | u64::from(addresses[lane].0[1]) << 32);
            let samplers = PixelSamplers::<f32x8<S>>::of_pixels(sampler, u64x8::load_array(simd, pixels));
            let sample = u32x8::load_array(simd, by_lane!(lane => addresses[lane].1));
            let [a, b] = samplers.two(sample, dimension);
            let (a, b): ([f32; LANES], [f32; LANES]) = (a.into(), b.into());
            for (lane, number) in numbers.iter_mut().enumerate() {
                *number = [a[lane], b[lane]];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use lookfrom_simd::mask32x8;

    use super::*;
    use crate::core::hash;

    /// Points of samplers, samples and dimensions; with the pixel in the lanes of a mask.
    struct Two<'a>(&'a [PixelSampler; LANES], [u32; LANES], [u32; LANES], u64);

    impl Kernel for Two<'_> {
        type Output = [[f32; LANES]; 2];
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let samplers = PixelSamplers::new(simd, |lane| &self.0[lane]);
            let dimension = u64x8::load_array(simd, by_lane!(lane => u64::from(self.2[lane])));
            let (sample, mask) = (u32x8::load_array(simd, self.1), mask32x8::from_bitmask(simd, self.3));
            let [a, b] = samplers.two_with_pixel(sample, dimension, mask);
            [a.into(), b.into()]
        }
    }

    #[test]
    fn all_of_a_batch_are_each_on_its_own() {
        for (kind, count) in [(Kind::Sobol, 29), (Kind::Independent, 16), (Kind::Sobol, 0)] {
            let sampler = Sampler::new(kind, 3);
            let address = |k: usize| ([hash::pair(k as u64, 5) as u32, k as u32], 77 * k as u32);
            let mut numbers = vec![[9.0; 2]];
            sampler.two_of_each(count, address, 11, &mut numbers);
            assert_eq!(numbers.len(), count);
            for (k, &of_batch) in numbers.iter().enumerate() {
                let (pixel, sample) = address(k);
                assert_eq!(of_batch, sampler.two(pixel, sample, 11));
            }
        }
    }

    #[test]
    fn eight_at_once_are_eight_one_by_one() {
        for kind in [Kind::Sobol, Kind::Independent] {
            let sampler = Sampler::new(kind, 7);
            for round in 0..2000_u64 {
                let number = |lane: usize, of: u64| hash::pair(8 * round + lane as u64, of) as u32;
                let samplers = std::array::from_fn(|lane| sampler.of_pixel([number(lane, 0), lane as u32]));
                let samples = std::array::from_fn(|lane| number(lane, 1) >> (round % 32));
                let dimensions = std::array::from_fn(|lane| number(lane, 2));
                let mask = round % 256;
                let [a, b] = dispatch(level(), Two(&samplers, samples, dimensions, mask));
                for lane in 0..LANES {
                    let expected = match mask & 1 << lane {
                        0 => samplers[lane].two(samples[lane], dimensions[lane]),
                        _ => samplers[lane].two_with_pixel(samples[lane], dimensions[lane]),
                    };
                    assert_eq!([a[lane], b[lane]], expected);
                }
            }
        }
    }
}
