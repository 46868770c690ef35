//! OpenPBR 1.1: the surface model of MaterialX, Maya and Blender.

use super::{Color, NormalTexture, Scalar};
use crate::scene::TextureId;

/// The surface of OpenPBR 1.1 (Academy Software Foundation 2024), by the specification's parameters: a mix of metal and dielectric,
/// under a coat and fuzz.
///
/// Emission and opacity are those of shapes, a medium inside is that of the material, subsurface scattering in depth is a material of
/// its own.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenPbr {
    /// Factor of [`Self::base_color`].
    pub base_weight: Scalar,
    /// Albedo of the diffuse base; reflectance of the metal at normal incidence.
    pub base_color: Color,
    /// Roughness of the diffuse base (EON, Portsmouth, Kutz & Hill 2025).
    pub base_diffuse_roughness: Scalar,
    /// 0 is a dielectric, 1 a metal.
    pub base_metalness: Scalar,
    /// Factor of the dielectric's reflectance at normal incidence, by its index of refraction, and of the metal's: ≥ 0.
    pub specular_weight: Scalar,
    /// Tint of the dielectric's reflection, and of the metal's at 82°.
    pub specular_color: Color,
    /// Roughness of metal and dielectric: α is its square.
    pub specular_roughness: Scalar,
    /// Stretch of their highlights along the tangent.
    pub specular_roughness_anisotropy: Scalar,
    /// Index of refraction of the dielectric: > 0.
    pub specular_ior: f32,
    /// The part of the dielectric that is translucent.
    pub transmission_weight: Scalar,
    /// Tint of transmitted light; white where the medium inside has the colour.
    pub transmission_color: Color,
    /// Dispersion of the dielectric, 20 over its Abbe number; 0 means none.
    pub dispersion: f32,
    /// The part of the opaque dielectric that has the colour below instead of the base colour.
    pub subsurface_weight: Scalar,
    /// Reflectance of that part.
    pub subsurface_color: Color,
    /// Of a thin wall: the light that this part scatters leaves in front (−1), on the other side (1), or both (0).
    pub subsurface_scatter_anisotropy: f32,
    /// Presence of the coat.
    pub coat_weight: Scalar,
    /// The square of its transmittance at normal incidence.
    pub coat_color: Color,
    /// Its roughness: α is its square.
    pub coat_roughness: Scalar,
    /// Stretch of its highlights along its tangent.
    pub coat_roughness_anisotropy: Scalar,
    /// Its index of refraction: > 0.
    pub coat_ior: f32,
    /// The darkening of the base by interreflection below the coat: 0 is none.
    pub coat_darkening: Scalar,
    /// Presence of the fuzz.
    pub fuzz_weight: Scalar,
    /// Its colour.
    pub fuzz_color: Color,
    /// Its roughness (Zeltner, Burley & Chiang 2022).
    pub fuzz_roughness: Scalar,
    /// Presence of the thin film.
    pub thin_film_weight: Scalar,
    /// Its thickness in µm.
    pub thin_film_thickness: Scalar,
    /// Its index of refraction: > 0.
    pub thin_film_ior: f32,
    /// Whether the surface is a sheet without an inside, the same from both sides.
    pub geometry_thin_walled: bool,
    /// Normal map of the coat; `None` for the mesh's normals, without [`super::Material::bump_mapping`].
    pub geometry_coat_normal: Option<NormalTexture>,
    /// The direction of the base's grain in the tangent frame.
    pub geometry_tangent: Tangent,
    /// The direction of the coat's grain in the tangent frame.
    pub geometry_coat_tangent: Tangent,
}

/// A direction in the tangent frame, of any length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tangent {
    /// Along u and v.
    Value([f32; 2]),
    /// Along u and v: twice red and green, less one.
    Texture(TextureId),
}

impl Tangent {
    /// Along u.
    pub const U: Self = Self::Value([1.0, 0.0]);

    /// Its texture.
    pub fn texture(self) -> Option<TextureId> {
        match self {
            Self::Value(_) => None,
            Self::Texture(id) => Some(id),
        }
    }
}

impl OpenPbr {
    /// Index of refraction of the coat where a file does not set it.
    pub const COAT_IOR: f32 = 1.6;
    /// Mean free path below the surface where a file does not set it, by primary.
    pub const RADIUS_SCALE: [f32; 3] = [1.0, 0.5, 0.25];
    /// The Abbe number where a file does not set it.
    pub const ABBE_NUMBER: f32 = 20.0;

