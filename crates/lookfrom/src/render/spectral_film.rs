//! Spectral films: from the light of traced samples to the buckets of their wavelengths.

use lookfrom_scene::settings::{Background, ColorMode, ImageSettings, RenderSettings, SpectralFilm};
use lookfrom_scene::{Error, ErrorKind, Location, Remedy, Result};

use super::{Batch, Renderer, Traced};
use crate::integrator::Alpha;
use crate::shading::texture::SpectralMode;

impl Renderer {
    /// A sample's spectral radiance for a spectral film, as the film of its light has it: weighted, and with the sample's limit of
    /// brightness. For each wavelength its bucket, the radiance, and the number of wavelengths of uniform density that it counts for: after
    /// dispersion the first for four.
    pub(super) fn light_by_buckets(
        &self,
        batch: &Batch,
        slot: usize,
        traced: &Traced,
    ) -> impl Iterator<Item = (usize, f32, u32)> {
        let radiance = match batch.queues.alpha[slot] {
            Alpha::Shadow(before) if self.image().background != Background::Environment => before,
            _ => traced.radiance,
        };
        let light = radiance * traced.weight;
        let light = light * self.limit(self.measured(light, &traced.mode));
        let film = self.image().spectral_film.filter(|film| film.buckets > 0);
        let wavelengths = match traced.mode {
            SpectralMode::Spectral(wavelengths) => film.map(|film| (film, wavelengths)),
            SpectralMode::Rgb => None,
        };
        wavelengths.into_iter().flat_map(move |(film, wavelengths)| {
            let (lanes, count) = if wavelengths.secondary_terminated() { (1, 4) } else { (4, 1) };
            let lambda = wavelengths.lambda();
            (0..lanes).map(move |lane| (film.bucket_of(lambda[lane]), light.0[lane], count))
        })
    }
}

/// Refuses a spectral film that is out of range, or of light that has no wavelengths.
pub(super) fn check(image: &ImageSettings, settings: &RenderSettings) -> Result<()> {
    let Some(film) = image.spectral_film else { return Ok(()) };
    let invalid = |message: String| Error::new(ErrorKind::Invalid, &Location::default(), message);
    if film.buckets > SpectralFilm::MOST_BUCKETS {
        let most = SpectralFilm::MOST_BUCKETS;
        return Err(invalid(format!("{} spectral buckets; expected at most {most}", film.buckets)));
    }
    if !SpectralFilm::is_range(film.range) {
        let [shortest, longest] = film.range;
        let expected = SpectralFilm::RANGE;
        return Err(invalid(format!("the wavelengths {shortest} to {longest} nm; expected {expected}")));
    }
    if settings.color == ColorMode::Rgb {
        let message = "a spectral film needs light of wavelengths, and this is rendered in RGB";
        return Err(invalid(message.to_owned()).hint(Remedy::SpectralLight));
    }
    if film.buckets > 0 && !settings.integrator.needs_light() {
        let integrator = settings.integrator.word();
        let message = format!("a spectral film needs light, and the integrator {integrator:?} shows none");
        return Err(invalid(message).hint("a picture of it has no spectral buckets: `spectral_buckets` = 0"));
    }
    Ok(())
}
