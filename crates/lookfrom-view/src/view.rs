//! From a page's request to a session: camera, size, settings, and the variation of the scene.

use glam::DVec3;
use lookfrom::session::{MOST_SAMPLES, Options, Session};
use lookfrom_scene::camera::{Camera, Look, Projection};
use lookfrom_scene::files::SharedFiles;
use lookfrom_scene::settings::{ImageSettings, Integrator, Layers, SpectralFilm, Tonemap};
use lookfrom_scene::{Error, ErrorKind, Location, Result};

use crate::document::Loaded;
use crate::message::{CameraRequest, ViewRequest};

/// The most pixels of a view: those of a screen of 3840 × 2160. Its film takes 3.5 GB.
pub(crate) const MOST_PIXELS: u64 = 3840 * 2160;

/// The largest depth, as on the command line.
const MOST_DEPTH: u32 = 256;

/// Settings that cannot be changed in a session: the scene is read again for it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Variation {
    rotate_environment: Option<f64>,
    animation: Option<usize>,
    at: Option<f64>,
    variant: Option<String>,
    has_turntable: bool,
}

/// The error for a request that cannot be fulfilled.
pub(crate) fn refused(message: impl Into<String>) -> Error {
    Error::new(ErrorKind::Request, &Location::default(), message)
}

/// The value of a word.
pub(crate) fn named<T: Copy>(words: &[(&str, T)], word: &str, what: &str) -> Result<T> {
    let found = words.iter().find(|(known, _)| *known == word).map(|&(_, value)| value);
    found.ok_or_else(|| {
        let known: Vec<&str> = words.iter().map(|&(known, _)| known).collect();
        refused(format!("there is no {what} {word:?}; expected one of {}", known.join(", ")))
    })
}

impl ViewRequest {
    /// The part that decides the light of each sample: pictures of equal ones are developed from the same film.
    pub(crate) fn light(&self) -> Self {
        Self {
            id: 0,
            moving: false,
            samples: None,
            exposure: 0.0,
            tonemap: None,
            denoise: false,
            layer: None,
            compare: None,
            ..self.clone()
        }
    }

    /// The variation of the scene; `None` for the scene as it is.
    pub(crate) fn variation(&self, loaded: &Loaded) -> Option<Variation> {
        let wants_turntable = self.turn.is_some() && loaded.options.turn.is_none();
        let Self { rotate_environment, animation, at, ref variant, .. } = *self;
        let varies = rotate_environment.is_some() || animation.is_some() || at.is_some() || variant.is_some();
        (varies || wants_turntable).then(|| Variation {
            rotate_environment,
            animation,
            at,
            variant: variant.clone(),
            has_turntable: self.turn.is_some(),
        })
    }

    /// The session of this view, made from one of the scene in its variation. Nothing is built.
    ///
    /// # Errors
    /// `Request` for what is out of range; as [`Session::set_camera`].
    pub(crate) fn applied(&self, mut session: Session) -> Result<Session> {
        if let Some(degrees) = self.turn {
            session.set_turn(finite(degrees, "turn")?)?;
        }
        let mut image = session.image().clone();
        if let Some([width, height]) = self.size {
            check_size([width, height])?;
            image.resize(width, height);
        }
        check_size([image.width, image.height])?;
        // Whatever may be asked for of this film is in it.
        let spectral_film = image.spectral_film.as_ref().map(SpectralFilm::of_picture);
        session.set_image(ImageSettings {
            layers: Layers::Geometry,
            denoise: true,
            spectral_film,
            ..image
        })?;
        if let Some(request) = &self.camera {
            let camera = request.applied(session.camera(), session.info().bounds.center())?;
            session.set_camera(camera)?;
        }
        let mut settings = session.settings().clone();
        if let Some(word) = &self.integrator {
            settings.integrator = named(Integrator::WORDS, word, "integrator")?;
        }
        if let Some(depth) = self.depth {
            settings.depth = in_range(depth, 0, MOST_DEPTH, "depth")?;
        }
        if let Some(samples) = self.samples {
            settings.samples = in_range(samples, 1, MOST_SAMPLES, "samples")?;
        }
        if let Some(least) = self.min_contribution {
            settings.min_contribution = in_range(least, 0.0, 1.0, "min_contribution")?;
        }
        session.set_settings(settings)?;
        Ok(session)
    }

    /// The tone map.
    ///
    /// # Errors
    /// `Request` for a word that is none.
    pub(crate) fn tonemap(&self, own: Tonemap) -> Result<Tonemap> {
        self.tonemap.as_deref().map_or(Ok(own), |word| named(Tonemap::WORDS, word, "tonemap"))
    }
}

impl Variation {
    /// Reads the scene in this variation, from its files.
    ///
    /// # Errors
    /// As [`Session::open`].
    pub(crate) fn open(&self, loaded: &Loaded, files: &SharedFiles) -> Result<Session> {
        let mut options: Options = loaded.options.clone();
        if let Some(degrees) = self.rotate_environment {
            options.rotate_environment = Some(finite(degrees, "rotate_environment")?);
        }
        if let Some(at) = self.at {
            options.import.at = Some(finite(at, "at")?);
        }
        if let Some(number) = self.animation {
            options.import.animation = Some(number.to_string());
        }
        if let Some(variant) = &self.variant {
            options.import.variant = Some(variant.clone());
        }
        if self.has_turntable {
            options.turn = options.turn.or(Some(0.0));
        }
        Session::open_in(loaded.session.name(), files, &options)
    }
}

impl CameraRequest {
    /// The scene's camera, moved.
    ///
    /// # Errors
    /// `Request` for numbers that are not finite.
    pub(crate) fn applied(&self, own: &Camera, middle: DVec3) -> Result<Camera> {
        let look = Look { lookfrom: self.lookfrom.into(), lookat: self.lookat.into(), up: self.up.into() };
        if ![look.lookfrom, look.lookat, look.up].iter().all(|vector| vector.is_finite()) {
            return Err(refused("the camera has numbers that are not finite"));
        }
        let mut camera = Camera { at: Location::default(), ..own.clone() };
        match &mut camera.projection {
            Projection::Perspective { fov } => *fov = self.fov.unwrap_or(*fov),
            // Of parallel rays, a nearer camera sees no less by itself.
            Projection::Orthographic { height } => {
                let distance = |look: &Look| look.lookfrom.distance(look.lookat);
                if let Some(before) = own.look(middle) {
                    *height *= distance(&look) / distance(&before);
                }
            }
            _ => {}
        }
        camera.set_look(look, middle);
        Ok(camera)
    }
}

/// # Errors
/// `Request` for a picture without pixels, or too large a one.
pub(crate) fn check_size([width, height]: [u32; 2]) -> Result<()> {
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || pixels > MOST_PIXELS {
        return Err(refused(format!(
            "a picture of {width} × {height} pixels; 1 to {MOST_PIXELS} are possible in a window"
        )));
    }
    Ok(())
}

fn finite(number: f64, what: &str) -> Result<f64> {
    match number.is_finite() {
        true => Ok(number),
        false => Err(refused(format!("{what} is {number}; expected a finite number"))),
    }
}

fn in_range<T: Copy + PartialOrd + std::fmt::Display>(number: T, least: T, most: T, what: &str) -> Result<T> {
    match least <= number && number <= most {
        true => Ok(number),
        false => Err(refused(format!("{what} is {number}; expected {least} to {most}"))),
    }
}
