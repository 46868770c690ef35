//! Sums of AOVs in 64 bits, eight pixels side by side.
//!
//! Nearly all positions and texture coordinates are 0 or of a magnitude of 2⁻²⁴ to 2²⁸: multiples of 2⁻⁴⁷, of which the sums of the
//! upper and of the lower bits are exact. Other first hits are added one by one.

use lookfrom_simd::{Float, LaneMask, Real, Simd, f32x8, f64x8, mask32x8, prelude::*};

use super::{AovColumns, AovSums, LayerSums};
use crate::core::accumulator::{Accumulator, PixelBlock, PixelSamples, nearest_integers};
use crate::core::fixed_point::TWO_TO_32;
use crate::core::lanes::{Columns, LANES, load, row};
use crate::core::sampler::SampleId;

/// Positions and texture coordinates from this magnitude on are multiples of 2⁻⁴⁷: 2⁻²⁴.
const LEAST: f32 = 1.0 / 16_777_216.0;

/// Positions and texture coordinates below this are less than 2⁵¹ multiples of 2⁻²³: 2²⁸.
const BOUND: f32 = 268_435_456.0;

/// Number of multiples of 2⁻²³ in 1.
const UPPER: f64 = 8_388_608.0;

/// Number of multiples of 2⁻⁴⁷ in one of 2⁻²³.
const LOWER: f64 = 16_777_216.0;

/// First indices of sums in multiples of 2⁻³².
const ALBEDO: usize = 0;
const NS: usize = 3;
const NG: usize = 6;

/// First index of those of position, then uv: of each number the multiples of 2⁻²³, and of 2⁻⁴⁷ for the rest.
const PLACES: usize = 9;

/// Index of the number of hits.
const HITS: usize = 19;

/// Number of sums.
const SUMS: usize = 20;

/// Sums of AOVs of pixels that are not yet in the film: memory that is reused.
#[derive(Debug, Default)]
pub(crate) struct AovAccumulator {
    sums: Accumulator<SUMS>,
    /// For each block of eight pixels the lanes that have had a hit which was not left out.
    seen: Vec<u32>,
    /// The first of these hits, by pixel; the others are any.
    firsts: Vec<AovSums>,
    /// Whether the sums count for the denoiser, too.
    pub(crate) are_features: bool,
}

impl AovAccumulator {
    /// Number of samples of each pixel since the last [`AovAccumulator::drain`], at most
    /// [`MOST_SAMPLES`](crate::core::accumulator::MOST_SAMPLES).
    pub(crate) fn samples(&self) -> u32 {
        self.sums.samples()
    }

    /// Adds the first hits of a sample of each pixel: as far as the denoiser needs them, or also for layers. `merge` is called with
    /// those that are left out.
    pub(crate) fn add(
        &mut self,
        ids: &[SampleId],
        columns: &[AovColumns],
        has_layers: bool,
        mut merge: impl FnMut(&SampleId, &LayerSums),
    ) {
        self.seen.resize(columns.len(), 0);
        self.firsts.resize(columns.len() * LANES, AovSums::default());
        let left_out = self.sums.add(columns.len(), &AovSamples { columns, has_layers });
        for (block, (columns, left_out)) in columns.iter().zip(left_out).enumerate() {
            let new = columns.hits & !left_out & !self.seen[block];
            if new | left_out == 0 {
                continue;
            }
            self.seen[block] |= new;
            for lane in LaneMask(new) {
                let index = block * LANES + lane;
                let (ng, position) = (row(&columns.ng, lane), row(&columns.position, lane));
                self.firsts[index] = AovSums::of_first(ids[index].sample, ng, position);
            }
            for lane in LaneMask(*left_out) {
                let id = &ids[block * LANES + lane];
                merge(id, &LayerSums::of_hit(id.sample, &columns.of(lane)));
            }
        }
    }

