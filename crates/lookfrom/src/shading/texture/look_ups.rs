//! Pictures looked up at eight points at once, before textures ask for them.
//!
//! Texels are seldom in the cache. One look-up after another would wait for each; here the places of all are computed first
//! and all texels are fetched together, so that the waits overlap. Textures of one picture and mapping (the roughness and the
//! metalness of glTF's material) share a look-up.

mod places;

use glam::Vec2;
use lookfrom_scene::image::Image;
use lookfrom_scene::texture::{Mapping, MipFilter, TexelFilter, Wrap};
use lookfrom_simd::LaneMask;

use self::places::{Places, UvMap};
use super::input::{FloatTexture, Input, SpectrumTexture};
use super::mip::{Levels, MipMap};
use super::node::Node;
use super::picture::Footprint;
use super::{TexturePoint, Textures, mapping};
use crate::core::lanes::{LANES, by_lane};

/// A picture on a surface: what is looked up there for all textures that read it in the same way.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Picture {
    /// Index of the image.
    pub(super) image: usize,
    pub(super) mapping: Mapping,
    pub(super) wraps: [Wrap; 2],
    pub(super) filter: TexelFilter,
    /// The mapping, where it is one of texture coordinates, and texels may be blended bilinearly; then also that to the coarser levels of the
    /// image's MIP map, if the filter takes them.
    uv_map: Option<UvMap>,
    coarser_maps: Vec<UvMap>,
}

impl Picture {
    pub(super) fn new(
        image: usize,
        mapping: Mapping,
        wraps: [Wrap; 2],
        filter: TexelFilter,
        images: &[Image],
    ) -> Self {
        let is_nearest = match filter {
            TexelFilter::Bilinear => false,
            TexelFilter::Nearest => true,
            TexelFilter::Mip { filter, .. } => filter == MipFilter::Nearest,
        };
        let affine = match mapping {
            Mapping::Uv { scale: [s, t], offset } => Some((0, [[s, 0.0, offset[0]], [0.0, t, offset[1]]])),
            Mapping::Affine { set, matrix } => Some((set as usize, matrix)),
            _ => None,
        };
        let (mut uv_map, mut coarser_maps) = (None, Vec::new());
        if let (false, Some((set, matrix)), Some(image)) = (is_nearest, affine, images.get(image)) {
            uv_map = Some(UvMap::new(set, matrix, [image.width, image.height], wraps));
            if filter.takes_levels() {
                coarser_maps =
                    image.sizes_of_levels().map(|size| UvMap::new(set, matrix, size, wraps)).collect();
            }
        }
        Self { image, mapping, wraps, filter, uv_map, coarser_maps }
    }
}

/// Greatest number of pictures that are looked up beforehand; others are looked up when a texture asks for them.
const MOST: usize = 4;

/// No picture.
const NONE: u32 = u32::MAX;

/// The pictures that a material will ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureSet([u32; MOST]);

impl PictureSet {
    /// No pictures.
    pub const EMPTY: Self = Self([NONE; MOST]);

    fn insert(&mut self, picture: u32) {
        let free = self.0.iter_mut().find(|place| **place == NONE || **place == picture);
        if let Some(place) = free {
            *place = picture;
        }
    }
}

/// A number that may vary over a surface, with the pictures that it depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PicturedFloat {
    /// The number.
    pub texture: FloatTexture,
    /// Its pictures.
    pub pictures: PictureSet,
}

/// The colours and opacities of pictures at eight points, by place in the points' sets and by point.
#[derive(Clone, Copy, Debug)]
pub struct LookUps([[[f32; 4]; LANES]; MOST]);

/// Texels that were looked up for one of eight points.
#[derive(Clone, Copy, Debug)]
pub struct LookedUp<'a> {
    pictures: &'a PictureSet,
    look_ups: &'a LookUps,
    lane: usize,
}

impl LookUps {
    /// The texels of a set at a point.
    #[inline]
    pub(crate) fn of<'a>(&'a self, pictures: &'a PictureSet, lane: usize) -> LookedUp<'a> {
        LookedUp { pictures, look_ups: self, lane }
    }
}

