//! What the denoiser is told of a pixel besides its light: what the camera's first rays met there.
//!
//! The layers of [`super::features`] say the same to others, better and at a price: here albedo is one look-up of a colour,
//! and only the first [`GUIDED_SAMPLES`] samples of a pixel are asked. Sums of whole numbers, so that they do not depend on the
//! order of the samples; where a place is needed, that of the first sample that met something is the pixel's. A pixel takes
//! 80 bytes.

use super::TWO_TO_48;

/// How many samples of a pixel are asked what they met.
pub const GUIDED_SAMPLES: u32 = 16;

/// What the camera's ray of one sample met, or the mean over a pixel's samples. Directions and places are in one space, whichever.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Guide {
    /// What the surface multiplies light by, more or less: 0 … 1 by channel. The mean is over all samples that were asked; nothing
    /// is white.
    pub albedo: [f32; 3],
    /// The normal that is shaded with, of unit length. The mean is over all samples that were asked; nothing has none.
    pub n: [f32; 3],
    /// The surface's normal as it stands, of unit length: in the mean, of the first that met something; 0 for nothing.
    pub ng: [f32; 3],
    /// The point: in the mean, of the first that met something; 0 for nothing.
    pub place: [f32; 3],
}

/// The mean over the samples of a pixel that were asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanGuide {
    /// What they met.
    pub guide: Guide,
    /// How many were asked.
    pub samples: u32,
    /// The share of them that met something: 0 … 1.
    pub coverage: f32,
}

/// Sums over the first samples of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct GuideSums {
    /// Multiples of 2⁻¹⁶.
    albedo: [u32; 3],
    /// Multiples of 2⁻¹⁶.
    n: [i32; 3],
    /// How many were asked.
    samples: u32,
    /// How many of them met something.
    hits: u32,
    /// The least number of a sample that met something; `u32::MAX` for none.
    first: u32,
    /// The bits of that one's normal and place.
    ng: [u32; 3],
    place: [u32; 3],
    /// Of *all* samples, the sum of squares of how much they hide of what is behind: multiples of 2⁻⁴⁸.
    alpha_squares: u128,
}

impl Default for GuideSums {
    fn default() -> Self {
        Self {
            albedo: [0; 3],
            n: [0; 3],
            samples: 0,
            hits: 0,
            first: u32::MAX,
            ng: [0; 3],
            place: [0; 3],
            alpha_squares: 0,
        }
    }
}

const TWO_TO_16: f32 = 65536.0;

impl GuideSums {
    /// Adds what one sample met; where not all is finite, nothing.
    pub(super) fn add(&mut self, sample: u32, met: Option<&Guide>) {
        let is_finite = |guide: &&Guide| {
            let Guide { albedo, n, ng, place } = guide;
            [albedo, n, ng, place].into_iter().flatten().all(|value| value.is_finite())
        };
        let met = met.filter(is_finite);
        self.samples = self.samples.saturating_add(1);
        let albedo = met.map_or([1.0; 3], |guide| guide.albedo);
        for (sum, value) in self.albedo.iter_mut().zip(albedo) {
            *sum = sum.wrapping_add((value.clamp(0.0, 1.0) * TWO_TO_16) as u32);
        }
        let Some(guide) = met else { return };
        self.hits = self.hits.saturating_add(1);
        for (sum, value) in self.n.iter_mut().zip(guide.n) {
            *sum = sum.wrapping_add((value.clamp(-1.0, 1.0) * TWO_TO_16) as i32);
        }
        if sample < self.first {
            self.first = sample;
            (self.ng, self.place) = (guide.ng.map(f32::to_bits), guide.place.map(f32::to_bits));
        }
    }

    /// Adds the square, in multiples of 2⁻⁴⁸, of how much one sample hides.
    pub(super) fn add_alpha_square(&mut self, square: u128) {
        self.alpha_squares = self.alpha_squares.saturating_add(square);
    }

    pub(super) fn merge(&mut self, other: &Self) {
        for (sum, add) in self.albedo.iter_mut().zip(other.albedo) {
            *sum = sum.wrapping_add(add);
        }
        for (sum, add) in self.n.iter_mut().zip(other.n) {
            *sum = sum.wrapping_add(add);
        }
        self.samples = self.samples.saturating_add(other.samples);
        self.hits = self.hits.saturating_add(other.hits);
        if other.first < self.first {
            (self.first, self.ng, self.place) = (other.first, other.ng, other.place);
        }
        self.add_alpha_square(other.alpha_squares);
    }

    /// The mean; `None` where none was asked.
    pub(super) fn mean(&self) -> Option<MeanGuide> {
        if self.samples == 0 {
            return None;
        }
        let scale = 1.0 / (self.samples as f32 * TWO_TO_16);
        let guide = Guide {
            albedo: self.albedo.map(|sum| sum as f32 * scale),
            n: self.n.map(|sum| sum as f32 * scale),
            ng: self.ng.map(f32::from_bits),
            place: self.place.map(f32::from_bits),
        };
        let coverage = self.hits as f32 / self.samples as f32;
        Some(MeanGuide { guide, samples: self.samples, coverage })
    }

    /// The mean of the squares of how much each of a pixel's `samples` hides.
    pub(super) fn alpha_square(&self, samples: u64) -> f64 {
        self.alpha_squares as f64 / (samples.max(1) as f64 * TWO_TO_48)
    }
}
