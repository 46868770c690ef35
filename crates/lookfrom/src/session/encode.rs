//! Picture formats and their encoding.

use std::borrow::Cow;
use std::io::{Cursor, Seek, Write};
use std::ops::Range;
use std::path::Path;

use lookfrom_scene::image::compare::CHANNELS_ATTRIBUTE;
use lookfrom_scene::image::{
    AnimationFormat, ExrChannel, ExrHeader, Metadata, Pixels, encode_hdr, encode_pfm, encode_ppm, write_exr,
    write_jpeg, write_png, write_webp,
};
use lookfrom_scene::settings::Background;
use lookfrom_scene::{Error, ErrorKind, Location, Remedy, Result};

use super::layers::Layers;
use super::options::unsuitable;
use super::{Developed, Development, Finished, Shown, header, spectral};
use crate::film::{Film, Picture, composited};
use crate::post::develop::{srgb8_before, srgb16_before, srgba8, srgba16};

/// A picture format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// 8-bit sRGB after exposure and tone map, with alpha where the background is transparent.
    Png,
    /// A PNG of 16 bits.
    Png16,
    /// 8-bit sRGB after exposure and tone map, with losses: of a quality of 1 to 100.
    Jpeg(u8),
    /// 8-bit sRGB after exposure and tone map, without losses, with alpha where the background is transparent.
    WebP,
    /// Linear light in 32-bit floats, with AOVs, alpha and a header with the settings.
    Exr,
    /// An EXR whose colours, alpha and normals are 16-bit floats: half the bytes. Other layers have 32 bits.
    Exr16,
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

    /// The format with as many bits of a channel.
    ///
    /// # Errors
    /// `Request` where it has none of so many.
    pub fn with_bits(self, bits: u8) -> Result<Self> {
        match (self, bits) {
            (Self::Png | Self::Png16, 16) => Ok(Self::Png16),
            (Self::Exr | Self::Exr16, 16) => Ok(Self::Exr16),
            (Self::Png16, 8) => Ok(Self::Png),
            (Self::Exr | Self::Exr16, 32) => Ok(Self::Exr),
            (Self::Pfm, 32) => Ok(self),
            (other, 8) if other.is_for_screens() => Ok(other),
            _ => Err(unsuitable(format!(
                "{} pictures have no channels of {bits} bits; those of PNGs have 8 or 16, of EXRs 16 or 32, of PFMs 32, of \
                 others 8",
                self.name()
            ))),
        }
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
        !matches!(self, Self::Exr | Self::Exr16 | Self::Hdr | Self::Pfm)
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
        Err(unsuitable(message).hint(Remedy::OpaqueBackground))
    }

    /// The name of the format, as people write it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Png | Self::Png16 => "PNG",
            Self::Jpeg(_) => "JPEG",
            Self::WebP => "WebP",
            Self::Exr | Self::Exr16 => "OpenEXR",
            Self::Hdr => "Radiance",
            Self::Pfm => "PFM",
            Self::Ppm => "PPM",
            Self::Gif => "GIF",
            Self::Apng => "APNG",
        }
    }

    /// Whether the format can hold AOVs.
    pub fn has_layers(self) -> bool {
        matches!(self, Self::Exr | Self::Exr16)
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
    /// The bytes of a file of the picture. Its layers and the header are for formats that can hold them.
    ///
    /// # Errors
    /// `Invalid`, `Limit` or `Request` where the format cannot hold the picture.
    pub fn encode(&self, format: Format) -> Result<Vec<u8>> {
        bytes(|out| self.write(None, format, out))
    }

    /// Writes a file of the picture; with the AOVs of its `film`, for formats that can hold them, if it is given.
    ///
    /// # Errors
    /// As [`Developed::encode`], and `Io` where `out` fails.
    pub fn write(&self, film: Option<&Film>, format: Format, out: &mut (impl Write + Seek)) -> Result<()> {
        write(format, &self.picture, &self.layers_with(film), &self.development, &self.header, out)
    }

    /// The further channels that an EXR of the picture has, with the number of each pixel: AOVs, layers of light-path expressions, buckets
    /// of a spectral film and the light before denoising, of its film.
    pub fn channels(&self, film: &Film) -> Vec<(String, Vec<f32>)> {
        let layers = self.layers_with(Some(film));
        let (width, height) = (self.picture.width, self.picture.height);
        let numbers = || vec![0.0; width as usize * height as usize];
        let mut channels: Vec<_> = layers.names().into_iter().map(|name| (name, numbers())).collect();
        for row in 0..height {
            layers.row(row, width, &mut |channel, x, number| {
                channels[channel].1[row as usize * width as usize + x as usize] = number;
            });
        }
        channels
    }

    /// Its own further channels, or those of its film.
    pub(super) fn layers_with<'a>(&'a self, film: Option<&'a Film>) -> Layers<'a> {
        match film {
            None => Layers::Given(&self.layers),
            Some(film) => Layers::OfFilm {
                film,
                light_paths: header::light_paths(&self.header).collect(),
                cryptomattes: &self.cryptomattes,
                buckets: spectral::channels(&self.header),
                noisy: self.denoised.then_some(self.development.background),
            },
        }
    }
}

