//! Automatic exposure, by a small picture of what the camera sees.
//!
//! Files with lights of their own mean candela and lux, watts, or anything: a picture of them may be white or black. The exposure is
//! chosen before the picture is rendered, so that all its parts, previews and films have the same.

use lookfrom_scene::Result;
use lookfrom_scene::settings::{Allocation, ImageSettings, RenderSettings};

use super::Session;
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
        let scale = f64::from(SIDE) / f64::from(image.width.max(image.height));
        let side = |pixels: u32| ((f64::from(pixels) * scale).round() as u32).max(1);
        small.set_image(image.of_light(side(image.width), side(image.height)))?;
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
