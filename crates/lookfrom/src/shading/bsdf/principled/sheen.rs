//! Sheen: the Charlie distribution (Estevez & Kulla 2017).
//!
//! The distribution of microfacet normals and its masking are those of `KHR_materials_sheen`:
//! `f = D / (4 cos θ_o cos θ_i (1 + Λ_o + Λ_i))`, times a colour. Directions are sampled uniformly over the hemisphere:
//! the lobe is broad, and where it is not, it rises toward the horizon, where a uniform density does best.

use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, PI};

use crate::core::math;
use crate::shading::bsdf::conductor::try_half_vector;

/// Smallest roughness: below it, fibres would be visible at the horizon only, and excessively bright there.
const SMOOTHEST: f32 = 0.07;

/// Density over solid angle of the sampled directions.
pub(super) const PDF: f32 = 0.5 * FRAC_1_PI;

/// Sheen of a given roughness.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sheen {
    alpha: f32,
    /// Coefficients of the fit of ln Λ.
    fit: [f32; 5],
}

impl Sheen {
    /// By glTF's roughness, whose square is α.
    pub(super) fn new(roughness: f32) -> Self {
        const SHARP: [f32; 5] = [25.3245, 3.32435, 0.16801, -1.27393, -4.85967];
        const ROUGH: [f32; 5] = [21.5473, 3.82987, 0.19823, -1.97760, -4.32054];
        let roughness = roughness.clamp(SMOOTHEST, 1.0);
        let alpha = roughness * roughness;
        let t = (1.0 - alpha) * (1.0 - alpha);
        Self { alpha, fit: std::array::from_fn(|k| ROUGH[k] + t * (SHARP[k] - ROUGH[k])) }
    }

    fn log_lambda(&self, cos: f32) -> f32 {
        let [a, b, c, d, e] = self.fit;
        a / (1.0 + b * math::power(cos, c)) + d * cos + e
    }

    /// Λ: masked over visible parts, for a cosine in 0 … 1.
    fn lambda(&self, cos: f32) -> f32 {
        let exponent = if cos < 0.5 {
            self.log_lambda(cos)
        } else {
            2.0 * self.log_lambda(0.5) - self.log_lambda(1.0 - cos)
        };
        libm::expf(exponent)
    }

    /// `f` of white fibres, for two directions above the surface.
    pub(super) fn f(&self, wo: Vec3, wi: Vec3) -> f32 {
        let Some(wm) = try_half_vector(wo, wi) else { return 0.0 };
        let sin2 = (1.0 - wm.z * wm.z).max(0.0);
        let d = (2.0 + 1.0 / self.alpha) * math::power(sin2, 0.5 / self.alpha) / (2.0 * PI);
        let [o, i] = [wo.z.min(1.0), wi.z.min(1.0)];
        d / (4.0 * o * i * (1.0 + self.lambda(o) + self.lambda(i)))
    }
}

/// The directional albedo of white sheen, for an outgoing direction of the given cosine.
pub(super) fn integrated(cos: f32, roughness: f32) -> f32 {
    const STEPS: [usize; 2] = [10, 24];
    let sheen = Sheen::new(roughness);
    let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let mut sum = 0.0;
    for row in 0..STEPS[1] {
        // Denser toward the horizon, where the lobe rises.
        let x = (row as f32 + 0.5) / STEPS[1] as f32;
        let z = x * x;
        let sin = (1.0 - z * z).sqrt();
        for column in 0..STEPS[0] {
            let (s, c) = libm::sincosf(PI * (column as f32 + 0.5) / STEPS[0] as f32);
            sum += 2.0 * x * z * sheen.f(wo, Vec3::new(sin * c, sin * s, z));
        }
    }
    2.0 * PI * sum / (STEPS[0] * STEPS[1]) as f32
}
