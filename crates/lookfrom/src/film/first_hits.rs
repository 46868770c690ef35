//! First hits of a sample of each pixel of a tile at once: [`FilmTile::add_first_hit`], as [`super::sums`] does for light.

use super::{FEATURE_SAMPLES, FilmTile, SampleId};
use crate::aov::{AovAccumulator, AovColumns};
use crate::core::accumulator::MOST_SAMPLES;

impl FilmTile {
    /// Adds the first hits of samples, all of which count for the denoiser or none, to the tile or to `sums`; always of the same
    /// pixels until [`FilmTile::add_first_hit_sums`].
    pub(crate) fn add_first_hits(&mut self, ids: &[SampleId], met: &[AovColumns], sums: &mut AovAccumulator) {
        let Some(&SampleId { sample, .. }) = ids.first() else { return };
        let are_features = !self.features.is_empty() && sample < FEATURE_SAMPLES;
        if sums.are_features != are_features || sums.samples() == MOST_SAMPLES {
            self.add_first_hit_sums(ids, sums);
        }
        sums.are_features = are_features;
        sums.add(ids, met, self.has_layers(), |id, aovs| self.merge_aovs(id.pixel, aovs, are_features));
    }

    /// Moves the sums of the pixels into the tile.
    pub(crate) fn add_first_hit_sums(&mut self, ids: &[SampleId], sums: &mut AovAccumulator) {
        let are_features = sums.are_features;
        sums.drain(|index, aovs| {
            ids.get(index).into_iter().for_each(|id| self.merge_aovs(id.pixel, aovs, are_features));
        });
    }
}

#[cfg(test)]
mod tests {
    use lookfrom_scene::settings::{ImageSettings, Layers, PixelBounds};

    use super::*;
    use crate::aov::Aovs;
    use crate::core::hash;
    use crate::core::lanes::LANES;

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
                5 => 1.0 / 16_777_216.0,
                6 => 268_435_456.0,
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
            let (mut together, mut each, mut sums) = (tile.clone(), tile, AovAccumulator::default());
            let pixels = (area.y0..area.y1).flat_map(|y| (area.x0..area.x1).map(move |x| [x, y]));
            let mut ids: Vec<SampleId> = pixels.map(|pixel| SampleId { pixel, sample: 0 }).collect();
            let mut columns = [AovColumns::default(); 2];
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
