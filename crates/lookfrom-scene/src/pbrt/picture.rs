//! Image files of textures and lights, with their encoding.

use std::path::{Path, PathBuf};

use super::Reader;
use super::text::Place;
use crate::error::{ErrorKind, Result};
use crate::image::{self, By, Encoding, Image, Reading};
use crate::scene::ImageId;

impl Reader<'_, '_> {
    /// The image of a float texture: the file's alpha channel if it has one, else its values.
    pub(super) fn number_picture(&mut self, name: &str, encoding: &str, place: &Place) -> Result<ImageId> {
        let key = (self.resolve(name), format!("{encoding}, opacity"));
        if let Some(&id) = self.images.get(&key) {
            return Ok(id);
        }
        let opacity =
            with_encoding(encoding, place, |encoding| image::read_opacity(&key.0, self.context, encoding));
        let opacity = self.or_blank(opacity, &key.0, place, Some(blank(name)))?;
        let Some(opacity) = opacity else { return self.picture(name, encoding, place) };
        Ok(self.push_picture(key, opacity))
    }

    /// An image of a texture, whose integer values are encoded as `sRGB`, `linear` or `gamma x`; each file is decoded once.
    pub(super) fn picture(&mut self, name: &str, encoding: &str, place: &Place) -> Result<ImageId> {
        self.picture_by(By::PbrtTexture, name, encoding, place)
    }

    /// An image of a light.
    pub(super) fn emitted_picture(&mut self, name: &str, place: &Place) -> Result<ImageId> {
        self.picture_by(By::PbrtLight, name, "sRGB", place)
    }

    fn picture_by(&mut self, by: By, name: &str, encoding: &str, place: &Place) -> Result<ImageId> {
        if name.is_empty() {
            return Err(place
                .invalid("the name of the picture is empty")
                .hint("give \"string filename\" a file's name"));
        }
        let path = self.resolve(name);
        let key = (path.clone(), if by == By::PbrtLight { "light".to_owned() } else { encoding.to_owned() });
        if let Some(&id) = self.images.get(&key) {
            return Ok(id);
        }
        let image = with_encoding(encoding, place, |encoding| {
            let reading = Reading { by, ..Reading::new(encoding) };
            image::read_as(&path, &reading, self.context)
        });
        let image = self.or_blank(image, &path, place, blank(name))?;
        Ok(self.push_picture(key, image))
    }

    /// The image that was read; if the file is missing, that is recorded and `blank` is returned.
    fn or_blank<T>(&mut self, read: Result<T>, path: &Path, place: &Place, blank: T) -> Result<T> {
        match read.map_err(|error| place.blame(error)) {
            Err(error) if error.kind == ErrorKind::Io => self.missing.add(path, error).map(|()| blank),
            read => read,
        }
    }

    fn push_picture(&mut self, key: (PathBuf, String), image: Image) -> ImageId {
        let id = ImageId(self.scene.images.len() as u32);
        self.scene.images.push(image);
        self.images.insert(key, id);
        id
    }
}

/// The placeholder of a missing image.
fn blank(name: &str) -> Image {
    Image::from_linear(name, 1, 1, vec![[1.0; 3]])
}

/// The result of `read` for the encoding with this name.
fn with_encoding<T>(
    encoding: &str,
    place: &Place,
    read: impl FnOnce(Encoding<'_>) -> Result<T>,
) -> Result<T> {
    match encoding.split_once(' ') {
        None if encoding == "sRGB" => return read(Encoding::Srgb),
        None if encoding == "linear" => return read(Encoding::Linear),
        Some(("gamma", exponent)) => match exponent.trim().parse::<f32>() {
            Ok(gamma) if gamma > 0.0 && gamma.is_finite() => {
                return read(Encoding::Curve(&|value| libm::powf(value, gamma)));
            }
            _ => {}
        },
        _ => {}
    }
    let error = place.invalid(format!("{encoding:?} is not a known encoding"));
    Err(error.hint("there are: \"sRGB\", \"linear\", \"gamma 2.2\""))
}

/// The encoding of a file's values if the scene gives none. pbrt applies the given encoding only to PNG files: other
/// integer formats are always sRGB.
pub(super) fn encoding_of(name: &str, written: Option<&str>) -> String {
    let extension = Path::new(name).extension().map(|e| e.to_string_lossy().to_lowercase());
    match (extension.as_deref(), written) {
        (Some("png"), Some(written)) => written.to_owned(),
        _ => "sRGB".to_owned(),
    }
}
