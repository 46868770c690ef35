//! Picture formats and their encoding.

use std::borrow::Cow;
use std::path::Path;

use lookfrom_scene::Result;
use lookfrom_scene::image::compare::CHANNELS_ATTRIBUTE;
use lookfrom_scene::image::{
    AnimationFormat, Metadata, Pixels, encode_exr, encode_hdr, encode_jpeg, encode_pfm, encode_png_of,
    encode_ppm, encode_webp,
};
use lookfrom_scene::settings::Background;

use super::options::unsuitable;
use super::{Developed, Development, Shown};
use crate::film::Picture;
use crate::post::develop::{srgb8_before, srgb16_before, srgba8, srgba16};

/// A picture format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// 8-bit sRGB after exposure and tone map, with alpha where the background is transparent.
    Png,
    /// The same in 16 bits.
    Png16,
    /// 8-bit sRGB after exposure and tone map, with losses: of a quality of 1 to 100.
    Jpeg(u8),
    /// 8-bit sRGB after exposure and tone map, without losses, with alpha where the background is transparent.
    WebP,
    /// Linear light in 32-bit floats, with AOVs, alpha and a header with the settings.
    Exr,
    /// Linear light in Radiance's shared exponents.
    Hdr,
    /// Linear light in 32-bit floats.
    Pfm,
    /// 8-bit sRGB after exposure and tone map.
    Ppm,
    /// 256 colours of sRGB after exposure and tone map: an animation, or a picture.
    Gif,
    /// A PNG that is an animation.
    Apng,
}

impl Format {
    /// All formats, by their file extensions.
    pub const EXTENSIONS: &'static [(&'static str, Self)] = &[
        ("png", Self::Png),
        ("jpg", Self::Jpeg(Self::JPEG_QUALITY)),
        ("jpeg", Self::Jpeg(Self::JPEG_QUALITY)),
        ("webp", Self::WebP),
        ("exr", Self::Exr),
        ("hdr", Self::Hdr),
        ("pfm", Self::Pfm),
        ("ppm", Self::Ppm),
        ("gif", Self::Gif),
        ("apng", Self::Apng),
    ];

    /// The quality of JPEGs where nothing else is asked for: hard to tell from the picture, and a tenth of its bytes.
    pub const JPEG_QUALITY: u8 = 90;

    /// The format of a file's extension, case-insensitive.
    pub fn of_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_string_lossy().to_lowercase();
        Self::EXTENSIONS.iter().find(|(known, _)| *known == extension).map(|&(_, format)| format)
    }

    /// The extension of its files.
    pub fn extension(self) -> &'static str {
        let of_extension = |format: Self| std::mem::discriminant(&format) == std::mem::discriminant(&self);
        let found = Self::EXTENSIONS.iter().find(|&&(_, format)| of_extension(format));
        found.map_or("png", |&(extension, _)| extension)
    }

    /// The animation of this format.
    ///
    /// # Errors
    /// `Request` for one without animations.
    pub fn animation(self) -> Result<AnimationFormat> {
        match self {
            Self::Gif => Ok(AnimationFormat::Gif),
            Self::Apng => Ok(AnimationFormat::Apng),
            Self::WebP => Ok(AnimationFormat::WebP),
            _ => Err(unsuitable("animations are GIF, APNG or WebP".to_owned())),
        }
    }

    /// Whether the format holds colours of a screen, not linear light.
    pub fn is_for_screens(self) -> bool {
        !matches!(self, Self::Exr | Self::Hdr | Self::Pfm)
    }

    /// Whether the format can hold a transparent background.
    pub fn has_alpha(self) -> bool {
        !matches!(self, Self::Jpeg(_) | Self::Ppm | Self::Hdr | Self::Pfm)
    }

    /// Refuses a transparent background where the format cannot hold it.
    ///
    /// # Errors
    /// `Request` for a transparent background in a format without alpha.
    pub fn check_background(self, background: Background) -> Result<()> {
        if background != Background::Transparent || self.has_alpha() {
            return Ok(());
        }
        let message = format!("the background is transparent, and {} pictures have no alpha", self.name());
        Err(unsuitable(message).hint(
            "a .png, .webp or .exr holds transparency; --background white, or any other colour, is for all formats",
        ))
    }

    /// The name of the format, as people write it.
    fn name(self) -> &'static str {
        match self {
            Self::Png | Self::Png16 => "PNG",
            Self::Jpeg(_) => "JPEG",
            Self::WebP => "WebP",
            Self::Exr => "OpenEXR",
            Self::Hdr => "Radiance",
            Self::Pfm => "PFM",
            Self::Ppm => "PPM",
            Self::Gif => "GIF",
            Self::Apng => "APNG",
        }
    }

    /// Whether the format can hold AOVs.
    pub fn has_layers(self) -> bool {
        self == Self::Exr
    }
}

