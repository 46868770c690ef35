//! The evaluation of a material at a point: the values of its textures there, as the parameters of a BSDF.

use lookfrom_scene::material::Energy;
use lookfrom_scene::scene::CurveId;

use super::{CoatMaterial, Ior, Material, MaterialKind, Metal, PlasticMaterial, Roughness, TintTextures};
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::conductor::Conductor;
use crate::shading::bsdf::dielectric::Dielectric;
use crate::shading::bsdf::diffuse::{Diffuse, DiffuseTransmission};
use crate::shading::bsdf::layered::{CoatLayer, Layered};
use crate::shading::bsdf::plastic::Plastic;
use crate::shading::bsdf::thin_dielectric::ThinDielectric;
use crate::shading::bsdf::tinted::{Tint, TintedDielectric};
use crate::shading::bsdf::{Bsdf, fresnel};
use crate::shading::interior_stack::InteriorStack;
use crate::shading::texture::{FloatTexture, SpectralMode, SpectrumTexture, TexturePoint, Textures};

/// The state of a path that the shading of a surface depends on.
#[derive(Debug)]
pub struct ShadingContext<'a> {
    /// Meaning of the lanes. Where wavelengths are dispersed, only the first is kept.
    pub mode: &'a mut SpectralMode,
    /// The path throughput. In RGB mode, where colours are dispersed, one of its primaries is kept, weighted
    /// to stand for all.
    pub throughput: &'a mut Spectrum,
    /// The bodies and media that the light travels through.
    pub interior: InteriorStack,
    /// Random number in [0, 1) that chooses among mixed materials and dispersed colours. Used where
    /// [`Material::is_stochastic`].
    pub u: f32,
    /// Random number in [0, 1) that seeds the walks of layered BSDFs.
    pub seed: f32,
}

/// The evaluation of a material at a point.
pub(crate) struct Evaluator<'a> {
    pub(super) materials: &'a [Material],
    pub(super) textures: &'a Textures,
    pub(super) point: &'a TexturePoint<'a>,
    pub(super) mode: &'a mut SpectralMode,
    pub(super) throughput: &'a mut Spectrum,
    pub(super) interior: InteriorStack,
    pub(super) u: f32,
    pub(super) seed: f32,
}

impl<'a> Evaluator<'a> {
    pub(super) fn new(
        materials: &'a [Material],
        textures: &'a Textures,
        point: &'a TexturePoint,
        context: ShadingContext<'a>,
    ) -> Self {
        let ShadingContext { mode, throughput, interior, u, seed } = context;
        Self { materials, textures, point, mode, throughput, interior, u, seed }
    }
}

