//! Validation of the settings of picture and integrator.

use super::{Part, check_curve};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::scene::Scene;
use crate::settings::{
    Background, Filter, FilterShape, ImageSettings, MOST_PIXELS, RenderSettings, SpectralFilm,
};

impl ImageSettings {
    /// Checks that size, filter, exposure, background, sensor and spectral film are as their documentation says.
    ///
    /// # Errors
    /// `Invalid` for a picture without pixels and for a number out of range; `Limit` for too large a picture.
    pub fn validate(&self) -> Result<()> {
        check(|part| check_image(part, self), "the picture")
    }
}

impl RenderSettings {
    /// Checks that the numbers are as their documentation says.
    ///
    /// # Errors
    /// `Invalid` for a number out of range.
    pub fn validate(&self) -> Result<()> {
        check(|part| check_render(part, self), "the integrator")
    }
}

/// Checks settings, which refer to nothing in a scene and have no place in a file.
fn check(settings: impl Fn(&Part<'_>) -> Result<()>, kind: &str) -> Result<()> {
    settings(&Part::new(&Scene::default(), &Location::default(), kind))
}

fn check_image(part: &Part<'_>, image: &ImageSettings) -> Result<()> {
    let (width, height) = (u64::from(image.width), u64::from(image.height));
    if width == 0 || height == 0 {
        return Err(part.fault(format!("it has {width} × {height} pixels; both must be at least 1")));
    }
    if width * height > MOST_PIXELS {
        let message = format!("{width}×{height} pixels are more than the limit of {MOST_PIXELS}");
        return Err(Error::new(ErrorKind::Limit, part.at, message));
    }
    part.number("exposure", image.exposure.into(), "stops from -64 to 64", image.exposure.abs() <= 64.0)?;
    check_filter(part, image.filter)?;
    if let Background::Color(rgb) = image.background {
        part.finite("background", &rgb.map(f64::from))?;
    }
    let sensor = &image.sensor;
    part.positive("imaging_ratio", sensor.imaging_ratio.into())?;
    if let Some(kelvin) = sensor.white_balance {
        part.positive("white_balance", kelvin.into())?;
    }
    let most = sensor.max_component;
    part.number("max_component", most.into(), "a number greater than 0", most > 0.0)?;
    image.spectral_film.as_ref().map_or(Ok(()), |film| check_spectral_film(part, film))
}

fn check_spectral_film(part: &Part<'_>, film: &SpectralFilm) -> Result<()> {
    let SpectralFilm { buckets, range, bands } = film;
    let most = SpectralFilm::MOST_BUCKETS;
    let expected = format!("a whole number from 0 to {most}");
    part.number("spectral_buckets", (*buckets).into(), &expected, *buckets <= most)?;
    part.number("wavelengths", range[0].into(), SpectralFilm::RANGE, SpectralFilm::is_range(*range))?;
    let most = SpectralFilm::MOST_BANDS;
    part.number("bands", bands.len() as f64, &format!("at most {most}"), bands.len() <= most)?;
    if !bands.is_sorted_by(|a, b| a.name < b.name) {
        return Err(part.fault("its bands are not sorted by name, each once"));
    }
    bands.iter().try_for_each(|band| {
        band.check_name().map_err(|message| part.fault(message))?;
        check_curve(part, &band.response)
    })
}

fn check_filter(part: &Part<'_>, filter: Filter) -> Result<()> {
    for (name, value) in filter.shape.parameters() {
        match filter.shape {
            FilterShape::Mitchell { .. } => part.finite("filter", &[value.into()])?,
            _ => part.positive(&format!("{name} of the filter"), value.into())?,
        }
    }
    filter.radius.into_iter().try_for_each(|radius| {
        let is_valid = radius > 0.0 && radius <= Filter::WIDEST;
        part.number("radius of the filter", radius.into(), "pixels, more than 0 and at most 16", is_valid)
    })
}

fn check_render(part: &Part<'_>, render: &RenderSettings) -> Result<()> {
    part.at_least_zero("min_contribution", render.min_contribution.into())?;
    let distance = render.occlusion_distance;
    part.number("occlusion_distance", distance.into(), "a number greater than 0", distance > 0.0)
}
