//! Which picture does a file hold, and how are its values to be taken?

use std::path::Path;

use super::Reader;
use super::text::Place;
use crate::error::Result;
use crate::image::{self, linear_from_srgb};
use crate::scene::ImageId;

impl Reader<'_, '_> {
    /// A picture whose whole-number values are `sRGB`, `linear` or `gamma x`; each file is decoded once.
    pub(super) fn picture(&mut self, name: &str, encoding: &str, place: &Place) -> Result<ImageId> {
        if name.is_empty() {
            return Err(place
                .invalid("the name of the picture is empty")
                .hint("give \"string filename\" a file's name"));
        }
        let path = self.resolve(name);
        let key = (path.clone(), encoding.to_owned());
        if let Some(&id) = self.images.get(&key) {
            return Ok(id);
        }
        let curve: Box<dyn Fn(f32) -> f32> = match encoding.split_once(' ') {
            None if encoding == "sRGB" => Box::new(linear_from_srgb),
            None if encoding == "linear" => Box::new(|value| value),
            Some(("gamma", exponent)) => match exponent.trim().parse::<f32>() {
                Ok(gamma) if gamma > 0.0 && gamma.is_finite() => {
                    Box::new(move |value| libm::powf(value, gamma))
                }
                _ => {
                    return Err(place.invalid(format!("expected \"gamma\" and a number, found {encoding:?}")));
                }
            },
            _ => {
                let error = place.invalid(format!("{encoding:?} is no encoding that is known"));
                return Err(error.hint("there are: \"sRGB\", \"linear\", \"gamma 2.2\""));
            }
        };
        let image = image::read_encoded(&path, self.sources, &*curve).map_err(|error| place.blame(error))?;
        let id = ImageId(self.scene.images.len() as u32);
        self.scene.images.push(image);
        self.images.insert(key, id);
        Ok(id)
    }
}

/// How the values of a file are encoded where the scene does not say. pbrt asks only for the encoding of PNG files: other
/// files of whole numbers are always sRGB.
pub(super) fn encoding_of(name: &str, written: Option<&str>) -> String {
    let extension = Path::new(name).extension().map(|e| e.to_string_lossy().to_lowercase());
    match (extension.as_deref(), written) {
        (Some("png"), Some(written)) => written.to_owned(),
        _ => "sRGB".to_owned(),
    }
}
