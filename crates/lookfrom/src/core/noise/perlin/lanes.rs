//! Perlin noise at points side by side. [`noise`](super::noise) of one point looks gradients up; here they are made by selection.

use lookfrom_simd::{Bits, Float, Real};

use super::super::permutation::PERMUTATION;
use super::super::{fade, mix_linearly};
use super::LACUNARITY;
use crate::core::vector::Vector;

/// The permuted numbers of an index and of the next one: the first plus 256 times the second.
static PAIRS: [f32; 256] = {
    let mut pairs = [0.0; 256];
    let mut index = 0;
    while index < 256 {
        let [first, second] = [PERMUTATION[index], PERMUTATION[(index + 1) % 256]];
        pairs[index] = (first as u16 | (second as u16) << 8) as f32;
        index += 1;
    }
    pairs
};

/// The gradients of the noise, by differences over 0.01, as in pbrt.
#[inline(always)]
pub(crate) fn gradients<R: Real>(p: Vector<R>) -> Vector<R> {
    const STEP: f32 = 0.01;
    let here = noises(p);
    let Vector { x, y, z } = p;
    let [x, y, z] = [Vector { x: x + STEP, ..p }, Vector { y: y + STEP, ..p }, Vector { z: z + STEP, ..p }];
    Vector { x: (noises(x) - here) / STEP, y: (noises(y) - here) / STEP, z: (noises(z) - here) / STEP }
}

/// As [`fbm`](super::fbm).
#[inline(always)]
pub(crate) fn fbms<R: Real>(p: Vector<R>, roughness: f32, octaves: u32) -> R {
    let (mut sum, mut frequency, mut strength) = (p.x.like(0.0), 1.0, 1.0);
    for _ in 0..octaves {
        sum = sum + noises(p * p.x.like(frequency)) * strength;
        frequency *= LACUNARITY;
        strength *= roughness;
    }
    sum
}

/// As [`noise`](super::noise).
#[inline(always)]
pub(super) fn noises<R: Real>(p: Vector<R>) -> R {
    // Find the cells of the lattice, modulo 256, and the positions in them.
    let below = Vector { x: p.x.floor(), y: p.y.floor(), z: p.z.floor() };
    let place = p - below;
    let beyond = place - Vector::splat(p.x, [1.0; 3]);
    let [x, y, z] = [modulo_256(below.x), modulo_256(below.y), modulo_256(below.z)];
    // The hashes of x and y serve two corners each.
    let [left, right] = pair::<R>(x);
    let [left, right] = [pair::<R>(left.wrapping_add(y)), pair::<R>(right.wrapping_add(y))];
    // Interpolate between corners, along x, then y, then z.
    let [u, v, w] = [fade(place.x), fade(place.y), fade(place.z)];
    let [low, high] = [[place.z, beyond.z], [place.y, beyond.y]];
    let x = [place.x, beyond.x];
    let first = edges([left[0], right[0]], z, (x, high[0], low), u);
    let second = edges([left[1], right[1]], z, (x, high[1], low), u);
    let noise = mix_linearly(mix_linearly(first[0], second[0], v), mix_linearly(first[1], second[1], v), w);
    let is_finite = p.x.is_finite() & p.y.is_finite() & p.z.is_finite();
    Float::select(is_finite, noise, noise.like(0.0))
}

/// The noise on two edges along x of the cells, of less and of greater z: between ramps of two rows of corners.
#[inline(always)]
fn edges<R: Real>(
    rows: [R::Bits; 2],
    z: R::Bits,
    ([near, far], y, [low, high]): ([R; 2], R, [R; 2]),
    u: R,
) -> [R; 2] {
    let [left, right] = [pair::<R>(rows[0].wrapping_add(z)), pair::<R>(rows[1].wrapping_add(z))];
    [
        mix_linearly(ramp(left[0], [near, y, low]), ramp(right[0], [far, y, low]), u),
        mix_linearly(ramp(left[1], [near, y, high]), ramp(right[1], [far, y, high]), u),
    ]
}

/// The ramp of a corner at a place beside it: the sum of two coordinates, each with a sign, by four bits of the hash.
#[inline(always)]
fn ramp<R: Real>(hash: R::Bits, [x, y, z]: [R; 3]) -> R {
    let hash = hash & hash.like(15);
    let number = R::from_integer(hash);
    let is_twelve_or_thirteen = number.gt(x.like(11.5)) & number.lt(x.like(13.5));
    let first = R::select(number.lt(x.like(7.5)) | is_twelve_or_thirteen, x, y);
    let second = R::select(number.lt(x.like(3.5)) | is_twelve_or_thirteen, y, z);
    let sign = hash.like(1 << 31);
    R::from_bits(first.to_bits() ^ ((hash << 31) & sign))
        + R::from_bits(second.to_bits() ^ ((hash << 30) & sign))
}

/// The permuted numbers of indices, modulo 256, and of the next ones.
#[inline(always)]
fn pair<R: Real>(index: R::Bits) -> [R::Bits; 2] {
    let byte = index.like(255);
    let both = R::lookup(
        index & byte,
        #[inline(always)]
        |index| PAIRS[index % 256],
    );
    let both = both.to_integer();
    [both & byte, both >> 8]
}

/// Whole numbers modulo 256.
#[inline(always)]
fn modulo_256<R: Real>(whole: R) -> R::Bits {
    (whole - (whole * (1.0 / 256.0)).floor() * 256.0).to_integer()
}
