//! Sums of light in 64 bits, eight pixels side by side: [`FilmTile::add`] for a sample of each pixel of a tile at once.

use lookfrom_scene::spectrum::space::XYZ_FROM_RGB;
use lookfrom_simd::{Float, LaneMask, Real, Simd, f32x8, f64x8, mask64x8, prelude::*};

use super::light_paths::LightPathSums;
use super::pixel::Pixel;
use super::weighted::WeightSums;
use super::{FilmTile, SampleId};
use crate::core::accumulator::{Accumulator, MOST_SAMPLES, PixelBlock, PixelSamples, nearest_integers};
use crate::core::fixed_point::{TWO_TO_47, TWO_TO_48};
use crate::core::lanes::{LANES, filled, gather};

/// Samples whose red, green and blue are below this in magnitude are summed here: X, Y and Z are then below 2.7, and
/// their squares below 2³.
const BOUND: f64 = 2.0;

/// Sums of red, green and blue in multiples of 2⁻⁴⁷, of the squares of X, Y and Z in multiples of 2⁻⁴⁸, of the number of samples, and where the
/// tile has these, in multiples of 2⁻⁴⁷, of filter weights, their magnitudes, and red, green and blue with these.
pub(crate) type SampleSums = Accumulator<12>;

impl FilmTile {
    /// Whether light, and filter weights, are all that it sums: then [`FilmTile::add_samples`] is enough.
    pub(crate) fn is_of_light(&self) -> bool {
        let Self { alphas, channels, light_paths, buckets, .. } = self;
        alphas.is_empty() && channels.is_empty() && light_paths.is_empty() && buckets.is_empty()
    }

    /// Adds a sample of each pixel, which has a filter weight, to the tile or to `sums`; always the same pixels until
    /// [`FilmTile::add_sums`].
    pub(crate) fn add_samples(
        &mut self,
        ids: &[SampleId],
        light: &[[f32; 3]],
        weights: &[f32],
        sums: &mut SampleSums,
    ) {
        let summed = (!self.weights.is_empty()).then_some(weights);
        let left_out = sums.add(light.len().div_ceil(LANES), &LightSamples { light, weights: summed });
        for (block, lanes) in left_out.iter().enumerate() {
            for index in LaneMask(*lanes).map(|lane| block * LANES + lane) {
                let SampleId { pixel: [x, y], sample } = ids[index];
                self.add_weighted(x, y, sample, light[index], 1.0, weights[index]);
            }
        }
        if sums.samples() == MOST_SAMPLES {
            self.add_sums(ids, sums);
        }
    }

    /// Moves the sums of the pixels into the tile.
    pub(crate) fn add_sums(&mut self, ids: &[SampleId], sums: &mut SampleSums) {
        sums.drain(|index, [r, g, b, x, y, z, samples, weight, magnitude, unsigned @ ..]| {
            let Some(SampleId { pixel: [column, row], .. }) = ids.get(index) else { return };
            let place = self.index_inside(*column, *row);
            let fixed_point = |sum: u64| i128::from(sum.cast_signed()) << 17;
            let sums = [r, g, b].map(fixed_point);
            if let Some(light) = self.unsigned_light.first_mut() {
                let [sum, magnitude] = [weight, magnitude].map(fixed_point);
                self.weights[place].merge(&WeightSums { sum, magnitude });
                light[place].merge(&LightPathSums { sums: unsigned.map(fixed_point) });
            }
            self.pixels[place].merge(&Pixel { sums, squares: [x, y, z].map(u128::from), samples });
        });
    }
}

/// The light of a sample of each pixel, and its filter weights.
struct LightSamples<'a> {
    light: &'a [[f32; 3]],
    /// `None` where they are not summed.
    weights: Option<&'a [f32]>,
}

