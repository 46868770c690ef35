//! pbrt-v4's procedural cloud: noise of five octaves, displaced by noise, that decreases with height.

use glam::Vec3;

use crate::core::noise::perlin;

/// A cloud. Its density is 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cloud {
    pub(super) density: f32,
    pub(super) wispiness: f32,
    pub(super) frequency: f32,
}

impl Cloud {
    /// The density at a point of medium space.
    pub(super) fn at(&self, point: Vec3) -> f32 {
        // Displace the point by noise.
        let mut at = point * self.frequency;
        if self.wispiness > 0.0 {
            let (mut strength, mut frequency) = (0.05 * self.wispiness, 10.0);
            for _ in 0..2 {
                at += strength * perlin::gradient(frequency * at);
                strength *= 0.5;
                frequency *= perlin::LACUNARITY;
            }
        }
        // Below, the cloud is full; above, it thins out.
        let noise = perlin::fbm(at, 0.5, 5) * 0.5;
        self.thinned(point.y, noise)
    }

    /// The density where the noise has a value.
    fn thinned(&self, y: f32, noise: f32) -> f32 {
        let above = ((1.0 - y) * 4.5 * self.density * noise).clamp(0.0, 1.0);
        (above + 2.0 * (0.5 - y).max(0.0)).clamp(0.0, 1.0)
    }

    /// A bound of the density between two heights.
    pub(super) fn most(&self, low: f32, high: f32) -> f32 {
        /// The sum of the amplitudes of the octaves, times the largest noise.
        const NOISE: f32 = 0.968_75 * 1.04;
        [low, high]
            .into_iter()
            .flat_map(|y| [NOISE, -NOISE].map(|noise| self.thinned(y, noise)))
            .fold(0.0, f32::max)
    }
}
