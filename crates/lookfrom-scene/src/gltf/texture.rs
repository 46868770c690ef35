//! Textures: image, sampler, channels and transform (specification, §3.8; `KHR_texture_transform`, `EXT_texture_webp`,
//! `KHR_texture_basisu`).
//!
//! In glTF v runs down from the image's upper edge, here it runs up: meshes have 1 − v, and [`mapping`] converts glTF's
//! transforms of v. Only images that are used are decoded, once as colours and once as data, in parallel.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};

use super::file::Document;
use super::json::{Sampler, Texture as TextureEntry, TextureInfo, Whole};
use super::uri::Uri;
use crate::error::{Error, ErrorKind, Result};
use crate::files::LoadContext;
use crate::image::{self, Encoding, Image};
use crate::material::{Color, Scalar};
use crate::parallel;
use crate::scene::{ImageId, Scene, TextureId};
use crate::texture::{Channel, Mapping, TexelFilter, Texture, TextureKind, Wrap};

/// The maximum number of texels of all images of a file, in units of [`crate::Limits::texels`].
const PICTURES_OF_MOST_TEXELS: u64 = 4;

/// The role of an image: colours or data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Meaning {
    /// sRGB-encoded colours; opacity is linear.
    Color,
    /// Linear values.
    Number,
    /// Linear values, as normals.
    Normal,
}

/// A reference to a texture.
#[derive(Clone, Copy)]
pub(super) struct Use<'a> {
    /// The JSON of the reference.
    pub(super) info: Option<&'a TextureInfo>,
    /// The JSON pointer of the reference.
    pub(super) pointer: &'a str,
}

/// The textures and images that materials have requested so far.
pub(super) struct Textures<'d> {
    document: &'d Document,
    /// By the first image of the file with the same content.
    pictures: BTreeMap<(usize, Meaning), ImageId>,
    /// The first image with the same content as this one.
    firsts: Vec<usize>,
    /// Fallbacks for images that an extension names and that cannot be read.
    instead: BTreeMap<usize, usize>,
}

impl<'d> Textures<'d> {
    pub(super) fn new(document: &'d Document) -> Self {
        let mut known = BTreeMap::new();
        let images = document.root.images.iter().enumerate();
        let firsts = images
            .map(|(index, image)| *known.entry((&image.uri, image.buffer_view)).or_insert(index))
            .collect();
        Self { document, pictures: BTreeMap::new(), firsts, instead: BTreeMap::new() }
    }

    /// A colour: a factor, times a texture where there is one.
    ///
    /// # Errors
    /// If the texture, its sampler or its image is not in the file.
    pub(super) fn color(&mut self, factor: [f32; 3], texture: Use<'_>, scene: &mut Scene) -> Result<Color> {
        let [r, g, b] = factor;
        let is_gray = r == g && g == b;
        let scale = if is_gray { r } else { 1.0 };
        match self.image(texture, Channel::Rgb, Meaning::Color, scale, false, scene)? {
            None => Ok(Color::Value(factor)),
            Some(id) if is_gray => Ok(Color::Texture(id)),
            Some(id) => Ok(self.product(Color::Value(factor), Color::Texture(id), texture.pointer, scene)),
        }
    }

    /// A scalar: a factor, times one channel of a texture where there is one.
    ///
    /// # Errors
    /// As [`Textures::color`].
    pub(super) fn number(
        &mut self,
        factor: f32,
        texture: Use<'_>,
        channel: Channel,
        scene: &mut Scene,
    ) -> Result<Scalar> {
        // Opacity is linear in colour images, too, so an image with both is decoded once.
        let meaning = if channel == Channel::Alpha { Meaning::Color } else { Meaning::Number };
        let found = self.image(texture, channel, meaning, factor, false, scene)?;
        Ok(found.map_or(Scalar::Value(factor), Scalar::Texture))
    }

