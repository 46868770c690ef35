//! The phase function of Henyey & Greenstein 1941.
//!
//! Directions follow the convention of this module: `wo` and `wi` both point away from the particle, so that light
//! that continues straight ahead has `wo·wi = −1`.

use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, TAU};

use crate::core::warp;

/// The phase function with mean cosine `g` (positive: forward scattering), within ±0.99.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    g: f32,
}

impl HenyeyGreenstein {
    /// By the mean cosine, clamped to ±0.99 as in pbrt.
    pub fn new(g: f32) -> Self {
        Self { g: g.clamp(-0.99, 0.99) }
    }

    /// The value of the phase function, per solid angle; also the density of [`Self::sample`].
    #[inline]
    pub fn p(self, wo: Vec3, wi: Vec3) -> f32 {
        let g2 = self.g * self.g;
        let denominator = (1.0 + g2 + 2.0 * self.g * wo.dot(wi)).max(f32::MIN_POSITIVE);
        0.25 * FRAC_1_PI * (1.0 - g2) / (denominator * denominator.sqrt())
    }

    /// A direction distributed by [`Self::p`].
    #[inline]
    pub fn sample(self, wo: Vec3, [u, v]: [f32; 2]) -> Vec3 {
        let g = self.g;
        let cos = if g.abs() < 1e-3 {
            1.0 - 2.0 * u
        } else {
            let ratio = (1.0 - g * g) / (1.0 + g - 2.0 * g * u);
            (ratio * ratio - 1.0 - g * g) / (2.0 * g)
        };
        let cos = cos.clamp(-1.0, 1.0);
        let sin = (1.0 - cos * cos).sqrt();
        let (sin_phi, cos_phi) = libm::sincosf(TAU * v);
        let (s, t) = warp::orthonormal_basis(wo);
        (s * (sin * cos_phi) + t * (sin * sin_phi) + wo * cos).normalize()
    }
}
