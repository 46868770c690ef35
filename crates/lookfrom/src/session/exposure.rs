//! Automatic exposure, by a small picture of what the camera sees.
//!
//! Files with lights of their own mean candela and lux, watts, or anything: a picture of them may be white or black. The exposure is
//! chosen before the picture is rendered, so that all its parts, previews and films have the same.

use std::borrow::Cow;
use std::path::Path;

use lookfrom_scene::settings::{Allocation, ImageSettings, RenderSettings};
use lookfrom_scene::{Location, Remedy, Result, Warning};

use super::{Developed, Session};
use crate::film::Picture;
use crate::post::exposure;

/// The longer side of the small picture, in pixels, and its samples per pixel.
const SIDE: u32 = 64;
const SAMPLES: u32 = 8;

/// The choice of a picture's exposure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// In stops: 8-bit pictures are multiplied by 2^stops before tone mapping.
    Stops(f32),
    /// By what the camera sees, in eighths of a stop.
    Auto,
}

impl Session {
    /// Chooses the exposure by a small picture, and returns it in stops. The same scene has the same exposure at any number of
    /// threads and samples.
    pub(super) fn expose(&mut self) -> Result<f32> {
        let mut small = self.clone();
        let image = self.image();
        let [width, height] = small_size(image.width, image.height);
        small.set_image(image.of_light(width, height))?;
        small.set_settings_of_same_integrator(RenderSettings {
            samples: SAMPLES,
            allocation: Allocation::Uniform,
            ..self.settings().clone()
        })?;
        (small.first_sample, small.identity) = (0, None);
        (small.stop.time, small.stop.noise) = (None, None);
        let stops = exposure::stops(&small.render(&())?.picture);
        self.set_image(ImageSettings { exposure: stops, ..self.image().clone() })?;
        Ok(stops)
    }
}

impl Developed {
    /// Chooses the exposure by the picture that there is, reduced to a small one: nearly that of [`Exposure::Auto`] of a render. Returns
    /// a notice of it, about a file.
    pub fn expose(&mut self, path: &Path) -> Warning {
        let stops = exposure::stops(&reduced(&self.picture));
        self.development.exposure = stops;
        let texts = self.header.iter_mut().filter(|(name, _)| name == "exposure");
        texts.for_each(|(_, text)| *text = stops.to_string());
        notice(stops, path)
    }
}

/// The notice of an exposure that was chosen, in stops.
pub(super) fn notice(stops: f32, path: &Path) -> Warning {
    let message = format!("the exposure is {stops}, chosen by what is seen");
    Warning::notice(&Location::file(path), message).remedy(Remedy::Exposure(stops))
}

/// The size of the small picture for one of this size.
fn small_size(width: u32, height: u32) -> [u32; 2] {
    let scale = f64::from(SIDE) / f64::from(width.max(height));
    [width, height].map(|pixels| ((f64::from(pixels) * scale).round() as u32).max(1))
}

/// The small picture with the means of the pixels of a larger one; of a smaller one itself.
fn reduced(picture: &Picture) -> Cow<'_, Picture> {
    let [width, height] = small_size(picture.width, picture.height);
    if width >= picture.width {
        return Cow::Borrowed(picture);
    }
    let range = |index: u32, count: u32, of: u32| {
        let edge = |index: u32| (u64::from(index) * u64::from(of) / u64::from(count)) as usize;
        edge(index)..edge(index + 1)
    };
    let mean = |x: u32, y: u32| {
        let (columns, rows) = (range(x, width, picture.width), range(y, height, picture.height));
        let count = (columns.len() * rows.len()) as f64;
        let row = |y: usize| &picture.pixels[y * picture.width as usize..][columns.clone()];
        let sums = rows.flat_map(row).fold([0.0; 3], |sums: [f64; 3], rgb| {
            [0, 1, 2].map(|channel| sums[channel] + f64::from(rgb[channel]))
        });
        sums.map(|sum| (sum / count) as f32)
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y])).map(|[x, y]| mean(x, y)).collect();
    Cow::Owned(Picture { width, height, pixels, alpha: Vec::new() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_pictures_have_the_means_of_large_ones() {
        let pixels = (0..130 * 65_u32).map(|pixel| [pixel % 130, pixel / 130, 1].map(|c| c as f32)).collect();
        let small = reduced(&Picture { width: 130, height: 65, pixels, alpha: Vec::new() }).into_owned();
        assert_eq!([small.width, small.height, small.pixels.len() as u32], [64, 32, 64 * 32]);
        // Of the columns 0 and 1, and the rows 0 and 1; of the last three, and the last three.
        assert_eq!(small.pixels[0], [0.5, 0.5, 1.0]);
        assert_eq!(small.pixels[64 * 32 - 1], [128.0, 63.0, 1.0]);
        let tiny = Picture { width: 3, height: 1, pixels: vec![[2.0; 3]; 3], alpha: Vec::new() };
        assert_eq!(reduced(&tiny).pixels, tiny.pixels);
        // Thin ones have at least one row.
        let thin = Picture { width: 1000, height: 2, pixels: vec![[2.0; 3]; 2000], alpha: Vec::new() };
        assert_eq!(reduced(&thin).pixels, vec![[2.0; 3]; 64]);
    }
}
