//! The parameters of Whitted's model at a point.
//!
//! Whitted 1980: `I = k_a I_a + k_d Σ (N·L_j) I_j + k_s Σ (N·H_j)ⁿ I_j + k_r S + k_t T`, with Blinn's half vector
//! `H` between `L` and the viewing direction.
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

use glam::Vec3;

use super::kind::Whitted;
use crate::core::math;
use crate::core::optics;
use crate::core::spectrum::Spectrum;
use crate::shading::texture::{SpectralMode, SpectrumTexture, TexturePoint, Textures};

/// Whitted's coefficients at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// `k_a`.
    pub ambient: Spectrum,
    /// `k_d`.
    pub diffuse: Spectrum,
    /// `k_s`.
    pub specular: Spectrum,
    /// `n`.
    pub shininess: f32,
    /// `k_r`.
    pub mirror: Spectrum,
    /// `k_t`.
    pub transmission: Spectrum,
    /// Index of refraction, inside over outside.
    pub ior: f32,
    /// True if the angle determines the split between reflection and refraction (Fresnel).
    pub fresnel: bool,
}

/// The two directions in which the ray tree branches, each with its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branches {
    /// Toward `S`, unit length, and its weight.
    pub mirrored: (Vec3, Spectrum),
    /// Toward `T`, unit length, and its weight; `None` for total reflection or where nothing is transmitted.
    pub refracted: Option<(Vec3, Spectrum)>,
    /// The Fresnel reflectance; 1 for total internal reflection, `None` where the angle does not matter.
    pub fresnel: Option<f32>,
    /// True for total internal reflection: Snell's law has no solution.
    pub total_reflection: bool,
}

impl Coefficients {
    /// The material's coefficients at a point.
    pub fn at(material: &Whitted, textures: &Textures, point: &TexturePoint, mode: &SpectralMode) -> Self {
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

    /// True if direct light contributes.
    pub fn is_lit(&self) -> bool {
        !(self.diffuse.is_black() && self.specular.is_black())
    }

    /// `k_d (N·L)` and `k_s (N·H)ⁿ`; `n`, `wo`, `wi` of unit length, `n` on the side of `wo`.
    pub fn lit(&self, n: Vec3, wo: Vec3, wi: Vec3) -> (Spectrum, Spectrum) {
        let n_dot_l = n.dot(wi);
        if n_dot_l <= 0.0 {
            return (Spectrum::BLACK, Spectrum::BLACK);
        }
        let specular = if self.specular.is_black() {
            Spectrum::BLACK
        } else {
            let h = (wo + wi).normalize_or_zero();
            self.specular * math::power(n.dot(h).max(0.0), self.shininess)
        };
        (self.diffuse * n_dot_l, specular)
    }

    /// The branches of the ray tree. `n` and `wo` of unit length on one side; `front` if that is the outside.
    ///
    /// With `fresnel` the fraction `F` of the larger of `k_r` and `k_t` is reflected, and `(1 − F) k_t` is
    /// refracted. Total internal reflection sends everything into the reflected direction.
    pub fn branches(&self, n: Vec3, wo: Vec3, front: bool) -> Option<Branches> {
        if self.mirror.is_black() && self.transmission.is_black() {
            return None;
        }
        let eta = if front { self.ior } else { 1.0 / self.ior };
        let bent = math::refract(wo, n, eta);
        let total_reflection = bent.is_none() && !self.transmission.is_black();
        let fresnel = self.fresnel.then(|| optics::fresnel_dielectric(n.dot(wo), eta));
        let (mirror, transmission) = match fresnel {
            Some(part) => {
                (self.mirror.zip(self.transmission, f32::max) * part, self.transmission * (1.0 - part))
            }
            None if total_reflection => (self.mirror + self.transmission, Spectrum::BLACK),
            None => (self.mirror, self.transmission),
        };
        let refracted = bent.filter(|_| !transmission.is_black()).map(|wi| (wi.normalize(), transmission));
        Some(Branches {
            mirrored: (math::reflect(wo, n).normalize(), mirror),
            refracted,
            fresnel,
            total_reflection,
        })
    }
}