    /// Whether light may pass into a body.
    pub fn is_body(&self) -> bool {
        !self.geometry_thin_walled
            && self.transmission_weight != Scalar::Value(0.0)
            && self.base_metalness != Scalar::Value(1.0)
    }

    /// α along the tangent and across it, of a roughness and an anisotropy of 0 … 1: their squares have the same mean for
    /// every anisotropy.
    pub fn alphas(roughness: f32, anisotropy: f32) -> [f32; 2] {
        let across = 1.0 - anisotropy;
        let along = roughness * roughness * (2.0 / (1.0 + across * across)).sqrt();
        [along, across * along]
    }

    /// Coefficients of absorption and scattering, per unit of length, of a medium in which white light has a colour after a
    /// length, and scatters: `depth` > 0.
    pub fn medium(color: [f32; 3], depth: f32, scatter: [f32; 3]) -> [[f32; 3]; 2] {
        // What is black has no coefficient: as dark as half floats tell.
        let extinction = color.map(|lane| -libm::log(f64::from(lane.clamp(6e-8, 1.0))) / f64::from(depth));
        let scattering = scatter.map(|lane| f64::from(lane) / f64::from(depth));
        let absorption = [0, 1, 2].map(|k| extinction[k] - scattering[k]);
        // Grey is added where there would be less than none.
        let least = absorption.into_iter().fold(0.0, f64::min);
        [absorption.map(|lane| (lane - least).max(0.0) as f32), scattering.map(|lane| lane as f32)]
    }

    /// Its numbers that may be textures, by name.
    pub fn scalars(&self) -> [(&'static str, Scalar); 16] {
        [
            ("base_weight", self.base_weight),
            ("base_diffuse_roughness", self.base_diffuse_roughness),
            ("base_metalness", self.base_metalness),
            ("specular_weight", self.specular_weight),
            ("specular_roughness", self.specular_roughness),
            ("specular_roughness_anisotropy", self.specular_roughness_anisotropy),
            ("transmission_weight", self.transmission_weight),
            ("subsurface_weight", self.subsurface_weight),
            ("coat_weight", self.coat_weight),
            ("coat_roughness", self.coat_roughness),
            ("coat_roughness_anisotropy", self.coat_roughness_anisotropy),
            ("coat_darkening", self.coat_darkening),
            ("fuzz_weight", self.fuzz_weight),
            ("fuzz_roughness", self.fuzz_roughness),
            ("thin_film_weight", self.thin_film_weight),
            ("thin_film_thickness", self.thin_film_thickness),
        ]
    }

    /// Its colours, by name.
    pub fn colors(&self) -> [(&'static str, Color); 6] {
        [
            ("base_color", self.base_color),
            ("specular_color", self.specular_color),
            ("transmission_color", self.transmission_color),
            ("subsurface_color", self.subsurface_color),
            ("coat_color", self.coat_color),
            ("fuzz_color", self.fuzz_color),
        ]
    }

    /// The textures of its directions.
    pub(super) fn directions(&self) -> impl Iterator<Item = TextureId> {
        let tangents = [self.geometry_tangent, self.geometry_coat_tangent];
        tangents
            .into_iter()
            .filter_map(Tangent::texture)
            .chain(self.geometry_coat_normal.map(|map| map.texture))
    }
}

impl Default for OpenPbr {
    /// The specification's.
    fn default() -> Self {
        let [none, all] = [0.0, 1.0].map(Scalar::Value);
        Self {
            base_weight: all,
            base_color: Color::gray(0.8),
            base_diffuse_roughness: none,
            base_metalness: none,
            specular_weight: all,
            specular_color: Color::gray(1.0),
            specular_roughness: Scalar::Value(0.3),
            specular_roughness_anisotropy: none,
            specular_ior: 1.5,
            transmission_weight: none,
            transmission_color: Color::gray(1.0),
            dispersion: 0.0,
            subsurface_weight: none,
            subsurface_color: Color::gray(0.8),
            subsurface_scatter_anisotropy: 0.0,
            coat_weight: none,
            coat_color: Color::gray(1.0),
            coat_roughness: none,
            coat_roughness_anisotropy: none,
            coat_ior: Self::COAT_IOR,
            coat_darkening: all,
            fuzz_weight: none,
            fuzz_color: Color::gray(1.0),
            fuzz_roughness: Scalar::Value(0.5),
            thin_film_weight: none,
            thin_film_thickness: Scalar::Value(0.5),
            thin_film_ior: 1.4,
            geometry_thin_walled: false,
            geometry_coat_normal: None,
            geometry_tangent: Tangent::U,
            geometry_coat_tangent: Tangent::U,
        }
    }
}
