//! pbrt-v4's procedural cloud: noise of five octaves, displaced by noise, that decreases with height.

use lookfrom_simd::{Float, Real};

use crate::core::noise::perlin;
use crate::core::vector::Vector;

/// A cloud. Its density is 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cloud {
    pub(super) density: f32,
    pub(super) wispiness: f32,
    pub(super) frequency: f32,
}

impl Cloud {
    /// The densities at points of medium space.
    #[inline(always)]
    pub(super) fn at<R: Real>(&self, points: Vector<R>) -> R {
        // Displace the points by noise.
        let mut at = points * points.x.like(self.frequency);
        if self.wispiness > 0.0 {
            let (mut strength, mut frequency) = (0.05 * self.wispiness, 10.0);
            for _ in 0..2 {
                at = at + perlin::gradients(at * at.x.like(frequency)) * at.x.like(strength);
                strength *= 0.5;
                frequency *= perlin::LACUNARITY;
            }
        }
        // Below, the cloud is full; above, it thins out.
        let noise = perlin::fbms(at, 0.5, 5) * 0.5;
        self.thinned(points.y, noise)
    }

    /// The density where the noise has a value.
    #[inline(always)]
    fn thinned<R: Real>(&self, y: R, noise: R) -> R {
        let above = Float::clamp((-y + 1.0) * 4.5 * self.density * noise, 0.0, 1.0);
        Float::clamp(above + Float::max(-y + 0.5, y.like(0.0)) * 2.0, 0.0, 1.0)
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
