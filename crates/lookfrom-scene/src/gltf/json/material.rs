//! Materials and their extensions, and their references to textures.

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::{Whole, or_default};

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Material {
    pub(crate) name: Option<String>,
    pub(crate) pbr_metallic_roughness: Option<MetallicRoughness>,
    pub(crate) normal_texture: Option<TextureInfo>,
    pub(crate) emissive_texture: Option<TextureInfo>,
    pub(crate) emissive_factor: Option<[f64; 3]>,
    pub(crate) alpha_mode: Option<String>,
    pub(crate) alpha_cutoff: Option<f64>,
    pub(crate) double_sided: Option<bool>,
    #[serde(default, deserialize_with = "or_default")]
    pub(crate) extensions: MaterialExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct MetallicRoughness {
    pub(crate) base_color_factor: Option<[f64; 4]>,
    pub(crate) base_color_texture: Option<TextureInfo>,
    pub(crate) metallic_factor: Option<f64>,
    pub(crate) roughness_factor: Option<f64>,
    pub(crate) metallic_roughness_texture: Option<TextureInfo>,
}

/// The supported material extensions.
#[derive(Debug, Default, Deserialize)]
pub(crate) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_anisotropy")]
    pub(crate) anisotropy: Option<Anisotropy>,
    #[serde(rename = "KHR_materials_clearcoat")]
    pub(crate) clearcoat: Option<Clearcoat>,
    #[serde(rename = "KHR_materials_diffuse_transmission")]
    pub(crate) diffuse_transmission: Option<DiffuseTransmission>,
    #[serde(rename = "KHR_materials_dispersion")]
    pub(crate) dispersion: Option<Dispersion>,
    #[serde(rename = "KHR_materials_emissive_strength")]
    pub(crate) emissive_strength: Option<EmissiveStrength>,
    #[serde(rename = "KHR_materials_ior")]
    pub(crate) ior: Option<Ior>,
    #[serde(rename = "KHR_materials_iridescence")]
    pub(crate) iridescence: Option<Iridescence>,
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    pub(crate) specular_glossiness: Option<SpecularGlossiness>,
    #[serde(rename = "KHR_materials_sheen")]
    pub(crate) sheen: Option<Sheen>,
    #[serde(rename = "KHR_materials_specular")]
    pub(crate) specular: Option<Specular>,
    #[serde(rename = "KHR_materials_transmission")]
    pub(crate) transmission: Option<Transmission>,
    #[serde(rename = "KHR_materials_unlit")]
    pub(crate) unlit: Option<Unlit>,
    #[serde(rename = "KHR_materials_volume")]
    pub(crate) volume: Option<Volume>,
    #[serde(rename = "KHR_materials_volume_scatter")]
    pub(crate) volume_scatter: Option<VolumeScatter>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Anisotropy {
    pub(crate) anisotropy_strength: Option<f64>,
    pub(crate) anisotropy_rotation: Option<f64>,
    pub(crate) anisotropy_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Clearcoat {
    pub(crate) clearcoat_factor: Option<f64>,
    pub(crate) clearcoat_texture: Option<TextureInfo>,
    pub(crate) clearcoat_roughness_factor: Option<f64>,
    pub(crate) clearcoat_roughness_texture: Option<TextureInfo>,
    pub(crate) clearcoat_normal_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct DiffuseTransmission {
    pub(crate) diffuse_transmission_factor: Option<f64>,
    pub(crate) diffuse_transmission_texture: Option<TextureInfo>,
    pub(crate) diffuse_transmission_color_factor: Option<[f64; 3]>,
    pub(crate) diffuse_transmission_color_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
pub(crate) struct Dispersion {
    pub(crate) dispersion: Option<f64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct EmissiveStrength {
    pub(crate) emissive_strength: Option<f64>,
}

#[derive(Debug, Default, Deserialize)]
pub(crate) struct Ior {
    pub(crate) ior: Option<f64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Iridescence {
    pub(crate) iridescence_factor: Option<f64>,
    pub(crate) iridescence_texture: Option<TextureInfo>,
    pub(crate) iridescence_ior: Option<f64>,
    pub(crate) iridescence_thickness_minimum: Option<f64>,
    pub(crate) iridescence_thickness_maximum: Option<f64>,
    pub(crate) iridescence_thickness_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SpecularGlossiness {
    pub(crate) diffuse_factor: Option<[f64; 4]>,
    pub(crate) diffuse_texture: Option<TextureInfo>,
    pub(crate) specular_factor: Option<[f64; 3]>,
    pub(crate) glossiness_factor: Option<f64>,
    pub(crate) specular_glossiness_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Sheen {
    pub(crate) sheen_color_factor: Option<[f64; 3]>,
    pub(crate) sheen_color_texture: Option<TextureInfo>,
    pub(crate) sheen_roughness_factor: Option<f64>,
    pub(crate) sheen_roughness_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Specular {
    pub(crate) specular_factor: Option<f64>,
    pub(crate) specular_texture: Option<TextureInfo>,
    pub(crate) specular_color_factor: Option<[f64; 3]>,
    pub(crate) specular_color_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Transmission {
    pub(crate) transmission_factor: Option<f64>,
    pub(crate) transmission_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
pub(crate) struct Unlit {}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Volume {
    pub(crate) thickness_factor: Option<f64>,
    pub(crate) attenuation_distance: Option<f64>,
    pub(crate) attenuation_color: Option<[f64; 3]>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct VolumeScatter {
    pub(crate) multiscatter_color_factor: Option<[f64; 3]>,
    /// The name of the factor in the drafts of 2025.
    pub(crate) multiscatter_color: Option<[f64; 3]>,
    pub(crate) multiscatter_color_texture: Option<IgnoredAny>,
    pub(crate) scatter_anisotropy: Option<f64>,
}

/// A texture reference of a material.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct TextureInfo {
    pub(crate) index: Whole,
    pub(crate) tex_coord: Option<Whole>,
    /// Only of normal textures.
    pub(crate) scale: Option<f64>,
    #[serde(default, deserialize_with = "or_default")]
    pub(crate) extensions: TextureInfoExtensions,
}

#[derive(Clone, Debug, Default, Deserialize)]
pub(crate) struct TextureInfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub(crate) transform: Option<TextureTransform>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct TextureTransform {
    pub(crate) offset: Option<[f64; 2]>,
    pub(crate) rotation: Option<f64>,
    pub(crate) scale: Option<[f64; 2]>,
    pub(crate) tex_coord: Option<Whole>,
}
