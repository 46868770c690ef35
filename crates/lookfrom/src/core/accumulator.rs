//! Sums of integers in 64 bits, of eight pixels side by side: for the light of films, and for AOVs.
//!
//! Nearly all numbers of samples are multiples of a small power of two, and less than 2⁵¹ of them: f64 computes them exactly, and thousands
//! fit into 64 bits. Other samples are left out, to be added one by one. Sums of integers do not depend on how they are grouped, so the
//! film is the same.

use lookfrom_simd::{Kernel, Simd, dispatch, f64x8, level, prelude::*, u64x8};

use crate::core::lanes::{Columns, LANES};

/// Maximum number of samples of a pixel that are summed: less than 2⁶⁴ / 2⁵¹.
pub(crate) const MOST_SAMPLES: u32 = 4096;

/// 1.5 · 2⁵²: added to it, an integer below 2⁵¹ in magnitude is in the lowest bits of the sum.
const INTEGERS: f64 = 6_755_399_441_055_744.0;

/// `N` sums of each of eight pixels, in two's complement.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PixelBlock<const N: usize>(Columns<N, u64>);

impl<const N: usize> PixelBlock<N> {
    /// Adds integers of magnitude below 2⁵¹ to the sums of an index.
    #[inline(always)]
    pub(crate) fn add<S: Simd>(&mut self, simd: S, index: usize, integers: f64x8<S>) {
        let bits: u64x8<S> = (integers + INTEGERS).bitcast();
        let sums = &mut self.0[index];
        *sums = (u64x8::load_array(simd, *sums) + bits - u64x8::splat(simd, INTEGERS.to_bits())).into();
    }
}

/// The integers that are nearest to numbers of magnitude below 2⁵¹.
#[inline(always)]
pub(crate) fn nearest_integers<S: Simd>(simd: S, numbers: f64x8<S>) -> f64x8<S> {
    numbers + INTEGERS - f64x8::splat(simd, INTEGERS)
}

/// A sample of each of many pixels.
pub(crate) trait PixelSamples<const N: usize> {
    /// Adds those of a block of eight pixels to its sums, but for some; bit i of the result for lane i: whether a sample is left out.
    fn add_to<S: Simd>(&self, simd: S, block: usize, sums: &mut PixelBlock<N>) -> u32;
}

/// Sums of pixels that are not yet in the film: memory that is reused.
#[derive(Debug, Default)]
pub(crate) struct Accumulator<const N: usize> {
    blocks: Vec<PixelBlock<N>>,
    /// For each block the lanes that were left out last.
    left_out: Vec<u32>,
    /// Number of samples that were added to each pixel.
    samples: u32,
}

impl<const N: usize> Accumulator<N> {
    /// Adds a sample of each pixel, always of the same ones until [`Accumulator::drain`]. For each block the lanes that were left out.
    pub(crate) fn add(&mut self, blocks: usize, samples: &impl PixelSamples<N>) -> &[u32] {
        self.blocks.resize(blocks, PixelBlock([[0; LANES]; N]));
        self.left_out.resize(blocks, 0);
        dispatch(level(), AddKernel { samples, blocks: &mut self.blocks, left_out: &mut self.left_out });
        self.samples += 1;
        &self.left_out
    }

    /// Number of samples of each pixel since the last [`Accumulator::drain`], at most [`MOST_SAMPLES`].
    pub(crate) fn samples(&self) -> u32 {
        self.samples
    }

    /// Removes the sums of all pixels, after a call of `each` with the index of each and its sums.
    pub(crate) fn drain(&mut self, mut each: impl FnMut(usize, [u64; N])) {
        for (block, PixelBlock(sums)) in self.blocks.iter().enumerate() {
            for lane in 0..LANES {
                let mut pixel = [0; N];
                pixel.iter_mut().zip(sums).for_each(|(to, sums)| *to = sums[lane]);
                each(block * LANES + lane, pixel);
            }
        }
        self.blocks.clear();
        self.samples = 0;
    }
}

/// Adds a sample of each pixel, and tells which were left out.
struct AddKernel<'a, T, const N: usize> {
    samples: &'a T,
    blocks: &'a mut [PixelBlock<N>],
    left_out: &'a mut [u32],
}

impl<T: PixelSamples<N>, const N: usize> Kernel for AddKernel<'_, T, N> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { samples, blocks, left_out } = self;
        for (block, (sums, left_out)) in blocks.iter_mut().zip(left_out).enumerate() {
            *left_out = samples.add_to(simd, block, sums);
        }
    }
}