    /// Removes the sums of all pixels, after a call of `each` with the index of each and its sums.
    pub(crate) fn drain(&mut self, mut each: impl FnMut(usize, &LayerSums)) {
        let Self { sums, seen, firsts, .. } = self;
        let samples = sums.samples().into();
        sums.drain(|index, sums| {
            let sums = sums.map(u64::cast_signed);
            let three = |first: usize| [sums[first], sums[first + 1], sums[first + 2]];
            let place = |index: usize| {
                let [upper, lower] = [0, 1].map(|half| i128::from(sums[PLACES + 2 * index + half]));
                (upper << 41) + (lower << 17)
            };
            let is_seen = seen[index / LANES] >> (index % LANES) & 1 != 0;
            let first = if is_seen { firsts[index] } else { AovSums::default() };
            let hits = sums[HITS].cast_unsigned();
            let shared = AovSums { albedo: three(ALBEDO), ns: three(NS), samples, hits, ..first };
            each(index, &LayerSums { shared, ng: three(NG), places: [0, 1, 2, 3, 4].map(place) });
        });
        seen.clear();
    }
}

/// The first hits of a sample of each pixel.
struct AovSamples<'a> {
    columns: &'a [AovColumns],
    has_layers: bool,
}

impl PixelSamples<SUMS> for AovSamples<'_> {
    #[inline(always)]
    fn add_to<S: Simd>(&self, simd: S, block: usize, sums: &mut PixelBlock<SUMS>) -> u32 {
        let AovColumns { albedo, ng, ns, position: [x, y, z], uv: [u, v], hits } = &self.columns[block];
        let places = [x, y, z, u, v];
        let mut is_summed = Float::is_finite(sum(simd, albedo) + sum(simd, ng) + sum(simd, ns));
        for place in places {
            let size = Float::abs(f32x8::load_array(simd, *place));
            let is_whole = !size.lt(size.like(LEAST)) | Float::eq(size, size.like(0.0));
            is_summed = is_summed & is_whole & size.lt(size.like(BOUND));
        }
        let summed = is_summed.to_bitmask() as u32 & hits;
        let is_summed = mask32x8::from_bitmask(simd, summed.into());
        add_narrow(simd, sums, ALBEDO, albedo, 0.0, is_summed);
        add_narrow(simd, sums, NS, ns, -1.0, is_summed);
        if self.has_layers {
            add_narrow(simd, sums, NG, ng, -1.0, is_summed);
            for (index, place) in places.into_iter().enumerate() {
                let place = wide(f32x8::load_array(simd, *place), is_summed) * UPPER;
                let upper = nearest_integers(simd, place);
                sums.add(simd, PLACES + 2 * index, upper);
                sums.add(simd, PLACES + 2 * index + 1, (place - upper) * LOWER);
            }
        }
        sums.add(simd, HITS, wide(f32x8::splat(simd, 1.0), is_summed));
        hits & !summed
    }
}

/// The sum of the components.
#[inline(always)]
fn sum<S: Simd>(simd: S, columns: &Columns<3>) -> f32x8<S> {
    let all = load(simd, columns);
    all.x + all.y + all.z
}

/// Numbers in double precision, 0 where the mask is not set.
#[inline(always)]
fn wide<S: Simd>(numbers: f32x8<S>, mask: mask32x8<S>) -> f64x8<S> {
    Real::widen(f32x8::select(mask, numbers, numbers.like(0.0)))
}

/// Adds the components of directions or colours as multiples of 2⁻³², from an index of sums on.
#[inline(always)]
fn add_narrow<S: Simd>(
    simd: S,
    sums: &mut PixelBlock<SUMS>,
    first: usize,
    columns: &Columns<3>,
    least: f32,
    mask: mask32x8<S>,
) {
    for (index, column) in (first..).zip(columns) {
        let value = Float::clamp(f32x8::load_array(simd, *column), least, 1.0);
        sums.add(simd, index, SimdFloat::trunc(wide(value, mask) * TWO_TO_32));
    }
}
