//! The spectral film: a range of wavelengths that are sampled uniformly, in buckets of equal width.

use crate::spectrum::{LONGEST, SHORTEST};

/// A film that sums light by wavelength beside the picture, as pbrt-v4's film of that name. It needs spectral rendering.
///
/// All wavelengths of the range have the same probability, so that the picture shows only light within it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectralFilm {
    /// Number of buckets, at most [`SpectralFilm::MOST_BUCKETS`]; 0 for the picture alone.
    pub buckets: u32,
    /// The shortest and the longest wavelength in nm, within 360 … 830 nm and at least 1 nm apart.
    pub range: [f32; 2],
}

impl SpectralFilm {
    /// Maximum number of buckets: one for each nm of all wavelengths.
    pub const MOST_BUCKETS: u32 = LONGEST - SHORTEST;

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
    pub fn centers(self) -> impl Iterator<Item = f64> {
        let [shortest, longest] = self.range.map(f64::from);
        let width = (longest - shortest) / f64::from(self.buckets);
        (0..self.buckets).map(move |bucket| shortest + (f64::from(bucket) + 0.5) * width)
    }

    /// The bucket of a wavelength in nm, which is in the range. There has to be a bucket.
    pub fn bucket_of(self, nm: f32) -> usize {
        let [shortest, longest] = self.range;
        let bucket = (nm - shortest) / (longest - shortest) * self.buckets as f32;
        (bucket as usize).min(self.buckets as usize - 1)
    }

    /// The film of the picture alone, with the same samples.
    #[must_use]
    pub fn without_buckets(self) -> Self {
        Self { buckets: 0, ..self }
    }
}

impl Default for SpectralFilm {
    /// The number of buckets of pbrt-v4, of all wavelengths.
    fn default() -> Self {
        Self { buckets: 16, range: Self::ALL }
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
            let film = SpectralFilm { buckets, range };
            let found: Vec<usize> = film.centers().map(|nm| film.bucket_of(nm as f32)).collect();
            assert_eq!(found, (0..buckets as usize).collect::<Vec<_>>());
            assert_eq!([0, buckets as usize - 1], range.map(|nm| film.bucket_of(nm)));
        }
    }

    #[test]
    fn a_range_is_within_all_wavelengths() {
        assert!(SpectralFilm::is_range([360.0, 830.0]) && SpectralFilm::is_range([500.0, 501.0]));
        for range in [[359.0, 830.0], [360.0, 831.0], [500.0, 500.0], [600.0, 500.0], [f32::NAN, 500.0]] {
            assert!(!SpectralFilm::is_range(range), "{range:?}");
        }
    }
}
