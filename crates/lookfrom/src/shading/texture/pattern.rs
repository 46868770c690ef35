//! Procedural patterns.
//!
//! Checkerboards, and pbrt-v4's dots, waves and marble by Perlin noise (Pharr, Jakob, Humphreys 2023).

use glam::{DVec3, Vec2, Vec3};

use crate::core::noise::perlin::{self, Octaves};

/// True if the sum of the integer parts is even.
pub(super) fn is_even(p: DVec3) -> bool {
    (whole(p.x) ^ whole(p.y) ^ whole(p.z)) & 1 == 0
}

/// The part of a checkerboard that is odd, seen through a filter: a tent three times as wide as the greater of two steps, along each axis.
///
/// pbrt-v4's `Checkerboard`: the second difference of the second integral of a square wave.
pub(super) fn odd_share(p: DVec3, steps: [DVec3; 2]) -> f32 {
    let reach = 1.5 * DVec3::max(steps[0].abs(), steps[1].abs());
    let wave = |x: f64, reach: f64| {
        let sharp = if whole(x) & 1 == 0 { 1.0 } else { -1.0 };
        if whole(x - reach) == whole(x + reach) {
            return sharp;
        }
        // The wave has a period of 2.
        let x = x - 2.0 * whole(0.5 * x) as f64;
        let integral = |x: f64| {
            let half = 0.5 * x;
            let y = half - whole(half) as f64 - 0.5;
            half + y * (1.0 - 2.0 * y.abs())
        };
        let mean = (integral(x + reach) - 2.0 * integral(x) + integral(x - reach)) / (reach * reach);
        if mean.is_finite() { mean.clamp(-1.0, 1.0) } else { sharp }
    };
    (0.5 - 0.5 * wave(p.x, reach.x) * wave(p.y, reach.y) * wave(p.z, reach.z)) as f32
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

/// pbrt's `windy`: the height of water under a wind that varies over the surface, by the width of the detail that is left out.
pub(super) fn windy(p: Vec3, detail: f32) -> f32 {
    let wind = perlin::fbm(0.1 * p, 0.5, Octaves::new(3, 0.1 * detail));
    let wave = perlin::fbm(p, 0.5, Octaves::new(6, detail));
    wind.abs() * wave
}

/// pbrt's marble: veins across y, displaced by noise. A reflectance.
pub(super) fn marble(p: Vec3, roughness: f32, octaves: Octaves, variation: f32) -> [f32; 3] {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::hash;

    /// The share of odd squares under a product of tents, by many points.
    fn slow_share(p: DVec3, reach: DVec3) -> f64 {
        const POINTS: u32 = 200;
        let (mut sum, mut weights) = (0.0, 0.0);
        for (i, j) in (0..POINTS).flat_map(|i| (0..POINTS).map(move |j| (i, j))) {
            let [x, y] = [i, j].map(|k| 2.0 * (f64::from(k) + 0.5) / f64::from(POINTS) - 1.0);
            let weight = (1.0 - x.abs()) * (1.0 - y.abs());
            let at = p + DVec3::new(x * reach.x, y * reach.y, 0.0);
            weights += weight;
            sum += if is_even(at) { 0.0 } else { weight };
        }
        sum / weights
    }

    #[test]
    fn checkers_are_averaged() {
        for seed in 0..400 {
            let number = |k: u64| (hash::pair(seed, k) >> 11) as f64 / (1_u64 << 53) as f64;
            let size = libm::exp2(8.0 * number(0) - 6.0);
            let p = DVec3::new(20.0 * number(1) - 10.0, 20.0 * number(2) - 10.0, 0.25);
            let steps = [
                DVec3::new(size * number(3), -size * number(4), 0.0),
                DVec3::new(-size * number(5), size * number(6), 0.0),
            ];
            let reach = 1.5 * DVec3::max(steps[0].abs(), steps[1].abs());
            let (found, expected) = (f64::from(odd_share(p, steps)), slow_share(p, reach));
            assert!((found - expected).abs() < 0.02, "{found} {expected} at {p}, {reach}");
        }
        let p = DVec3::new(-0.5, 3.5, 0.0);
        assert_eq!(odd_share(p, [DVec3::ZERO; 2]), 0.0);
        assert_eq!(odd_share(p + DVec3::X, [DVec3::new(0.1, 0.1, 0.0); 2]), 1.0);
    }

    #[test]
    fn far_checkers_are_gray_and_all_are_shares() {
        for seed in 0..5000 {
            let number = |k: u64| {
                let bits = hash::pair(seed, k);
                ((bits >> 40) as f64 / 8_388_608.0 - 1.0) * libm::exp2((bits % 61) as f64 - 30.0)
            };
            let vector = |k: u64| DVec3::new(number(k), number(k + 1), number(k + 2));
            let share = odd_share(vector(0), [vector(3), vector(6)]);
            assert!((0.0..=1.0).contains(&share), "{share}");
            let far = odd_share(vector(0) * 1e-6, [DVec3::splat(1e3); 2]);
            assert!((far - 0.5).abs() < 1e-3, "{far}");
        }
    }
}
