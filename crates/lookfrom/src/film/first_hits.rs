//! Sums of first hits in 64 bits, eight pixels side by side.
//!
//! [`FilmTile::add_first_hit`] for a sample of each pixel of a tile at once, as [`super::sums`] does for light. Nearly all
//! positions and texture coordinates are 0 or of a magnitude of 2⁻²⁴ to 2²⁸: multiples of 2⁻⁴⁷, of which the sums of the
//! upper and of the lower bits are exact. Other first hits are added one by one.

use lookfrom_simd::{
    Float, Kernel, LaneMask, Real, Simd, dispatch, f32x8, f64x8, level, mask32x8, prelude::*,
};

use super::aov::{AovSums, LayerSums, TWO_TO_32};
use super::sums::{INTEGERS, MOST_SAMPLES, add};
use super::{Aovs, FEATURE_SAMPLES, FilmTile, SampleId};
use crate::core::lanes::{Columns, LANES, load, row, set_row};

/// Positions and texture coordinates from this magnitude on are multiples of 2⁻⁴⁷: 2⁻²⁴.
const LEAST: f32 = 1.0 / 16_777_216.0;

/// Positions and texture coordinates below this are less than 2⁵¹ multiples of 2⁻²³: 2²⁸.
const BOUND: f32 = 268_435_456.0;

/// Number of multiples of 2⁻²³ in 1.
const UPPER: f64 = 8_388_608.0;

/// Number of multiples of 2⁻⁴⁷ in one of 2⁻²³.
const LOWER: f64 = 16_777_216.0;

/// The first hits of eight samples, by component.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AovColumns {
    pub(crate) albedo: Columns<3>,
    pub(crate) ng: Columns<3>,
    pub(crate) ns: Columns<3>,
    pub(crate) position: Columns<3>,
    pub(crate) uv: Columns<2>,
    /// Bit i for lane i: whether the sample has a hit. The numbers of others are any.
    pub(crate) hits: u32,
}

impl AovColumns {
    /// Eight misses.
    pub(crate) const MISSES: Self = Self {
        albedo: [[0.0; LANES]; 3],
        ng: [[0.0; LANES]; 3],
        ns: [[0.0; LANES]; 3],
        position: [[0.0; LANES]; 3],
        uv: [[0.0; LANES]; 2],
        hits: 0,
    };

    /// The hit of a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, aovs: &Aovs) {
        let Aovs { albedo, ng, ns, position, uv } = *aovs;
        set_row(&mut self.albedo, lane, albedo);
        set_row(&mut self.ng, lane, ng);
        set_row(&mut self.ns, lane, ns);
        set_row(&mut self.position, lane, position);
        set_row(&mut self.uv, lane, uv);
        self.hits |= 1 << lane;
    }

    /// The hit of a lane that has one.
    #[inline(always)]
    pub(crate) fn of(&self, lane: usize) -> Aovs {
        Aovs {
            albedo: row(&self.albedo, lane),
            ng: row(&self.ng, lane),
            ns: row(&self.ns, lane),
            position: row(&self.position, lane),
            uv: row(&self.uv, lane),
        }
    }
}

/// Sums of a tile's pixels that are not yet in the tile: memory that is reused.
#[derive(Debug, Default)]
pub(crate) struct FirstHitSums {
    eights: Vec<Eight>,
    /// Number of samples that were added to each pixel.
    samples: u32,
    /// Whether they count for the denoiser.
    are_features: bool,
    /// Indices of samples with hits that were left out, and of those that may be the first ones of their pixels.
    others: Vec<usize>,
    firsts: Vec<usize>,
}

/// Sums of eight pixels, in two's complement.
#[derive(Clone, Copy, Debug, Default)]
struct Eight {
    /// Multiples of 2⁻³².
    albedo: [[u64; LANES]; 3],
    ns: [[u64; LANES]; 3],
    ng: [[u64; LANES]; 3],
    /// Position, then uv: multiples of 2⁻²³, and of 2⁻⁴⁷ for the rest.
    places: [[[u64; LANES]; 2]; 5],
    hits: [u64; LANES],
    /// Lanes that have had a hit.
    seen: u32,
}

