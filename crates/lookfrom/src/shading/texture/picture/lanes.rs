//! Bilinear look-ups at eight places side by side.

use lookfrom_scene::image::{Image, Quad};
use lookfrom_scene::texture::Wrap;
use lookfrom_simd::{Float, Real, Simd, f32x4, f32x8, prelude::*};

use super::{FARTHEST, Footprint};
use crate::core::lanes::{Columns, LANES, by_lane, row, set_row};

/// The colours and opacities at eight places of an image, bilinearly blended: as [`super::look_up`].
#[inline(always)]
pub(crate) fn look_up_lanes<S: Simd>(
    simd: S,
    image: &Image,
    st: [f32x8<S>; 2],
    wraps: [Wrap; 2],
) -> [[f32; 4]; LANES] {
    let [width, height] = signed_size([image.width, image.height], wraps);
    let signed_size = [f32x8::splat(simd, width), f32x8::splat(simd, height)];
    look_up_each(simd, &[image; LANES], signed_size, &[wraps; LANES], st)
}

/// The colours of the texels at eight places of an image: as [`super::look_up`] of the nearest, where edges are continued.
#[inline(always)]
pub(crate) fn nearest_lanes<S: Simd>(image: &Image, [s, t]: [f32x8<S>; 2]) -> [[f32; 3]; LANES] {
    let [width, height] = [image.width, image.height];
    let (x, y): ([f32; LANES], [f32; LANES]) = ((s * width as f32).into(), (t * height as f32).into());
    // All places are found before any texel is read, so that the waits for memory overlap.
    let places = by_lane!(lane => {
        let (column, row) = ((x[lane] as u32).min(width - 1), (y[lane] as u32).min(height - 1));
        row as usize * width as usize + column as usize
    });
    by_lane!(lane => image.texel(places[lane]))
}

/// Texels at a place of each of eight images, by their [`signed_size`].
#[inline(always)]
pub(in crate::shading::texture) fn look_up_each<S: Simd>(
    simd: S,
    images: &[&Image; LANES],
    signed_size: [f32x8<S>; 2],
    wraps: &[[Wrap; 2]; LANES],
    [s, t]: [f32x8<S>; 2],
) -> [[f32; 4]; LANES] {
    let [width, height] = [Float::abs(signed_size[0]), Float::abs(signed_size[1])];
    let ([x, y], weights) = bilinear(s * width, t * height);
    let (x, y) = (repeated(x, signed_size[0]), repeated(y, signed_size[1]));
    let inside = (is_inside(x, width) & is_inside(y, height)).to_bitmask();
    let cells: Columns<2> = [x.into(), y.into()];
    let (x, y): ([u32; LANES], [u32; LANES]) = (x.to_integer().into(), y.to_integer().into());
    let mut weights: Columns<4> =
        [weights[0].into(), weights[1].into(), weights[2].into(), weights[3].into()];

    // All texels are fetched before any is decoded, so that the waits for memory overlap.
    let mut quads = [Quad::BLACK; LANES];
    for (lane, quad) in quads.iter_mut().enumerate() {
        *quad = if inside & 1 << lane != 0 {
            images[lane].quad([x[lane], x[lane] + 1], [y[lane], y[lane] + 1])
        } else {
            let cell = [cells[0][lane] as i32, cells[1][lane] as i32];
            let footprint = Footprint::around(images[lane], cell, row(&weights, lane), wraps[lane]);
            set_row(&mut weights, lane, footprint.weights);
            footprint.fetch(images[lane])
        };
    }
    let mut blended = [[0.0; 4]; LANES];
    for (lane, blended) in blended.iter_mut().enumerate() {
        let [a, b, c, d] = images[lane].decoded(&quads[lane]);
        let w = row(&weights, lane);
        *blended = (f32x4::load_array(simd, a) * w[0]
            + f32x4::load_array(simd, b) * w[1]
            + f32x4::load_array(simd, c) * w[2]
            + f32x4::load_array(simd, d) * w[3])
            .into();
    }
    blended
}

/// Width and height of an image; negative along axes in which it repeats.
#[inline]
pub(in crate::shading::texture) fn signed_size(size: [u32; 2], wraps: [Wrap; 2]) -> [f32; 2] {
    let [width, height] = size.map(|size| size as f32);
    let sign = |wrap| if wrap == Wrap::Repeat { -1.0 } else { 1.0 };
    [sign(wraps[0]) * width, sign(wraps[1]) * height]
}

/// Whether a column (or row) and the next are in an image of a size; `false` in those of more than 2²⁴, where floats are not
/// exact.
#[inline(always)]
fn is_inside<R: Real>(cell: R, size: R) -> R::Mask {
    let last = Float::min(size - 1.0, size.like(16_777_215.0));
    cell.gt(size.like(-1.0)) & cell.lt(last)
}

/// A column (or row), as a whole number, of an image that repeats, within the image; as it is where the image does not repeat,
/// or numbers are so large that they are not exact.
#[inline(always)]
fn repeated<R: Real>(cell: R, signed_size: R) -> R {
    let size = Float::abs(signed_size);
    let rest = cell - Float::floor(cell / size) * size;
    // The quotient may have been rounded to a whole number beside it.
    let rest = R::select(rest.lt(cell.like(0.0)), rest + size, rest);
    let rest = R::select(rest.lt(size), rest, rest - size);
    let is_exact = Float::max(Float::abs(cell), size).lt(cell.like(8_388_608.0));
    R::select(signed_size.lt(cell.like(0.0)) & is_exact, rest, cell)
}

/// The column and row, as whole numbers, of the first of the four texels around (x, y), measured in texels, and the weights
/// of the four: as [`Footprint::new`] has them, at any width.
#[inline(always)]
fn bilinear<R: Real>(x: R, y: R) -> ([R; 2], [R; 4]) {
    // texel centres are at halves
    let [x, y] = [Float::clamp(x - 0.5, -FARTHEST, FARTHEST), Float::clamp(y - 0.5, -FARTHEST, FARTHEST)];
    let cell = [Float::floor(x), Float::floor(y)];
    let (fx, fy) = (x - cell[0], y - cell[1]);
    let (gx, gy) = (x.like(1.0) - fx, x.like(1.0) - fy);
    (cell, [gx * gy, fx * gy, gx * fy, fx * fy])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::hash;

    #[test]
    fn cells_repeat() {
        for count in 0..200_000_u64 {
            let size = 1 + (hash::pair(count, 0) % 5000) as i32;
            let cell = (hash::pair(count, 1) % (1 << 24)) as i32 - (1 << 23) + 1;
            let expected = cell.rem_euclid(size) as f32;
            assert_eq!(repeated(cell as f32, -size as f32), expected, "{cell} of {size}");
            assert_eq!(repeated(cell as f32, size as f32), cell as f32);
        }
        assert_eq!(repeated(1e9, -512.0), 1e9);
    }

    #[test]
    fn cells_inside_need_no_wrapping() {
        for size in [1_u32, 2, 7, 4096, 16_777_215, 16_777_216, 16_777_217, u32::MAX] {
            for cell in [-1e9, -1.0, 0.0, 1.0, 5.0, 6.0, 4094.0, 4095.0, 16_777_214.0, 16_777_215.0, 4e9] {
                let exactly = cell >= 0.0 && cell as u32 + 1 < size;
                let is_inside = is_inside(cell, size as f32);
                assert!(is_inside == exactly || (!is_inside && cell >= 16_777_215.0), "{cell} of {size}");
            }
        }
    }
}
