//! What is the colour of a picture between its texels and beyond its edges?

use lookfrom_scene::image::Image;
use lookfrom_scene::texture::{TexelFilter, Wrap};

/// Places beyond this many texels are taken to be here; they have long had no fraction.
const FARTHEST: f32 = 1_073_741_824.0;

/// The colour of a picture at `(s, t)`, with `t` *down* and both from 0 to 1 over the picture. Finite for a picture of finite
/// texels, wherever: a place that is not a number is taken as 0.
pub fn look_up(
    image: &Image,
    [s, t]: [f32; 2],
    [wrap_s, wrap_t]: [Wrap; 2],
    filter: TexelFilter,
) -> [f32; 3] {
    let column = |x: i32| wrapped(x, image.width, wrap_s);
    let row = |y: i32| wrapped(y, image.height, wrap_t);
    let texel = |x: Option<usize>, y: Option<usize>| match (x, y) {
        (Some(x), Some(y)) => image.texels[y * image.width as usize + x],
        _ => [0.0; 3],
    };
    let (x, y) = (s * image.width as f32, t * image.height as f32);
    match filter {
        TexelFilter::Nearest => texel(column(split(x).0), row(split(y).0)),
        TexelFilter::Bilinear => {
            // texel centres are at halves
            let ((x, fx), (y, fy)) = (split(x - 0.5), split(y - 0.5));
            let (left, right, top, bottom) = (column(x), column(x + 1), row(y), row(y + 1));
            let weights = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
            let [a, b, c, d] =
                [texel(left, top), texel(right, top), texel(left, bottom), texel(right, bottom)];
            std::array::from_fn(|i| {
                weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i] + weights[3] * d[i]
            })
        }
    }
}

/// The whole number below, and the fraction.
fn split(x: f32) -> (i32, f32) {
    let x = if x.is_nan() { 0.0 } else { x.clamp(-FARTHEST, FARTHEST) };
    let floor = x.floor();
    (floor as i32, x - floor)
}

/// The column (or row) that a whole number means, `None` for one outside that is black.
fn wrapped(x: i32, size: u32, wrap: Wrap) -> Option<usize> {
    // most places are inside, where all wraps agree
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
    fn places_are_split() {
        assert_eq!([split(1.75), split(-0.25), split(-3.0)], [(1, 0.75), (-1, 0.75), (-3, 0.0)]);
        assert_eq!(split(f32::NAN), (0, 0.0));
        for wild in [f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1e20] {
            let (whole, fraction) = split(wild);
            assert!(whole.unsigned_abs() == 1 << 30 && fraction == 0.0, "{wild}");
        }
    }
}
