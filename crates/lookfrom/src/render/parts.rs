//! Parts of a pass that threads take one after the other: tiles, and samples of tiles.

use std::ops::Range;

use lookfrom_scene::settings::PixelBounds;

/// Side of a tile in pixels. One sample of each pixel of a tile is a batch.
const TILE: u32 = 32;

/// Pixels of a tile that lack the same samples.
pub(super) struct TilePart {
    /// Disjoint.
    pub(super) areas: Vec<PixelBounds>,
    pub(super) samples: Range<u32>,
}

/// The missing samples of a tile's pixels, those with the same samples together.
pub(super) fn parts(missing: Vec<(PixelBounds, Range<u32>)>) -> Vec<TilePart> {
    let mut parts: Vec<TilePart> = Vec::new();
    for (area, samples) in missing {
        match parts.iter_mut().find(|part| part.samples == samples) {
            Some(part) => part.areas.push(area),
            None => parts.push(TilePart { areas: vec![area], samples }),
        }
    }
    parts
}

/// Divides parts by their samples until there are `count`, if they are fewer and have as many samples.
pub(super) fn divided(parts: Vec<TilePart>, count: usize) -> Vec<TilePart> {
    let pieces = count.div_ceil(parts.len().max(1));
    let divide = |TilePart { areas, samples: Range { start, end } }| {
        let length = (end - start).div_ceil(pieces as u32).max(1);
        (start..end).step_by(length as usize).map(move |start| TilePart {
            areas: areas.clone(),
            samples: start..end.min(start.saturating_add(length)),
        })
    };
    if pieces > 1 { parts.into_iter().flat_map(divide).collect() } else { parts }
}

/// The parts of an area that threads work on.
pub(super) fn tiles(area: PixelBounds) -> Vec<PixelBounds> {
    let rows = (area.y0..area.y1).step_by(TILE as usize);
    rows.flat_map(|y0| {
        let columns = (area.x0..area.x1).step_by(TILE as usize);
        columns.map(move |x0| PixelBounds {
            x0,
            y0,
            x1: (x0 + TILE).min(area.x1),
            y1: (y0 + TILE).min(area.y1),
        })
    })
    .collect()
}

/// The rows of an area.
pub(super) fn rows(area: &PixelBounds) -> impl Iterator<Item = PixelBounds> + use<> {
    let area = *area;
    (area.y0..area.y1).map(move |y| PixelBounds { y0: y, y1: y + 1, ..area })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_parts_are_divided_by_their_samples() {
        let areas = tiles(PixelBounds { x0: 0, y0: 0, x1: 32, y1: 40 });
        let samples_of = |samples: &[Range<u32>], count| -> Vec<Range<u32>> {
            let part = |(area, samples): (&PixelBounds, &Range<u32>)| TilePart {
                areas: vec![*area],
                samples: samples.clone(),
            };
            let parts = areas.iter().zip(samples).map(part).collect();
            divided(parts, count).into_iter().map(|part| part.samples).collect()
        };
        let all = [[8..11, 11..14, 14..16], [0..2, 2..4, 4..5]].concat();
        assert_eq!(samples_of(&[8..16, 0..5], 6), all);
        assert_eq!(samples_of(&[8..16, 0..5], 2), [8..16, 0..5]);
        assert_eq!(samples_of(&[7..9, 0..1], 64), [7..8, 8..9, 0..1]);
        assert_eq!(samples_of(&[], 64), []);
    }
}
