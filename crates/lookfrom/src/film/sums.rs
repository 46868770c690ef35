//! Sums of samples in 64 bits, eight pixels side by side.
//!
//! [`FilmTile::add`] for a sample of each pixel of a tile at once. Nearly all light is so dim that its multiples of 2⁻⁴⁷,
//! and those of 2⁻⁴⁸ of its squares, are integers below 2⁵¹: f64 computes them exactly, and thousands fit into 64 bits.
//! Other samples are added one by one. Sums of integers do not depend on how they are grouped, so the film is the same.

use lookfrom_scene::spectrum::space::XYZ_FROM_RGB;
use lookfrom_simd::{Float, Kernel, Real, Simd, dispatch, f32x8, f64x8, level, mask64x8, prelude::*, u64x8};

use super::pixel::{TWO_TO_47, TWO_TO_48};
use super::{FilmTile, SampleId};
use crate::core::lanes::{LANES, by_lane};

/// Samples whose red, green and blue are below this in magnitude are summed here: X, Y and Z are then below 2.7, and
/// their squares below 2³.
const BOUND: f64 = 2.0;

/// Maximum number of samples of a pixel that are summed in 64 bits: less than 2⁶⁴ / 2⁵¹.
pub(super) const MOST_SAMPLES: u32 = 4096;

/// 1.5 · 2⁵²: added to it, an integer below 2⁵¹ in magnitude is in the lowest bits of the sum.
pub(super) const INTEGERS: f64 = 6_755_399_441_055_744.0;

/// Sums of a tile's pixels that are not yet in the tile: memory that is reused.
#[derive(Debug, Default)]
pub(crate) struct SampleSums {
    eights: Vec<Eight>,
    /// Number of samples that were added to each pixel.
    samples: u32,
    /// Indices of samples that were left out.
    others: Vec<usize>,
}

/// Sums of eight pixels, in two's complement.
#[derive(Clone, Copy, Debug, Default)]
struct Eight {
    /// Red, green and blue in multiples of 2⁻⁴⁷.
    sums: [[u64; LANES]; 3],
    /// The squares of X, Y and Z in multiples of 2⁻⁴⁸.
    squares: [[u64; LANES]; 3],
    samples: [u64; LANES],
}

impl FilmTile {
    /// Whether light is all that it sums: then [`FilmTile::add_samples`] is enough.
    pub(crate) fn is_of_light(&self) -> bool {
        self.alphas.is_empty() && self.channels.is_empty() && self.light_paths.is_empty()
    }

    /// Adds a sample of each pixel, to the tile or to `sums`; always the same pixels until [`FilmTile::add_sums`].
    pub(crate) fn add_samples(&mut self, ids: &[SampleId], light: &[[f32; 3]], sums: &mut SampleSums) {
        sums.eights.resize(light.len().div_ceil(LANES), Eight::default());
        sums.others.clear();
        dispatch(level(), AddEights { light, eights: &mut sums.eights, others: &mut sums.others });
        for &index in &sums.others {
            let SampleId { pixel: [x, y], sample } = ids[index];
            self.add(x, y, sample, light[index]);
        }
        sums.samples += 1;
        if sums.samples == MOST_SAMPLES {
            self.add_sums(ids, sums);
        }
    }

    /// Moves the sums of the pixels into the tile.
    pub(crate) fn add_sums(&mut self, ids: &[SampleId], sums: &mut SampleSums) {
        for (index, id) in ids.iter().enumerate() {
            let Some(Eight { sums, squares, samples }) = sums.eights.get(index / LANES) else { break };
            let lane = index % LANES;
            let place = self.index_inside(id.pixel[0], id.pixel[1]);
            let pixel = &mut self.pixels[place];
            for channel in 0..3 {
                let sum = i128::from(sums[channel][lane].cast_signed()) << 17;
                pixel.sums[channel] = pixel.sums[channel].wrapping_add(sum);
                let square = u128::from(squares[channel][lane]);
                pixel.squares[channel] = pixel.squares[channel].saturating_add(square);
            }
            pixel.samples = pixel.samples.saturating_add(samples[lane]);
        }
        sums.eights.clear();
        sums.samples = 0;
    }
}

/// Adds a sample of each pixel, and tells which were left out.
struct AddEights<'a> {
    light: &'a [[f32; 3]],
    eights: &'a mut [Eight],
    others: &'a mut Vec<usize>,
}

