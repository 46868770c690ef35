//! Sheen: the Charlie distribution (Estevez & Kulla 2017).
//!
//! The distribution of microfacet normals and its masking are those of `KHR_materials_sheen`:
//! `f = D / (4 cos θ_o cos θ_i (1 + Λ_o + Λ_i))`, times a colour. Directions are sampled uniformly over the hemisphere:
//! the lobe is broad, and where it is not, it rises toward the horizon, where a uniform density does best.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::Vec3;
use lookfrom_simd::{Float, Mask, Real};

use crate::core::elementary;
use crate::core::vector::Vector;
use crate::shading::bsdf::conductor::half_vector;

/// Smallest roughness: below it, fibres would be visible at the horizon only, and excessively bright there.
const SMOOTHEST: f32 = 0.07;

/// Density over solid angle of the sampled directions.
pub(super) const PDF: f32 = 0.5 * FRAC_1_PI;

/// Sheen of a given roughness.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Sheen<R = f32> {
    alpha: R,
    /// Coefficients of the fit of ln Λ.
    fit: [R; 5],
}

impl<R: Real> Sheen<R> {
    /// By glTF's roughness, whose square is α.
    #[inline(always)]
    pub(in super::super) fn new(roughness: R) -> Self {
        let roughness = Float::clamp(roughness, SMOOTHEST, 1.0);
        let alpha = roughness * roughness;
        let t = (alpha.like(1.0) - alpha) * (alpha.like(1.0) - alpha);
        Self {
            alpha,
            fit: [
                coefficient(t, 0),
                coefficient(t, 1),
                coefficient(t, 2),
                coefficient(t, 3),
                coefficient(t, 4),
            ],
        }
    }

    #[inline(always)]
    fn log_lambda(&self, cos: R) -> R {
        let [a, b, c, d, e] = self.fit;
        a / (b * elementary::power(cos, c) + 1.0) + d * cos + e
    }

    /// Λ: masked over visible parts, for a cosine in 0 … 1.
    #[inline(always)]
    fn lambda(&self, cos: R) -> R {
        let half = cos.like(0.5);
        let is_low = cos.lt(half);
        let near = self.log_lambda(R::select(is_low, cos, cos.like(1.0) - cos));
        let exponent = match is_low.all() {
            true => near,
            false => R::select(is_low, near, self.log_lambda(half) * 2.0 - near),
        };
        elementary::exp(exponent)
    }

    /// `f` of white fibres, for two directions above the surface.
    #[inline(always)]
    pub(in super::super) fn f(&self, wo: impl Into<Vector<R>>, wi: impl Into<Vector<R>>) -> R {
        self.f_by(wo.into(), wi.into())
    }

    /// Not inlined, since it is long.
    #[inline(never)]
    fn f_by(&self, wo: Vector<R>, wi: Vector<R>) -> R {
        self.alpha.at_level(
            #[inline(always)]
            || {
                let (zero, one) = (wo.z.like(0.0), wo.z.like(1.0));
                let (wm, exists) = half_vector(wo, wi);
                let sin2 = Float::max(one - wm.z * wm.z, zero);
                let power = elementary::power(sin2, one.like(0.5) / self.alpha);
                let d = (one / self.alpha + 2.0) * power / (2.0 * PI);
                let (o, i) = (Float::min(wo.z, one), Float::min(wi.z, one));
                let f = d / (o * 4.0 * i * (self.lambda(o) + 1.0 + self.lambda(i)));
                R::select(exists, f, zero)
            },
        )
    }
}

/// A coefficient between those of the sharpest fibres and of the roughest.
#[inline(always)]
fn coefficient<R: Real>(t: R, k: usize) -> R {
    const SHARP: [f32; 5] = [25.3245, 3.32435, 0.16801, -1.27393, -4.85967];
    const ROUGH: [f32; 5] = [21.5473, 3.82987, 0.19823, -1.97760, -4.32054];
    t * (SHARP[k] - ROUGH[k]) + ROUGH[k]
}

/// The directional albedo of white sheen, for an outgoing direction of the given cosine.
pub(in super::super) fn integrated(cos: f32, roughness: f32) -> f32 {
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
