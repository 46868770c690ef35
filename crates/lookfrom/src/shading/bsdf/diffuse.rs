//! Diffuse (Lambertian) reflection and transmission.
//!
//! Lambert 1760.

use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

use super::{BsdfSample, Lobes, is_grazing, layered::Base, same_side};
use crate::core::spectrum::Spectrum;
use crate::core::warp;

/// Lambertian reflection: reflects the fraction `reflectance` (0 … 1) of the light, uniformly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffuse {
    /// 0 … 1.
    pub(crate) reflectance: Spectrum,
}

impl Diffuse {
    /// The reflectance is clamped to 0 … 1.
    pub fn new(reflectance: Spectrum) -> Self {
        Self { reflectance: reflectance.map(|r| r.clamp(0.0, 1.0)) }
    }
}

impl Base for Diffuse {
    #[inline]
    fn f(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        if same_side(wo, wi) { self.reflectance * FRAC_1_PI } else { Spectrum::BLACK }
    }

    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if same_side(wo, wi) { warp::cosine_hemisphere_pdf(wi.z.abs()) } else { 0.0 }
    }

    #[inline]
    fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample> {
        if is_grazing(wo) {
            return None;
        }
        let wi = cosine_direction(u, wo.z);
        let pdf = warp::cosine_hemisphere_pdf(wi.z.abs());
        Some(BsdfSample::diffuse(wi, self.reflectance * FRAC_1_PI, pdf))
    }

    #[inline]
    fn lobes(&self) -> Lobes {
        if self.reflectance.is_black() { Lobes::NONE } else { Lobes::REFLECTION | Lobes::DIFFUSE }
    }

    fn regularize(&mut self) {}
}

/// Reflects the fraction `reflectance` of the light and transmits the fraction `transmittance`, both uniformly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmission {
    /// 0 … 1.
    pub(crate) reflectance: Spectrum,
    /// 0 … 1.
    pub(crate) transmittance: Spectrum,
}

impl DiffuseTransmission {
    /// Each is clamped to 0 … 1; the caller ensures that their sum is at most 1, as in pbrt.
    pub fn new(reflectance: Spectrum, transmittance: Spectrum) -> Self {
        let [reflectance, transmittance] =
            [reflectance, transmittance].map(|part| part.map(|lane| lane.clamp(0.0, 1.0)));
        Self { reflectance, transmittance }
    }

    #[inline]
    pub(super) fn f(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        if is_grazing(wo) || is_grazing(wi) {
            Spectrum::BLACK
        } else if same_side(wo, wi) {
            self.reflectance * FRAC_1_PI
        } else {
            self.transmittance * FRAC_1_PI
        }
    }

    /// The probability of reflection; `None` where no allowed side carries light.
    #[inline]
    fn reflection_probability(&self, lobes: Lobes) -> Option<f32> {
        let [r, t] = lobes.allowed([self.reflectance.max_lane(), self.transmittance.max_lane()]);
        (r + t > 0.0).then(|| r / (r + t))
    }

    #[inline]
    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3, lobes: Lobes) -> f32 {
        let Some(reflection) = self.reflection_probability(lobes) else { return 0.0 };
        if is_grazing(wo) || is_grazing(wi) {
            return 0.0;
        }
        let probability = if same_side(wo, wi) { reflection } else { 1.0 - reflection };
        probability * warp::cosine_hemisphere_pdf(wi.z.abs())
    }

    #[inline]
    pub(super) fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2], lobes: Lobes) -> Option<BsdfSample> {
        let reflection = self.reflection_probability(lobes)?;
        let (side, probability, lobe) = if uc < reflection {
            (wo.z, reflection, Lobes::REFLECTION)
        } else {
            (-wo.z, 1.0 - reflection, Lobes::TRANSMISSION)
        };
        let wi = cosine_direction(u, side);
        let pdf = probability * warp::cosine_hemisphere_pdf(wi.z.abs());
        Some(BsdfSample::new(wi, self.f(wo, wi), pdf, lobe | Lobes::DIFFUSE))
    }

    pub(super) fn lobes(&self) -> Lobes {
        let mut lobes = Lobes::NONE;
        if !self.reflectance.is_black() {
            lobes |= Lobes::REFLECTION | Lobes::DIFFUSE;
        }
        if !self.transmittance.is_black() {
            lobes |= Lobes::TRANSMISSION | Lobes::DIFFUSE;
        }
        lobes
    }
}

/// A cosine-distributed direction about the z axis, on the side of the sign of `side`.
#[inline]
pub(super) fn cosine_direction(u: [f32; 2], side: f32) -> Vec3 {
    let up = warp::cosine_hemisphere(u, Vec3::Z);
    Vec3::new(up.x, up.y, up.z.copysign(side))
}
