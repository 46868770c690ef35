//! AOVs: data of the first hits of a pixel (a G-buffer), in the mean over its samples.
//!
//! One accumulator for two readers. The AOVs of a picture are means over all samples; the denoiser compares means over
//! the first [`FEATURE_SAMPLES`], so that its result does not depend on whether AOVs are written. Sums of fixed-point
//! numbers, as those of light, do not depend on the order of the samples. In a tile the denoiser's take 96 bytes per pixel,
//! those of AOVs 208.

use super::pixel::{TWO_TO_64, fixed_point};
use super::stored::{Stored, Sums, channels_of, store_fields};

/// Number of samples of a pixel that count for the denoiser.
pub const FEATURE_SAMPLES: u32 = 16;

/// The first hit of one sample, or a mean over samples.
///
/// Directions and positions are in camera space: x to the right, y up, z forward, in the scene's unit; the origin is
/// lookfrom.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Aovs {
    /// Albedo: 0 … 1 in linear Rec. 709. Base colours, as in Cycles and Open Image Denoise, not an integral over
    /// directions: 1 for glass, the colour at normal incidence for a metal.
    pub albedo: [f32; 3],
    /// Geometric normal on the viewer's side, of unit length.
    pub ng: [f32; 3],
    /// Shading normal (interpolated, with bump and normal maps) on the viewer's side, of unit length.
    pub ns: [f32; 3],
    /// Position. Its z is the depth: the distance from the camera along the view axis.
    pub position: [f32; 3],
    /// Texture coordinates.
    pub uv: [f32; 2],
}

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

pub(super) const TWO_TO_32: f64 = 4_294_967_296.0;

/// Sums over the samples of a pixel. Additions wrap, after at least 2²³ of the largest values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct AovSums {
    /// Multiples of 2⁻³².
    albedo: [i64; 3],
    /// Multiples of 2⁻³².
    ns: [i64; 3],
    /// Number of samples.
    samples: u64,
    /// Number of samples with a hit.
    hits: u64,
    /// The least index of a sample with a hit; `u32::MAX` for none.
    first: u32,
    /// The bits of the geometric normal and position of that sample.
    ng: [u32; 3],
    position: [u32; 3],
}

/// Sums for the AOVs of the picture, with those that the denoiser does not need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LayerSums {
    shared: AovSums,
    /// Multiples of 2⁻³².
    ng: [i64; 3],
    /// Position, then uv: multiples of 2⁻⁶⁴, clamped as light is.
    places: [i128; 5],
}

store_fields!(AovSums {
    albedo: [i64; 3] = ["albedo.R", "albedo.G", "albedo.B"],
    ns: [i64; 3] = ["ns.X", "ns.Y", "ns.Z"],
    samples: u64 = ["samples"],
    hits: u64 = ["hits"],
    first: u32 = ["first"],
    ng: [u32; 3] = ["first_ng.X", "first_ng.Y", "first_ng.Z"],
    position: [u32; 3] = ["first_p.X", "first_p.Y", "first_p.Z"],
});

store_fields!(LayerSums {
    shared: AovSums,
    ng: [i64; 3] = ["ng.X", "ng.Y", "ng.Z"],
    places: [i128; 5] = ["p.X", "p.Y", "p.Z", "u", "v"],
});

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

impl Aovs {
    /// Albedo, geometric normal, shading normal, position, depth, texture coordinates.
    pub fn to_array(&self) -> [f32; 15] {
        let Self { albedo: [r, g, b], ng: [gx, gy, gz], ns: [sx, sy, sz], position: [x, y, z], uv: [u, v] } =
            *self;
        [r, g, b, gx, gy, gz, sx, sy, sz, x, y, z, z, u, v]
    }

    fn is_finite(&self) -> bool {
        self.to_array().into_iter().all(f32::is_finite)
    }
}

/// Adds a direction's or colour's components as multiples of 2⁻³².
fn add_narrow(sums: &mut [i64; 3], values: [f32; 3]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum = sum.wrapping_add((f64::from(value) * TWO_TO_32) as i64);
    }
}

