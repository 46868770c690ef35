//! Rough diffuse reflection that keeps its energy: EON (Portsmouth, Kutz & Hill 2025, "EON: A Practical Energy-Preserving
//! Rough Diffuse BRDF").
//!
//! Fujii's form of Oren & Nayar's model, and the light that it loses between facets. White stays white, in every
//! direction.

use std::f32::consts::PI;

use lookfrom_simd::{Float, Mask, Real};

use crate::core::elementary::angle_in_turns;
use crate::core::math::both;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// ½ − 2 / 3π: of the normalisation.
const NORM: f32 = 0.5 - 2.0 / (3.0 * PI);
/// ⅔ − 28 / 15π: of the mean albedo.
const MEAN: f32 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

/// A rough diffuse surface.
#[derive(Clone, Copy)]
pub(super) struct RoughDiffuse<R> {
    roughness: R,
    /// 1 / (1 + (½ − 2 / 3π) roughness).
    norm: R,
}

impl<R: Real> RoughDiffuse<R> {
    /// Reflection of a roughness of 0 … 1; 0 is Lambert's.
    #[inline(always)]
    pub(super) fn new(roughness: R) -> Self {
        Self { roughness, norm: roughness.like(1.0) / (roughness * NORM + 1.0) }
    }

    /// The albedo of a white surface without light between facets, for a direction of a cosine.
    #[inline(always)]
    pub(super) fn albedo(&self, cos: R) -> R {
        let one = cos.like(1.0);
        let cos = Float::clamp(cos, 0.0, 1.0);
        let sin = Float::sqrt(one - cos * cos);
        // The specification's (s/μ)(1 − s³) − s, without a difference of almost equal numbers.
        let tail = sin * cos * (one + sin + sin * sin) / (one + sin) - sin;
        let g = sin * (angle_in_turns(sin, cos) * (2.0 * PI) - sin * cos) + tail * (2.0 / 3.0);
        self.norm * (one + self.roughness * g * (1.0 / PI))
    }

    /// π f of a surface of a colour, for two directions above it.
    #[inline(always)]
    pub(super) fn pi_f(&self, color: Spectrum<R>, wo: Vector<R>, wi: Vector<R>) -> Spectrum<R> {
        let (zero, one) = (wo.z.like(0.0), wo.z.like(1.0));
        let s = wo.x * wi.x + wo.y * wi.y;
        let back = R::select(s.gt(zero), s / Float::max(Float::max(wo.z, wi.z), s.like(1e-6)), s);
        let single = Float::max(self.norm * (one + self.roughness * back), zero);
        let mean = self.norm * (self.roughness * MEAN + 1.0);
        let [lost_o, lost_i] = both(
            [wo.z, wi.z],
            #[inline(always)]
            |cos| Float::max(one - self.albedo(cos), zero),
        );
        let lost = lost_o * lost_i / Float::max(one - mean, one.like(1e-6));
        let is_smooth = !self.roughness.gt(zero);
        color.map(
            #[inline(always)]
            |color| {
                let again = color * color * mean / (one - color * (one - mean));
                R::select(is_smooth, color, color * single + again * lost)
            },
        )
    }
}

/// Whether any surface is rough.
#[inline(always)]
pub(super) fn is_any<R: Real>(roughness: R) -> bool {
    roughness.gt(roughness.like(0.0)).any()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shading::bsdf::tests::direction;

    /// The albedo of a lobe, by even directions.
    fn integrated(f: impl Fn(Vector<f32>) -> f32) -> f64 {
        const N: usize = 300;
        let mut sum = 0.0;
        for k in 0..N * N {
            let u = [((k % N) as f32 + 0.5) / N as f32, ((k / N) as f32 + 0.5) / N as f32];
            sum += f64::from(f(crate::core::warp::cosine_about_z(u)));
        }
        sum / (N * N) as f64
    }

    #[test]
    fn albedos_are_the_integrals() {
        for roughness in [0.0, 0.4, 1.0_f32] {
            let rough = RoughDiffuse::new(roughness);
            for angle in [0.0, 40.0, 75.0, 85.0] {
                let wo = Vector::from(direction(angle, 30.0));
                let white = integrated(|wi| rough.pi_f(Spectrum([1.0; 4]), wo, wi).0[0]);
                assert!((white - 1.0).abs() < 3e-3, "{roughness} {angle}: {white}");
                let grey = integrated(|wi| rough.pi_f(Spectrum([0.2; 4]), wo, wi).0[0]);
                let single = 0.2 * f64::from(rough.albedo(wo.z));
                assert!(grey > single - 1e-3 && grey < 0.2 + 1e-3, "{roughness} {angle}: {grey} {single}");
            }
        }
        // A_F (1 + σ G / π) at normal incidence, where G is 0: 1 / (1 + ½ − 2 / 3π).
        assert!((RoughDiffuse::new(1.0_f32).albedo(1.0) - 0.776_522).abs() < 1e-5);
        // It grows to 1 at grazing incidence.
        assert!((RoughDiffuse::new(1.0_f32).albedo(0.0) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn light_returns_to_where_it_comes_from() {
        let rough = RoughDiffuse::new(1.0_f32);
        let of = |phi| {
            let [wo, wi] = [direction(60.0, 0.0), direction(60.0, phi)].map(Vector::from);
            rough.pi_f(Spectrum([0.5; 4]), wo, wi).0[0]
        };
        assert!(of(0.0) > 1.5 * of(180.0), "{} {}", of(0.0), of(180.0));
        // By hand: ρ A (1 + s / t) with s = ¾, t = ½, which is 0.970 65, and ρ² E (1 − E_o)² / ((1 − ρ (1 − E)) (1 − E)) with the mean
        // albedo E = 0.832 81 and 1 − E_o = 0.134 68.
        assert!((of(0.0) - 0.995_302).abs() < 1e-5, "{}", of(0.0));
    }
}
