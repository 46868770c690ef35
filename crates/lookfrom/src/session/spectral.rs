//! Layers of a spectral film in an EXR, by Fichet, Pacanowski & Wilkie (2021), "An OpenEXR Layout for Spectral Images", JCGT 10(3).
//!
//! A band with a response is the channel `band.<name>`. A bucket is the channel `S0.<wavelength>nm`, S0 for light that is not polarised, of the wavelength in its middle with a comma in place
//! of the decimal point. Names and attributes are those of pbrt-v4's film.

use lookfrom_scene::settings::SpectralFilm;

/// The name of the text with the range of wavelengths, and that of the text with the number of buckets.
const WAVELENGTHS: &str = "wavelengths";
const BUCKETS: &str = "spectral_buckets";

/// The names of texts and channels of bands begin with this, and end with the band's name. The text is the integral of its response
/// over the wavelengths.
const BAND: &str = "band.";

/// The attributes of the layout: its version, and the unit of radiance.
const LAYOUT: [(&str, &str); 2] = [("spectralLayoutVersion", "1.0"), ("emissiveUnits", "W.m^-2.sr^-1")];

/// Whether a text is about the layout of the channels alone.
pub(super) fn is_of_layout(name: &str) -> bool {
    LAYOUT.iter().any(|(known, _)| *known == name)
}

/// The texts of the header of a spectral film.
pub(super) fn texts(film: &SpectralFilm) -> Vec<(String, String)> {
    let [shortest, longest] = film.range;
    let range = (WAVELENGTHS, format!("{shortest} {longest}"));
    let layout = LAYOUT.map(|(name, text)| (name, text.to_owned()));
    let of_buckets = [(BUCKETS, film.buckets.to_string())].into_iter().chain(layout);
    let of_buckets = of_buckets.filter(|_| film.buckets > 0);
    let texts = [range].into_iter().chain(of_buckets).map(|(name, text)| (name.to_owned(), text));
    let of_bands = film
        .bands
        .iter()
        .map(|band| (format!("{BAND}{}", band.name), format!("{} nm", band.width(film.range))));
    texts.chain(of_bands).collect()
}

/// The names of the channels of the buckets that the sorted texts of a header tell of, by wavelength, and then those of the bands.
pub(super) fn channels(texts: &[(String, String)]) -> Vec<String> {
    let buckets = film_of(texts).map_or_else(Vec::new, |film| film.centers().map(channel).collect());
    let bands = texts.iter().map(|(name, _)| name).filter(|name| name.starts_with(BAND)).cloned();
    buckets.into_iter().chain(bands).collect()
}

fn film_of(texts: &[(String, String)]) -> Option<SpectralFilm> {
    let text = |name: &str| texts.iter().find(|(known, _)| known == name).map(|(_, text)| text.as_str());
    let buckets = text(BUCKETS)?.parse().ok().filter(|buckets| *buckets <= SpectralFilm::MOST_BUCKETS)?;
    let (shortest, longest) = text(WAVELENGTHS)?.split_once(' ')?;
    let range = [shortest.parse().ok()?, longest.parse().ok()?];
    SpectralFilm::is_range(range).then_some(SpectralFilm { buckets, range, ..SpectralFilm::NONE })
}

fn channel(nm: f64) -> String {
    format!("S0.{}nm", format!("{nm:.3}").replace('.', ","))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_have_the_wavelengths_in_the_middles_of_the_buckets() {
        let pbrt = channels(&texts(&SpectralFilm::default()));
        assert_eq!(pbrt.len(), 16);
        assert_eq!([&*pbrt[0], &*pbrt[1], &*pbrt[15]], ["S0.374,688nm", "S0.404,062nm", "S0.815,312nm"]);
        let two = SpectralFilm { buckets: 2, range: [400.0, 700.0], ..SpectralFilm::NONE };
        assert_eq!(channels(&texts(&two)), ["S0.475,000nm", "S0.625,000nm"]);
        assert!(channels(&texts(&two.of_picture())).is_empty() && channels(&[]).is_empty());
        // The most buckets in the least range have names of their own.
        let mut names =
            channels(&texts(&SpectralFilm { buckets: 470, range: [500.0, 501.0], ..SpectralFilm::NONE }));
        names.dedup();
        assert_eq!(names.len(), 470);
    }

    #[test]
    fn damaged_texts_have_no_channels() {
        for (range, buckets) in [("400 700", "x"), ("700 400", "3"), ("400", "3"), ("400 700", "4294967295")]
        {
            let texts = [("wavelengths", range), ("spectral_buckets", buckets)];
            assert!(channels(&texts.map(|(name, text)| (name.to_owned(), text.to_owned()))).is_empty());
        }
    }
}