impl PixelSamples<12> for LightSamples<'_> {
    #[inline(always)]
    fn add_to<S: Simd>(&self, simd: S, block: usize, sums: &mut PixelBlock<12>) -> u32 {
        let light = &self.light[block * LANES..];
        let (zero, one) = (f64x8::splat(simd, 0.0), f64x8::splat(simd, 1.0));
        // Unused lanes repeat the last sample; their sums are of no pixel.
        let rgb = gather(simd, filled(light, &mut None)).widen();
        let [r, g, b] = [rgb.x * TWO_TO_47, rgb.y * TWO_TO_47, rgb.z * TWO_TO_47];
        let mut is_summed = is_exact(simd, rgb.x, r) & is_exact(simd, rgb.y, g) & is_exact(simd, rgb.z, b);
        if let Some(weights) = self.weights {
            let weights = *filled(&weights[block * LANES..], &mut None);
            let weight = Real::widen(f32x8::load_array(simd, weights));
            let multiple = weight * TWO_TO_47;
            is_summed &= is_exact(simd, weight, multiple);
            let is_negative = weight.lt(zero);
            let magnitude = turned(is_negative, multiple);
            let unsigned = [turned(is_negative, r), turned(is_negative, g), turned(is_negative, b)];
            for (index, value) in (7..).zip([multiple, magnitude].into_iter().chain(unsigned)) {
                sums.add(simd, index, f64x8::select(is_summed, value, zero));
            }
        }
        for (index, value) in [r, g, b].into_iter().enumerate() {
            sums.add(simd, index, f64x8::select(is_summed, value, zero));
        }
        for (index, [x, y, z]) in (3..).zip(XYZ_FROM_RGB) {
            let value = rgb.x * x + rgb.y * y + rgb.z * z;
            let square = value * value * TWO_TO_48;
            let nearest = nearest_integers(simd, square);
            let truncated = f64x8::select(nearest.gt(square), nearest - one, nearest);
            sums.add(simd, index, f64x8::select(is_summed, truncated, zero));
        }
        sums.add(simd, 6, f64x8::select(is_summed, one, zero));
        !is_summed.to_bitmask() as u32 & ((1 << light.len().min(LANES)) - 1)
    }
}

/// The number with the other sign in some lanes.
#[inline(always)]
fn turned<S: Simd>(are: mask64x8<S>, number: f64x8<S>) -> f64x8<S> {
    f64x8::select(are, -number, number)
}

/// Whether light is within the bound and a whole multiple.
#[inline(always)]
fn is_exact<S: Simd>(simd: S, light: f64x8<S>, multiple: f64x8<S>) -> mask64x8<S> {
    Float::abs(light).lt(light.like(BOUND)) & Float::eq(nearest_integers(simd, multiple), multiple)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::hash;
    use lookfrom_scene::settings::{FilterShape, ImageSettings, PixelBounds};

    #[test]
    fn sums_of_many_are_those_of_each() {
        let area = PixelBounds { x0: 3, y0: 5, x1: 8, y1: 8 };
        let filter = FilterShape::Sinc { tau: 3.0 }.of_radius(4.0);
        let image = ImageSettings { filter, ..ImageSettings::default() };
        compare(&FilmTile::new(area).unwrap());
        compare(&FilmTile::for_image(area, &image).unwrap());
    }

    /// Adds samples to a tile, of each pixel together and one by one.
    fn compare(tile: &FilmTile) {
        let (mut together, mut each, area) = (tile.clone(), tile.clone(), tile.area());
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
            let weight = |index: usize| match (index + sample as usize) % 7 {
                0 => -1.3,
                1 => 2.5,
                _ => 1.3,
            };
            let weights: Vec<f32> = (0..ids.len()).map(weight).collect();
            together.add_samples(&ids, &light, &weights, &mut sums);
            for ((id, rgb), weight) in ids.iter().zip(light).zip(weights) {
                each.add_weighted(id.pixel[0], id.pixel[1], sample, rgb, 1.0, weight);
            }
        }
        together.add_sums(&ids, &mut sums);
        assert_eq!(together, each);
    }
}
