//! The spectral film: a range of wavelengths that are sampled uniformly, in buckets of equal width, and bands with responses.

use super::{CHANNEL_NAME, is_channel_name};
use crate::spectrum::{Curve, LONGEST, SHORTEST};

/// A film that sums light by wavelength beside the picture, as pbrt-v4's film of that name and Mitsuba's `specfilm`. It needs
/// spectral rendering.
///
/// All wavelengths of the range have the same probability, so that the picture and the bands have only light within it.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralFilm {
    /// Number of buckets, at most [`SpectralFilm::MOST_BUCKETS`]; 0 for the picture alone.
    pub buckets: u32,
    /// The shortest and the longest wavelength in nm, within 360 … 830 nm and at least 1 nm apart.
    pub range: [f32; 2],
    /// By their names, at most [`SpectralFilm::MOST_BANDS`].
    pub bands: Vec<Band>,
}

/// A band of a sensor: light is measured by its response, as the integral of radiance · response over wavelengths in nm.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Its channel is `band.` and this: see [`is_channel_name`].
    pub name: String,
    /// At least 0.
    pub response: Curve,
}

impl Band {
    /// Checks its name.
    ///
    /// # Errors
    /// In words, for a name that is none.
    pub(crate) fn check_name(&self) -> Result<(), String> {
        match is_channel_name(&self.name) {
            true => Ok(()),
            false => Err(format!("{:?} is no name of a band; expected {CHANNEL_NAME}", self.name)),
        }
    }

    /// The integral of the response over a range of wavelengths, in nm.
    pub fn width(&self, range: [f32; 2]) -> f64 {
        let [mut shortest, mut longest] = range;
        let mut nodes = match &self.response {
            Curve::Constant(_) => Vec::new(),
            Curve::Tabulated { wavelengths, .. } => {
                shortest = shortest.max(wavelengths.first().copied().unwrap_or(f32::INFINITY));
                longest = longest.min(wavelengths.last().copied().unwrap_or(0.0));
                wavelengths.clone()
            }
            Curve::Blackbody { .. } => (SHORTEST..=LONGEST).map(|nm| nm as f32).collect(),
        };
        nodes.retain(|nm| *nm > shortest && *nm < longest);
        let ends =
            [shortest].into_iter().chain(nodes.iter().copied()).zip(nodes.iter().copied().chain([longest]));
        let parts = ends.filter(|(from, to)| from < to).map(|(from, to)| {
            let mean = 0.5 * (f64::from(self.response.at(from)) + f64::from(self.response.at(to)));
            mean * (f64::from(to) - f64::from(from))
        });
        parts.sum()
    }
}

impl SpectralFilm {
    /// Maximum number of buckets: one for each nm of all wavelengths.
    pub const MOST_BUCKETS: u32 = LONGEST - SHORTEST;

    /// Maximum number of bands.
    pub const MOST_BANDS: usize = 470;

    /// All wavelengths, without buckets and bands.
    pub const NONE: Self = Self { buckets: 0, range: Self::ALL, bands: Vec::new() };

    /// The wavelengths that there are, in nm.
    pub const ALL: [f32; 2] = [SHORTEST as f32, LONGEST as f32];

    /// The range that [`SpectralFilm::is_range`] allows, in words.
    pub const RANGE: &str =
        "two wavelengths from 360 to 830 nm, the second at least 1 nm longer than the first";

    /// Whether two wavelengths in nm, the shortest and the longest, are a range.
    pub fn is_range([shortest, longest]: [f32; 2]) -> bool {
        shortest >= Self::ALL[0] && longest <= Self::ALL[1] && longest - shortest >= 1.0
    }

    /// The wavelengths in nm in the middles of the buckets.
    pub fn centers(&self) -> impl Iterator<Item = f64> {
        let [shortest, longest] = self.range.map(f64::from);
        let width = (longest - shortest) / f64::from(self.buckets);
        (0..self.buckets).map(move |bucket| shortest + (f64::from(bucket) + 0.5) * width)
    }