fn merge_narrow(sums: &mut [i64; 3], others: [i64; 3]) {
    for (sum, add) in sums.iter_mut().zip(others) {
        *sum = sum.wrapping_add(add);
    }
}

impl AovSums {
    /// Sums over samples of which none is the first with a hit.
    pub(super) fn of(samples: u64, hits: u64, albedo: [i64; 3], ns: [i64; 3]) -> Self {
        Self { albedo, ns, samples, hits, ..Self::default() }
    }

    /// Adds the first hit of a sample, `None` for a miss; one that is not finite counts as a miss.
    pub(super) fn add(&mut self, sample: u32, met: Option<&Aovs>) {
        self.samples = self.samples.saturating_add(1);
        met.into_iter().for_each(|aovs| self.add_hit(sample, aovs));
    }

    /// Adds the hit of a sample that has been counted.
    pub(super) fn add_hit(&mut self, sample: u32, aovs: &Aovs) {
        if !aovs.is_finite() {
            return;
        }
        self.hits = self.hits.saturating_add(1);
        add_narrow(&mut self.albedo, aovs.albedo.map(|c| c.clamp(0.0, 1.0)));
        add_narrow(&mut self.ns, aovs.ns.map(|c| c.clamp(-1.0, 1.0)));
        self.note_first(sample, aovs);
    }

    /// Notes a finite hit if it is that of the first sample with one.
    pub(super) fn note_first(&mut self, sample: u32, aovs: &Aovs) {
        if sample < self.first {
            self.first = sample;
            (self.ng, self.position) = (aovs.ng.map(f32::to_bits), aovs.position.map(f32::to_bits));
        }
    }

    pub(super) fn merge(&mut self, other: &Self) {
        merge_narrow(&mut self.albedo, other.albedo);
        merge_narrow(&mut self.ns, other.ns);
        self.samples = self.samples.saturating_add(other.samples);
        self.hits = self.hits.saturating_add(other.hits);
        if other.first < self.first {
            (self.first, self.ng, self.position) = (other.first, other.ng, other.position);
        }
    }

    /// The denoiser features; `None` where there are no samples.
    pub(super) fn features(&self) -> Option<DenoiserFeatures> {
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
    /// Sums for AOVs, with those that the denoiser needs, too.
    pub(super) fn of(shared: AovSums, ng: [i64; 3], places: [i128; 5]) -> Self {
        Self { shared, ng, places }
    }

    /// The sums that the denoiser needs, too.
    pub(super) fn shared(&self) -> &AovSums {
        &self.shared
    }

    /// As [`AovSums::add`].
    pub(super) fn add(&mut self, sample: u32, met: Option<&Aovs>) {
        self.shared.samples = self.shared.samples.saturating_add(1);
        met.into_iter().for_each(|aovs| self.add_hit(sample, aovs));
    }

    /// As [`AovSums::add_hit`].
    pub(super) fn add_hit(&mut self, sample: u32, aovs: &Aovs) {
        if !aovs.is_finite() {
            return;
        }
        self.shared.add_hit(sample, aovs);
        add_narrow(&mut self.ng, aovs.ng.map(|c| c.clamp(-1.0, 1.0)));
        for (sum, value) in self.places.iter_mut().zip(aovs.position.iter().chain(&aovs.uv)) {
            *sum = sum.wrapping_add(fixed_point(*value));
        }
    }

    /// As [`AovSums::note_first`].
    pub(super) fn note_first(&mut self, sample: u32, aovs: &Aovs) {
        self.shared.note_first(sample, aovs);
    }

    pub(super) fn merge(&mut self, other: &Self) {
        self.shared.merge(&other.shared);
        merge_narrow(&mut self.ng, other.ng);
        for (sum, add) in self.places.iter_mut().zip(other.places) {
            *sum = sum.wrapping_add(add);
        }
    }

    /// The mean; `None` where no sample has a hit. The albedo is over all samples (a miss is black), as the picture is;
    /// all others are over the samples with a hit, as in pbrt's `gbuffer` film. A mean of normals is normalised; where
    /// they cancel, it is 0.
    pub(super) fn mean(&self) -> Option<Aovs> {
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
