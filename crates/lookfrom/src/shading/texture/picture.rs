//! Image lookups: filtering and wrapping.

use lookfrom_scene::image::Image;
use lookfrom_scene::texture::{Channel, TexelFilter, Wrap};

/// Coordinates are clamped to this many texels; floats of this size have long lost their fraction.
const FARTHEST: f32 = 1_073_741_824.0;

/// The colour of an image at `(s, t)`, with `t` *down* and both from 0 to 1 over the image. Finite for an image of
/// finite texels, at any coordinates: NaN is taken as 0.
pub fn look_up(image: &Image, st: [f32; 2], wraps: [Wrap; 2], filter: TexelFilter) -> [f32; 3] {
    blended(image, &Colors, st, wraps, filter)
}

/// One channel of an image, looked up the same way. Beyond the edges of [`Wrap::Black`] it is 0.
pub(super) fn look_up_channel(
    image: &Image,
    channel: Channel,
    st: [f32; 2],
    wraps: [Wrap; 2],
    filter: TexelFilter,
) -> f32 {
    blended(image, &channel, st, wraps, filter)
}

/// The part of a texel that is read.
trait Read {
    type Value: Copy + Default;

    fn texels<const N: usize>(&self, image: &Image, places: [usize; N]) -> [Self::Value; N];

    fn sum(weights: [f32; 4], values: [Self::Value; 4]) -> Self::Value;
}

/// Red, green and blue.
struct Colors;

impl Read for Colors {
    type Value = [f32; 3];

    #[inline]
    fn texels<const N: usize>(&self, image: &Image, places: [usize; N]) -> [[f32; 3]; N] {
        image.texels_at(places)
    }

    #[inline]
    fn sum(weights: [f32; 4], [a, b, c, d]: [[f32; 3]; 4]) -> [f32; 3] {
        std::array::from_fn(|i| weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i] + weights[3] * d[i])
    }
}

impl Read for Channel {
    type Value = f32;

    #[inline]
    fn texels<const N: usize>(&self, image: &Image, places: [usize; N]) -> [f32; N] {
        image.channel_at(places, *self)
    }

    #[inline]
    fn sum(weights: [f32; 4], [a, b, c, d]: [f32; 4]) -> f32 {
        weights[0] * a + weights[1] * b + weights[2] * c + weights[3] * d
    }
}

#[inline]
fn blended<R: Read>(
    image: &Image,
    read: &R,
    [s, t]: [f32; 2],
    wraps: [Wrap; 2],
    filter: TexelFilter,
) -> R::Value {
    let (x, y) = (s * image.width as f32, t * image.height as f32);
    match filter {
        TexelFilter::Nearest => {
            let column = wrapped(split(x).0, image.width, wraps[0]);
            texel(image, read, (column, wrapped(split(y).0, image.height, wraps[1])))
        }
        TexelFilter::Bilinear => {
            // texel centres are at halves
            let ((x, fx), (y, fy)) = (split(x - 0.5), split(y - 0.5));
            let weights = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
            R::sum(weights, four_texels(image, read, [x, y], wraps))
        }
    }
}

/// The texels at (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
#[inline]
fn four_texels<R: Read>(image: &Image, read: &R, [x, y]: [i32; 2], wraps: [Wrap; 2]) -> [R::Value; 4] {
    let inside = |x: i32, size: u32| x >= 0 && (x as u32) < size - 1;
    if inside(x, image.width) && inside(y, image.height) {
        // No wrapping is needed, as nearly always.
        let width = image.width as usize;
        let top = y as usize * width + x as usize;
        return read.texels(image, [top, top + 1, top + width, top + width + 1]);
    }
    let [left, right] = [x, x + 1].map(|x| wrapped(x, image.width, wraps[0]));
    let [top, bottom] = [y, y + 1].map(|y| wrapped(y, image.height, wraps[1]));
    [(left, top), (right, top), (left, bottom), (right, bottom)].map(|place| texel(image, read, place))
}

/// The texel at a column and a row; black where there is none.
#[inline]
fn texel<R: Read>(image: &Image, read: &R, place: (Option<usize>, Option<usize>)) -> R::Value {
    match place {
        (Some(x), Some(y)) => {
            let [texel] = read.texels(image, [y * image.width as usize + x]);
            texel
        }
        _ => R::Value::default(),
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
                let long = [[x, y], [x + 1, y], [x, y + 1], [x + 1, y + 1]];
                let long =
                    long.map(|[x, y]| texel(&image, &Colors, (wrapped(x, 4, wrap), wrapped(y, 3, wrap))));
                assert_eq!(four_texels(&image, &Colors, [x, y], [wrap; 2]), long, "{wrap:?} at {x}, {y}");
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
