//! Pictures: copies of their files where these are read to the same values, else new files that are.

use super::Writer;
use super::text::{Fields, Item};
use crate::error::Result;
use crate::image::{self, Encoding, Image, Pixels, encode_exr, encode_png_of};
use crate::scene::ImageId;
use crate::texture::Channel;

/// The use of a picture, by which its integers are decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum For {
    /// A texture, which names its encoding.
    Texture,
    /// The opacity of a picture, as a texture.
    Opacity,
    /// A light or an aperture: sRGB.
    Light,
    /// Normals: linear numbers.
    Normals,
}

/// A picture in the document.
#[derive(Clone, Debug)]
pub(super) struct Picture {
    pub(super) file: String,
    /// The encoding of a texture, if it is not sRGB.
    pub(super) encoding: Option<Item>,
    /// The channel, of an opacity that has become a picture of its own.
    pub(super) channel: Option<Channel>,
}

/// An encoding of integers, as a document names it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Named {
    Srgb,
    Linear,
    Gamma(f32),
}

impl Writer<'_> {
    pub(super) fn picture(&mut self, id: ImageId, purpose: For) -> Result<Picture> {
        if let Some(picture) = self.pictures.get(&(id, purpose)) {
            return Ok(picture.clone());
        }
        let picture = self.picture_of(&self.scene.images[id.index()], purpose)?;
        self.pictures.insert((id, purpose), picture.clone());
        Ok(picture)
    }

    /// The file of an image.
    ///
    /// # Errors
    /// `Unsupported` where no file is read to the same values.
    pub(super) fn picture_of(&mut self, image: &Image, purpose: For) -> Result<Picture> {
        let encodings = match purpose {
            For::Light => vec![Named::Srgb],
            For::Normals => vec![Named::Linear],
            For::Texture | For::Opacity => {
                let gamma = gamma_of(image).map(Named::Gamma);
                [Named::Srgb, Named::Linear].into_iter().chain(gamma).collect()
            }
        };
        if let Some((path, bytes)) = self.sources.file_of(&image.name)
            && let Some(named) = encodings.iter().find(|named| self.is_read_as(&bytes, &path, **named, image))
        {
            let file = match self.copies.get(&path) {
                Some(file) => file.clone(),
                None => self.copy(&path, bytes),
            };
            return Ok(picture(file, *named, None));
        }
        let size = [image.width, image.height];
        if let Some(rgba) = image.bytes_of_texels() {
            let rgba = rgba.as_flattened();
            let bytes = match image.has_alpha() {
                true => encode_png_of(size, Pixels::Rgba8(rgba), None)?,
                false => encode_png_of(size, Pixels::Rgb8(&image::without_alpha(rgba)), None)?,
            };
            if let Some(named) =
                encodings.iter().find(|named| self.is_read_as(&bytes, "new.png", **named, image))
            {
                let file = self.file(&name_of(image), "png", bytes);
                return Ok(picture(file, *named, None));
            }
        }
        let opacity = purpose == For::Opacity;
        let channel = |channel: usize| -> Vec<f32> {
            let value = |index| if opacity { image.alpha(index) } else { image.texel(index)[channel] };
            (0..image.len()).map(value).collect()
        };
        let channels = [0, 1, 2].map(channel);
        let named: Vec<(String, &[f32])> = ["R", "G", "B"]
            .into_iter()
            .zip(&channels)
            .map(|(name, values)| (name.to_owned(), &values[..]))
            .collect();
        let bytes = encode_exr(image.width, image.height, &named, &[])?;
        let texels: Vec<[f32; 3]> =
            (0..image.len()).map(|index| [0, 1, 2].map(|channel: usize| channels[channel][index])).collect();
        let written = Image::from_linear(image.name.clone(), image.width, image.height, texels);
        if !self.is_read_as(&bytes, "new.exr", Named::Srgb, &written) {
            return Err(super::cannot(format!(
                "the picture {:?}: it has values that are not finite",
                image.name
            )));
        }
        let file = self.file(&name_of(image), "exr", bytes);
        Ok(picture(file, Named::Srgb, opacity.then_some(Channel::Red)))
    }

    /// Adds a copy of a file of a picture.
    fn copy(&mut self, path: &str, bytes: Vec<u8>) -> String {
        let ending = path.rsplit_once('.').map_or("png", |(_, ending)| ending);
        let is_plain = ending.len() <= 8 && ending.bytes().all(|byte| byte.is_ascii_alphanumeric());
        let file = self.file(path, if is_plain { ending } else { "png" }, bytes);
        self.copies.insert(path.to_owned(), file.clone());
        file
    }

    /// Whether the bytes of a file are read to the values of an image.
    fn is_read_as(&self, bytes: &[u8], path: &str, named: Named, image: &Image) -> bool {
        let mut context = self.sources.context();
        let read = match named {
            Named::Srgb => image::decode(bytes, path, Encoding::Srgb, &mut context),
            Named::Linear => image::decode(bytes, path, Encoding::Linear, &mut context),
            Named::Gamma(gamma) => {
                image::decode(bytes, path, Encoding::Curve(&|value| libm::powf(value, gamma)), &mut context)
            }
        };
        read.is_ok_and(|read| read.has_values_of(image))
    }
}

/// The name of the file of an image: that of its own, or a number of one within another file.
fn name_of(image: &Image) -> String {
    match image.name.split_once("#/images/") {
        Some((_, number)) => format!("picture-{number}"),
        None => image.name.clone(),
    }
}

fn picture(file: String, named: Named, channel: Option<Channel>) -> Picture {
    let encoding = match named {
        Named::Srgb => None,
        Named::Linear => Some("linear".into()),
        Named::Gamma(gamma) => Some(Fields::one("gamma", gamma).into()),
    };
    Picture { file, encoding, channel }
}

/// The exponent by which the bytes of an image are decoded, if it is one of few digits.
fn gamma_of(image: &Image) -> Option<f32> {
    let half = image.decoded_byte(128)?;
    let gamma = libm::log(f64::from(half)) / libm::log(128.0 / 255.0);
    let gamma = (libm::round(gamma * 1e4) / 1e4) as f32;
    let is_it = |byte: u8| image.decoded_byte(byte) == Some(libm::powf(f32::from(byte) / 255.0, gamma));
    (gamma > 0.0 && gamma.is_finite() && (0..=255).all(is_it)).then_some(gamma)
}