impl Evaluator<'_> {
    /// The BSDF of a material, by its index; of one that has any, and is not evaluated above.
    pub(super) fn bsdf(&mut self, index: u32) -> Option<Bsdf> {
        let materials = self.materials;
        Some(match &materials[index as usize].kind {
            MaterialKind::Whitted(whitted) => Bsdf::Whitted(self.whitted(whitted)),
            MaterialKind::Diffuse { reflectance } => Bsdf::Diffuse(self.diffuse(reflectance)),
            MaterialKind::DiffuseTransmission { reflectance, transmittance, scale } => {
                Bsdf::DiffuseTransmission(self.diffuse_transmission(reflectance, transmittance, scale))
            }
            MaterialKind::Conductor { metal, roughness, energy, specular_reflectance } => {
                Bsdf::Conductor(self.conductor(metal, roughness, energy, specular_reflectance))
            }
            MaterialKind::Dielectric { eta, roughness, energy } => {
                Bsdf::Dielectric(self.dielectric(eta, roughness, energy))
            }
            MaterialKind::TintedDielectric { eta, roughness, energy, tint } => {
                Bsdf::TintedDielectric(self.tinted_dielectric(eta, roughness, energy, tint))
            }
            MaterialKind::ThinDielectric { eta, tint } => {
                Bsdf::ThinDielectric(self.thin_dielectric(eta, tint))
            }
            MaterialKind::CoatedDiffuse { reflectance, coat } => {
                Bsdf::CoatedDiffuse(self.coated_diffuse(reflectance, coat))
            }
            MaterialKind::CoatedConductor { metal, roughness, coat } => {
                Bsdf::CoatedConductor(self.coated_conductor(metal, roughness, coat))
            }
            MaterialKind::Disney(look) => Bsdf::Disney(self.disney(look)),
            MaterialKind::Plastic(plastic) => Bsdf::Plastic(self.plastic(plastic)),
            MaterialKind::Hair(hair) => Bsdf::Hair(self.hair(hair)),
            MaterialKind::Measured(tables) => Bsdf::Measured(self.measured(tables)),
            MaterialKind::Subsurface(below) => Bsdf::Subsurface(self.subsurface(below, index)),
            // Its emission is all that is visible: see [`unlit`].
            MaterialKind::Unlit { .. } => Bsdf::diffuse(Spectrum::BLACK),
            // Mixtures are resolved above, materials of layers need the surface, and shadow catchers are shaded by the
            // world.
            MaterialKind::Mix { .. }
            | MaterialKind::Principled(_)
            | MaterialKind::OpenPbr(_)
            | MaterialKind::ShadowCatcher { .. }
            | MaterialKind::Interface => return None,
        })
    }

    #[inline]
    pub(super) fn diffuse(&self, reflectance: &SpectrumTexture) -> Diffuse {
        match reflectance.is_unbounded() {
            true => Diffuse { reflectance: self.textures.spectrum(reflectance, self.point, self.mode) },
            false => Diffuse::new(self.albedo(reflectance)),
        }
    }

    #[inline]
    pub(super) fn diffuse_transmission(
        &self,
        reflectance: &SpectrumTexture,
        transmittance: &SpectrumTexture,
        scale: &f32,
    ) -> DiffuseTransmission {
        let [reflected, transmitted] = [reflectance, transmittance]
            .map(|color| self.textures.spectrum(color, self.point, self.mode) * *scale);
        DiffuseTransmission::new(reflected, transmitted)
    }

    pub(super) fn conductor(
        &self,
        metal: &Metal,
        roughness: &Roughness,
        &energy: &Energy,
        specular_reflectance: &SpectrumTexture,
    ) -> Conductor {
        let (eta, k) = self.indices(metal);
        Conductor::new(eta, k, roughness.at(self.textures, self.point))
            .with_energy(energy)
            .with_specular_reflectance(self.albedo(specular_reflectance))
    }

    pub(super) fn dielectric(&mut self, eta: &Ior, roughness: &Roughness, &energy: &Energy) -> Dielectric {
        Dielectric::new(self.ior(eta), roughness.at(self.textures, self.point)).with_energy(energy)
    }

    pub(super) fn tinted_dielectric(
        &mut self,
        eta: &Ior,
        roughness: &Roughness,
        energy: &Energy,
        tint: &TintTextures,
    ) -> TintedDielectric {
        TintedDielectric { boundary: self.dielectric(eta, roughness, energy), tint: self.tint(tint) }
    }

    pub(super) fn thin_dielectric(&mut self, eta: &Ior, tint: &Option<Box<TintTextures>>) -> ThinDielectric {
        let tint = tint.as_ref().map_or(Tint::NONE, |tint| self.tint(tint));
        ThinDielectric::new(self.ior(eta)).with_tint(tint)
    }

    pub(super) fn tint(&self, tint: &TintTextures) -> Tint {
        Tint { reflectance: self.albedo(&tint.reflectance), transmittance: self.albedo(&tint.transmittance) }
    }

    pub(super) fn coated_diffuse(
        &mut self,
        reflectance: &SpectrumTexture,
        coat: &CoatMaterial,
    ) -> Layered<Diffuse> {
        let coat = self.coat(coat);
        Layered::coated_diffuse(self.diffuse(reflectance), &coat, self.seed)
    }

    pub(super) fn coated_conductor(
        &mut self,
        metal: &Metal,
        roughness: &Roughness,
        coat: &CoatMaterial,
    ) -> Layered<Conductor> {
        let coat = self.coat(coat);
        let (eta, k) = self.indices(metal);
        Layered::coated_conductor(eta, k, roughness.at(self.textures, self.point), &coat, self.seed)
    }

    pub(super) fn plastic(&self, plastic: &PlasticMaterial) -> Plastic {
        let (base, surface) = (self.albedo(&plastic.reflectance), self.albedo(&plastic.specular_reflectance));
        Plastic::new(base, surface, plastic.is_nonlinear, plastic.interface)
    }

    #[inline]
    pub(super) fn albedo(&self, color: &SpectrumTexture) -> Spectrum {
        self.textures.albedo(color, self.point, self.mode)
    }

    pub(super) fn float(&self, texture: FloatTexture) -> f32 {
        self.textures.float(texture, self.point)
    }

    /// η and k.
    pub(super) fn indices(&self, metal: &Metal) -> (Spectrum, Spectrum) {
        let spectrum = |texture| self.textures.spectrum(texture, self.point, self.mode);
        match metal {
            Metal::Indices { eta, k } => (spectrum(eta), spectrum(k)),
            Metal::Reflectance(color) => fresnel::conductor_of_reflectance(spectrum(color)),
        }
    }

    /// The index of refraction; if it varies with wavelength, only the first wavelength is kept.
    pub(super) fn ior(&mut self, ior: &Ior) -> f32 {
        match ior {
            Ior::Value(eta) => *eta,
            Ior::Curve(curve) => ior_at(*curve, self.textures, self.mode),
        }
    }

    pub(super) fn coat(&mut self, coat: &CoatMaterial) -> CoatLayer {
        let eta = self.ior(&coat.eta);
        CoatLayer {
            eta,
            roughness: coat.roughness.at(self.textures, self.point),
            thickness: self.float(coat.thickness),
            albedo: self.albedo(&coat.albedo),
            g: self.float(coat.g).clamp(-1.0, 1.0),
            max_depth: coat.max_depth,
            samples: coat.samples,
            estimate: coat.estimate,
            interior: coat.interior,
        }
    }
}

/// The index of refraction of a curve: at the first wavelength, the only one kept afterwards; in RGB mode at
/// sodium's yellow line.
pub(super) fn ior_at(curve: CurveId, textures: &Textures, mode: &mut SpectralMode) -> f32 {
    let nm = match mode {
        SpectralMode::Rgb => [589.3; 4],
        SpectralMode::Spectral(wavelengths) => {
            wavelengths.terminate_secondary();
            wavelengths.lambda
        }
    };
    let [eta, ..] = textures.curve(curve).at(&nm).0;
    if eta > 0.0 { eta } else { 1.0 }
}
