//! The dielectric boundary of a medium in which light diffuses.

use glam::Vec3;

use super::dielectric::Dielectric;
use super::lobes::Lobes;
use super::normalized_fresnel::NormalizedFresnel;
use super::{BsdfSample, Description, MicrofacetFactors, Mode, ScatteringFunction};
use crate::core::spectrum::Spectrum;
use crate::shading::bssrdf::MediumBelow;

/// Scatters light as its boundary does; what is transmitted leaves at another point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Subsurface {
    pub(crate) boundary: Dielectric,
    pub(crate) medium: MediumBelow,
    /// The directions in which light leaves.
    pub(crate) exit: NormalizedFresnel,
    /// Index into the world's materials of the one that has the profiles.
    pub(crate) material: u32,
}

impl ScatteringFunction for Subsurface {
    fn f(&self, wo: Vec3, wi: Vec3, mode: Mode) -> Spectrum {
        ScatteringFunction::f(&self.boundary, wo, wi, mode)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, mode: Mode, lobes: Lobes) -> f32 {
        ScatteringFunction::pdf(&self.boundary, wo, wi, mode, lobes)
    }

    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2], mode: Mode, lobes: Lobes) -> Option<BsdfSample> {
        ScatteringFunction::sample(&self.boundary, wo, uc, u, mode, lobes)
    }

    fn lobes(&self) -> Lobes {
        self.boundary.lobes()
    }

    fn regularize(&mut self) {
        self.boundary.regularize();
    }

    fn factors(&self, wo: Vec3, wi: Vec3, is_specular: bool) -> Vec<MicrofacetFactors> {
        self.boundary.factors(wo, wi, is_specular)
    }

    fn description(&self) -> Description {
        Description {
            kind: "subsurface",
            does: "the boundary of a medium below it: reflects, and refracts light that diffuses there and leaves elsewhere",
            numbers: vec![
                ("eta", self.boundary.eta.into()),
                ("alpha", self.boundary.roughness.into()),
                ("extinction", self.medium.extinction.into()),
                ("albedo", self.medium.albedo.into()),
            ],
        }
    }
}