    /// A texture of an image; `None` where no texture is named.
    ///
    /// # Errors
    /// As [`Textures::color`].
    pub(super) fn image(
        &mut self,
        texture: Use<'_>,
        channel: Channel,
        meaning: Meaning,
        scale: f32,
        invert: bool,
        scene: &mut Scene,
    ) -> Result<Option<TextureId>> {
        let Some(info) = texture.info else { return Ok(None) };
        let root = &self.document.root;
        let pointer = format!("{}/index", texture.pointer);
        let entry = self.document.one_of(&root.textures, info.index, "texture", &pointer)?;
        let place = format!("/textures/{}", info.index.0);
        let sampler = match entry.sampler {
            Some(index) => {
                Some(self.document.one_of(&root.samplers, index, "sampler", &format!("{place}/sampler"))?)
            }
            None => None,
        };
        let Some(source) = source(entry) else { return Ok(None) };
        self.document.one_of(&root.images, source, "image", &format!("{place}/source"))?;
        if let Some(plain) = entry.source.filter(|&plain| plain != source) {
            self.document.one_of(&root.images, plain, "image", &format!("{place}/source"))?;
            self.instead.insert(self.firsts[source.index()], self.firsts[plain.index()]);
        }
        let key = (self.firsts[source.index()], meaning);
        let image = *self.pictures.entry(key).or_insert_with(|| {
            scene.images.push(Image::from_linear("", 1, 1, vec![[1.0; 3]]));
            ImageId(scene.images.len() as u32 - 1)
        });
        let (wrap, filter) = sampling(sampler);
        let mapping = mapping(info);
        let kind = TextureKind::Image { image, mapping, wrap, filter, channel, scale, invert };
        Ok(Some(self.push(kind, texture.pointer, scene)))
    }

    /// The product of two colours.
    pub(super) fn product(&self, a: Color, b: Color, pointer: &str, scene: &mut Scene) -> Color {
        if a == Color::gray(1.0) {
            return b;
        }
        if b == Color::gray(1.0) {
            return a;
        }
        match (a, b) {
            (Color::Value(a), Color::Value(b)) => Color::Value(std::array::from_fn(|i| a[i] * b[i])),
            _ => Color::Texture(self.push(TextureKind::Product { a, b }, pointer, scene)),
        }
    }

    /// Adds a texture.
    pub(super) fn push(&self, kind: TextureKind, pointer: &str, scene: &mut Scene) -> TextureId {
        let at = self.document.at(pointer);
        scene.textures.push(Texture { name: pointer.to_owned(), at, kind });
        TextureId(scene.textures.len() as u32 - 1)
    }

    /// Decodes the requested images. An image that cannot be read is white, with a warning.
    pub(super) fn decode(self, context: &mut LoadContext<'_>, scene: &mut Scene) {
        let Self { document, pictures, instead, .. } = self;
        let (files, limits, budget) = (context.files, context.limits, context.budget.clone());
        let texels = AtomicU64::new(0);
        let read = |((index, meaning), id): ((usize, Meaning), ImageId)| {
            let mut context = LoadContext { limits, ..LoadContext::within(&budget, files) };
            let image =
                picture(document, index, meaning, &texels, &mut context).or_else(|error| {
                    match instead.get(&index) {
                        Some(&plain) => {
                            picture(document, plain, meaning, &texels, &mut context).map_err(|_| error)
                        }
                        None => Err(error),
                    }
                });
            let image = image.unwrap_or_else(|error| {
                let message = format!("the picture cannot be used, white is used instead: {}", error.message);
                context.warn(&error.at, message);
                blank(document, index, meaning)
            });
            (id, image, context.warnings, context.kept)
        };
        let decoded: Vec<_> = parallel::map(pictures.into_iter().collect(), read);
        for (id, image, warnings, kept) in decoded {
            scene.images[id.index()] = image;
            context.kept.extend(kept);
            context.warnings.extend(warnings);
        }
    }
}

/// The image of a texture: the one of an extension if there is one, else the fallback.
fn source(entry: &TextureEntry) -> Option<Whole> {
    let others = [&entry.extensions.basisu, &entry.extensions.webp];
    others.into_iter().flatten().find_map(|other| other.source).or(entry.source)
}