    /// The bucket of a wavelength in nm, which is in the range. There has to be a bucket.
    pub fn bucket_of(&self, nm: f32) -> usize {
        let [shortest, longest] = self.range;
        let bucket = (nm - shortest) / (longest - shortest) * self.buckets as f32;
        (bucket as usize).min(self.buckets as usize - 1)
    }

    /// Adds a band, in the order of names.
    ///
    /// # Errors
    /// In words, for a name that is none or is there already, and for too many bands.
    pub(crate) fn add(&mut self, band: Band) -> Result<(), String> {
        band.check_name()?;
        if self.bands.len() == Self::MOST_BANDS {
            return Err(format!("more than {} bands", Self::MOST_BANDS));
        }
        match self.bands.binary_search_by(|other| other.name.cmp(&band.name)) {
            Ok(_) => Err(format!("two bands are named {:?}", band.name)),
            Err(place) => {
                self.bands.insert(place, band);
                Ok(())
            }
        }
    }

    /// Whether it measures light beside the picture.
    pub fn is_measuring(&self) -> bool {
        self.buckets > 0 || !self.bands.is_empty()
    }

    /// The film of the picture alone, with the same samples.
    #[must_use]
    pub fn of_picture(&self) -> Self {
        Self { range: self.range, ..Self::NONE }
    }
}

impl Default for SpectralFilm {
    /// The number of buckets of pbrt-v4, of all wavelengths.
    fn default() -> Self {
        Self { buckets: 16, ..Self::NONE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bucket_has_its_center_in_its_middle() {
        let all: Vec<f64> = SpectralFilm::default().centers().collect();
        assert_eq!((all.len(), all[0], all[15]), (16, 374.6875, 815.3125));
        for (buckets, range) in [(1, [400.0, 401.0]), (7, [360.0, 830.0]), (470, SpectralFilm::ALL)] {
            let film = SpectralFilm { buckets, range, ..SpectralFilm::NONE };
            let found: Vec<usize> = film.centers().map(|nm| film.bucket_of(nm as f32)).collect();
            assert_eq!(found, (0..buckets as usize).collect::<Vec<_>>());
            assert_eq!([0, buckets as usize - 1], range.map(|nm| film.bucket_of(nm)));
        }
    }

    #[test]
    fn a_band_has_the_width_of_its_response() {
        let of = |response: Curve| Band { name: "a".to_owned(), response };
        let table = |entries: &[(f32, f32)]| {
            let (wavelengths, values) = entries.iter().copied().unzip();
            of(Curve::Tabulated { wavelengths, values })
        };
        assert_eq!(of(Curve::Constant(0.5)).width([400.0, 700.0]), 150.0);
        let triangle = table(&[(500.0, 0.0), (550.0, 1.0), (600.0, 0.0)]);
        assert_eq!(triangle.width(SpectralFilm::ALL), 50.0);
        assert_eq!(triangle.width([550.0, 575.0]), 18.75);
        assert_eq!(triangle.width([600.0, 700.0]), 0.0);
        assert_eq!(table(&[(300.0, 2.0), (900.0, 2.0)]).width(SpectralFilm::ALL), 940.0);
        assert_eq!(table(&[(900.0, 2.0), (950.0, 2.0)]).width(SpectralFilm::ALL), 0.0);
        let warm = of(Curve::Blackbody { kelvin: 5000.0 });
        let sum: f64 =
            (0..4700).map(|step| f64::from(warm.response.at(360.05 + 0.1 * step as f32)) * 0.1).sum();
        assert!((warm.width(SpectralFilm::ALL) - sum).abs() < 1e-3 * sum);
    }

    #[test]
    fn a_range_is_within_all_wavelengths() {
        assert!(SpectralFilm::is_range([360.0, 830.0]) && SpectralFilm::is_range([500.0, 501.0]));
        for range in [[359.0, 830.0], [360.0, 831.0], [500.0, 500.0], [600.0, 500.0], [f32::NAN, 500.0]] {
            assert!(!SpectralFilm::is_range(range), "{range:?}");
        }
    }
}
