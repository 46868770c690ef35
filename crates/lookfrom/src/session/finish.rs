//! From the film of a render to a finished picture: fireflies, denoising, AOVs, header, in this order.

use lookfrom_scene::settings::ImageSettings;

use super::header::{Taken, header};
use super::{Fireflies, Session, layers};
use crate::film::Picture;
use crate::post::denoise::denoised;
use crate::render::{Rendered, StopReason};

/// A finished picture, ready to be [encoded](Finished::encode).
#[derive(Debug)]
pub struct Finished {
    /// The film, with statistics of the render.
    pub rendered: Rendered,
    /// Linear light, with firefly suppression and denoising if they are enabled.
    pub picture: Picture,
    /// Further channels for formats that can hold them, by name: AOVs, and the light before denoising.
    pub layers: Vec<(String, Vec<f32>)>,
    /// The settings of the picture, as names and values: everything that determines its light, and nothing else, so
    /// that the same picture has the same bytes.
    pub header: Vec<(String, String)>,
    /// Whether it is denoised.
    pub denoised: bool,
    pub(super) image: ImageSettings,
}

impl Finished {
    /// Mean number of samples per pixel, rounded down.
    pub fn samples_taken(&self) -> u64 {
        let area = self.rendered.film.area();
        let pixels = u64::from(area.x1 - area.x0) * u64::from(area.y1 - area.y0);
        self.rendered.samples_taken / pixels.max(1)
    }

    /// Maximum number of samples of a pixel; the number in the settings if the render was cancelled.
    pub fn samples(&self) -> u32 {
        self.rendered.samples
    }
}

impl Session {
    /// Finishes the picture of a film that its renderer has rendered.
    pub fn finish(&self, rendered: Rendered) -> Finished {
        let film = &rendered.film;
        let image = self.renderer.view().image().clone();
        let spread = self.fireflies == Fireflies::Spread;
        let mut picture = if spread { film.picture_without_fireflies() } else { film.picture() };
        let mut layers = if film.has_layers() { layers::channels(film) } else { Vec::new() };
        if image.denoise {
            picture = denoised(film, &picture);
            if self.has_room_for_layers() {
                layers.extend(layers::noisy(&image, film.picture()));
            }
        }
        let cancelled = rendered.reason == StopReason::Cancelled;
        let mut finished =
            Finished { denoised: image.denoise, picture, layers, header: Vec::new(), image, rendered };
        if cancelled {
            finished.rendered.samples = self.renderer.settings().samples;
        }
        let taken = Taken {
            samples: finished.samples(),
            mean: (cancelled || self.stop.noise.is_some()).then(|| finished.samples_taken()),
            noise: self.stop.noise,
            fireflies_spread: spread,
            denoised: finished.denoised,
        };
        finished.header = header(self, &taken);
        finished
    }
}
