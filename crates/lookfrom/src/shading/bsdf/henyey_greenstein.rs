//! The phase function of Henyey & Greenstein 1941.
//!
//! Directions follow the convention of this module: `wo` and `wi` both point away from the particle, so that light
//! that continues straight ahead has `wo·wi = −1`.

use std::f32::consts::FRAC_1_PI;

use lookfrom_simd::{Float, Real};

use crate::core::elementary::sin_cos_of_turns;
use crate::core::vector::Vector;
use crate::core::warp;

/// The phase function with mean cosine `g` (positive: forward scattering), within ±0.99.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein<R = f32> {
    pub(super) g: R,
}

impl HenyeyGreenstein {
    /// By the mean cosine, clamped to ±0.99 as in pbrt.
    pub fn new(g: f32) -> Self {
        Self { g: g.clamp(-0.99, 0.99) }
    }
}

impl HenyeyGreenstein {
    /// The mean cosine.
    pub fn g(self) -> f32 {
        self.g
    }
}

impl<R: Real> HenyeyGreenstein<R> {
    /// By mean cosines within ±0.99.
    #[inline(always)]
    pub(crate) fn of(g: R) -> Self {
        Self { g }
    }

    /// The value of the phase function, per solid angle; also the density of [`Self::sample`].
    #[inline(always)]
    pub fn p(self, wo: Vector<R>, wi: Vector<R>) -> R {
        let g = self.g;
        let g2 = g * g;
        let denominator = Float::max(g2 + 1.0 + g * 2.0 * wo.dot(wi), g.like(f32::MIN_POSITIVE));
        (g.like(1.0) - g2) * (0.25 * FRAC_1_PI) / (denominator * Float::sqrt(denominator))
    }

    /// A direction distributed by [`Self::p`].
    #[inline(always)]
    pub fn sample(self, wo: Vector<R>, [u, v]: [R; 2]) -> Vector<R> {
        let (g, one) = (self.g, u.like(1.0));
        let ratio = (one - g * g) / (g + 1.0 - g * 2.0 * u);
        let cos = (ratio * ratio - 1.0 - g * g) / (g * 2.0);
        let cos = R::select(Float::abs(g).lt(g.like(1e-3)), one - u * 2.0, cos);
        let cos = Float::clamp(cos, -1.0, 1.0);
        let sin = Float::sqrt(one - cos * cos);
        let (sin_phi, cos_phi) = sin_cos_of_turns(v);
        let (s, t) = warp::basis_about(wo);
        (s * (sin * cos_phi) + t * (sin * sin_phi) + wo * cos).normalize()
    }
}
