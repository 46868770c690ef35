//! glTF's material, and what metals and bodies are made of.

use super::{Color, Ior, NormalTexture, Scalar};
use crate::scene::TextureId;

/// glTF 2.0's metallic-roughness material with its extensions: a weighted mix of metal, dielectric and diffuse base, under
/// sheen and a clear coat. All parameters are those of the extensions, with textures and factors multiplied.
#[derive(Clone, Debug, PartialEq)]
pub struct Principled {
    /// Normal-incidence reflectance of the metal; albedo or tint of the dielectric.
    pub base_color: Color,
    /// 0 is a dielectric, 1 a metal.
    pub metallic: Scalar,
    /// Perceptual roughness: α is its square.
    pub roughness: Scalar,
    /// Anisotropy of the highlight (`KHR_materials_anisotropy`).
    pub anisotropy: Option<Anisotropy>,
    /// Index of refraction (`KHR_materials_ior`); 0 means infinity: the Fresnel reflectance is 1 times the specular colour.
    pub ior: f32,
    /// 20 divided by the Abbe number (`KHR_materials_dispersion`); 0 means no dispersion.
    pub dispersion: f32,
    /// Strength of a dielectric's specular reflection (`KHR_materials_specular`).
    pub specular: Scalar,
    /// Colour of a dielectric's specular reflection at normal incidence.
    pub specular_color: Color,
    /// The fraction of light not reflected specularly that is transmitted instead of scattered
    /// (`KHR_materials_transmission`).
    pub transmission: Scalar,
    /// Whether the surface bounds a refracting volume (`KHR_materials_volume` with a thickness); otherwise it is a thin
    /// sheet.
    pub is_solid: bool,
    /// Absorption coefficient of the volume in world units, for each primary: ≥ 0. [`Material::medium`](super::Material::medium) replaces it.
    pub absorption: [f32; 3],
    /// The fraction of diffuse light that is transmitted instead of reflected (`KHR_materials_diffuse_transmission`).
    pub diffuse_transmission: Scalar,
    /// Colour of the diffuse transmission.
    pub diffuse_transmission_color: Color,
    /// Strength of a clear coat (`KHR_materials_clearcoat`); its index of refraction is 1.5.
    pub clearcoat: Scalar,
    /// Perceptual roughness of the clear coat: α is its square.
    pub clearcoat_roughness: Scalar,
    /// Normal map of the clear coat; `None` for the mesh's normals, without [`Material::bump_mapping`](super::Material::bump_mapping).
    pub clearcoat_normal: Option<NormalTexture>,
    /// Colour of the sheen of fibres (`KHR_materials_sheen`); black means no sheen.
    pub sheen_color: Color,
    /// Roughness of the sheen, whose square is the α of the Charlie distribution (Estevez & Kulla 2017).
    pub sheen_roughness: Scalar,
    /// Strength of the thin-film effect (`KHR_materials_iridescence`, Belcour & Barla 2017).
    pub iridescence: Scalar,
    /// Index of refraction of the film.
    pub iridescence_ior: f32,
    /// Thickness of the film in nm.
    pub iridescence_thickness: Scalar,
}

impl Principled {
    /// Index of refraction of a thin film where a file does not set one (`KHR_materials_iridescence`).
    pub const FILM_IOR: f32 = 1.3;
    /// Thickness of a thin film in nm where a file does not set one (`KHR_materials_iridescence`).
    pub const FILM_THICKNESS: f32 = 400.0;
}

impl Default for Principled {
    /// glTF's default material.
    fn default() -> Self {
        Self {
            base_color: Color::gray(1.0),
            metallic: Scalar::Value(1.0),
            roughness: Scalar::Value(1.0),
            anisotropy: None,
            ior: Ior::GLASS,
            dispersion: 0.0,
            specular: Scalar::Value(1.0),
            specular_color: Color::gray(1.0),
            transmission: Scalar::Value(0.0),
            is_solid: false,
            absorption: [0.0; 3],
            diffuse_transmission: Scalar::Value(0.0),
            diffuse_transmission_color: Color::gray(1.0),
            clearcoat: Scalar::Value(0.0),
            clearcoat_roughness: Scalar::Value(0.0),
            clearcoat_normal: None,
            sheen_color: Color::BLACK,
            sheen_roughness: Scalar::Value(0.0),
            iridescence: Scalar::Value(0.0),
            iridescence_ior: Self::FILM_IOR,
            iridescence_thickness: Scalar::Value(Self::FILM_THICKNESS),
        }
    }
}

/// Elongation of the highlight along a direction of the surface (`KHR_materials_anisotropy`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anisotropy {
    /// From 0, isotropic, to 1, the maximum.
    pub strength: f32,
    /// Angle from the tangent (u) toward the bitangent (v), in radians.
    pub rotation: f32,
    /// Red and green, 2·texel − 1, are a direction in the tangent frame, to which `rotation` is added; blue multiplies the
    /// strength.
    pub texture: Option<TextureId>,
}

/// The light under which a curve is seen where it becomes a colour of Rec. 709.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Illuminant {
    /// Daylight, the white of Rec. 709: a constant curve is grey.
    #[default]
    D65,
    /// Light of equal energy at all wavelengths, which is not that white: a constant curve is reddish. Mitsuba's metals are seen under it.
    EqualEnergy,
}

/// The optical constants of a metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Metal {
    /// The complex index of refraction η + i k, relative to vacuum.
    Indices {
        /// η.
        eta: Color,
        /// k.
        k: Color,
        /// The light under which curves have their colours in RGB mode.
        illuminant: Illuminant,
    },
    /// The reflectance at normal incidence: η = 1 and the k that gives it.
    Reflectance(Color),
}
