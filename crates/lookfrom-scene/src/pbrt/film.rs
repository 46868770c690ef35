//! The `Film` and `PixelFilter` directives: resolution, reconstruction filter and sensor.

use super::Reader;
use super::params::{ParameterType, Parameters};
use super::spectra::SRGB;
use super::state::Entity;
use crate::error::Result;
use crate::settings::{Filter, FilterShape, Layers, PixelBounds, Sensor, SpectralFilm};
use crate::spectrum::CameraSensor;

/// Maximum width and height.
const LARGEST: i32 = 1 << 16;

impl Reader<'_, '_> {
    /// Converts the film, and the camera's exposure time.
    pub(super) fn film(&mut self, film: Option<&Entity>, camera: Option<&Entity>) -> Result<()> {
        let is_old = self.is_old();
        let image = &mut self.scene.image;
        let [width, height] = if is_old { [640, 480] } else { [1280, 720] };
        (image.width, image.height) = (width as u32, height as u32);
        let shutter = match camera {
            Some(camera) => {
                let parameters = &camera.parameters;
                let (mut open, mut close) =
                    (parameters.float("shutteropen", 0.0)?, parameters.float("shutterclose", 1.0)?);
                if close < open {
                    let message =
                        format!("the shutter closes at {close}, before it opens at {open}: swapped");
                    self.context.warn(&parameters.place.location(), message);
                    (open, close) = (close, open);
                }
                if !(close > open) {
                    let expected = "a time after that of \"shutteropen\" (nothing is exposed while the shutter is closed)";
                    return Err(parameters.refuse("shutterclose", expected));
                }
                self.shutter = [open, close];
                close - open
            }
            None => 1.0,
        };
        // In version 3 it does not matter how long the shutter is open.
        let shutter = if is_old { 1.0 } else { shutter };
        image.sensor.imaging_ratio = shutter;
        let Some(Entity { kind, parameters }) = film else { return Ok(()) };
        match &**kind {
            "rgb" => {}
            "gbuffer" => image.layers = Layers::Geometry,
            "spectral" => image.spectral_film = Some(spectral(parameters)?),
            _ => return Err(Self::unknown(&parameters.place, "film", kind, ["rgb", "gbuffer", "spectral"])),
        }
        parameters.ignore(&["filename", "savefp16", "coordinatesystem", "displayfile"]);
        self.film_diagonal = f64::from(parameters.positive("diagonal", 35.0)?);
        let sensor = Self::sensor(parameters, shutter)?;
        let image = &mut self.scene.image;
        image.width = parameters.integer("xresolution", width, 1, LARGEST)? as u32;
        image.height = parameters.integer("yresolution", height, 1, LARGEST)? as u32;
        image.crop = crop(parameters, image.width, image.height)?;
        image.sensor = sensor;
        if parameters.space != SRGB {
            let message = format!(
                "images are written with the primaries of sRGB (Rec. 709), not with those of {}",
                parameters.space
            );
            self.context.warn(&parameters.place.location(), message);
        }
        Ok(())
    }

    fn sensor(parameters: &Parameters, shutter: f32) -> Result<Sensor> {
        let iso = parameters.positive("iso", 100.0)?;
        let exposure_time = parameters.positive("exposuretime", 1.0)?;
        let white =
            parameters.float_where("whitebalance", 0.0, "a temperature in kelvin, or 0", |k| k >= 0.0)?;
        let camera = match parameters.string("sensor")? {
            None | Some(Sensor::OBSERVER) => None,
            Some(name) => Some(CameraSensor::named(name).ok_or_else(|| {
                let cameras = CameraSensor::all().map(CameraSensor::name);
                Self::unknown(
                    &parameters.place,
                    "sensor",
                    name,
                    std::iter::once(Sensor::OBSERVER).chain(cameras),
                )
            })?),
        };
        Ok(Sensor {
            camera,
            imaging_ratio: shutter * exposure_time * iso / 100.0,
            white_balance: (white > 0.0).then_some(white),
            max_component: parameters.positive("maxcomponentvalue", f32::INFINITY)?,
        })
    }

