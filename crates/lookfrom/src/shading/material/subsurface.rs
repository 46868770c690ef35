//! Media below surfaces: from their parameters at a point to a BSSRDF.

use lookfrom_simd::Float;

use super::{Evaluator, SubsurfaceMaterial, SubsurfaceMedium};
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::dielectric::Dielectric;
use crate::shading::bsdf::subsurface::Subsurface;
use crate::shading::bssrdf::MediumBelow;
use crate::shading::texture::SpectrumTexture;

impl SubsurfaceMaterial {
    /// The medium, by the values of its textures.
    fn medium(&self, value: impl Fn(&SpectrumTexture) -> Spectrum) -> MediumBelow {
        let scaled = |texture| (value(texture) * self.scale).map(|lane| lane.max(0.0));
        match &self.medium {
            SubsurfaceMedium::Coefficients { absorption, scattering } => {
                MediumBelow::of_coefficients(scaled(absorption), scaled(scattering))
            }
            SubsurfaceMedium::Reflectance { reflectance, mean_free_path } => {
                let reflectance = value(reflectance).map(|lane| Float::clamp(lane, 0.0, 1.0));
                MediumBelow::of_reflectance(&self.profiles, reflectance, scaled(mean_free_path))
            }
        }
    }

    /// The fraction of the light that has entered which leaves again, by the values of its textures.
    pub(super) fn effective_albedo(&self, value: impl Fn(&SpectrumTexture) -> Spectrum) -> Spectrum {
        self.medium(value).effective_albedo(&self.profiles)
    }
}

impl Evaluator<'_> {
    /// The boundary, of the material of an index.
    pub(super) fn subsurface(&self, below: &SubsurfaceMaterial, material: u32) -> Subsurface {
        Subsurface {
            boundary: Dielectric::new(below.eta, below.roughness.at(self.textures, self.point)),
            medium: below.medium(|texture| self.textures.spectrum(texture, self.point, self.mode)),
            exit: below.exit,
            material,
        }
    }
}
