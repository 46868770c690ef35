//! Places in pictures by texture coordinates, in eight lanes: as `mapping` and `Footprint` have them.

use lookfrom_scene::image::Image;
use lookfrom_scene::texture::Wrap;
use lookfrom_simd::{Float, Kernel, Real, Simd, dispatch, f32x8, level, prelude::*};

use crate::core::lanes::LANES;
use crate::shading::texture::picture::bilinear;
use crate::shading::texture::{TexturePoint, mapping};

/// An affine map of a set of texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UvMap {
    pub(super) set: usize,
    pub(super) matrix: [[f32; 3]; 2],
}

/// Texture coordinates in eight lanes, their maps, and the images there.
pub(super) struct Places {
    uv: [[f32; LANES]; 2],
    matrix: [[[f32; LANES]; 3]; 2],
    size: [[f32; LANES]; 2],
    /// 1 where the image repeats along an axis, otherwise 0.
    repeats: [[f32; LANES]; 2],
}

/// The first of four texels around a place, by column and row, and their weights.
pub(super) struct Cells {
    pub(super) cell: [[f32; LANES]; 2],
    pub(super) weights: [[f32; LANES]; 4],
}

impl Places {
    /// Nowhere.
    pub(super) const NONE: Self = Self {
        uv: [[0.0; LANES]; 2],
        matrix: [[[0.0; LANES]; 3]; 2],
        size: [[1.0; LANES]; 2],
        repeats: [[0.0; LANES]; 2],
    };

    /// In all lanes the same map to the same image.
    #[inline]
    pub(super) fn of_one(map: &UvMap, image: &Image, wraps: [Wrap; 2]) -> Self {
        Self {
            uv: [[0.0; LANES]; 2],
            matrix: map.matrix.map(|row| row.map(|number| [number; LANES])),
            size: [image.width, image.height].map(|size| [size as f32; LANES]),
            repeats: wraps.map(|wrap| [repeats(wrap); LANES]),
        }
    }

    /// Sets the map and the image of a lane.
    #[inline]
    pub(super) fn set(&mut self, lane: usize, map: &UvMap, image: &Image, wraps: [Wrap; 2]) {
        for (axis, size) in [image.width, image.height].into_iter().enumerate() {
            self.size[axis][lane] = size as f32;
            self.repeats[axis][lane] = repeats(wraps[axis]);
            for k in 0..3 {
                self.matrix[axis][k][lane] = map.matrix[axis][k];
            }
        }
    }

    /// Sets the texture coordinates of a lane.
    #[inline]
    pub(super) fn set_uv(&mut self, lane: usize, map: &UvMap, at: &TexturePoint<'_>) {
        let uv = match map.set {
            0 => at.uv,
            set => at.more_uvs.get(set - 1).copied().unwrap_or_default(),
        };
        (self.uv[0][lane], self.uv[1][lane]) = (uv.x, uv.y);
    }

    /// The texels around the places.
    #[inline(never)]
    pub(super) fn cells(&self) -> Cells {
        dispatch(level(), self)
    }
}

impl Kernel for &Places {
    type Output = Cells;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Cells {
        macro_rules! load {
            ($array:expr) => {
                f32x8::load_array(simd, $array)
            };
        }
        let (u, v) = (load!(self.uv[0]), load!(self.uv[1]));
        let [s, t] = [
            load!(self.matrix[0][0]) * u + load!(self.matrix[0][1]) * v + load!(self.matrix[0][2]),
            load!(self.matrix[1][0]) * u + load!(self.matrix[1][1]) * v + load!(self.matrix[1][2]),
        ];
        // v runs up, rows run down.
        let (s, t) = (mapping::bounded(s), -mapping::bounded(t) + 1.0);
        let size = [load!(self.size[0]), load!(self.size[1])];
        let ([column, row], weights) = bilinear(s * size[0], t * size[1]);
        let column = repeated(column, size[0], load!(self.repeats[0]));
        let row = repeated(row, size[1], load!(self.repeats[1]));
        Cells {
            cell: [column.into(), row.into()],
            weights: [weights[0].into(), weights[1].into(), weights[2].into(), weights[3].into()],
        }
    }
}

/// 1 where an image repeats, otherwise 0.
#[inline]
fn repeats(wrap: Wrap) -> f32 {
    if wrap == Wrap::Repeat { 1.0 } else { 0.0 }
}

/// A column (or row) of an image that repeats, as a whole number within the image; as it is where the image does not repeat, or
/// numbers are so large that they are not exact.
#[inline(always)]
fn repeated<R: Real>(cell: R, size: R, repeats: R) -> R {
    let rest = cell - Float::floor(cell / size) * size;
    // The quotient may have been rounded to a whole number beside it.
    let rest = R::select(rest.lt(cell.like(0.0)), rest + size, rest);
    let rest = R::select(rest.lt(size), rest, rest - size);
    let is_exact = Float::max(Float::abs(cell), size).lt(cell.like(8_388_608.0));
    R::select(repeats.gt(cell.like(0.0)) & is_exact, rest, cell)
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
            assert_eq!(repeated(cell as f32, size as f32, 1.0), expected, "{cell} of {size}");
            assert_eq!(repeated(cell as f32, size as f32, 0.0), cell as f32);
        }
        assert_eq!(repeated(1e9, 512.0, 1.0), 1e9);
    }
}
