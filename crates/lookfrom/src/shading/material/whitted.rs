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

use lookfrom_simd::{Float, Mask, Real};

use super::kind::WhittedMaterial;
use crate::core::math;
use crate::core::optics;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::texture::{SpectralMode, SpectrumTexture, TexturePoint, Textures};

/// Whitted's coefficients at a point, or at several side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients<R: Real = f32> {
    /// `k_a`.
    pub ambient: Spectrum<R>,
    /// `k_d`.
    pub diffuse: Spectrum<R>,
    /// `k_s`.
    pub specular: Spectrum<R>,
    /// `n`.
    pub shininess: R,
    /// `k_r`.
    pub mirror: Spectrum<R>,
    /// `k_t`.
    pub transmission: Spectrum<R>,
    /// Index of refraction, inside over outside.
    pub ior: R,
    /// True if the angle determines the split between reflection and refraction (Fresnel).
    pub fresnel: R::Mask,
}

/// The two directions in which the ray tree branches, each with its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branches<R: Real = f32> {
    /// Toward `S`, unit length, and its weight.
    pub mirrored: (Vector<R>, Spectrum<R>),
    /// Toward `T`, unit length, and its weight.
    pub refracted: (Vector<R>, Spectrum<R>),
    /// False for total reflection and where nothing is transmitted.
    pub is_refracted: R::Mask,
    /// The Fresnel reflectance; 1 for total internal reflection. Without a meaning where the angle does not matter.
    pub fresnel: R,
    /// True for total internal reflection: Snell's law has no solution.
    pub total_reflection: R::Mask,
}

impl Coefficients {
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

impl<R: Real> Coefficients<R> {
    /// True if direct light contributes.
    #[inline(always)]
    pub fn is_lit(&self) -> R::Mask {
        !(self.diffuse.is_black() & self.specular.is_black())
    }

    /// `k_d (N·L)` and `k_s (N·H)ⁿ`, for `N·L > 0`; `n`, `wo`, `wi` of unit length, `n` on the side of `wo`.
    #[inline(always)]
    pub fn lit(&self, n: Vector<R>, wo: Vector<R>, wi: Vector<R>) -> (Spectrum<R>, Spectrum<R>) {
        let diffuse = self.diffuse * n.dot(wi);
        if self.specular.is_black().all() {
            return (diffuse, self.specular);
        }
        let (half, exists) = (wo + wi).try_normalize();
        let zero = self.shininess.like(0.0);
        let cos = R::select(exists, Float::max(n.dot(half), zero), zero);
        (diffuse, self.specular * math::power(cos, self.shininess))
    }

    /// True if the ray tree branches: where light is reflected or transmitted.
    #[inline(always)]
    pub fn has_branches(&self) -> R::Mask {
        !(self.mirror.is_black() & self.transmission.is_black())
    }

    /// The branches of the ray tree, where there are any. `n` and `wo` of unit length on one side; `front` where that is the
    /// outside.
    ///
    /// With `fresnel` the fraction `F` of the larger of `k_r` and `k_t` is reflected, and `(1 − F) k_t` is
    /// refracted. Total internal reflection sends everything into the reflected direction.
    #[inline(always)]
    pub fn branches(&self, n: Vector<R>, wo: Vector<R>, front: R::Mask) -> Branches<R> {
        let (k_r, k_t) = (self.mirror, self.transmission);
        let has_transmission = !k_t.is_black();
        let one = self.ior.like(1.0);
        let black = Spectrum::splat(self.ior.like(0.0));
        let (mut mirror, mut refracted, mut fresnel) = (k_r, (n, black), one);
        let mut is_refracted = has_transmission.like(false);
        let mut total_reflection = is_refracted;
        if (has_transmission | self.fresnel).any() {
            let eta = R::select(front, self.ior, one / self.ior);
            let (bent, is_bent) = optics::refract(wo, n, eta);
            total_reflection = !is_bent & has_transmission;
            mirror = Spectrum::select(total_reflection, k_r + k_t, k_r);
            let mut transmission = Spectrum::select(total_reflection, black, k_t);
            if self.fresnel.any() {
                fresnel = optics::fresnel_dielectric(n.dot(wo), eta);
                mirror = Spectrum::select(self.fresnel, k_r.zip(k_t, Float::max) * fresnel, mirror);
                transmission = Spectrum::select(self.fresnel, k_t * (one - fresnel), transmission);
            }
            refracted = (bent.normalize(), transmission);
            is_refracted = is_bent & !transmission.is_black();
        }
        let mirrored = (optics::reflect(wo, n).normalize(), mirror);
        Branches { mirrored, refracted, is_refracted, fresnel, total_reflection }
    }
}
