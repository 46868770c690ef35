//! The parameters of Whitted's model at a point.
//!
//! ```toml
//! [materials.glass]
//! diffuse = 0            # k_d
//! specular = 0.8         # k_s
//! shininess = 200        # n
//! transmission = 1       # k_t
//! ior = 1.5
//! fresnel = true         # the angle decides between mirror and refraction
//! absorption = [0.3, 0.05, 0.1]
//! ```

use super::Evaluator;
use super::kind::WhittedMaterial;
use crate::shading::bsdf::whitted::WhittedCoefficients;
use crate::shading::texture::{SpectralMode, SpectrumTexture, TexturePoint, Textures};

impl WhittedCoefficients {
    /// The material's coefficients at a point.
    pub fn at(
        material: &WhittedMaterial,
        textures: &Textures,
        point: &TexturePoint,
        mode: &SpectralMode,
    ) -> Self {
        let color = |texture: &SpectrumTexture| textures.spectrum(texture, point, mode);
        let diffuse = color(&material.diffuse);
        Self {
            ambient: material.ambient.as_ref().map_or(diffuse, color),
            diffuse,
            specular: color(&material.specular),
            shininess: material.shininess,
            mirror: color(&material.mirror),
            transmission: color(&material.transmission),
            ior: material.ior,
            fresnel: material.fresnel,
        }
    }
}

impl Evaluator<'_> {
    #[inline]
    pub(super) fn whitted(&self, material: &WhittedMaterial) -> WhittedCoefficients {
        WhittedCoefficients::at(material, self.textures, self.point, self.mode)
    }
}