impl LookedUp<'_> {
    /// The colour and opacity of a picture, if it was looked up.
    #[inline]
    fn find(&self, picture: u32) -> Option<[f32; 4]> {
        let place = self.pictures.0.iter().position(|looked_up| *looked_up == picture)?;
        Some(self.look_ups.0[place][self.lane])
    }
}

impl Textures {
    /// Looks up the pictures of sets at their points; `None` where all sets are empty.
    #[inline]
    pub(crate) fn look_up_lanes(
        &self,
        sets: &[&PictureSet; LANES],
        points: &[TexturePoint<'_>; LANES],
    ) -> Option<LookUps> {
        if sets.iter().all(|set| **set == PictureSet::EMPTY) {
            return None;
        }
        let mut look_ups = LookUps([[[0.0; 4]; LANES]; MOST]);
        for (place, texels) in look_ups.0.iter_mut().enumerate() {
            if sets.iter().all(|set| set.0[place] == NONE) {
                break;
            }
            self.look_up_place(place, sets, points, texels);
        }
        Some(look_ups)
    }

    /// The pictures at one place of the sets.
    fn look_up_place(
        &self,
        place: usize,
        sets: &[&PictureSet; LANES],
        points: &[TexturePoint<'_>; LANES],
        texels: &mut [[f32; 4]; LANES],
    ) {
        let pictures = by_lane!(lane => self.pictures.get(sets[lane].0[place] as usize));
        // Pictures by texture coordinates are looked up side by side; lanes without one do what another does.
        let mut places = None;
        for (lane, picture) in pictures.iter().enumerate() {
            let Some(Picture { image, wraps, uv_map: Some(map), filter, .. }) = picture else { continue };
            if filter.takes_levels() {
                return self.look_up_levels(&pictures, points, texels);
            }
            let (image, uv) = (&self.images[*image], map.uv(&points[lane]));
            places
                .get_or_insert_with(|| Places::all_at(map, image, *wraps, uv))
                .set(lane, map, image, *wraps, uv);
        }
        if let Some(places) = places {
            *texels = places.look_up();
        }
        self.look_up_others(&pictures, points, texels);
    }

    /// Pictures of which some are blended from levels of MIP maps.
    #[inline(never)]
    fn look_up_levels(
        &self,
        pictures: &[Option<&Picture>; LANES],
        points: &[TexturePoint<'_>; LANES],
        texels: &mut [[f32; 4]; LANES],
    ) {
        let (mut fine, mut coarse) = (None, None);
        let mut levels = [Levels::FINEST; LANES];
        let mut ellipses = 0;
        for (lane, picture) in pictures.iter().enumerate() {
            let Some(Picture { image, mapping, wraps, filter, uv_map: Some(finest), coarser_maps }) = picture
            else {
                continue;
            };
            let (mip_map, uv) = (self.mip_map(*image), finest.uv(&points[lane]));
            if let TexelFilter::Mip { filter, footprint } = *filter {
                match mip_map.levels(steps_of(mapping, footprint, &points[lane]), filter) {
                    Some(blended) => levels[lane] = blended,
                    None => {
                        ellipses |= 1 << lane;
                        continue;
                    }
                }
            }
            let Levels { fine: level, coarse: share } = levels[lane];
            for (places, level) in [(&mut fine, level), (&mut coarse, level + usize::from(share > 0.0))] {
                let map = level.checked_sub(1).map_or(finest, |coarser| &coarser_maps[coarser]);
                let image = mip_map.level(level);
                places
                    .get_or_insert_with(|| Places::all_at(map, image, *wraps, uv))
                    .set(lane, map, image, *wraps, uv);
            }
        }
        if let (Some(fine), Some(coarse)) = (fine, coarse) {
            *texels = fine.look_up();
            if levels.iter().any(|levels| levels.coarse > 0.0) {
                let coarse = coarse.look_up();
                for (lane, levels) in levels.iter().enumerate().filter(|(_, levels)| levels.coarse > 0.0) {
                    texels[lane] = levels.mixed(texels[lane], coarse[lane]);
                }
            }
        }
        for lane in LaneMask(ellipses) {
            if let Some(picture) = pictures[lane] {
                texels[lane] = self.look_up_alone(picture, &points[lane]);
            }
        }
        self.look_up_others(pictures, points, texels);
    }

    /// Pictures that are not looked up side by side.
    #[inline]
    fn look_up_others(
        &self,
        pictures: &[Option<&Picture>; LANES],
        points: &[TexturePoint<'_>; LANES],
        texels: &mut [[f32; 4]; LANES],
    ) {
        for (lane, picture) in pictures.iter().enumerate() {
            if let Some(picture @ Picture { uv_map: None, .. }) = picture {
                texels[lane] = self.look_up_alone(picture, &points[lane]);
            }
        }
    }

    /// The colour and opacity of a picture at a point, by its index.
    #[inline]
    pub(super) fn look_up(&self, picture: u32, at: &TexturePoint<'_>) -> [f32; 4] {
        at.looked_up
            .and_then(|looked_up| looked_up.find(picture))
            .unwrap_or_else(|| self.look_up_alone(&self.pictures[picture as usize], at))
    }

    #[inline]
    fn look_up_alone(&self, picture: &Picture, at: &TexturePoint<'_>) -> [f32; 4] {
        let [s, t] = mapping::coordinates(&picture.mapping, at).as_vec3().truncate().to_array();
        // v runs up, rows run down.
        let (image, st) = (&self.images[picture.image], [s, 1.0 - t]);
        match picture.filter {
            TexelFilter::Mip { filter, footprint } => {
                let steps = steps_of(&picture.mapping, footprint, at);
                self.mip_map(picture.image).look_up(st, steps, filter, picture.wraps)
            }
            TexelFilter::Bilinear | TexelFilter::Nearest => {
                Footprint::new(image, st, picture.wraps, picture.filter).blend(image)
            }
        }
    }

    #[inline]
    fn mip_map(&self, image: usize) -> MipMap<'_> {
        MipMap { image: &self.images[image], coarser: &self.coarser_levels[image] }
    }

    /// A number with its pictures.
    pub fn pictured(&self, texture: FloatTexture) -> PicturedFloat {
        let mut pictures = PictureSet::EMPTY;
        self.add_pictures_of_float(texture, &mut pictures);
        PicturedFloat { texture, pictures }
    }

    /// The numbers at eight points, in the lanes where there are any.
    pub(crate) fn floats(
        &self,
        numbers: &[Option<&PicturedFloat>; LANES],
        points: &[TexturePoint<'_>; LANES],
    ) -> [f32; LANES] {
        let pictures = by_lane!(lane => numbers[lane].map_or(&PictureSet::EMPTY, |number| &number.pictures));
        let look_ups = self.look_up_lanes(&pictures, points);
        by_lane!(lane => numbers[lane].map_or(0.0, |number| {
            let looked_up = look_ups.as_ref().map(|look_ups| look_ups.of(pictures[lane], lane));
            self.float(number.texture, &TexturePoint { looked_up, ..points[lane] })
        }))
    }

    /// Adds the pictures of a colour.
    pub fn add_pictures(&self, color: &SpectrumTexture, pictures: &mut PictureSet) {
        self.add_of_input(&color.input, pictures);
    }

    /// Adds the pictures of a number.
    pub fn add_pictures_of_float(&self, number: FloatTexture, pictures: &mut PictureSet) {
        if let FloatTexture::Texture(id) = number {
            self.add_of_input(&Input::Texture(id), pictures);
        }
    }

    fn add_of_input(&self, input: &Input, pictures: &mut PictureSet) {
        let Input::Texture(id) = input else { return };
        match &self.nodes[id.index()] {
            Node::Image { picture, .. } => pictures.insert(*picture),
            Node::Product { a, b } => {
                self.add_of_input(a, pictures);
                self.add_of_input(b, pictures);
            }
            Node::Scale { color, by } => {
                self.add_of_input(color, pictures);
                self.add_pictures_of_float(*by, pictures);
            }
            Node::Threshold { value, .. } => self.add_pictures_of_float(*value, pictures),
            Node::Quotient { a, b } => {
                self.add_pictures_of_float(*a, pictures);
                self.add_pictures_of_float(*b, pictures);
            }
            // Of others it is not known before which of their inputs they will read.
            _ => {}
        }
    }
}

/// The steps in a picture, right and down, from one pixel of a width to the next; 0 for a point alone.
fn steps_of(mapping: &Mapping, footprint: f32, at: &TexturePoint<'_>) -> [Vec2; 2] {
    let steps = mapping::changes(mapping, at).unwrap_or_default();
    steps.map(|step| footprint * Vec2::new(step.x as f32, -step.y as f32))
}

#[cfg(test)]
mod tests {
    use lookfrom_scene::image::Image;
    use lookfrom_scene::scene::{ImageId, TextureId};
    use lookfrom_scene::settings::ColorMode;
    use lookfrom_scene::texture::{Channel, TextureKind};

    use super::*;
    use crate::core::hash;
    use crate::shading::footprint::SurfaceFootprint;

    #[test]
    fn eight_at_once_are_eight_one_by_one() {
        let bytes = (0..35).map(|k| [k * 7, 255 - k, k, 200 + k]).collect();
        let images = vec![
            Image::from_bytes("", 7, 5, bytes, lookfrom_scene::image::Encoding::Srgb),
            Image::from_linear("", 3, 2, (0..6).map(|k| [k as f32, -1.0, 0.1]).collect()),
        ];
        const MIP: fn(MipFilter) -> TexelFilter = |filter| TexelFilter::Mip { filter, footprint: 0.5 };
        let filters = [
            TexelFilter::Bilinear,
            TexelFilter::Nearest,
            MIP(MipFilter::Nearest),
            MIP(MipFilter::Bilinear),
            MIP(MipFilter::Trilinear),
            MIP(MipFilter::Ewa { anisotropy: 4.0 }),
        ];
        let kinds: Vec<TextureKind> = (0..36)
            .map(|k| TextureKind::Image {
                image: ImageId(k % 2),
                mapping: match k % 3 {
                    0 => Mapping::Uv { scale: [1.0 + (k / 2) as f32; 2], offset: [0.25; 2] },
                    1 => Mapping::Affine { set: k / 18, matrix: [[0.5, 1.0, -0.25], [2.0, -0.5, 0.75]] },
                    _ => Mapping::Spherical { texture_from_world: glam::DMat4::IDENTITY },
                },
                wrap: [[Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Black][k as usize / 2 % 4]; 2],
                filter: filters[k as usize / 3 % 6],
                channel: Channel::Rgb,
                scale: 1.0,
                invert: false,
            })
            .collect();
        let textures = Textures::new(&kinds, images, Vec::new(), ColorMode::Rgb);
        for round in 0..2000 {
            let number = |k: u64| (hash::pair(round, k) >> 40) as f32 / 1_048_576.0 - 8.0;
            let step = |k: u64| 0.1 * number(k) * libm::exp2f(number(k + 1));
            let steps = |k: u64| [Vec2::new(step(k), step(k + 2)), Vec2::new(step(k + 4), step(k + 6))];
            let points: [_; LANES] = std::array::from_fn(|lane| TexturePoint {
                uv: Vec2::new(number(2 * lane as u64), number(2 * lane as u64 + 1)),
                more_uvs: [Vec2::splat(number(100 + lane as u64)); super::super::MORE_UV_SETS],
                world: glam::DVec3::new(0.5, f64::from(number(200 + lane as u64)), 1.0),
                footprint: (lane != 3).then(|| SurfaceFootprint {
                    uv: steps(300 + 20 * lane as u64),
                    p: steps(500 + 20 * lane as u64).map(|step| step.extend(0.1)),
                }),
                ..TexturePoint::NOWHERE
            });
            let first = (round % 36) as u32;
            let sets: [_; LANES] = std::array::from_fn(|lane| {
                let mut set = PictureSet::EMPTY;
                for k in 0..lane as u32 % 4 {
                    textures.add_pictures_of_float(
                        FloatTexture::Texture(TextureId((first + 5 * lane as u32 + 3 * k) % 36)),
                        &mut set,
                    );
                }
                set
            });
            let look_ups = textures.look_up_lanes(&sets.each_ref(), &points).expect("some are not empty");
            for (lane, alone) in points.iter().enumerate() {
                let looked_up = look_ups.of(&sets[lane], lane);
                let point = TexturePoint { looked_up: Some(looked_up), ..*alone };
                let mut found = 0;
                for picture in 0..textures.pictures.len() as u32 {
                    found += usize::from(looked_up.find(picture).is_some());
                    assert_eq!(textures.look_up(picture, &point), textures.look_up(picture, alone));
                }
                assert_eq!(found, lane % 4);
            }
        }
    }
}
