//! Oren & Nayar (1994), "Generalization of Lambert's Reflectance Model": rough matte surfaces, by the qualitative model.

use std::f32::consts::FRAC_1_PI;

use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::bsdf::diffuse::{cosine_direction, cosine_pdf, cosine_sample};
use crate::shading::bsdf::lanes::LaneBsdf;
use crate::shading::bsdf::lobes::Lobes;
use crate::shading::bsdf::{Description, DirectionSample, ScatteringFunction, same_side};

/// Clay: facets that are matte each, so that its edges do not darken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clay {
    /// 0 … 1.
    pub reflectance: Spectrum,
    /// Standard deviation of the facets' angles, in radians.
    pub sigma: f32,
}

impl LaneBsdf<f32> for Clay {
    type Prepared = Vector<f32>;

    fn prepare(&self, wo: Vector<f32>) -> Vector<f32> {
        wo
    }

    fn f(&self, &wo: &Vector<f32>, wi: Vector<f32>) -> Spectrum {
        if !same_side(wo, wi) {
            return Spectrum::BLACK;
        }
        let variance = self.sigma * self.sigma;
        let matte = 1.0 - 0.5 * variance / (variance + 0.33);
        let rough = 0.45 * variance / (variance + 0.09);
        // sin α tan β cos (φ_i − φ_o), where α is the larger angle.
        let back = (wo.x * wi.x + wo.y * wi.y).max(0.0) / wo.z.abs().max(wi.z.abs());
        self.reflectance * (FRAC_1_PI * (matte + rough * back))
    }

    fn pdf(&self, &wo: &Vector<f32>, wi: Vector<f32>) -> f32 {
        cosine_pdf(wo, wi)
    }

    fn sample(&self, wo: &Vector<f32>, _: f32, u: [f32; 2]) -> DirectionSample<f32> {
        let wi = cosine_direction(u, wo.z);
        cosine_sample(*wo, wi, self.f(wo, wi))
    }

    fn has_density(&self) -> bool {
        true
    }

    fn diffuse_share(&self, _: &Vector<f32>, _: Vector<f32>, _: Spectrum) -> Spectrum {
        Spectrum([1.0; 4])
    }
}

impl ScatteringFunction for Clay {
    fn lobes(&self) -> Lobes {
        Lobes::REFLECTION | Lobes::DIFFUSE
    }

    fn description(&self) -> Description {
        Description {
            kind: "clay",
            does: "Oren and Nayar's rough matte surface",
            numbers: vec![("reflectance", self.reflectance.into()), ("sigma", self.sigma.into())],
        }
    }
}
