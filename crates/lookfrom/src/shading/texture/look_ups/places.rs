//! Places in pictures by texture coordinates, in eight lanes: as `mapping` has them.

use lookfrom_scene::image::Image;
use lookfrom_scene::texture::Wrap;
use lookfrom_simd::{Kernel, Simd, dispatch, f32x8, level, prelude::*, transposed};

use crate::core::lanes::{Columns, LANES, by_lane, set_row};
use crate::shading::texture::picture::{look_up_each, signed_size};
use crate::shading::texture::{TexturePoint, mapping};

/// An affine map of a set of texture coordinates to an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::shading::texture) struct UvMap {
    set: usize,
    /// The rows of the matrix, and the image's signed size.
    numbers: [f32; 8],
}

impl UvMap {
    pub(super) fn new(
        set: usize,
        [[a, b, c], [d, e, f]]: [[f32; 3]; 2],
        size: [u32; 2],
        wraps: [Wrap; 2],
    ) -> Self {
        let [width, height] = signed_size(size, wraps);
        Self { set, numbers: [a, b, c, d, e, f, width, height] }
    }

    /// The texture coordinates that it maps.
    #[inline]
    pub(super) fn uv(&self, at: &TexturePoint<'_>) -> [f32; 2] {
        let uv = match self.set {
            0 => at.uv,
            set => at.more_uvs.get(set - 1).copied().unwrap_or_default(),
        };
        uv.to_array()
    }
}

/// Texture coordinates in eight lanes, their maps, and the images there.
pub(super) struct Places<'a> {
    uv: Columns<2>,
    maps: [&'a UvMap; LANES],
    images: [&'a Image; LANES],
    wraps: [[Wrap; 2]; LANES],
}

impl<'a> Places<'a> {
    /// All lanes at the same place.
    #[inline]
    pub(super) fn all_at(map: &'a UvMap, image: &'a Image, wraps: [Wrap; 2], [u, v]: [f32; 2]) -> Self {
        Self {
            uv: [[u; LANES], [v; LANES]],
            maps: [map; LANES],
            images: [image; LANES],
            wraps: [wraps; LANES],
        }
    }

    /// Sets the place of a lane.
    #[inline]
    pub(super) fn set(
        &mut self,
        lane: usize,
        map: &'a UvMap,
        image: &'a Image,
        wraps: [Wrap; 2],
        uv: [f32; 2],
    ) {
        set_row(&mut self.uv, lane, uv);
        (self.maps[lane], self.images[lane], self.wraps[lane]) = (map, image, wraps);
    }

    /// The colours and opacities there.
    #[inline(never)]
    pub(super) fn look_up(&self) -> [[f32; 4]; LANES] {
        dispatch(level(), self)
    }
}

impl Kernel for &Places<'_> {
    type Output = [[f32; 4]; LANES];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> [[f32; 4]; LANES] {
        let Places { uv, maps, images, wraps } = self;
        let [u, v] = [f32x8::load_array(simd, uv[0]), f32x8::load_array(simd, uv[1])];
        let maps = by_lane!(lane => f32x8::load_array(simd, maps[lane].numbers));
        let [a, b, c, d, e, f, width, height] = transposed(maps);
        let (s, t) = (a * u + b * v + c, d * u + e * v + f);
        // v runs up, rows run down.
        let st = [mapping::bounded(s), -mapping::bounded(t) + 1.0];
        look_up_each(simd, images, [width, height], wraps, st)
    }
}