impl Finished {
    /// The bytes of a file of the picture. AOVs and the header are for formats that can hold them.
    ///
    /// # Errors
    /// As [`Developed::encode`].
    pub fn encode(&self, format: Format) -> Result<Vec<u8>> {
        bytes(|out| self.write(format, out))
    }

    /// Writes a file of the picture, as [`Finished::encode`] makes it.
    ///
    /// # Errors
    /// As [`Developed::write`].
    pub fn write(&self, format: Format, out: &mut (impl Write + Seek)) -> Result<()> {
        self.developed.write(Some(&self.rendered.film).filter(|_| self.has_layers), format, out)
    }
}

/// The bytes that are written, in memory.
pub(super) fn bytes(write: impl FnOnce(&mut Cursor<Vec<u8>>) -> Result<()>) -> Result<Vec<u8>> {
    let mut out = Cursor::new(Vec::new());
    write(&mut out)?;
    Ok(out.into_inner())
}

pub(super) fn write(
    format: Format,
    picture: &Picture,
    layers: &Layers<'_>,
    development: &Development,
    header: &[(String, String)],
    out: &mut (impl Write + Seek),
) -> Result<()> {
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
            write_png(size, Pixels::Rgba8(&srgba8(picture, exposure, tonemap)), Some(&metadata()), out)
        }
        Format::Png => write_png(size, Pixels::Rgb8(&developed()), Some(&metadata()), out),
        Format::Png16 if is_transparent => {
            write_png(size, Pixels::Rgba16(&srgba16(picture, exposure, tonemap)), Some(&metadata()), out)
        }
        Format::Png16 => {
            let developed = srgb16_before(picture, background, exposure, tonemap);
            write_png(size, Pixels::Rgb16(&developed), Some(&metadata()), out)
        }
        Format::Jpeg(quality) => write_jpeg(size, &developed(), quality, Some(&metadata()), out),
        Format::WebP if is_transparent => {
            write_webp(size, Pixels::Rgba8(&srgba8(picture, exposure, tonemap)), Some(&metadata()), out)
        }
        Format::WebP => write_webp(size, Pixels::Rgb8(&developed()), Some(&metadata()), out),
        Format::Ppm => put(&encode_ppm(width, height, &developed())?, out),
        Format::Hdr => put(&encode_hdr(width, height, &linear())?, out),
        Format::Pfm => put(&encode_pfm(width, height, &linear())?, out),
        Format::Gif | Format::Apng => put(&Shown::new(picture, development).encode(format)?, out),
        Format::Exr | Format::Exr16 => {
            let rows = Rows { light: Light::Picture(picture), layers, background: development.background };
            let kind = |name: &str| match format == Format::Exr16 && rows.is_shade(name) {
                true => ExrChannel::Half,
                false => ExrChannel::Float,
            };
            let channels = rows.channels().into_iter().map(|name| (kind(&name), name));
            let channels = channels.map(|(kind, name)| (name, kind)).collect();
            let mut attributes = header.to_vec();
            attributes.extend(layers.attributes());
            // What the header of a file says of it may be wrong.
            let is_part = |[columns, rows]: &[Range<u32>; 2]| {
                !columns.is_empty() && !rows.is_empty() && columns.end <= width && rows.end <= height
            };
            let crop = header::crop(header).filter(is_part);
            let header = ExrHeader { width, height, crop, channels, attributes, ..ExrHeader::default() };
            write_exr(&header, &mut |row: u32, bytes: &mut [u8]| rows.fill(row, bytes), out)
        }
    }
}

