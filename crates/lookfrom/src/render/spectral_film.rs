//! Spectral films: from the light of traced samples to the buckets of their wavelengths.

use lookfrom_scene::settings::{Background, ColorMode, ImageSettings, RenderSettings, SpectralFilm};
use lookfrom_scene::{Error, ErrorKind, Location, Remedy, Result};

use super::{Batch, Renderer, Traced};
use crate::integrator::Alpha;
use crate::shading::texture::SpectralMode;

impl Renderer {
    /// A sample's spectral radiance for a spectral film, as the film of its light has it: weighted, and with the sample's limit of
    /// brightness. For each wavelength its bucket, the radiance, and the number of wavelengths of uniform density that it counts for: after
    /// dispersion the first for four. After the buckets there are the bands: in all of them each wavelength counts, with radiance ·
    /// response / density.
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
        let film = self.image().spectral_film.as_ref().filter(|film| film.is_measuring());
        let wavelengths = match traced.mode {
            SpectralMode::Spectral(wavelengths) => film.map(|film| (film, wavelengths)),
            SpectralMode::Rgb => None,
        };
        wavelengths.into_iter().flat_map(move |(film, wavelengths)| {
            let (lanes, count) = if wavelengths.secondary_terminated() { (1, 4) } else { (4, 1) };
            let (lambda, pdf) = (wavelengths.lambda(), wavelengths.pdf());
            (0..lanes).flat_map(move |lane| {
                let (nm, radiance) = (lambda[lane], light.0[lane]);
                let bucket = (film.buckets > 0).then(|| (film.bucket_of(nm), radiance, count));
                // The density of a wavelength that counts for four has been divided by four.
                let per_density = radiance / (pdf[lane] * count as f32);
                let bands = (film.buckets as usize..).zip(&film.bands);
                let bands =
                    bands.map(move |(index, band)| (index, band.response.at(nm) * per_density, count));
                bucket.into_iter().chain(bands)
            })
        })
    }
}

/// Refuses a spectral film that is out of range, or of light that has no wavelengths.
pub(super) fn check(image: &ImageSettings, settings: &RenderSettings) -> Result<()> {
    let Some(film) = &image.spectral_film else { return Ok(()) };
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
    if let Some(band) = film.bands.iter().find(|band| band.width(film.range) == 0.0) {
        let ([shortest, longest], name) = (film.range, &band.name);
        let message = format!(
            "the band {name:?} has no response between {shortest} and {longest} nm, the wavelengths of the picture"
        );
        return Err(invalid(message).hint("give it another response, or leave it out"));
    }
    if film.is_measuring() && !settings.integrator.needs_light() {
        let integrator = settings.integrator.word();
        let message = format!("a spectral film needs light, and the integrator {integrator:?} shows none");
        return Err(
            invalid(message).hint("a picture of it has no spectral buckets or bands: `spectral_buckets` = 0")
        );
    }
    Ok(())
}
