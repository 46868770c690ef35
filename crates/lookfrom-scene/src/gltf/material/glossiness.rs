//! Conversion of specular-glossiness materials (`KHR_materials_pbrSpecularGlossiness`).
//!
//! A dielectric with the index of refraction 0, which stands for infinity, reflects exactly its specular colour by
//! Schlick's formula; `KHR_materials_specular` recommends this conversion. Roughness is 1 − glossiness.

use super::Reader;
use crate::error::Result;
use crate::gltf::json;
use crate::gltf::texture::{Meaning, Use};
use crate::material::{Color, Principled, Scalar};
use crate::texture::Channel;

impl Reader<'_, '_, '_> {
    /// `base_color` is the diffuse colour.
    pub(super) fn glossy(&mut self, own: &json::SpecularGlossiness, base_color: Color) -> Result<Principled> {
        let place = "/extensions/KHR_materials_pbrSpecularGlossiness/specularGlossinessTexture";
        let info = own.specular_glossiness_texture.as_ref();
        let pointer = "/extensions/KHR_materials_pbrSpecularGlossiness/specularFactor";
        let factor = self.reflectance(own.specular_factor.unwrap_or([1.0; 3]), pointer);
        let specular_color = self.color(factor, info, place)?;
        let pointer = "/extensions/KHR_materials_pbrSpecularGlossiness/glossinessFactor";
        let glossiness = self.unit(own.glossiness_factor, 1.0, pointer);
        let pointer = format!("{}{place}", self.pointer);
        let used = Use { info, pointer: &pointer };
        let texture =
            self.textures.image(used, Channel::Alpha, Meaning::Color, glossiness, true, self.scene)?;
        Ok(Principled {
            base_color,
            metallic: Scalar::Value(0.0),
            roughness: texture.map_or(Scalar::Value(1.0 - glossiness), Scalar::Texture),
            ior: 0.0,
            specular_color,
            ..Principled::default()
        })
    }
}
