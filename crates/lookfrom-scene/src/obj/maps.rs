//! Images and textures of MTL maps.
//!
//! Colours are sRGB-encoded; opacities, roughness, heights and normals are linear. A map with `-mm` changes the texels of a
//! colour, and the value of a number.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::mtl::Map;
use crate::files::LoadContext;
use crate::image::{Encoding, Image};
use crate::material::{BumpMapping, Color, NormalTexture, Scalar};
use crate::model::surface::{add_texture, beside, picture, push_image, push_texture, read_image};
use crate::scene::{ImageId, Scene};
use crate::texture::{Channel, TextureKind, Wrap};

/// The height of white over black in a bump map with `-bm 1`, relative to the side of the picture on the surface. The format
/// gives no unit; so slopes do not depend on the unit of the model.
const RELIEF: f32 = 0.01;

/// The images read so far.
#[derive(Default)]
pub(super) struct Images {
    /// By file and use, so that each is read once; `None` if it cannot be read.
    known: HashMap<(PathBuf, Use), Option<ImageId>>,
    /// Their total number of texels.
    texels: u64,
}

/// The use that an image is read for.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Use {
    /// A colour: the bits of the range and of the tint that are applied to the texels.
    Color([u32; 2], [u32; 3]),
    /// Numbers.
    Data,
}

/// Access to the maps of one library.
pub(super) struct Maps<'a, 'f> {
    pub(super) images: &'a mut Images,
    /// The path of the library.
    pub(super) library: &'a Path,
    pub(super) context: &'a mut LoadContext<'f>,
    pub(super) scene: &'a mut Scene,
}

impl Maps<'_, '_> {
    /// The texture of a map with its texels multiplied by `tint`; `None`, with a warning, if it cannot be read.
    pub(super) fn color(&mut self, map: &Map, tint: [f32; 3]) -> Option<Color> {
        let image = self.image(map, Use::Color(map.range.map(f32::to_bits), tint.map(f32::to_bits)))?;
        let wrap = if map.clamp { Wrap::Black } else { Wrap::Repeat };
        let kind = picture(image, map.scale, map.offset, wrap);
        Some(push_texture(self.scene, &map.file, &map.at, kind))
    }

    /// A number: its channel is that of `-imfchan`, or the luminance.
    pub(super) fn number(&mut self, map: &Map) -> Option<Scalar> {
        let image = self.image(map, Use::Data)?;
        Some(self.channel(map, image, map.channel.unwrap_or_default(), 1.0, Wrap::Clamp))
    }

    /// The mean of a number, which is used where a material has only one for the whole surface.
    pub(super) fn mean(&mut self, map: &Map) -> Option<f32> {
        let image = self.image(map, Use::Data)?;
        let [r, g, b] = self.scene.images[image.index()].mean();
        let mean = match map.channel {
            Some(Channel::Red) => r,
            Some(Channel::Green) => g,
            Some(Channel::Blue) => b,
            _ => (r + g + b) / 3.0,
        };
        Some(map.range[0] + map.range[1] * mean)
    }

    /// An opacity: `-imfchan`, or the alpha channel if there is one, or the luminance. `colors` is the map of the colour: a
    /// picture without an alpha channel that is both is no opacity.
    pub(super) fn opacity(&mut self, map: &Map, colors: Option<&Map>) -> Option<Scalar> {
        let image = self.image(map, Use::Data)?;
        let has_alpha = self.scene.images[image.index()].has_alpha();
        let channel = map.channel.unwrap_or(if has_alpha { Channel::Alpha } else { Channel::Rgb });
        if map.channel.is_none() && !has_alpha && colors.is_some_and(|colors| colors.file == map.file) {
            let message = format!(
                "`map_d` names the picture of the colour, `{}`, which has no alpha channel: the material is opaque",
                map.file
            );
            self.context.notice(&map.at, message);
            return None;
        }
        Some(self.channel(map, image, channel, 1.0, Wrap::Black))
    }

    /// The normals of a normal map.
    pub(super) fn normals(&mut self, map: &Map) -> Option<BumpMapping> {
        let image = self.image(map, Use::Data)?;
        Some(self.normal_texture(map, image))
    }

