//! Procedural patterns.
//!
//! Checkerboards, and pbrt-v4's dots, waves and marble by Perlin noise (Pharr, Jakob, Humphreys 2023).

use glam::{DVec3, Vec2, Vec3};

use crate::core::noise::perlin;

/// True if the sum of the integer parts is even.
pub(super) fn is_even(p: DVec3) -> bool {
    (whole(p.x) ^ whole(p.y) ^ whole(p.z)) & 1 == 0
}

/// The greatest integer that is not above a number; the last one that there is for numbers beyond. `f64::floor` is a
/// call where the instruction set is not known to have it.
#[inline]
fn whole(x: f64) -> i64 {
    let cut = x as i64;
    cut.wrapping_sub(i64::from(cut as f64 > x))
}

/// True if a point lies in a dot. Cells have size 1 and are centred at integers; about half of them have a dot.
pub(super) fn is_in_dot(st: Vec2) -> bool {
    const RADIUS: f32 = 0.35;
    let cell = (st + 0.5).floor();
    let noise = |s, t| perlin::noise((cell + Vec2::new(s, t)).extend(0.5));
    if !(noise(0.5, 0.5) > 0.0) {
        return false;
    }
    // The dot stays in its cell.
    let center = cell + (0.5 - RADIUS) * Vec2::new(noise(1.5, 2.8), noise(4.5, 9.8));
    st.distance_squared(center) < RADIUS * RADIUS
}

/// pbrt's `windy`: the height of water under a wind that varies over the surface.
pub(super) fn windy(p: Vec3) -> f32 {
    let wind = perlin::fbm(0.1 * p, 0.5, 3);
    let wave = perlin::fbm(p, 0.5, 6);
    wind.abs() * wave
}

/// pbrt's marble: veins across y, displaced by noise. A reflectance.
pub(super) fn marble(p: Vec3, roughness: f32, octaves: u32, variation: f32) -> [f32; 3] {
    const STONE: [f32; 3] = [0.58, 0.58, 0.6];
    const PALETTE: [[f32; 3]; 9] =
        [STONE, STONE, STONE, [0.5, 0.5, 0.5], [0.6, 0.59, 0.58], STONE, STONE, [0.2, 0.2, 0.33], STONE];
    const SEGMENTS: usize = PALETTE.len() - 3;
    let phase = p.y + variation * perlin::fbm(p, roughness, octaves);
    let t = (0.5 + 0.5 * libm::sinf(phase)) * SEGMENTS as f32;
    // Each segment is a cubic Bézier curve through four colours of the palette; the next one shares three of them.
    let first = (t as usize).min(SEGMENTS - 1);
    let t = t - first as f32;
    let s = 1.0 - t;
    let weights = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
    std::array::from_fn(|c| 1.5 * (0..4).map(|k| weights[k] * PALETTE[first + k][c]).sum::<f32>())
}
