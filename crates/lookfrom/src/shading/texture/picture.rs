//! Image lookups: filtering and wrapping.

use lookfrom_scene::image::{Image, Quad};
use lookfrom_scene::texture::{TexelFilter, Wrap};
use lookfrom_simd::{Float, Real, Simd, f32x8, prelude::*};

use crate::core::lanes::{LANES, by_lane};

/// Coordinates are clamped to this many texels; floats of this size have long lost their fraction.
const FARTHEST: f32 = 1_073_741_824.0;

/// The colour of an image at `(s, t)`, with `t` *down* and both from 0 to 1 over the image. Finite for an image of
/// finite texels, at any coordinates: NaN is taken as 0.
pub fn look_up(image: &Image, st: [f32; 2], wraps: [Wrap; 2], filter: TexelFilter) -> [f32; 3] {
    let [r, g, b, _] = Footprint::new(image, st, wraps, filter).blend(image);
    [r, g, b]
}

/// The colours at eight places of an image, bilinearly blended: as [`look_up`].
#[inline(always)]
pub(crate) fn look_up_lanes<S: Simd>(
    simd: S,
    image: &Image,
    [s, t]: [f32x8<S>; 2],
    wraps: [Wrap; 2],
) -> [[f32; 3]; LANES] {
    let size = [image.width, image.height].map(|size| f32x8::splat(simd, size as f32));
    let ([column, row], weights) = bilinear(s * size[0], t * size[1]);
    let (column, row): ([f32; LANES], [f32; LANES]) = (column.into(), row.into());
    let [a, b, c, d]: [[f32; LANES]; 4] =
        [weights[0].into(), weights[1].into(), weights[2].into(), weights[3].into()];
    let footprints = by_lane!(lane =>
        Footprint::of_cell(image, [column[lane], row[lane]], [a[lane], b[lane], c[lane], d[lane]], wraps));
    // All texels are fetched together, so that the waits for memory overlap.
    let quads = by_lane!(lane => footprints[lane].fetch(image));
    by_lane!(lane => {
        let [r, g, b, _] = blended(image, &quads[lane], &footprints[lane].weights);
        [r, g, b]
    })
}

/// The texels of an image that are blended at a point, and their weights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Footprint {
    places: [usize; 4],
    pub(super) weights: [f32; 4],
}

impl Footprint {
    /// The texels at `(s, t)`. Those beyond the edges of [`Wrap::Black`] have the weight 0.
    #[inline]
    pub(super) fn new(image: &Image, [s, t]: [f32; 2], wraps: [Wrap; 2], filter: TexelFilter) -> Self {
        let (x, y) = (s * image.width as f32, t * image.height as f32);
        match filter {
            TexelFilter::Nearest => {
                let column = wrapped(split(x).0, image.width, wraps[0]);
                let row = wrapped(split(y).0, image.height, wraps[1]);
                let (place, weight) = place(image, column, row);
                Self { places: [place; 4], weights: [weight, 0.0, 0.0, 0.0] }
            }
            TexelFilter::Bilinear => {
                // texel centres are at halves
                let ((x, fx), (y, fy)) = (split(x - 0.5), split(y - 0.5));
                let weights = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
                Self { places: [0; 4], weights }.around(image, [x, y], wraps)
            }
        }
    }

    /// Bilinear footprints from the cells and weights that [`bilinear`] computes.
    #[inline]
    pub(super) fn of_cell(image: &Image, cell: [f32; 2], weights: [f32; 4], wraps: [Wrap; 2]) -> Self {
        Self { places: [0; 4], weights }.around(image, cell.map(|x| x as i32), wraps)
    }

    /// The same weights for the texels at (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
    #[inline]
    fn around(self, image: &Image, [x, y]: [i32; 2], wraps: [Wrap; 2]) -> Self {
        let inside = |x: i32, size: u32| x >= 0 && (x as u32) < size - 1;
        if inside(x, image.width) && inside(y, image.height) {
            // No wrapping is needed, as nearly always.
            let width = image.width as usize;
            let top = y as usize * width + x as usize;
            return Self { places: [top, top + 1, top + width, top + width + 1], ..self };
        }
        self.around_edge(image, [x, y], wraps)
    }

    #[inline(never)]
    fn around_edge(mut self, image: &Image, [x, y]: [i32; 2], wraps: [Wrap; 2]) -> Self {
        let [left, right] = [x, x + 1].map(|x| wrapped(x, image.width, wraps[0]));
        let [top, bottom] = [y, y + 1].map(|y| wrapped(y, image.height, wraps[1]));
        for (k, (column, row)) in
            [(left, top), (right, top), (left, bottom), (right, bottom)].into_iter().enumerate()
        {
            let (place, weight) = place(image, column, row);
            self.places[k] = place;
            self.weights[k] *= weight;
        }
        self
    }

    /// The texels, as they are stored.
    #[inline(always)]
    pub(super) fn fetch(&self, image: &Image) -> Quad {
        image.quad(self.places)
    }

    /// The blended colour and opacity.
    #[inline]
    pub(super) fn blend(&self, image: &Image) -> [f32; 4] {
        blended(image, &self.fetch(image), &self.weights)
    }
}