impl Eight {
    /// The sums of a lane.
    #[inline]
    fn of(&self, lane: usize, samples: u32) -> LayerSums {
        let narrow = |sums: &[[u64; LANES]; 3]| row(sums, lane).map(u64::cast_signed);
        let mut places = [0; 5];
        for (place, [upper, lower]) in places.iter_mut().zip(&self.places) {
            let [upper, lower] = [upper[lane], lower[lane]].map(|sum| i128::from(sum.cast_signed()));
            *place = (upper << 41) + (lower << 17);
        }
        let shared = AovSums::of(samples.into(), self.hits[lane], narrow(&self.albedo), narrow(&self.ns));
        LayerSums::of(shared, narrow(&self.ng), places)
    }
}

impl FilmTile {
    /// Adds the first hits of samples, all of which count for the denoiser or none, to the tile or to `sums`; always of the same
    /// pixels until [`FilmTile::add_first_hit_sums`].
    pub(crate) fn add_first_hits(&mut self, ids: &[SampleId], met: &[AovColumns], sums: &mut FirstHitSums) {
        let Some(&SampleId { sample, .. }) = ids.first() else { return };
        let are_features = !self.features.is_empty() && sample < FEATURE_SAMPLES;
        if sums.are_features != are_features || sums.samples == MOST_SAMPLES {
            self.add_first_hit_sums(ids, sums);
        }
        sums.are_features = are_features;
        sums.eights.resize(met.len(), Eight::default());
        let FirstHitSums { eights, others, firsts, .. } = sums;
        others.clear();
        firsts.clear();
        dispatch(level(), AddEights { met, eights, has_layers: self.has_layers(), others, firsts });
        for (indices, is_first) in [(&sums.others, false), (&sums.firsts, true)] {
            for &index in indices {
                let SampleId { pixel: [x, y], sample } = ids[index];
                let (place, aovs) = (self.index_inside(x, y), met[index / LANES].of(index % LANES));
                let layer = self.layers.get_mut(place);
                let features = self.features.get_mut(place).filter(|_| are_features);
                if is_first {
                    layer.into_iter().for_each(|sums| sums.note_first(sample, &aovs));
                    features.into_iter().for_each(|sums| sums.note_first(sample, &aovs));
                } else {
                    layer.into_iter().for_each(|sums| sums.add_hit(sample, &aovs));
                    features.into_iter().for_each(|sums| sums.add_hit(sample, &aovs));
                }
            }
        }
        sums.samples += 1;
    }

    /// Moves the sums of the pixels into the tile.
    pub(crate) fn add_first_hit_sums(&mut self, ids: &[SampleId], sums: &mut FirstHitSums) {
        for (index, id) in ids.iter().enumerate() {
            let Some(eight) = sums.eights.get(index / LANES) else { break };
            let (place, sum) =
                (self.index_inside(id.pixel[0], id.pixel[1]), eight.of(index % LANES, sums.samples));
            if let Some(layer) = self.layers.get_mut(place) {
                layer.merge(&sum);
            }
            if sums.are_features {
                self.features[place].merge(sum.shared());
            }
        }
        sums.eights.clear();
        sums.samples = 0;
    }
}

/// Adds the first hits of a sample of each pixel, and tells which were left out and which may be the first.
struct AddEights<'a> {
    met: &'a [AovColumns],
    eights: &'a mut [Eight],
    has_layers: bool,
    others: &'a mut Vec<usize>,
    firsts: &'a mut Vec<usize>,
}

impl Kernel for AddEights<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { met, eights, has_layers, others, firsts } = self;
        for (block, (met, eight)) in met.iter().zip(eights).enumerate() {
            let AovColumns { albedo, ng, ns, position: [x, y, z], uv: [u, v], hits } = met;
            let places = [x, y, z, u, v];
            let mut is_summed = Float::is_finite(sum(simd, albedo) + sum(simd, ng) + sum(simd, ns));
            for place in places {
                let size = Float::abs(f32x8::load_array(simd, *place));
                let is_whole = !size.lt(size.like(LEAST)) | Float::eq(size, size.like(0.0));
                is_summed = is_summed & is_whole & size.lt(size.like(BOUND));
            }
            let summed = is_summed.to_bitmask() as u32 & hits;
            let is_summed = mask32x8::from_bitmask(simd, summed.into());
            add_narrow(simd, &mut eight.albedo, albedo, 0.0, is_summed);
            add_narrow(simd, &mut eight.ns, ns, -1.0, is_summed);
            if has_layers {
                add_narrow(simd, &mut eight.ng, ng, -1.0, is_summed);
                for ([upper_sums, lower_sums], place) in eight.places.iter_mut().zip(places) {
                    let place = wide(f32x8::load_array(simd, *place), is_summed) * UPPER;
                    let upper = place + INTEGERS - f64x8::splat(simd, INTEGERS);
                    add(simd, upper_sums, upper);
                    add(simd, lower_sums, (place - upper) * LOWER);
                }
            }
            add(simd, &mut eight.hits, wide(f32x8::splat(simd, 1.0), is_summed));
            let (new, left) = (summed & !eight.seen, hits & !summed);
            eight.seen |= summed;
            if new | left != 0 {
                firsts.extend(LaneMask(new).map(|lane| block * LANES + lane));
                others.extend(LaneMask(left).map(|lane| block * LANES + lane));
            }
        }
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

