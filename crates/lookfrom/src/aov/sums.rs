//! Sums of AOVs over the samples of a pixel, and their means.
//!
//! One accumulator for two readers. The AOVs of a picture are means over all samples; the denoiser compares means over
//! the first [`FEATURE_SAMPLES`], so that its result does not depend on whether AOVs are written. Sums of fixed-point
//! numbers, as those of light, do not depend on the order of the samples. In a tile the denoiser's take 96 bytes per pixel,
//! those of AOVs 208.

use super::Aovs;
use crate::core::fixed_point::{TWO_TO_32, TWO_TO_64, fixed_point};

/// Number of samples of a pixel that count for the denoiser.
pub const FEATURE_SAMPLES: u32 = 16;

/// The features by which the denoiser compares pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DenoiserFeatures {
    /// The mean albedo, in which a miss is white, and the mean of the shading normals, in which it is 0; the geometric
    /// normal and the position of the first sample with a hit, 0 if there is none. No uv.
    pub aovs: Aovs,
    /// Number of samples.
    pub samples: u64,
    /// The fraction of them with a hit: 0 … 1.
    pub coverage: f32,
}

/// Sums over the samples of a pixel. Additions wrap, after at least 2²³ of the largest values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct AovSums {
    /// Multiples of 2⁻³².
    pub(crate) albedo: [i64; 3],
    /// Multiples of 2⁻³².
    pub(crate) ns: [i64; 3],
    /// Number of samples.
    pub(crate) samples: u64,
    /// Number of samples with a hit.
    pub(crate) hits: u64,
    /// The least index of a sample with a hit; `u32::MAX` for none.
    pub(crate) first: u32,
    /// The bits of the geometric normal and position of that sample.
    pub(crate) ng: [u32; 3],
    pub(crate) position: [u32; 3],
}

/// Sums for the AOVs of the picture, with those that the denoiser does not need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LayerSums {
    /// The sums that the denoiser needs, too.
    pub(crate) shared: AovSums,
    /// Multiples of 2⁻³².
    pub(crate) ng: [i64; 3],
    /// Position, then uv: multiples of 2⁻⁶⁴, clamped as light is.
    pub(crate) places: [i128; 5],
}

impl Default for AovSums {
    fn default() -> Self {
        Self {
            albedo: [0; 3],
            ns: [0; 3],
            samples: 0,
            hits: 0,
            first: u32::MAX,
            ng: [0; 3],
            position: [0; 3],
        }
    }
}

/// The components of a direction or colour as multiples of 2⁻³².
fn narrow(values: [f32; 3], least: f32) -> [i64; 3] {
    values.map(|value| (f64::from(value.clamp(least, 1.0)) * TWO_TO_32) as i64)
}

fn merge_narrow(sums: &mut [i64; 3], others: [i64; 3]) {
    for (sum, add) in sums.iter_mut().zip(others) {
        *sum = sum.wrapping_add(add);
    }
}

impl AovSums {
    /// No sums, but what only the first sample with a hit has.
    pub(super) fn of_first(sample: u32, ng: [f32; 3], position: [f32; 3]) -> Self {
        let [ng, position] = [ng, position].map(|numbers| numbers.map(f32::to_bits));
        Self { first: sample, ng, position, ..Self::default() }
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        merge_narrow(&mut self.albedo, other.albedo);
        merge_narrow(&mut self.ns, other.ns);
        self.samples = self.samples.saturating_add(other.samples);
        self.hits = self.hits.saturating_add(other.hits);
        if other.first < self.first {
            (self.first, self.ng, self.position) = (other.first, other.ng, other.position);
        }
    }

    /// The denoiser features; `None` where there are no samples.
    pub(crate) fn features(&self) -> Option<DenoiserFeatures> {
        if self.samples == 0 {
            return None;
        }
        let scale = 1.0 / (self.samples as f64 * TWO_TO_32);
        let misses = (self.samples - self.hits) as f64 * TWO_TO_32;
        let aovs = Aovs {
            albedo: self.albedo.map(|sum| ((sum as f64 + misses) * scale) as f32),
            ns: self.ns.map(|sum| (sum as f64 * scale) as f32),
            ng: self.ng.map(f32::from_bits),
            position: self.position.map(f32::from_bits),
            uv: [0.0; 2],
        };
        let coverage = self.hits as f32 / self.samples as f32;
        Some(DenoiserFeatures { aovs, samples: self.samples, coverage })
    }
}

impl LayerSums {
    /// The sums of a hit, without its sample; none if it is not finite.
    pub(super) fn of_hit(sample: u32, aovs: &Aovs) -> Self {
        if !aovs.is_finite() {
            return Self::default();
        }
        let Aovs { albedo, ng, ns, position: [x, y, z], uv: [u, v] } = *aovs;
        let first = AovSums::of_first(sample, ng, aovs.position);
        Self {
            shared: AovSums { albedo: narrow(albedo, 0.0), ns: narrow(ns, -1.0), hits: 1, ..first },
            ng: narrow(ng, -1.0),
            places: [x, y, z, u, v].map(fixed_point),
        }
    }

    /// The sums of a sample by its first hit, `None` for a miss; one that is not finite counts as a miss.
    pub(crate) fn of_sample(sample: u32, met: Option<&Aovs>) -> Self {
        let mut sums = met.map_or_else(Self::default, |aovs| Self::of_hit(sample, aovs));
        sums.shared.samples = 1;
        sums
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        self.shared.merge(&other.shared);
        merge_narrow(&mut self.ng, other.ng);
        for (sum, add) in self.places.iter_mut().zip(other.places) {
            *sum = sum.wrapping_add(add);
        }
    }

    /// The mean; `None` where no sample has a hit. The albedo is over all samples (a miss is black), as the picture is;
    /// all others are over the samples with a hit, as in pbrt's `gbuffer` film. A mean of normals is normalised; where
    /// they cancel, it is 0.
    pub(crate) fn mean(&self) -> Option<Aovs> {
        let AovSums { albedo, ns, samples, hits, .. } = self.shared;
        if hits == 0 {
            return None;
        }
        let [x, y, z, u, v] = self.places.map(|sum| (sum as f64 / (hits as f64 * TWO_TO_64)) as f32);
        Some(Aovs {
            albedo: albedo.map(|sum| (sum as f64 / (samples as f64 * TWO_TO_32)) as f32),
            ng: unit(self.ng),
            ns: unit(ns),
            position: [x, y, z],
            uv: [u, v],
        })
    }
}

/// The unit vector in this direction; 0 for the zero vector.
fn unit(sums: [i64; 3]) -> [f32; 3] {
    let v = sums.map(|sum| sum as f64 / TWO_TO_32);
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 { v.map(|x| (x / length) as f32) } else { [0.0; 3] }
}