    /// The heights of a bump map on a mesh on which a unit of texture coordinates has this length; its normals if it is a
    /// normal map, as exporters often write.
    pub(super) fn heights(&mut self, map: &Map, unit_of_uv: f32) -> Option<BumpMapping> {
        let image = self.image(map, Use::Data)?;
        if map.channel.is_none() && is_normal_map(&self.scene.images[image.index()]) {
            let file = &map.file;
            let message = format!("the bump map `{file}` has the colours of a normal map and is used as one");
            self.context.notice(&map.at, format!("{message}: the keyword of normal maps is `norm`"));
            return Some(self.normal_texture(map, image));
        }
        let repeats = (map.scale[0] * map.scale[1]).abs().sqrt();
        let side = if repeats > 0.0 { unit_of_uv / repeats } else { unit_of_uv };
        let height = RELIEF * map.strength * side;
        let channel = map.channel.unwrap_or_default();
        Some(BumpMapping::Bump(self.channel(map, image, channel, height, Wrap::Clamp)))
    }

    fn normal_texture(&mut self, map: &Map, image: ImageId) -> BumpMapping {
        let wrap = if map.clamp { Wrap::Clamp } else { Wrap::Repeat };
        let kind = picture(image, map.scale, map.offset, wrap);
        let texture = add_texture(self.scene, &map.file, &map.at, kind);
        BumpMapping::NormalTexture(NormalTexture { texture, scale: map.strength })
    }

    /// A channel of an image in the range of its map, times `factor`; `outside` is the wrap mode of a clamped map.
    fn channel(&mut self, map: &Map, image: ImageId, channel: Channel, factor: f32, outside: Wrap) -> Scalar {
        let wrap = if map.clamp { outside } else { Wrap::Repeat };
        let mut kind = picture(image, map.scale, map.offset, wrap);
        if let TextureKind::Image { channel: read, scale, .. } = &mut kind {
            (*read, *scale) = (channel, factor);
        }
        let amount = Scalar::Texture(add_texture(self.scene, &map.file, &map.at, kind));
        if map.range == Map::WHOLE_RANGE {
            return amount;
        }
        // `amount` has the factor already: base · factor + gain · amount.
        let [base, gain] = map.range;
        let (low, high) = (Color::gray(factor * base), Color::gray(factor * base + gain));
        let kind = TextureKind::Mix { low, high, amount };
        Scalar::Texture(add_texture(self.scene, &map.file, &map.at, kind))
    }

    fn image(&mut self, map: &Map, purpose: Use) -> Option<ImageId> {
        let key = (beside(self.library, &map.file), purpose);
        if let Some(known) = self.images.known.get(&key) {
            return *known;
        }
        let image = match self.read(&map.file, purpose) {
            Ok(image) => Some(push_image(self.scene, image)),
            Err(why) => {
                let instead = match purpose {
                    Use::Color(..) => "the constant colour is used",
                    Use::Data => "it is left out",
                };
                self.context.warn(&map.at, format!("texture `{}`: {why}; {instead}", map.file));
                None
            }
        };
        self.images.known.insert(key, image);
        image
    }

    /// Reads an image. One image with many tints must not exhaust the memory: all images together have at most as many texels
    /// as one image may have.
    fn read(&mut self, name: &str, purpose: Use) -> Result<Image, String> {
        let limit = self.context.limits.texels;
        let left = limit.saturating_sub(self.images.texels);
        let too_many = || format!("the pictures of this model have more than {limit} texels");
        if left == 0 {
            return Err(too_many());
        }
        let encoding = if purpose == Use::Data { Encoding::Linear } else { Encoding::Srgb };
        let image = read_image(self.library, name, encoding, self.context).map_err(|error| error.message)?;
        if image.len() as u64 > left {
            return Err(too_many());
        }
        self.images.texels += image.len() as u64;
        let Use::Color(range, tint) = purpose else { return Ok(image) };
        let ([base, gain], tint) = (range.map(f32::from_bits), tint.map(f32::from_bits));
        if [base, gain] == Map::WHOLE_RANGE && tint == [1.0; 3] {
            return Ok(image);
        }
        Ok(image.with_colors(|texel| {
            std::array::from_fn(|c| match [base, gain] {
                Map::WHOLE_RANGE => texel[c] * tint[c],
                _ => (base + gain * texel[c]).max(0.0) * tint[c],
            })
        }))
    }
}

/// Whether an image has the colours of a map of normals that mostly look outward: bluish, with a mean near (½, ½, 1).
fn is_normal_map(image: &Image) -> bool {
    let [r, g, b] = image.mean();
    (r - 0.5).abs() < 0.1 && (g - 0.5).abs() < 0.1 && b > 0.75
}
