//! Perlin noise by its original permutation table, as in pbrt-v4.
//!
//! It repeats every 256 units, and reproduces the scenes that were made for it. New textures should use the noise
//! of the parent module.
//!
//! Perlin 2002, with pbrt's sixteen gradients (Pharr, Jakob, Humphreys 2023), four of which occur twice.

mod lanes;

use glam::Vec3;

pub(crate) use lanes::{fbms, gradients};

use super::permutation::PERMUTATION;
use super::{EDGES, fade, mix_linearly};

/// Ratio of frequencies of successive octaves: not quite two, so that their zeros do not coincide.
pub const LACUNARITY: f32 = 1.99;

/// The mean magnitude of noise assumed by pbrt.
const MEAN_MAGNITUDE: f32 = 0.2;

/// The gradients at lattice points: all edge directions, four of them twice.
const GRADIENTS: [Vec3; 16] = {
    let mut gradients = [Vec3::ZERO; 16];
    let mut index = 0;
    while index < EDGES.len() {
        gradients[index] = EDGES[index];
        index += 1;
    }
    gradients[12] = EDGES[0];
    gradients[13] = EDGES[1];
    gradients[14] = EDGES[10];
    gradients[15] = EDGES[11];
    gradients
};

/// Gradient noise: about −1 … 1, 0 at points of whole coordinates. Finite for every `p`: 0 where a coordinate is
/// not finite.
pub fn noise(p: Vec3) -> f32 {
    if !p.is_finite() {
        return 0.0;
    }
    // Find the cell of the lattice, modulo 256, and the position in it.
    let floor = Vec3::from_array(p.to_array().map(super::floor));
    let place = p - floor;
    let [x, y, z] = floor.to_array().map(|x| x as i64 as u8);
    // Each corner contributes a linear ramp along its gradient, 0 at the corner.
    let shuffled = |index: u8| PERMUTATION[usize::from(index)];
    let columns = [shuffled(x), shuffled(x.wrapping_add(1))];
    let corner = |i: u8, j: u8, k: u8| {
        let row = shuffled(columns[usize::from(i)].wrapping_add(y).wrapping_add(j));
        let hash = shuffled(row.wrapping_add(z).wrapping_add(k));
        let away = place - Vec3::new(f32::from(i), f32::from(j), f32::from(k));
        GRADIENTS[usize::from(hash % 16)].dot(away)
    };
    // Interpolate between corners, along x, then y, then z.
    let [u, v, w] = place.to_array().map(fade);
    let edge = |j, k| mix_linearly(corner(0, j, k), corner(1, j, k), u);
    let face = |k| mix_linearly(edge(0, k), edge(1, k), v);
    mix_linearly(face(0), face(1), w)
}

/// The octaves of noise that are summed: those that are not much finer than a pixel, as in pbrt-v4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Octaves {
    /// All that there are.
    all: u32,
    /// The octaves that are whole.
    whole: u32,
    /// The share of the next one.
    next: f32,
}

impl Octaves {
    /// The octaves whose detail is not finer than a width, in units of the noise: all for 0.
    pub fn new(all: u32, detail: f32) -> Self {
        let all = all.min(super::MOST_OCTAVES);
        if !(detail > 0.0) {
            return Self { all, whole: all, next: 0.0 };
        }
        // The n-th octave has a period of about 2⁻ⁿ; from half of that on it is left out.
        let count = (-1.0 - libm::log2f(detail)).clamp(0.0, all as f32);
        let share = ((count - count.floor() - 0.3) / 0.4).clamp(0.0, 1.0);
        Self { all, whole: count as u32, next: share * share * (3.0 - 2.0 * share) }
    }
}

impl From<u32> for Octaves {
    /// All of them.
    fn from(all: u32) -> Self {
        Self::new(all, 0.0)
    }
}

/// Fractional Brownian motion: the sum of octaves of noise, each of 1.99 times the frequency and `roughness` times the amplitude of the one
/// before.
pub fn fbm(p: Vec3, roughness: f32, octaves: impl Into<Octaves>) -> f32 {
    let octaves = octaves.into();
    let Sum { sum, frequency, strength } = Sum::new(p, roughness, octaves.whole, |noise| noise);
    if octaves.next == 0.0 { sum } else { sum + strength * octaves.next * noise(frequency * p) }
}

/// [`fbm`] of magnitudes, plus the mean of the first omitted octave after all, as in pbrt. Octaves that are left out have their mean, too.
pub fn turbulence(p: Vec3, roughness: f32, octaves: impl Into<Octaves>) -> f32 {
    let octaves = octaves.into();
    let Sum { mut sum, frequency, mut strength } = Sum::new(p, roughness, octaves.whole, f32::abs);
    let next = match octaves.next {
        0.0 => MEAN_MAGNITUDE,
        share => MEAN_MAGNITUDE * (1.0 - share) + noise(frequency * p).abs() * share,
    };
    sum += strength * next;
    for _ in octaves.whole..octaves.all {
        sum += strength * MEAN_MAGNITUDE;
        strength *= roughness;
    }
    sum
}

/// A sum of octaves, and the frequency and amplitude of the octave after the last.
struct Sum {
    sum: f32,
    frequency: f32,
    strength: f32,
}

impl Sum {
    fn new(p: Vec3, roughness: f32, octaves: u32, shape: impl Fn(f32) -> f32) -> Self {
        let mut sum = Self { sum: 0.0, frequency: 1.0, strength: 1.0 };
        for _ in 0..octaves {
            sum.sum += sum.strength * shape(noise(sum.frequency * p));
            sum.frequency *= LACUNARITY;
            sum.strength *= roughness;
        }
        sum
    }
}

#[cfg(test)]
mod tests;
