//! Perlin noise by its original permutation table, as in pbrt-v4.
//!
//! It repeats every 256 units, and reproduces the scenes that were made for it. New textures should use the noise
//! of the parent module.
//!
//! Perlin 2002, with pbrt's sixteen gradients (Pharr, Jakob, Humphreys 2023), four of which occur twice. pbrt omits
//! octaves that are finer than a pixel, by its ray differentials. There are none here: all octaves are summed, and
//! detail below a pixel is left to the pixel's samples.

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

/// Fractional Brownian motion: the sum of `octaves` noises, each of 1.99 times the frequency and `roughness` times
/// the amplitude of the one before.
pub fn fbm(p: Vec3, roughness: f32, octaves: u32) -> f32 {
    sum(p, roughness, octaves, |noise| noise).0
}

/// [`fbm`] of magnitudes, plus the mean of the first omitted octave, as in pbrt.
pub fn turbulence(p: Vec3, roughness: f32, octaves: u32) -> f32 {
    let (sum, next) = sum(p, roughness, octaves, f32::abs);
    sum + next * MEAN_MAGNITUDE
}

/// The sum, and the amplitude of the octave after the last.
fn sum(p: Vec3, roughness: f32, octaves: u32, shape: impl Fn(f32) -> f32) -> (f32, f32) {
    let (mut sum, mut frequency, mut strength) = (0.0, 1.0, 1.0);
    for _ in 0..octaves.min(super::MOST_OCTAVES) {
        sum += strength * shape(noise(frequency * p));
        frequency *= LACUNARITY;
        strength *= roughness;
    }
    (sum, strength)
}

#[cfg(test)]
mod tests;