/// The background colour of a picture with alpha in a format that cannot hold alpha: its own, or black.
pub(super) fn behind(background: Background) -> [f32; 3] {
    match background {
        Background::Color(color) => color,
        Background::Transparent | Background::Environment => [0.0; 3],
    }
}

impl Developed {
    /// The bytes of a file of the picture. AOVs and the header are for formats that can hold them.
    ///
    /// # Errors
    /// `Invalid`, `Limit` or `Request` where the format cannot hold the picture.
    pub fn encode(&self, format: Format) -> Result<Vec<u8>> {
        encode(format, &self.picture, &self.layers, &self.development, &self.header)
    }
}

pub(super) fn encode(
    format: Format,
    picture: &Picture,
    layers: &[(String, Vec<f32>)],
    development: &Development,
    header: &[(String, String)],
) -> Result<Vec<u8>> {
    let (width, height) = (picture.width, picture.height);
    let &Development { exposure, tonemap, background, .. } = development;
    format.check_background(background)?;
    let is_transparent = background == Background::Transparent;
    let background = behind(background);
    let developed = || srgb8_before(picture, background, exposure, tonemap);
    let linear = || before(picture, background);
    let size = [width, height];
    let metadata = || metadata(header, development);
    match format {
        Format::Png if is_transparent => {
            encode_png_of(size, Pixels::Rgba8(&srgba8(picture, exposure, tonemap)), Some(&metadata()))
        }
        Format::Png => encode_png_of(size, Pixels::Rgb8(&developed()), Some(&metadata())),
        Format::Png16 if is_transparent => {
            encode_png_of(size, Pixels::Rgba16(&srgba16(picture, exposure, tonemap)), Some(&metadata()))
        }
        Format::Png16 => {
            let developed = srgb16_before(picture, background, exposure, tonemap);
            encode_png_of(size, Pixels::Rgb16(&developed), Some(&metadata()))
        }
        Format::Jpeg(quality) => encode_jpeg(size, &developed(), quality, Some(&metadata())),
        Format::WebP if is_transparent => {
            encode_webp(size, Pixels::Rgba8(&srgba8(picture, exposure, tonemap)), Some(&metadata()))
        }
        Format::WebP => encode_webp(size, Pixels::Rgb8(&developed()), Some(&metadata())),
        Format::Ppm => encode_ppm(width, height, &developed()),
        Format::Hdr => encode_hdr(width, height, &linear()),
        Format::Pfm => encode_pfm(width, height, &linear()),
        Format::Gif | Format::Apng => Shown::new(picture, development).encode(format),
        Format::Exr => {
            let channels = channels(picture, layers, development.background);
            let channels: Vec<_> =
                channels.iter().map(|(name, values)| (name.clone(), values.as_ref())).collect();
            encode_exr(width, height, &channels, header)
        }
    }
}

/// The light of a picture before a background; its own where it has no alpha.
fn before(picture: &Picture, background: [f32; 3]) -> Cow<'_, [[f32; 3]]> {
    match picture.alpha.is_empty() {
        true => Cow::Borrowed(&picture.pixels),
        false => Cow::Owned(picture.clone().before(background).pixels),
    }
}

/// The metadata of a picture for display: the texts of an EXR's header, and its development.
fn metadata(header: &[(String, String)], development: &Development) -> Metadata {
    let mut lines: Vec<String> = header
        .iter()
        .filter(|(name, _)| !["software", "exposure", "tonemap", CHANNELS_ATTRIBUTE].contains(&name.as_str()))
        .map(|(name, text)| format!("{name}: {text}"))
        .collect();
    lines.push(format!("exposure: {}", development.exposure));
    lines.push(format!("tonemap: {}", development.tonemap.word()));
    Metadata::new(concat!("lookfrom ", env!("CARGO_PKG_VERSION")), &lines.join("\n"))
}

/// The channels of a picture in an EXR: red, green and blue, alpha before a transparent background, and layers.
pub(super) fn channels<'a>(
    picture: &Picture,
    layers: &'a [(String, Vec<f32>)],
    background: Background,
) -> Vec<(String, Cow<'a, [f32]>)> {
    let pixels = before(picture, behind(background));
    let mut channels: Vec<(String, Cow<'a, [f32]>)> = ["R", "G", "B"]
        .iter()
        .enumerate()
        .map(|(index, name)| ((*name).to_owned(), pixels.iter().map(|pixel| pixel[index]).collect()))
        .collect();
    if background == Background::Transparent {
        let alpha = picture.alpha.iter().map(|alpha| alpha.clamp(0.0, 1.0));
        channels.push(("A".to_owned(), alpha.collect()));
    }
    channels.extend(layers.iter().map(|(name, values)| (name.clone(), Cow::Borrowed(values.as_slice()))));
    channels
}