/// The colour and opacity of texels of an image that were fetched, blended by weights.
#[inline(always)]
pub(super) fn blended(image: &Image, quad: &Quad, w: &[f32; 4]) -> [f32; 4] {
    let [a, b, c, d] = image.decoded(quad);
    std::array::from_fn(|i| w[0] * a[i] + w[1] * b[i] + w[2] * c[i] + w[3] * d[i])
}

/// The column and row, as whole numbers, of the first of the four texels around (x, y), measured in texels, and the weights
/// of the four: as [`Footprint::new`] has them, at any width.
#[inline(always)]
pub(super) fn bilinear<R: Real>(x: R, y: R) -> ([R; 2], [R; 4]) {
    // texel centres are at halves
    let [x, y] = [Float::clamp(x - 0.5, -FARTHEST, FARTHEST), Float::clamp(y - 0.5, -FARTHEST, FARTHEST)];
    let cell = [Float::floor(x), Float::floor(y)];
    let (fx, fy) = (x - cell[0], y - cell[1]);
    let (gx, gy) = (x.like(1.0) - fx, x.like(1.0) - fy);
    (cell, [gx * gy, fx * gy, gx * fy, fx * fy])
}

/// The index of the texel at a column and a row, and the weight 1; the weight 0 where there is none.
#[inline]
fn place(image: &Image, column: Option<usize>, row: Option<usize>) -> (usize, f32) {
    match (column, row) {
        (Some(x), Some(y)) => (y * image.width as usize + x, 1.0),
        _ => (0, 0.0),
    }
}

/// The integer below and the fraction: by truncation, because `floor` is a function call on most target CPUs that
/// programs are compiled for.
#[inline]
fn split(x: f32) -> (i32, f32) {
    let x = x.clamp(-FARTHEST, FARTHEST);
    let toward_zero = x as i32;
    let below = toward_zero - i32::from(toward_zero as f32 > x);
    // The fraction of NaN is NaN, which `max` replaces by 0.
    (below, (x - below as f32).max(0.0))
}

/// The column (or row) after wrapping; `None` for a black one outside.
fn wrapped(x: i32, size: u32, wrap: Wrap) -> Option<usize> {
    // Without a division in the common case.
    if x >= 0 && (x as u32) < size {
        return Some(x as usize);
    }
    let (x, size) = (i64::from(x), i64::from(size));
    let inside = match wrap {
        Wrap::Repeat => x.rem_euclid(size),
        Wrap::Mirror => {
            let folded = x.rem_euclid(2 * size);
            folded.min(2 * size - 1 - folded)
        }
        Wrap::Clamp => x.clamp(0, size - 1),
        Wrap::Black => return None,
    };
    Some(inside as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapping() {
        let columns = |wrap| [-3, -1, 0, 1, 2, 5].map(|x| wrapped(x, 2, wrap));
        assert_eq!(columns(Wrap::Repeat), [1, 1, 0, 1, 0, 1].map(Some));
        assert_eq!(columns(Wrap::Mirror), [1, 0, 0, 1, 1, 1].map(Some));
        assert_eq!(columns(Wrap::Clamp), [0, 0, 0, 1, 1, 1].map(Some));
        assert_eq!(columns(Wrap::Black), [None, None, Some(0), Some(1), None, None]);
        for size in [1, 3, 1000, u32::MAX] {
            for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
                for x in [i32::MIN, -1, 0, i32::MAX] {
                    assert!(wrapped(x, size, wrap).unwrap() < size as usize);
                }
            }
        }
    }

    #[test]
    fn the_short_way_agrees_with_the_long_one() {
        let texels = (0..12).map(|i| [i as f32, 0.5, -1.0]).collect();
        let image = Image::from_linear("", 4, 3, texels);
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Black] {
            for (x, y) in (-9..9).flat_map(|x| (-9..9).map(move |y| (x, y))) {
                let weights = Footprint { places: [0; 4], weights: [0.5, 0.25, 0.125, 0.0625] };
                let blended = weights.around(&image, [x, y], [wrap; 2]).blend(&image);
                // The long way: each texel by itself, black beyond the edges.
                let mut expected = [0.0; 4];
                for (k, [x, y]) in [[x, y], [x + 1, y], [x, y + 1], [x + 1, y + 1]].into_iter().enumerate() {
                    let (Some(x), Some(y)) = (wrapped(x, 4, wrap), wrapped(y, 3, wrap)) else { continue };
                    let [r, g, b] = image.texel(4 * y + x);
                    for (sum, value) in expected.iter_mut().zip([r, g, b, 1.0]) {
                        *sum += weights.weights[k] * value;
                    }
                }
                assert_eq!(blended, expected, "{wrap:?} at {x}, {y}");
            }
        }
    }

    #[test]
    fn places_are_split() {
        assert_eq!([split(1.75), split(-0.25), split(-3.0)], [(1, 0.75), (-1, 0.75), (-3, 0.0)]);
        assert_eq!(split(f32::NAN), (0, 0.0));
        for wild in [f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1e20] {
            let (whole, fraction) = split(wild);
            assert!(whole.unsigned_abs() == 1 << 30 && fraction == 0.0, "{wild}");
        }
    }
}