/// Adds the components of directions or colours as multiples of 2⁻³².
#[inline(always)]
fn add_narrow<S: Simd>(
    simd: S,
    sums: &mut [[u64; LANES]; 3],
    columns: &Columns<3>,
    least: f32,
    mask: mask32x8<S>,
) {
    for (sums, column) in sums.iter_mut().zip(columns) {
        let value = Float::clamp(f32x8::load_array(simd, *column), least, 1.0);
        add(simd, sums, SimdFloat::trunc(wide(value, mask) * TWO_TO_32));
    }
}

#[cfg(test)]
mod tests {
    use lookfrom_scene::settings::{ImageSettings, Layers, PixelBounds};

    use super::*;
    use crate::core::hash;

    /// A first hit; some have numbers that are left out of the sums of eight, or are none.
    fn first_hit(pixel: usize, sample: u32) -> Option<Aovs> {
        let bits = |number: u64| hash::pair(u64::from(sample) * 100 + pixel as u64, number);
        let number = |index: u64| {
            let bits = bits(index);
            let mantissa = (bits >> 40) as f32 / 16_777_216.0 - 0.5;
            match bits % 600 {
                0 => f32::NAN,
                1 => f32::INFINITY,
                2 => 1e30 * mantissa,
                3 => 1e-9 * mantissa,
                4 => -0.0,
                5 => LEAST,
                6 => BOUND,
                7..60 => 1e6 * mantissa,
                60..100 => 1e-3 * mantissa,
                _ => 2.2 * mantissa,
            }
        };
        let three = |first: u64| [first, first + 1, first + 2].map(number);
        (bits(99) % 4 != 0 && sample > pixel as u32 % 3).then(|| Aovs {
            albedo: three(0),
            ng: three(3),
            ns: three(6),
            position: three(9),
            uv: [12, 13].map(number),
        })
    }

    #[test]
    fn sums_of_many_are_those_of_each() {
        let area = PixelBounds { x0: 3, y0: 5, x1: 8, y1: 8 };
        for (layers, denoise) in
            [(Layers::Geometry, false), (Layers::None, true), (Layers::Geometry, true), (Layers::None, false)]
        {
            let image = ImageSettings { layers, denoise, ..ImageSettings::default() };
            let tile = FilmTile::for_image(area, &image).unwrap();
            let (mut together, mut each, mut sums) = (tile.clone(), tile, FirstHitSums::default());
            let pixels = (area.y0..area.y1).flat_map(|y| (area.x0..area.x1).map(move |x| [x, y]));
            let mut ids: Vec<SampleId> = pixels.map(|pixel| SampleId { pixel, sample: 0 }).collect();
            let mut columns = [AovColumns::MISSES; 2];
            for sample in 0..MOST_SAMPLES + 300 {
                ids.iter_mut().for_each(|id| id.sample = sample);
                columns.iter_mut().for_each(|columns| columns.hits = 0);
                for (index, id) in ids.iter().enumerate() {
                    let met = first_hit(index, sample);
                    each.add_first_hit(id.pixel[0], id.pixel[1], sample, met.as_ref());
                    if let Some(aovs) = met {
                        columns[index / LANES].set(index % LANES, &aovs);
                    }
                }
                together.add_first_hits(&ids, &columns, &mut sums);
            }
            together.add_first_hit_sums(&ids, &mut sums);
            assert!(together == each, "{layers:?}, denoiser: {denoise}");
        }
    }
}
