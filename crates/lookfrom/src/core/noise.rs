//! Gradient noise over three-dimensional space, and its sums over octaves.
//!
//! Perlin 1985 (gradients on a lattice, turbulence) and 2002 (the quintic fade, gradients along the edges of a
//! cube). A hash of the lattice point replaces Perlin's table, so that the pattern does not repeat every 256 units;
//! noise by the table itself is in [`perlin`].

pub mod perlin;
mod permutation;

use crate::core::hash::mix;
use glam::Vec3;
use lookfrom_simd::Real;

/// Further octaves are omitted: together they contribute less than 2⁻²³.
const MOST_OCTAVES: u32 = 24;

/// Offset of each octave's lattice from the one before, so that their zeros do not coincide.
const SHIFT: Vec3 = Vec3::new(0.374_165, 0.732_051, 0.181_981);

/// The twelve directions from the centre of a cube to its edges.
const EDGES: [Vec3; 12] = [
    Vec3::new(1.0, 1.0, 0.0),
    Vec3::new(-1.0, 1.0, 0.0),
    Vec3::new(1.0, -1.0, 0.0),
    Vec3::new(-1.0, -1.0, 0.0),
    Vec3::new(1.0, 0.0, 1.0),
    Vec3::new(-1.0, 0.0, 1.0),
    Vec3::new(1.0, 0.0, -1.0),
    Vec3::new(-1.0, 0.0, -1.0),
    Vec3::new(0.0, 1.0, 1.0),
    Vec3::new(0.0, -1.0, 1.0),
    Vec3::new(0.0, 1.0, -1.0),
    Vec3::new(0.0, -1.0, -1.0),
];

/// Gradient noise: about −1 … 1 (never beyond ±1.04), 0 on average and at points of whole coordinates, with two
/// continuous derivatives. Features are about one unit wide.
///
/// Finite for every `p`: 0 where a coordinate is not finite, and where all are too large to have fractions (beyond
/// 2²³).
pub fn noise(p: Vec3) -> f32 {
    octave(p, 0)
}

/// Fractional Brownian motion: the sum of `octaves` noises, each of twice the frequency and half the amplitude of
/// the one before. About −1 … 1, in theory less than ±2.1; 0 for no octaves. At most 24 octaves are summed.
pub fn fbm(p: Vec3, octaves: u32) -> f32 {
    sum(p, octaves, |noise| noise)
}

/// Perlin's turbulence: [`fbm`] of the magnitudes of the noises, which has creases where they are 0. Not negative,
/// in theory less than 2.1, mostly below 1.
pub fn turbulence(p: Vec3, octaves: u32) -> f32 {
    sum(p, octaves, f32::abs)
}

fn sum(p: Vec3, octaves: u32, shape: impl Fn(f32) -> f32) -> f32 {
    let (mut p, mut strength, mut sum) = (p, 1.0, 0.0);
    for index in 0..octaves.min(MOST_OCTAVES) {
        sum += strength * shape(octave(p, index));
        p = p * 2.0 + SHIFT;
        strength *= 0.5;
    }
    sum
}

/// Noise on the lattice of one octave.
fn octave(p: Vec3, octave: u32) -> f32 {
    if !p.is_finite() {
        return 0.0;
    }
    // Find the cell of the lattice and the position in it.
    let below = Vec3::from_array(p.to_array().map(floor));
    let place = p - below;
    let [x, y, z] = below.to_array().map(|x| [x as i32, (x as i32).wrapping_add(1)]);
    // Interpolate between corners, along x, then y, then z. The hashes of x and y serve two corners each.
    let [u, v, w] = place.to_array().map(fade);
    let columns = [[column(x[0], y[0]), column(x[1], y[0])], [column(x[0], y[1]), column(x[1], y[1])]];
    let mut faces = [0.0; 2];
    for (k, face) in faces.iter_mut().enumerate() {
        let mut edges = [0.0; 2];
        for (j, edge) in edges.iter_mut().enumerate() {
            // Each corner contributes a linear ramp along its gradient, 0 at the corner.
            let corner = |i: usize| {
                let offset = place - Vec3::new(i as f32, j as f32, k as f32);
                gradient(columns[j][i], z[k], octave).dot(offset)
            };
            *edge = mix_linearly(corner(0), corner(1), u);
        }
        *face = mix_linearly(edges[0], edges[1], v);
    }
    mix_linearly(faces[0], faces[1], w)
}

/// The greatest integer that is not greater; without a function call, which `f32::floor` is on most target CPUs that programs
/// are compiled for.
#[inline]
fn floor(x: f32) -> f32 {
    const WHOLE: f32 = 8_388_608.0;
    if x.abs() >= WHOLE {
        return x;
    }
    let toward_zero = x as i32 as f32;
    if toward_zero > x { toward_zero - 1.0 } else { toward_zero }
}

/// The hash of the lattice points above one of the plane.
#[inline]
fn column(x: i32, y: i32) -> u64 {
    mix(u64::from(x as u32) | u64::from(y as u32) << 32)
}

/// The gradient at a lattice point.
#[inline]
fn gradient(column: u64, z: i32, octave: u32) -> Vec3 {
    let hash = mix(column ^ (u64::from(z as u32) | u64::from(octave) << 32));
    EDGES[(((hash >> 32) * EDGES.len() as u64) >> 32) as usize]
}

/// The fade from 0 to 1 with zero first and second derivatives at both ends: 6t⁵ − 15t⁴ + 10t³.
#[inline(always)]
fn fade<R: Real>(t: R) -> R {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

#[inline(always)]
fn mix_linearly<R: Real>(a: R, b: R, share: R) -> R {
    a + share * (b - a)
}

#[cfg(test)]
mod tests;
