//! Conductors, smooth or rough.
//!
//! Cook & Torrance 1982; Walter et al. 2007; Heitz 2014.

use glam::Vec3;

use super::microfacet::TrowbridgeReitz;
use super::{BsdfSample, Lobes, fresnel, is_grazing, layered::Base, same_side};
use crate::core::math;
use crate::core::spectrum::Spectrum;

/// A metal with index of refraction `eta` and extinction `k`, both divided by the surrounding index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    /// Index of refraction over the surrounding one.
    pub(crate) eta: Spectrum,
    /// Extinction over the surrounding index.
    pub(crate) k: Spectrum,
    /// Roughness of the surface.
    pub(crate) roughness: TrowbridgeReitz,
}

impl Conductor {
    /// By index and extinction over the surrounding index.
    pub fn new(eta: Spectrum, k: Spectrum, roughness: TrowbridgeReitz) -> Self {
        Self { eta, k, roughness }
    }

    /// `f` with the half vector `wm`; both directions on one side, neither grazing.
    #[inline]
    fn rough_f(&self, wo: Vec3, wi: Vec3, wm: Vec3) -> Spectrum {
        let fresnel = fresnel::conductor(wo.dot(wm).abs(), self.eta, self.k);
        fresnel * (self.roughness.d(wm) * self.roughness.g(wo, wi) / (4.0 * wo.z * wi.z))
    }
}

/// The half vector of two directions on one side, with z > 0; `None` where there is none.
#[inline]
pub(super) fn half_vector(wo: Vec3, wi: Vec3) -> Option<Vec3> {
    let wm = (wo + wi).try_normalize()?;
    Some(if wm.z < 0.0 { -wm } else { wm })
}

impl Base for Conductor {
    #[inline]
    fn f(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        if self.roughness.is_smooth() || !same_side(wo, wi) {
            return Spectrum::BLACK;
        }
        half_vector(wo, wi).map_or(Spectrum::BLACK, |wm| self.rough_f(wo, wi, wm))
    }

    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if self.roughness.is_smooth() || !same_side(wo, wi) {
            return 0.0;
        }
        half_vector(wo, wi).map_or(0.0, |wm| 0.25 * self.roughness.visible_per_cosine(wo, wm))
    }

    #[inline]
    fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample> {
        if is_grazing(wo) {
            return None;
        }
        if self.roughness.is_smooth() {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            let f = fresnel::conductor(wi.z.abs(), self.eta, self.k) / wi.z.abs();
            return Some(BsdfSample::new(wi, f, 1.0, Lobes::REFLECTION | Lobes::SPECULAR));
        }
        let wm = self.roughness.sample(wo, u);
        let wi = math::reflect(wo, wm);
        if !same_side(wo, wi) {
            return None;
        }
        let pdf = 0.25 * self.roughness.visible_per_cosine(wo, wm);
        Some(BsdfSample::new(wi, self.rough_f(wo, wi, wm), pdf, Lobes::REFLECTION | Lobes::GLOSSY))
    }

    #[inline]
    fn lobes(&self) -> Lobes {
        Lobes::REFLECTION | if self.roughness.is_smooth() { Lobes::SPECULAR } else { Lobes::GLOSSY }
    }

    fn regularize(&mut self) {
        self.roughness.regularize();
    }
}
