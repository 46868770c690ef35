//! The layout of a film, its sums besides those of light: by the settings of a picture, or by the channels of a film's file.

use std::fmt;

use lookfrom_scene::settings::{Background, ImageSettings, Layers, PixelBounds};

use super::buckets::BucketSums;
use super::light_paths::LightPathSums;
use super::motion::MotionSums;
use super::pixel::Pixel;
use super::stored::{Stored, Sums, channels_of};
use super::weighted::WeightSums;
use crate::aov::{AovSums, LayerSums};

/// The kinds of sums that a film or tile has besides light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Layout {
    pub(super) alpha: bool,
    /// Filter weights, of a filter with negative lobes.
    pub(super) weights: bool,
    pub(super) aovs: bool,
    /// Motion vectors.
    pub(super) motion: bool,
    /// Variances in the channels of a sensor that does not measure X, Y and Z.
    pub(super) sensor: bool,
    /// Denoiser features.
    pub(super) features: bool,
    /// Number of layers of light-path expressions.
    pub(super) light_paths: usize,
    /// Number of buckets of a spectral film, and of its bands.
    pub(super) buckets: usize,
}

/// Prefixes of the names of channels.
const ALPHA: &str = "film.alpha";
const WEIGHTS: &str = "film.weight";
const UNSIGNED_ALPHA: &str = "film.unsigned_alpha";
const AOVS: &str = "film.aov";
const SENSOR: &str = "film.sensor";
const FEATURES: &str = "film.feature";
const MOTION: &str = "film.motion";

fn unsigned_light(index: usize) -> String {
    format!("film.unsigned_light.{index}")
}

fn unsigned_bucket(index: usize) -> String {
    format!("film.unsigned_bucket.{index}")
}

fn light_path(index: usize) -> String {
    format!("film.light_path.{index}")
}

fn bucket(index: usize) -> String {
    format!("film.bucket.{index}")
}

/// The names of the channels of the sensor's sums, a [`Pixel`] each.
fn sensor_channels() -> Vec<String> {
    let sums = channels_of(SENSOR, &["sum.0", "sum.1", "sum.2"], <[i128; 3]>::WORDS);
    let squares = channels_of(SENSOR, &["square.0", "square.1", "square.2"], <[u128; 3]>::WORDS);
    [sums, squares, channels_of(SENSOR, &["samples"], u64::WORDS)].concat()
}

impl Layout {
    /// The layout for these settings.
    pub(super) fn of_image(image: &ImageSettings) -> Self {
        let aovs = image.layers != Layers::None;
        Self {
            motion: image.layers == Layers::Motion,
            alpha: image.background != Background::Environment,
            weights: image.filter.shape.has_negative_lobes(),
            aovs,
            sensor: aovs && !image.sensor.measures_xyz(),
            features: image.denoise,
            light_paths: image.light_paths.len(),
            buckets: image.spectral_film.as_ref().map_or(0, |film| film.buckets as usize + film.bands.len()),
        }
    }

    /// The layout of the film of a file that has these channels of integers, and perhaps others.
    pub(crate) fn of_channels(names: &[&str]) -> Self {
        let has = |prefix: &str| {
            names.iter().any(|name| name.strip_prefix(prefix).is_some_and(|rest| rest.starts_with('.')))
        };
        Self {
            alpha: has(ALPHA),
            weights: has(WEIGHTS),
            aovs: has(AOVS),
            sensor: has(SENSOR),
            features: has(FEATURES),
            motion: has(MOTION),
            light_paths: (0..).take_while(|&index| has(&light_path(index))).count(),
            buckets: (0..).take_while(|&index| has(&bucket(index))).count(),
        }
    }

    /// Whether there are squares of alpha: for its variance, which the denoiser needs.
    pub(super) fn alpha_squares(self) -> bool {
        self.alpha && self.features
    }

    /// Whether there are sums of alpha with the magnitudes of weights.
    pub(super) fn unsigned_alphas(self) -> bool {
        self.weights && self.alpha
    }

    /// The number of sums of light with the magnitudes of weights.
    pub(super) fn unsigned_light(self) -> usize {
        if self.weights { 1 + self.light_paths } else { 0 }
    }

    /// The number of sums of buckets with the magnitudes of weights.
    pub(super) fn unsigned_buckets(self) -> usize {
        if self.weights { self.buckets } else { 0 }
    }

