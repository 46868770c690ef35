//! Oren & Nayar (1994), "Generalization of Lambert's Reflectance Model": rough matte surfaces, by the qualitative model.

use std::f32::consts::FRAC_1_PI;

use glam::{Vec2, Vec3, Vec3Swizzles};

use crate::core::spectrum::Spectrum;
use crate::core::warp;
use crate::shading::bsdf::diffuse::cosine_direction;
use crate::shading::bsdf::lobes::Lobes;
use crate::shading::bsdf::{BsdfSample, Description, Mode, ScatteringFunction, same_side};

/// Clay: facets that are matte each, so that its edges do not darken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clay {
    /// 0 … 1.
    pub reflectance: Spectrum,
    /// Standard deviation of the facets' angles, in radians.
    pub sigma: f32,
}

impl ScatteringFunction for Clay {
    fn f(&self, wo: Vec3, wi: Vec3, _: Mode) -> Spectrum {
        if !same_side(wo, wi) {
            return Spectrum::BLACK;
        }
        let variance = self.sigma * self.sigma;
        let matte = 1.0 - 0.5 * variance / (variance + 0.33);
        let rough = 0.45 * variance / (variance + 0.09);
        // sin α tan β cos (φ_i − φ_o), where α is the larger angle.
        let back = Vec2::dot(wo.xy(), wi.xy()).max(0.0) / wo.z.abs().max(wi.z.abs());
        self.reflectance * (FRAC_1_PI * (matte + rough * back))
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, _: Mode, _: Lobes) -> f32 {
        if same_side(wo, wi) { warp::cosine_hemisphere_pdf(wi.z.abs()) } else { 0.0 }
    }

    fn sample(&self, wo: Vec3, _: f32, u: [f32; 2], mode: Mode, _: Lobes) -> Option<BsdfSample> {
        let wi = Vec3::from(cosine_direction(u, wo.z));
        let (f, pdf) = (self.f(wo, wi, mode), self.pdf(wo, wi, mode, Lobes::ALL));
        Some(BsdfSample::new(wi, f, pdf, self.lobes()))
    }

    fn lobes(&self) -> Lobes {
        Lobes::REFLECTION | Lobes::DIFFUSE
    }

    fn diffuse_share(&self, _: Vec3, _: Vec3, _: Spectrum) -> Spectrum {
        Spectrum([1.0; 4])
    }

    fn description(&self) -> Description {
        Description {
            kind: "clay",
            does: "Oren and Nayar's rough matte surface",
            numbers: vec![("reflectance", self.reflectance.into()), ("sigma", self.sigma.into())],
        }
    }
}