/// Writes bytes that are in memory.
fn put(bytes: &[u8], out: &mut impl Write) -> Result<()> {
    out.write_all(bytes).map_err(|error| Error::new(ErrorKind::Io, &Location::default(), error.to_string()))
}

/// The light of a picture.
pub(super) enum Light<'a> {
    Picture(&'a Picture),
    /// As it was computed.
    Film(&'a Film),
}

impl Light<'_> {
    fn width(&self) -> u32 {
        match self {
            Self::Picture(picture) => picture.width,
            Self::Film(film) => film.width(),
        }
    }

    /// Light and, if there is one, alpha of a pixel.
    fn at(&self, x: u32, y: u32) -> ([f32; 3], Option<f32>) {
        match self {
            Self::Picture(Picture { width, pixels, alpha, .. }) => {
                let index = y as usize * *width as usize + x as usize;
                (pixels[index], alpha.get(index).copied())
            }
            Self::Film(film) => (film.mean(x, y), film.alpha(x, y)),
        }
    }
}

/// The rows of a picture in an EXR: red, green and blue, alpha before a transparent background, and layers.
pub(super) struct Rows<'a> {
    pub(super) light: Light<'a>,
    pub(super) layers: &'a Layers<'a>,
    pub(super) background: Background,
}

impl Rows<'_> {
    /// The names of the channels.
    pub(super) fn channels(&self) -> Vec<String> {
        let alpha = (self.background == Background::Transparent).then_some("A");
        let light = ["R", "G", "B"].into_iter().chain(alpha).map(str::to_owned);
        light.chain(self.layers.names()).collect()
    }

    /// Whether a channel is of a colour, of alpha or of a normal.
    fn is_shade(&self, name: &str) -> bool {
        matches!(name, "R" | "G" | "B" | "A") || self.layers.is_shade(name)
    }

    /// Writes the numbers of a row in little endian: `width` of the first channel, `width` of the second …
    pub(super) fn fill(&self, row: u32, bytes: &mut [u8]) {
        let width = self.light.width();
        let mut put = |channel: usize, x: u32, number: f32| {
            let place = channel * width as usize + x as usize;
            bytes[place * 4..][..4].copy_from_slice(&number.to_le_bytes());
        };
        let background = behind(self.background);
        let is_transparent = self.background == Background::Transparent;
        for x in 0..width {
            let (light, alpha) = self.light.at(x, row);
            let light = alpha.map_or(light, |alpha| composited(light, alpha, background));
            (0..3).for_each(|channel| put(channel, x, light[channel]));
            if is_transparent {
                put(3, x, alpha.map_or(1.0, |alpha| alpha.clamp(0.0, 1.0)));
            }
        }
        let first = if is_transparent { 4 } else { 3 };
        self.layers.row(row, width, &mut |channel, x, number| put(first + channel, x, number));
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
        .filter(|(name, _)| !spectral::is_of_layout(name) && header::light_path_of(name).is_none())
        .map(|(name, text)| format!("{name}: {text}"))
        .collect();
    lines.push(format!("exposure: {}", development.exposure));
    lines.push(format!("tonemap: {}", development.tonemap.word()));
    Metadata::new(concat!("lookfrom ", env!("CARGO_PKG_VERSION")), &lines.join("\n"))
}