    pub(super) fn filter(&mut self, filter: Option<&Entity>) -> Result<()> {
        self.scene.image.filter = match self.is_old() {
            true => FilterShape::Box.of_radius(0.5),
            false => FilterShape::Gaussian { sigma: 0.5 }.of_radius(1.5),
        };
        let Some(Entity { kind, parameters }) = filter else { return Ok(()) };
        let (shape, radius) = match &**kind {
            "box" => (FilterShape::Box, 0.5),
            "gaussian" => (FilterShape::Gaussian { sigma: parameters.positive("sigma", 0.5)? }, 1.5),
            "triangle" => (FilterShape::Triangle, 2.0),
            "mitchell" => {
                let [b, c] = [parameters.float("B", 1.0 / 3.0)?, parameters.float("C", 1.0 / 3.0)?];
                (FilterShape::Mitchell { b, c }, 2.0)
            }
            "sinc" => (FilterShape::Sinc { tau: parameters.positive("tau", 3.0)? }, 4.0),
            _ => {
                let known = ["box", "gaussian", "triangle", "mitchell", "sinc"];
                return Err(Self::unknown(&parameters.place, "filter", kind, known));
            }
        };
        let radius = [parameters.positive("xradius", radius)?, parameters.positive("yradius", radius)?];
        let warn = |told| self.context.warn(&parameters.place.location(), told);
        self.scene.image.filter = Filter { shape, radius }.narrowed(warn);
        Ok(())
    }
}

/// The buckets of a spectral film.
fn spectral(parameters: &Parameters) -> Result<SpectralFilm> {
    let default = SpectralFilm::default();
    let most = SpectralFilm::MOST_BUCKETS as i32;
    let buckets = parameters.integer("nbuckets", default.buckets as i32, 1, most)? as u32;
    let [shortest, longest] = SpectralFilm::ALL;
    let wavelength = |name, default| {
        parameters.float_where(name, default, "a wavelength from 360 to 830 nm", |nm| {
            (shortest..=longest).contains(&nm)
        })
    };
    let range = [wavelength("lambdamin", shortest)?, wavelength("lambdamax", longest)?];
    if SpectralFilm::is_range(range) {
        return Ok(SpectralFilm { buckets, range, ..SpectralFilm::NONE });
    }
    Err(match parameters.has("lambdamax") {
        true => parameters.refuse("lambdamax", "a wavelength at least 1 nm longer than \"lambdamin\""),
        false => parameters.refuse("lambdamin", "a wavelength at least 1 nm shorter than \"lambdamax\""),
    })
}

/// The crop window, from pixels or from fractions of the image.
fn crop(parameters: &Parameters, width: u32, height: u32) -> Result<Option<PixelBounds>> {
    let pixels = parameters.integers("pixelbounds")?;
    let shares = parameters.floats("cropwindow", ParameterType::Float)?;
    let crop = match (pixels, shares) {
        (&[x0, x1, y0, y1], _) => {
            let [x0, x1] = [x0, x1].map(|x| x.clamp(0, width as i32) as u32);
            let [y0, y1] = [y0, y1].map(|y| y.clamp(0, height as i32) as u32);
            PixelBounds { x0, y0, x1, y1 }
        }
        ([], None) => return Ok(None),
        ([], Some(&[x0, x1, y0, y1])) => {
            // A pixel belongs to the crop window that contains its lower edge.
            let at = |share: f32, count: u32| (share.clamp(0.0, 1.0) * count as f32).ceil() as u32;
            let (x0, x1) = (at(x0.min(x1), width), at(x0.max(x1), width));
            let (y0, y1) = (at(y0.min(y1), height), at(y0.max(y1), height));
            PixelBounds { x0, y0, x1, y1 }
        }
        ([], Some(_)) => return Err(parameters.refuse("cropwindow", "4 numbers: x0 x1 y0 y1")),
        _ => return Err(parameters.refuse("pixelbounds", "4 whole numbers: x0 x1 y0 y1")),
    };
    if crop.x0 >= crop.x1 || crop.y0 >= crop.y1 {
        let name = if pixels.is_empty() { "cropwindow" } else { "pixelbounds" };
        return Err(parameters.refuse(name, "x0 x1 y0 y1 around at least one pixel"));
    }
    Ok(Some(crop))
}