fn sampling(sampler: Option<&Sampler>) -> ([Wrap; 2], TexelFilter) {
    let Some(sampler) = sampler else { return ([Wrap::Repeat; 2], TexelFilter::Bilinear) };
    let wrap = |wrap: Option<Whole>| match wrap.map(|wrap| wrap.0) {
        Some(33071) => Wrap::Clamp,
        Some(33648) => Wrap::Mirror,
        _ => Wrap::Repeat,
    };
    let filter = match sampler.mag_filter.map(|filter| filter.0) {
        Some(9728) => TexelFilter::Nearest,
        _ => TexelFilter::Bilinear,
    };
    ([wrap(sampler.wrap_s), wrap(sampler.wrap_t)], filter)
}

/// The affine map from the coordinates (u, w = 1 − v) of our meshes to (s, 1 − t), where s and t are glTF's.
fn mapping(info: &TextureInfo) -> Mapping {
    let transform = info.extensions.transform.as_ref();
    let set = transform.and_then(|transform| transform.tex_coord).or(info.tex_coord).unwrap_or_default();
    let set = u32::try_from(set.0).unwrap_or(u32::MAX);
    let offset = transform.and_then(|transform| transform.offset).unwrap_or([0.0; 2]);
    let scale = transform.and_then(|transform| transform.scale).unwrap_or([1.0; 2]);
    let rotation = transform.and_then(|transform| transform.rotation).unwrap_or(0.0);
    if set == 0 && offset == [0.0; 2] && scale == [1.0; 2] && rotation == 0.0 {
        return Mapping::UV;
    }
    let (sin, cos) = libm::sincos(rotation);
    // s = cos·a·u + sin·b·v + x and t = −sin·a·u + cos·b·v + y, with v = 1 − w.
    let ([a, b], [x, y]) = (scale, offset);
    let rows = [[cos * a, -sin * b, x + sin * b], [sin * a, cos * b, 1.0 - cos * b - y]];
    let finite = |number: f64| if (number as f32).is_finite() { number as f32 } else { 0.0 };
    Mapping::Affine { set, matrix: rows.map(|row| row.map(finite)) }
}

/// Decodes one image.
fn picture(
    document: &Document,
    index: usize,
    meaning: Meaning,
    texels: &AtomicU64,
    context: &mut LoadContext<'_>,
) -> Result<Image> {
    let entry = &document.root.images[index];
    let pointer = format!("/images/{index}");
    let most = context.limits.texels.saturating_mul(PICTURES_OF_MOST_TEXELS);
    if texels.load(Ordering::Relaxed) > most {
        let message = format!("the pictures of this file have more than {most} texels together");
        return Err(Error::new(ErrorKind::Limit, &document.at(&pointer), message));
    }
    let image = match (&entry.uri, entry.buffer_view) {
        (None, Some(view)) => {
            let view = document.view(view, &format!("{pointer}/bufferView"))?;
            decoded(view.bytes, &pointer, meaning, document, context)?
        }
        (Some(uri), _) => match document.uri(uri, &format!("{pointer}/uri"))? {
            Uri::Data(bytes) => decoded(&bytes, &pointer, meaning, document, context)?,
            Uri::Names(names) => {
                let (path, bytes) = document.first_of(&names, &pointer, |path| context.read(path))?;
                let mut image = decoded(&bytes, &pointer, meaning, document, context)?;
                image.name = path.display().to_string();
                image
            }
        },
        (None, None) => {
            return Err(document.invalid(&pointer, "the image has neither `uri` nor `bufferView`"));
        }
    };
    texels.fetch_add(u64::from(image.width) * u64::from(image.height), Ordering::Relaxed);
    Ok(image)
}

fn decoded(
    bytes: &[u8],
    pointer: &str,
    meaning: Meaning,
    document: &Document,
    context: &mut LoadContext<'_>,
) -> Result<Image> {
    let encoding = if meaning == Meaning::Color { Encoding::Srgb } else { Encoding::Linear };
    image::decode(bytes, &document.at(pointer).to_string(), encoding, context)
}

/// The placeholder of an image that cannot be used.
fn blank(document: &Document, index: usize, meaning: Meaning) -> Image {
    let name = document.at(&format!("/images/{index}")).to_string();
    let texel = if meaning == Meaning::Normal { [0.5, 0.5, 1.0] } else { [1.0; 3] };
    Image::from_linear(name, 1, 1, vec![texel])
}
