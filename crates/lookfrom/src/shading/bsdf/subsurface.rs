//! The dielectric boundary of a medium in which light diffuses.

use glam::Vec3;

use super::dielectric::Dielectric;
use super::lobes::Lobes;
use super::normalized_fresnel::NormalizedFresnel;
use super::{Description, MicrofacetFactors, ScatteringFunction};
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
