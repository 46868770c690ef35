//! Picture formats and their encoding.

use std::path::Path;

use lookfrom_scene::Result;
use lookfrom_scene::image::{
    encode_exr, encode_hdr, encode_pfm, encode_png, encode_png_with_alpha, encode_ppm,
};
use lookfrom_scene::settings::{Background, ImageSettings};

use super::Finished;
use crate::film::Picture;
use crate::post::develop::{srgb8_before, srgba8};

/// A picture format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// 8-bit sRGB after exposure and tone map, with alpha where the background is transparent.
    Png,
    /// Linear light in 32-bit floats, with AOVs, alpha and a header with the settings.
    Exr,
    /// Linear light in Radiance's shared exponents.
    Hdr,
    /// Linear light in 32-bit floats.
    Pfm,
    /// 8-bit sRGB after exposure and tone map.
    Ppm,
}

impl Format {
    /// All formats, by their file extensions.
    pub const EXTENSIONS: &'static [(&'static str, Self)] =
        &[("png", Self::Png), ("exr", Self::Exr), ("hdr", Self::Hdr), ("pfm", Self::Pfm), ("ppm", Self::Ppm)];

    /// The format of a file's extension, case-insensitive.
    pub fn of_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_string_lossy().to_lowercase();
        Self::EXTENSIONS.iter().find(|(known, _)| *known == extension).map(|&(_, format)| format)
    }

    /// Whether the format can hold AOVs.
    pub fn has_layers(self) -> bool {
        self == Self::Exr
    }
}

/// The background colour of a picture with alpha in a format that cannot hold alpha: its own, or black.
pub(super) fn behind(image: &ImageSettings) -> [f32; 3] {
    match image.background {
        Background::Color(color) => color,
        Background::Transparent | Background::Environment => [0.0; 3],
    }
}

impl Finished {
    /// The bytes of a file of the picture. AOVs and the header are for formats that can hold them.
    ///
    /// # Errors
    /// `Invalid` or `Limit` where the format cannot hold the picture.
    pub fn encode(&self, format: Format) -> Result<Vec<u8>> {
        encode(format, &self.picture, &self.layers, &self.image, &self.header)
    }
}

pub(super) fn encode(
    format: Format,
    picture: &Picture,
    layers: &[(String, Vec<f32>)],
    image: &ImageSettings,
    header: &[(String, String)],
) -> Result<Vec<u8>> {
    let (width, height) = (picture.width, picture.height);
    let is_transparent = image.background == Background::Transparent;
    let background = behind(image);
    let developed = || srgb8_before(picture, background, image.exposure, image.tonemap);
    let linear = || picture.clone().before(background).pixels;
    match format {
        Format::Png if is_transparent => {
            encode_png_with_alpha(width, height, &srgba8(picture, image.exposure, image.tonemap))
        }
        Format::Png => encode_png(width, height, &developed()),
        Format::Ppm => encode_ppm(width, height, &developed()),
        Format::Hdr => encode_hdr(width, height, &linear()),
        Format::Pfm => encode_pfm(width, height, &linear()),
        Format::Exr => {
            let pixels = linear();
            let channel = |index: usize| pixels.iter().map(|pixel| pixel[index]).collect::<Vec<f32>>();
            let [r, g, b] = [channel(0), channel(1), channel(2)];
            let channels = [("R", &r), ("G", &g), ("B", &b)];
            let channels = channels.map(|(name, values)| (name.to_owned(), values.as_slice()));
            let alpha: Vec<f32> = picture.alpha.iter().map(|alpha| alpha.clamp(0.0, 1.0)).collect();
            let alpha = is_transparent.then(|| ("A".to_owned(), alpha.as_slice()));
            let layers = layers.iter().map(|(name, values)| (name.clone(), values.as_slice()));
            let channels: Vec<_> = channels.into_iter().chain(alpha).chain(layers).collect();
            encode_exr(width, height, &channels, header)
        }
    }
}
