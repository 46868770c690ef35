//! Albedo for AOVs and the denoiser: one colour per surface.
//!
//! A look-up of base colours, as in Cycles and Open Image Denoise, not an integral over directions: the reflection
//! of a coat is left out, glass is white, a metal has its reflectance at normal incidence.

use std::cell::Cell;

use lookfrom_simd::{Float, Real};

use super::{Material, MaterialKind, Metal};
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::fresnel;
use crate::shading::texture::{FloatTexture, SpectrumTexture, TexturePoint, Textures};

/// Linear Rec. 709, at least 0; white where a surface has no colour of its own.
#[inline]
pub fn albedo(
    materials: &[Material],
    textures: &Textures,
    material: &Material,
    point: &TexturePoint,
) -> [f32; 3] {
    material.albedo.unwrap_or_else(|| {
        let color = |texture: &SpectrumTexture| Spectrum::from_rgb(textures.rgb(texture, point));
        shown(of_kind(&material.kind, materials, &color, &|texture| textures.float(texture, point)))
    })
}

impl Material {
    /// Its [`albedo()`], where that is known to be the same everywhere.
    #[inline]
    pub(crate) fn even_albedo(&self) -> Option<[f32; 3]> {
        self.albedo
    }

    /// Whether its [`albedo()`] is [`of_coefficients`].
    #[inline]
    pub(crate) fn has_albedo_of_coefficients(&self) -> bool {
        matches!(self.kind, MaterialKind::Whitted(_) | MaterialKind::Diffuse { .. })
    }
}

/// The albedo of Whitted's model, by its coefficients `k_d`, `k_r` and `k_t` in RGB.
#[inline(always)]
pub(crate) fn of_coefficients<R: Real>([diffuse, mirror, transmission]: [Spectrum<R>; 3]) -> [R; 3] {
    let [r, g, b, _] = (diffuse + mirror + transmission).0;
    [Float::clamp(r, 0.0, 1.0), Float::clamp(g, 0.0, 1.0), Float::clamp(b, 0.0, 1.0)]
}

/// The albedo of a kind of material that has the same colours everywhere; `None` where they may vary.
pub(super) fn constant(kind: &MaterialKind, textures: &Textures) -> Option<[f32; 3]> {
    // The materials of a mix are not known here.
    if matches!(kind, MaterialKind::Mix { .. }) {
        return None;
    }
    let (point, varies) = (&TexturePoint::NOWHERE, Cell::new(false));
    let color = |texture: &SpectrumTexture| {
        varies.set(varies.get() || texture.varies());
        Spectrum::from_rgb(textures.rgb(texture, point))
    };
    let float = |texture: FloatTexture| {
        varies.set(varies.get() || texture.varies());
        textures.float(texture, point)
    };
    let albedo = of_kind(kind, &[], &color, &float);
    (!varies.get()).then(|| shown(albedo))
}

impl Metal {
    /// At normal incidence.
    fn reflectance(&self, color: impl Fn(&SpectrumTexture) -> Spectrum) -> Spectrum {
        match self {
            Self::Reflectance(reflectance) => color(reflectance),
            Self::Indices { eta, k } => fresnel::conductor(1.0, color(eta), color(k)),
        }
    }
}

fn shown(color: Spectrum) -> [f32; 3] {
    color.rgb().map(|c| c.max(0.0))
}

/// The albedo of a kind of material, by the values of colours and numbers at a point.
fn of_kind(
    kind: &MaterialKind,
    materials: &[Material],
    color: &impl Fn(&SpectrumTexture) -> Spectrum,
    float: &impl Fn(FloatTexture) -> f32,
) -> Spectrum {
    match kind {
        MaterialKind::Whitted(k) => {
            let coefficients = [color(&k.diffuse), color(&k.mirror), color(&k.transmission)];
            Spectrum::from_rgb(of_coefficients(coefficients))
        }
        // Whitted's k_d may be above 1.
        MaterialKind::Diffuse { reflectance } | MaterialKind::CoatedDiffuse { reflectance, .. } => {
            color(reflectance).map(|lane| lane.clamp(0.0, 1.0))
        }
        MaterialKind::Plastic(plastic) => color(&plastic.reflectance),
        MaterialKind::DiffuseTransmission { reflectance, transmittance, scale } => {
            (color(reflectance) + color(transmittance)) * *scale
        }
        MaterialKind::Conductor { metal, specular_reflectance, .. } => {
            metal.reflectance(color) * color(specular_reflectance)
        }
        MaterialKind::CoatedConductor { metal, .. } => metal.reflectance(color),
        MaterialKind::Subsurface(below) => below.effective_albedo(color),
        MaterialKind::Hair(hair) => hair.reflectance(color, float),
        MaterialKind::Measured(tables) => Spectrum::from_rgb(tables.albedo()),
        MaterialKind::Mix { materials: parts, amount } => {
            let [first, second] =
                parts.map(|part| of_kind(&materials[part as usize].kind, materials, color, float));
            let amount = float(*amount).clamp(0.0, 1.0);
            first * (1.0 - amount) + second * amount
        }
        MaterialKind::Principled(look) => color(&look.base_color),
        MaterialKind::Disney(look) => color(&look.base_color),
        MaterialKind::OpenPbr(look) => {
            let part = float(look.subsurface_weight).clamp(0.0, 1.0);
            let base = color(&look.base_color) * float(look.base_weight).clamp(0.0, 1.0);
            base * (1.0 - part) + color(&look.subsurface_color) * part
        }
        MaterialKind::Unlit { albedo, .. } => color(albedo),
        MaterialKind::Dielectric { .. }
        | MaterialKind::TintedDielectric { .. }
        | MaterialKind::ThinDielectric { .. }
        | MaterialKind::ShadowCatcher { .. }
        | MaterialKind::Interface => Spectrum::ONE,
    }
}
