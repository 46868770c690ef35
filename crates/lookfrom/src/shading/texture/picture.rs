//! Image lookups: filtering and wrapping.

mod lanes;

use lookfrom_scene::image::{Image, Quad};
use lookfrom_scene::texture::{TexelFilter, Wrap};

pub(super) use self::lanes::{look_up_each, signed_size};
pub(crate) use self::lanes::{look_up_lanes, nearest_lanes};

/// Coordinates are clamped to this many texels; floats of this size have long lost their fraction.
const FARTHEST: f32 = 1_073_741_824.0;

/// The colour of an image at `(s, t)`, with `t` *down* and both from 0 to 1 over the image. Finite for an image of
/// finite texels, at any coordinates: NaN is taken as 0.
pub fn look_up(image: &Image, st: [f32; 2], wraps: [Wrap; 2], filter: TexelFilter) -> [f32; 3] {
    let [r, g, b, _] = Footprint::new(image, st, wraps, filter).blend(image);
    [r, g, b]
}

/// The four texels of an image that bilinear interpolation blends at `(s, t)`, and their weights.
pub fn blended_texels(image: &Image, st: [f32; 2], wraps: [Wrap; 2]) -> [([f32; 3], f32); 4] {
    let footprint = Footprint::new(image, st, wraps, TexelFilter::Bilinear);
    let texels = image.decoded(&footprint.fetch(image));
    std::array::from_fn(|k| {
        let [r, g, b, _] = texels[k];
        ([r, g, b], footprint.weights[k])
    })
}

/// The texels of an image that are blended at a point, and their weights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Footprint {
    columns: [u32; 2],
    rows: [u32; 2],
    weights: [f32; 4],
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
                let weight = if column.is_some() && row.is_some() { 1.0 } else { 0.0 };
                Self {
                    columns: [column.unwrap_or(0); 2],
                    rows: [row.unwrap_or(0); 2],
                    weights: [weight, 0.0, 0.0, 0.0],
                }
            }
            // Without a footprint a MIP map is its finest level.
            TexelFilter::Bilinear | TexelFilter::Mip { .. } => {
                // texel centres are at halves
                let ((x, fx), (y, fy)) = (split(x - 0.5), split(y - 0.5));
                let weights = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
                Self::around(image, [x, y], weights, wraps)
            }
        }
    }

    /// The texels at (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
    #[inline]
    fn around(image: &Image, [x, y]: [i32; 2], weights: [f32; 4], wraps: [Wrap; 2]) -> Self {
        let inside = |x: i32, size: u32| x >= 0 && (x as u32) < size - 1;
        if inside(x, image.width) && inside(y, image.height) {
            // No wrapping is needed, as nearly always.
            let (x, y) = (x as u32, y as u32);
            return Self { columns: [x, x + 1], rows: [y, y + 1], weights };
        }
        Self::around_edge(image, [x, y], weights, wraps)
    }

    #[inline(never)]
    fn around_edge(image: &Image, [x, y]: [i32; 2], mut weights: [f32; 4], wraps: [Wrap; 2]) -> Self {
        let columns = [x, x + 1].map(|x| wrapped(x, image.width, wraps[0]));
        let rows = [y, y + 1].map(|y| wrapped(y, image.height, wraps[1]));
        for (k, weight) in weights.iter_mut().enumerate() {
            *weight *= if columns[k % 2].is_some() && rows[k / 2].is_some() { 1.0 } else { 0.0 };
        }
        Self { columns: columns.map(|x| x.unwrap_or(0)), rows: rows.map(|y| y.unwrap_or(0)), weights }
    }

    /// The texels, as they are stored.
    #[inline(always)]
    fn fetch(&self, image: &Image) -> Quad {
        image.quad(self.columns, self.rows)
    }

    /// The blended colour and opacity.
    #[inline]
    pub(super) fn blend(&self, image: &Image) -> [f32; 4] {
        let ([a, b, c, d], w) = (image.decoded(&self.fetch(image)), &self.weights);
        std::array::from_fn(|i| w[0] * a[i] + w[1] * b[i] + w[2] * c[i] + w[3] * d[i])
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
pub(super) fn wrapped(x: i32, size: u32, wrap: Wrap) -> Option<u32> {
    // Without a division in the common case.
    if x >= 0 && (x as u32) < size {
        return Some(x as u32);
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
    Some(inside as u32)
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
                    assert!(wrapped(x, size, wrap).unwrap() < size);
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
                let weights = [0.5, 0.25, 0.125, 0.0625];
                let blended = Footprint::around(&image, [x, y], weights, [wrap; 2]).blend(&image);
                // The long way: each texel by itself, black beyond the edges.
                let mut expected = [0.0; 4];
                for (k, [x, y]) in [[x, y], [x + 1, y], [x, y + 1], [x + 1, y + 1]].into_iter().enumerate() {
                    let (Some(x), Some(y)) = (wrapped(x, 4, wrap), wrapped(y, 3, wrap)) else { continue };
                    let [r, g, b] = image.texel((4 * y + x) as usize);
                    for (sum, value) in expected.iter_mut().zip([r, g, b, 1.0]) {
                        *sum += weights[k] * value;
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