impl Kernel for AddEights<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { light, eights, others } = self;
        let (zero, one) = (f64x8::splat(simd, 0.0), f64x8::splat(simd, 1.0));
        for (block, (light, eight)) in light.chunks(LANES).zip(eights).enumerate() {
            // Unused lanes repeat the last sample; their sums are of no pixel.
            let last = light.len() - 1;
            let rgb = [
                channel(simd, by_lane!(lane => light[lane.min(last)][0])),
                channel(simd, by_lane!(lane => light[lane.min(last)][1])),
                channel(simd, by_lane!(lane => light[lane.min(last)][2])),
            ];
            let [r, g, b] = [rgb[0] * TWO_TO_47, rgb[1] * TWO_TO_47, rgb[2] * TWO_TO_47];
            let is_summed = is_exact(rgb[0], r) & is_exact(rgb[1], g) & is_exact(rgb[2], b);
            for (sums, value) in eight.sums.iter_mut().zip([r, g, b]) {
                add(simd, sums, f64x8::select(is_summed, value, zero));
            }
            for (squares, [x, y, z]) in eight.squares.iter_mut().zip(XYZ_FROM_RGB) {
                let value = rgb[0] * x + rgb[1] * y + rgb[2] * z;
                let square = value * value * TWO_TO_48;
                let nearest = square + INTEGERS - f64x8::splat(simd, INTEGERS);
                let truncated = f64x8::select(nearest.gt(square), nearest - one, nearest);
                add(simd, squares, f64x8::select(is_summed, truncated, zero));
            }
            add(simd, &mut eight.samples, f64x8::select(is_summed, one, zero));
            let summed = is_summed.to_bitmask();
            if summed != 0xff {
                others.extend(
                    (0..=last).filter(|lane| summed & 1 << lane == 0).map(|lane| block * LANES + lane),
                );
            }
        }
    }
}

#[inline(always)]
fn channel<S: Simd>(simd: S, values: [f32; LANES]) -> f64x8<S> {
    Real::widen(f32x8::load_array(simd, values))
}

/// Whether light is within the bound and a whole multiple.
#[inline(always)]
fn is_exact<S: Simd>(light: f64x8<S>, multiple: f64x8<S>) -> mask64x8<S> {
    let integers = multiple.like(INTEGERS);
    Float::abs(light).lt(light.like(BOUND)) & Float::eq(multiple + integers - integers, multiple)
}

/// Adds integers of magnitude below 2⁵¹.
#[inline(always)]
pub(super) fn add<S: Simd>(simd: S, sums: &mut [u64; LANES], integers: f64x8<S>) {
    let bits: u64x8<S> = (integers + INTEGERS).bitcast();
    *sums = (u64x8::load_array(simd, *sums) + bits - u64x8::splat(simd, INTEGERS.to_bits())).into();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::hash;
    use lookfrom_scene::settings::PixelBounds;

    #[test]
    fn sums_of_many_are_those_of_each() {
        let area = PixelBounds { x0: 3, y0: 5, x1: 8, y1: 8 };
        let (mut together, mut each) = (FilmTile::new(area).unwrap(), FilmTile::new(area).unwrap());
        let mut sums = SampleSums::default();
        let pixels = (area.y0..area.y1).flat_map(|y| (area.x0..area.x1).map(move |x| [x, y]));
        let mut ids: Vec<SampleId> = pixels.map(|pixel| SampleId { pixel, sample: 0 }).collect();
        for sample in 0..MOST_SAMPLES + 900 {
            let light = |index: usize, channel: u64| {
                let bits = hash::pair(u64::from(sample) * 100 + index as u64, channel);
                let mantissa = (bits >> 40) as f32 / 16_777_216.0 - 0.1;
                match bits % 40 {
                    0 => f32::NAN,
                    1 => 1e30 * mantissa,
                    2 => 1e-9 * mantissa,
                    3 => 0.0,
                    4 => -0.0,
                    5 => 2.0,
                    6 => 20.0 * mantissa,
                    _ => mantissa,
                }
            };
            let light: Vec<[f32; 3]> = (0..ids.len()).map(|k| [0, 1, 2].map(|c| light(k, c))).collect();
            ids.iter_mut().for_each(|id| id.sample = sample);
            together.add_samples(&ids, &light, &mut sums);
            for (id, rgb) in ids.iter().zip(light) {
                each.add(id.pixel[0], id.pixel[1], sample, rgb);
            }
        }
        together.add_sums(&ids, &mut sums);
        assert_eq!(together, each);
    }
}
