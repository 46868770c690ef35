//! From the film of a render to a finished picture: fireflies, denoising, header, Cryptomattes, in this order.

use std::time::Duration;

use lookfrom_scene::settings::{Background, ImageSettings, Tonemap};

use super::{Fireflies, Session, header};
use crate::aov::Cryptomatte;
use crate::core::clock::Stopwatch;
use crate::film::{Film, Picture};
use crate::post::denoise::denoise;
use crate::render::Rendered;

/// The settings by which a film becomes a picture, which can be changed without rendering anew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Development {
    /// In stops: 8-bit pictures are multiplied by 2^exposure before tone mapping.
    pub exposure: f32,
    /// The tone mapping of 8-bit pictures.
    pub tonemap: Tonemap,
    /// The background of a film with alpha.
    pub background: Background,
    /// Whether the picture is denoised; guided by the first hits if the film has denoiser features.
    pub denoise: bool,
    /// Treatment of fireflies.
    pub fireflies: Fireflies,
}

impl Development {
    /// The development that image settings ask for.
    pub fn of_image(image: &ImageSettings, fireflies: Fireflies) -> Self {
        let &ImageSettings { exposure, tonemap, background, denoise, .. } = image;
        Self { exposure, tonemap, background, denoise, fireflies }
    }
}

/// A developed picture, ready to be [encoded](Developed::encode).
#[derive(Clone, Debug)]
pub struct Developed {
    /// Linear light, with firefly suppression and denoising if they are enabled.
    pub picture: Picture,
    /// Further channels for formats that can hold them, by name, where it is of no film: those of a film, AOVs and the light before
    /// denoising, are made as they are [written](Developed::write).
    pub layers: Vec<(String, Vec<f32>)>,
    /// Cryptomattes, of a picture that its session has just rendered: a film has none.
    pub cryptomattes: Vec<Cryptomatte>,
    /// The settings of the picture, as names and values: everything that determines its light, and nothing else, so
    /// that the same picture has the same bytes.
    pub header: Vec<(String, String)>,
    /// Whether it is denoised.
    pub denoised: bool,
    /// The settings by which it was developed, and will be encoded.
    pub development: Development,
}

/// A finished picture, with the film that it was developed from.
#[derive(Debug)]
pub struct Finished {
    /// The film, with statistics of the render.
    pub rendered: Rendered,
    /// The picture.
    pub developed: Developed,
    /// Whether AOVs and the light before denoising belong to it.
    pub(super) has_layers: bool,
    /// The time that its development took.
    pub developing: Duration,
}

impl std::ops::Deref for Finished {
    type Target = Developed;

    fn deref(&self) -> &Developed {
        &self.developed
    }
}

impl Finished {
    /// Mean number of samples per pixel, rounded down.
    pub fn samples_taken(&self) -> u64 {
        self.rendered.samples_taken / self.rendered.film.area().pixels().max(1)
    }
}

impl Session {
    /// Finishes the picture of a film that its renderer has rendered.
    pub fn finish(&self, rendered: Rendered) -> Finished {
        let started = Stopwatch::start();
        let mut developed = self.develop(&rendered.film, &self.development());
        let has_layers = self.has_room_for_layers();
        // Those of later samples alone are nobody's picture.
        if has_layers && rendered.film.ledger().is_from_start(rendered.film.area()) {
            developed.cryptomattes = self.renderer.cryptomattes(rendered.samples);
        }
        Finished { rendered, developed, has_layers, developing: started.elapsed() }
    }

    /// Develops a film of this session's picture, finished or not.
    pub fn develop(&self, film: &Film, development: &Development) -> Developed {
        develop(film, development, &header::header(self))
    }
}

/// Develops a film, whose header has the `common` texts. A film of a part of the samples, whose noise is nobody's picture, is not
/// denoised.
pub(super) fn develop(film: &Film, development: &Development, common: &[(String, String)]) -> Developed {
    let spread = development.fireflies == Fireflies::Spread;
    let mut picture = if spread { film.picture_without_fireflies() } else { film.picture() };
    let is_denoised = development.denoise && film.ledger().is_from_start(film.area());
    if is_denoised {
        denoise(film, &mut picture);
    }
    let header = header::finished(common, film, development, is_denoised);
    Developed {
        picture,
        layers: Vec::new(),
        cryptomattes: Vec::new(),
        header,
        denoised: is_denoised,
        development: *development,
    }
}