    /// The names of the channels of a file, in the order of its sums.
    pub(crate) fn channels(self) -> Vec<String> {
        let mut names = Pixel::channels("film");
        let mut add = |has: bool, channels: Vec<String>| names.extend(channels.into_iter().filter(|_| has));
        add(self.alpha, i128::channels(ALPHA));
        add(self.alpha_squares(), u128::channels(ALPHA));
        add(self.weights, WeightSums::channels(WEIGHTS));
        add(self.unsigned_alphas(), i128::channels(UNSIGNED_ALPHA));
        (0..self.unsigned_light())
            .for_each(|index| add(true, LightPathSums::channels(&unsigned_light(index))));
        (0..self.unsigned_buckets()).for_each(|index| add(true, i128::channels(&unsigned_bucket(index))));
        add(self.sensor, sensor_channels());
        add(self.aovs, LayerSums::channels(AOVS));
        add(self.features, AovSums::channels(FEATURES));
        add(self.motion, MotionSums::channels(MOTION));
        (0..self.light_paths).for_each(|index| add(true, LightPathSums::channels(&light_path(index))));
        (0..self.buckets).for_each(|index| add(true, BucketSums::channels(&bucket(index))));
        names
    }

    /// The bytes of a film of this layout, which has an area of a picture, with those that are needed at the same time to
    /// develop and encode the picture: an estimate, by what was measured (docs/benchmarks/memory.md).
    pub(super) fn memory(self, [width, height]: [u32; 2], area: PixelBounds) -> u64 {
        /// Bytes of a pixel of the film's area.
        const LIGHT: u64 = 55;
        const AOVS: u64 = 120;
        const FEATURES: u64 = 65;
        const DENOISER: u64 = 10;
        const ALPHA: u64 = 20;
        const WEIGHT: u64 = 45;
        const MOTION: u64 = 25;
        const LIGHT_PATHS: u64 = 30;
        const BUCKET: u64 = 12;
        /// Bytes of a pixel of the picture, in which a crop has its place.
        const DEVELOPED: u64 = 30;
        const OPACITY: u64 = 6;
        let summed = LIGHT
            + u64::from(self.aovs) * AOVS
            + u64::from(self.features) * (FEATURES + DENOISER)
            + u64::from(self.alpha) * ALPHA
            + self.unsigned_light() as u64 * WEIGHT
            + u64::from(self.motion) * MOTION
            + self.light_paths as u64 * LIGHT_PATHS
            + (self.buckets + self.unsigned_buckets()) as u64 * BUCKET;
        let developed = DEVELOPED + u64::from(self.alpha) * OPACITY;
        let picture = u64::from(width) * u64::from(height);
        area.pixels().saturating_mul(summed).saturating_add(picture.saturating_mul(developed))
    }
}

impl fmt::Display for Layout {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kinds = [
            ("alpha", self.alpha),
            ("filter weights", self.weights),
            ("AOVs", self.aovs),
            ("variances in the sensor's channels", self.sensor),
            ("denoiser features", self.features),
            ("motion vectors", self.motion),
        ];
        formatter.write_str("light")?;
        for (kind, _) in kinds.iter().filter(|(_, has)| *has) {
            write!(formatter, " and {kind}")?;
        }
        match self.light_paths {
            0 => {}
            1 => formatter.write_str(" and 1 layer of light paths")?,
            count => write!(formatter, " and {count} layers of light paths")?,
        }
        match self.buckets {
            0 => Ok(()),
            1 => formatter.write_str(" and 1 spectral bucket"),
            count => write!(formatter, " and {count} spectral buckets"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_tell_the_layout() {
        for bits in 0..384 {
            let has = |bit: u32| bits >> bit & 1 != 0;
            let [alpha, aovs, sensor, features, motion, weights] = [0, 1, 2, 3, 4, 5].map(has);
            let layout = Layout {
                alpha,
                weights,
                aovs,
                motion,
                sensor,
                features,
                light_paths: bits as usize / 64 % 3,
                buckets: bits as usize / 192 * 12,
            };
            let channels = layout.channels();
            let mut names: Vec<&str> = channels.iter().map(String::as_str).collect();
            names.sort_unstable();
            assert_eq!(Layout::of_channels(&names), layout);
        }
    }
}
