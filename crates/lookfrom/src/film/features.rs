//! What does a camera see first in a pixel: the layers beside the picture, in the mean over its samples.
//!
//! Sums of fixed-point numbers, as those of light, so that they do not depend on the order of the samples. A pixel takes
//! 176 bytes. What the layers are called in a file is left to who writes it.

/// What the ray of one sample met first, or the mean over the samples of a pixel.
///
/// In the mean, the albedo is over all samples of the pixel (nothing is black), as the picture is; all else is over those
/// that met something, as pbrt's `gbuffer` film has it. A mean of normals is made as long as one of them again; where they
/// cancel, it is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Features {
    /// The share of light that the surface throws back, by channel: 0 … 1.
    pub albedo: [f32; 3],
    /// Geometric normal on the viewer's side, in the camera's space, of unit length.
    pub ng: [f32; 3],
    /// Shading normal (smoothed, bent by bumps and normal maps where the integrator shades with them) on the viewer's side, in
    /// the camera's space, of unit length.
    pub ns: [f32; 3],
    /// The point, in the camera's space: x to the right, y up, z ahead, in the scene's unit.
    pub position: [f32; 3],
    /// Distance from the eye along the view axis, in the scene's unit.
    pub depth: f32,
    /// The surface's coordinates.
    pub uv: [f32; 2],
}

/// Beyond this a direction's or colour's component is cut.
const MOST_OF_UNIT: f32 = 4.0;

/// Beyond this a place's coordinate is cut: 2⁴⁰.
const FARTHEST: f32 = 1_099_511_627_776.0;

const TWO_TO_32: f64 = 4_294_967_296.0;
const TWO_TO_64: f64 = TWO_TO_32 * TWO_TO_32;

/// Sums over the samples of a pixel. Additions wrap, after no less than 2²³ of the greatest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct FeatureSums {
    /// Position, depth, uv: multiples of 2⁻⁶⁴.
    wide: [i128; 6],
    /// Albedo, ng, ns: multiples of 2⁻³².
    narrow: [i64; 9],
    /// How many were added.
    samples: u64,
}

impl Features {
    /// Albedo, geometric normal, shading normal, position, depth, surface coordinates.
    pub fn to_array(&self) -> [f32; 15] {
        let Self {
            albedo: [r, g, b],
            ng: [gx, gy, gz],
            ns: [sx, sy, sz],
            position: [x, y, z],
            depth,
            uv: [u, v],
        } = *self;
        [r, g, b, gx, gy, gz, sx, sy, sz, x, y, z, depth, u, v]
    }
}

impl FeatureSums {
    pub(super) fn add(&mut self, features: &Features) {
        let values = features.to_array();
        if !values.iter().all(|value| value.is_finite()) {
            return;
        }
        let (narrow, wide) = values.split_at(self.narrow.len());
        for (sum, value) in self.narrow.iter_mut().zip(narrow) {
            let value = f64::from(value.clamp(-MOST_OF_UNIT, MOST_OF_UNIT)) * TWO_TO_32;
            *sum = sum.wrapping_add(value as i64);
        }
        for (sum, value) in self.wide.iter_mut().zip(wide) {
            let value = f64::from(value.clamp(-FARTHEST, FARTHEST)) * TWO_TO_64;
            *sum = sum.wrapping_add(value as i128);
        }
        self.samples = self.samples.saturating_add(1);
    }

    pub(super) fn merge(&mut self, other: &Self) {
        for (sum, add) in self.narrow.iter_mut().zip(other.narrow) {
            *sum = sum.wrapping_add(add);
        }
        for (sum, add) in self.wide.iter_mut().zip(other.wide) {
            *sum = sum.wrapping_add(add);
        }
        self.samples = self.samples.saturating_add(other.samples);
    }

    /// The mean, where there is one; `all` is the number of the pixel's samples.
    pub(super) fn mean(&self, all: u64) -> Option<Features> {
        if self.samples == 0 {
            return None;
        }
        let met = self.samples as f64;
        let [r, g, b, ..] =
            self.narrow.map(|sum| (sum as f64 / (all.max(self.samples) as f64 * TWO_TO_32)) as f32);
        let [_, _, _, ng @ .., sx, sy, sz] = self.narrow.map(|sum| sum as f64 / TWO_TO_32);
        let [x, y, z, depth, u, v] = self.wide.map(|sum| (sum as f64 / (met * TWO_TO_64)) as f32);
        Some(Features {
            albedo: [r, g, b],
            ng: unit(ng),
            ns: unit([sx, sy, sz]),
            position: [x, y, z],
            depth,
            uv: [u, v],
        })
    }
}

/// The vector of unit length in this direction; 0 where there is none.
fn unit(v: [f64; 3]) -> [f32; 3] {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 { v.map(|x| (x / length) as f32) } else { [0.0; 3] }
}
