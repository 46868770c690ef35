//! Conversion of materials (specification, §3.9, and the extensions `KHR_materials_…`).
//!
//! Each becomes a [`Principled`] material, or an unlit one, together with the emission, the alpha and the sidedness of the
//! surface. Factors outside the range that their extension allows are clamped, with a warning. Occlusion textures are ignored: they
//! approximate what path tracing computes.

mod glossiness;
mod volume;

use std::collections::BTreeMap;

use super::file::Document;
use super::json::{self, TextureInfo, Whole};
use super::texture::{Meaning, Textures, Use};
use crate::error::Result;
use crate::files::LoadContext;
use crate::material::{
    Anisotropy, BumpMapping, Color, Ior, Material, MaterialKind, NormalTexture, Principled, Scalar,
};
use crate::scene::{MaterialId, Scene};
use crate::shape::Emission;
use crate::texture::{Channel, TextureKind};

/// The material of a primitive, and the properties that a shape keeps beside its material.
#[derive(Clone, Copy, Debug)]
pub(super) struct MaterialBinding {
    pub(super) material: MaterialId,
    pub(super) emission: Option<Emission>,
    pub(super) alpha: Option<Scalar>,
    pub(super) single_sided: bool,
    /// The set of texture coordinates that the mesh needs tangents for; `None` where the direction of u on the surface
    /// does not matter.
    pub(super) grain: Option<u32>,
}

/// The vertex attributes of a primitive that its material can use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct VertexColors {
    pub(super) colors: Colors,
    pub(super) opacities: bool,
}

/// The colours that a primitive brings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Colors {
    #[default]
    None,
    /// The colours of its vertices.
    OfVertices,
    /// One for all of it, as bits.
    One([u32; 3]),
}

/// The materials converted so far.
pub(super) struct MaterialBindings<'d> {
    document: &'d Document,
    textures: Textures<'d>,
    known: BTreeMap<(Option<usize>, VertexColors), MaterialBinding>,
}

impl<'d> MaterialBindings<'d> {
    pub(super) fn new(document: &'d Document) -> Self {
        Self { document, textures: Textures::new(document), known: BTreeMap::new() }
    }

    /// Decodes the images of all materials.
    pub(super) fn decode(self, context: &mut LoadContext<'_>, scene: &mut Scene) {
        self.textures.decode(context, scene);
    }

    /// The material of a primitive; glTF's default if `material` is `None`.
    ///
    /// # Errors
    /// If the material, or one of its textures, does not exist.
    pub(super) fn of_primitive(
        &mut self,
        material: Option<Whole>,
        asked: &str,
        vertex_colors: VertexColors,
        context: &mut LoadContext<'_>,
        scene: &mut Scene,
    ) -> Result<MaterialBinding> {
        let key = (material.map(Whole::index), vertex_colors);
        if let Some(look) = self.known.get(&key) {
            return Ok(*look);
        }
        let default = json::Material::default();
        let (entry, pointer) = match material {
            Some(index) => {
                let entry = self.document.one_of(&self.document.root.materials, index, "material", asked)?;
                (entry, format!("/materials/{}", index.0))
            }
            None => (&default, "/materials".to_owned()),
        };
        let mut reader =
            Reader { document: self.document, textures: &mut self.textures, context, scene, pointer };
        let binding = reader.binding(entry, vertex_colors)?;
        self.known.insert(key, binding);
        Ok(binding)
    }
}

/// The state of the conversion of one material.
struct Reader<'r, 'd, 'f> {
    document: &'d Document,
    textures: &'r mut Textures<'d>,
    context: &'r mut LoadContext<'f>,
    scene: &'r mut Scene,
    /// The JSON pointer of the material.
    pointer: String,
}

impl Reader<'_, '_, '_> {
    fn binding(&mut self, entry: &json::Material, vertex_colors: VertexColors) -> Result<MaterialBinding> {
        let (base_color, base_alpha) = self.base(entry)?;
        let own = match vertex_colors.colors {
            Colors::None => None,
            Colors::OfVertices => {
                let own = TextureKind::VertexColor { tint: [1.0; 3] };
                Some(Color::Texture(self.textures.push(own, &self.pointer, self.scene)))
            }
            Colors::One(bits) => Some(Color::Value(bits.map(f32::from_bits))),
        };
        let base_color = match own {
            Some(own) => self.textures.product(base_color, own, &self.pointer, self.scene),
            None => base_color,
        };
        let kind = match (&entry.extensions.unlit, &entry.extensions.specular_glossiness) {
            (Some(_), _) => MaterialKind::Unlit { color: base_color },
            (None, Some(own)) => MaterialKind::Principled(Box::new(self.glossy(own, base_color)?)),
            (None, None) => MaterialKind::Principled(Box::new(self.principled(entry, base_color)?)),
        };
        let bump_mapping = self.normals(entry.normal_texture.as_ref(), "/normalTexture")?;
        let grain = self.grain(entry, &kind, bump_mapping.is_some());
        let name = match &entry.name {
            Some(name) => name.clone(),
            None => self.pointer.trim_start_matches('/').replace('/', " "),
        };
        let medium = match &kind {
            MaterialKind::Principled(look) => self.medium(entry, &name, look),
            _ => None,
        };
        let mut material = Material::new(name, self.document.at(&self.pointer), kind);
        material.medium = medium;
        material.bump_mapping = bump_mapping.map_or(BumpMapping::None, BumpMapping::NormalTexture);
        self.scene.materials.push(material);
        let is_double_sided = entry.double_sided.unwrap_or(false);
        Ok(MaterialBinding {
            material: MaterialId(self.scene.materials.len() as u32 - 1),
            emission: self.emission(entry, is_double_sided)?,
            alpha: self.alpha(entry, base_alpha, vertex_colors)?,
            single_sided: !is_double_sided,
            grain,
        })
    }

    /// The base colour and alpha of the material.
    fn base(&mut self, entry: &json::Material) -> Result<(Color, Scalar)> {
        let (factor, info, place) =
            match (&entry.extensions.specular_glossiness, &entry.pbr_metallic_roughness) {
                (Some(own), _) => {
                    let place = "/extensions/KHR_materials_pbrSpecularGlossiness/diffuse";
                    (own.diffuse_factor, own.diffuse_texture.as_ref(), place)
                }
                (None, Some(own)) => (
                    own.base_color_factor,
                    own.base_color_texture.as_ref(),
                    "/pbrMetallicRoughness/baseColor",
                ),
                (None, None) => (None, None, ""),
            };
        let [r, g, b, a] = factor.unwrap_or([1.0; 4]);
        let pointer = format!("{place}Factor");
        let (tint, a) = (self.reflectance([r, g, b], &pointer), self.unit(Some(a), 1.0, &pointer));
        let place = format!("{place}Texture");
        let color = self.color(tint, info, &place)?;
        let alpha = self.number(a, info, &place, Channel::Alpha)?;
        Ok((color, alpha))
    }

    fn principled(&mut self, entry: &json::Material, base_color: Color) -> Result<Principled> {
        let mut look = Principled { base_color, ..Principled::default() };
        if let Some(own) = &entry.pbr_metallic_roughness {
            let (info, place) =
                (own.metallic_roughness_texture.as_ref(), "/pbrMetallicRoughness/metallicRoughnessTexture");
            let metallic = self.unit(own.metallic_factor, 1.0, "/pbrMetallicRoughness/metallicFactor");
            look.metallic = self.number(metallic, info, place, Channel::Blue)?;
            let roughness = self.unit(own.roughness_factor, 1.0, "/pbrMetallicRoughness/roughnessFactor");
            look.roughness = self.number(roughness, info, place, Channel::Green)?;
        }
        let extensions = &entry.extensions;
        if let Some(own) = &extensions.ior {
            look.ior = self.ior(own.ior);
        }
        if let Some(own) = &extensions.dispersion {
            let pointer = "/extensions/KHR_materials_dispersion/dispersion";
            look.dispersion = self.at_least(0.0, own.dispersion.unwrap_or(0.0), pointer).min(100.0);
        }
        if let Some(own) = &extensions.specular {
            let place = "/extensions/KHR_materials_specular/specularTexture";
            let pointer = "/extensions/KHR_materials_specular/specularFactor";
            let (info, factor) =
                (own.specular_texture.as_ref(), self.unit(own.specular_factor, 1.0, pointer));
            look.specular = self.number(factor, info, place, Channel::Alpha)?;
            let place = "/extensions/KHR_materials_specular/specularColorTexture";
            let pointer = "/extensions/KHR_materials_specular/specularColorFactor";
            let factor = own.specular_color_factor.unwrap_or([1.0; 3]);
            let factor = factor.map(|factor| self.at_least(0.0, factor, pointer));
            look.specular_color = self.color(factor, own.specular_color_texture.as_ref(), place)?;
        }
        if let Some(own) = &extensions.transmission {
            let place = "/extensions/KHR_materials_transmission/transmissionTexture";
            let pointer = "/extensions/KHR_materials_transmission/transmissionFactor";
            let factor = self.unit(own.transmission_factor, 0.0, pointer);
            let info = own.transmission_texture.as_ref();
            look.transmission = self.number(factor, info, place, Channel::Red)?;
        }
        if let Some(own) = &extensions.volume {
            let pointer = "/extensions/KHR_materials_volume/thicknessFactor";
            look.is_solid = self.at_least(0.0, own.thickness_factor.unwrap_or(0.0), pointer) > 0.0;
            look.absorption = self.attenuation(own);
        }
        if let Some(own) = &extensions.diffuse_transmission {
            let place = "/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionTexture";
            let info = own.diffuse_transmission_texture.as_ref();
            let pointer = "/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionFactor";
            let factor = self.unit(own.diffuse_transmission_factor, 0.0, pointer);
            look.diffuse_transmission = self.number(factor, info, place, Channel::Alpha)?;
            let place = "/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorTexture";
            let factor = own.diffuse_transmission_color_factor.unwrap_or([1.0; 3]);
            let pointer = "/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorFactor";
            let factor = self.reflectance(factor, pointer);
            let info = own.diffuse_transmission_color_texture.as_ref();
            look.diffuse_transmission_color = self.color(factor, info, place)?;
        }
        self.layers(extensions, &mut look)?;
        Ok(look)
    }

    /// Clearcoat, sheen and anisotropy.
    fn layers(&mut self, extensions: &json::MaterialExtensions, look: &mut Principled) -> Result<()> {
        if let Some(own) = &extensions.clearcoat {
            let place = "/extensions/KHR_materials_clearcoat/clearcoatTexture";
            let pointer = "/extensions/KHR_materials_clearcoat/clearcoatFactor";
            let (info, factor) =
                (own.clearcoat_texture.as_ref(), self.unit(own.clearcoat_factor, 0.0, pointer));
            look.clearcoat = self.number(factor, info, place, Channel::Red)?;
            let place = "/extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture";
            let info = own.clearcoat_roughness_texture.as_ref();
            let pointer = "/extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor";
            let factor = self.unit(own.clearcoat_roughness_factor, 0.0, pointer);
            look.clearcoat_roughness = self.number(factor, info, place, Channel::Green)?;
            let place = "/extensions/KHR_materials_clearcoat/clearcoatNormalTexture";
            look.clearcoat_normal = self.normals(own.clearcoat_normal_texture.as_ref(), place)?;
        }
        if let Some(own) = &extensions.sheen {
            let place = "/extensions/KHR_materials_sheen/sheenColorTexture";
            let factor = own.sheen_color_factor.unwrap_or([0.0; 3]);
            let factor = self.reflectance(factor, "/extensions/KHR_materials_sheen/sheenColorFactor");
            look.sheen_color = match factor {
                [0.0, 0.0, 0.0] => Color::BLACK,
                _ => self.color(factor, own.sheen_color_texture.as_ref(), place)?,
            };
            let place = "/extensions/KHR_materials_sheen/sheenRoughnessTexture";
            let pointer = "/extensions/KHR_materials_sheen/sheenRoughnessFactor";
            let factor = self.unit(own.sheen_roughness_factor, 0.0, pointer);
            let info = own.sheen_roughness_texture.as_ref();
            look.sheen_roughness = self.number(factor, info, place, Channel::Alpha)?;
        }
        if let Some(own) = &extensions.iridescence {
            let place = "/extensions/KHR_materials_iridescence/iridescenceTexture";
            let pointer = "/extensions/KHR_materials_iridescence/iridescenceFactor";
            let factor = self.unit(own.iridescence_factor, 0.0, pointer);
            look.iridescence = self.number(factor, own.iridescence_texture.as_ref(), place, Channel::Red)?;
            let pointer = "/extensions/KHR_materials_iridescence/iridescenceIor";
            let ior = own.iridescence_ior.unwrap_or(Principled::FILM_IOR.into());
            look.iridescence_ior = self.at_least(1.0, ior, pointer).min(10.0);
            look.iridescence_thickness = self.film_thickness(own)?;
        }
        if let Some(own) = &extensions.anisotropy {
            let place = format!("{}/extensions/KHR_materials_anisotropy/anisotropyTexture", self.pointer);
            let pointer = "/extensions/KHR_materials_anisotropy/anisotropyStrength";
            let strength = self.unit(own.anisotropy_strength, 0.0, pointer);
            let used = Use { info: own.anisotropy_texture.as_ref(), pointer: &place };
            let texture = self.textures.image(used, Channel::Rgb, Meaning::Number, 1.0, false, self.scene)?;
            let rotation = own.anisotropy_rotation.unwrap_or(0.0) as f32;
            let rotation = if rotation.is_finite() { rotation } else { 0.0 };
            look.anisotropy = (strength > 0.0).then_some(Anisotropy { strength, rotation, texture });
        }
        Ok(())
    }

    /// Thin-film thickness, interpolated between minimum and maximum by the texture's green channel; without a texture, the
    /// maximum.
    fn film_thickness(&mut self, own: &json::Iridescence) -> Result<Scalar> {
        let most = own.iridescence_thickness_maximum.unwrap_or(Principled::FILM_THICKNESS.into());
        let pointer = "/extensions/KHR_materials_iridescence/iridescenceThicknessMaximum";
        let most = self.at_least(0.0, most, pointer);
        let least = own.iridescence_thickness_minimum.unwrap_or(100.0);
        let pointer = "/extensions/KHR_materials_iridescence/iridescenceThicknessMinimum";
        let least = self.at_least(0.0, least, pointer);
        let place = "/extensions/KHR_materials_iridescence/iridescenceThicknessTexture";
        match self.number(1.0, own.iridescence_thickness_texture.as_ref(), place, Channel::Green)? {
            Scalar::Value(_) => Ok(Scalar::Value(most)),
            amount => {
                let (low, high) = (Color::gray(least), Color::gray(most));
                let kind = TextureKind::Mix { low, high, amount };
                Ok(Scalar::Texture(self.textures.push(kind, &self.pointer, self.scene)))
            }
        }
    }

    /// A colour factor that is a reflectance: clamped to [0, 1], with a warning if it is not in there.
    fn reflectance(&mut self, factor: [f64; 3], place: &str) -> [f32; 3] {
        self.check_reflectance(factor, place);
        factor.map(|factor| factor.clamp(0.0, 1.0) as f32)
    }

    fn check_reflectance(&mut self, factor: [f64; 3], place: &str) {
        if factor.iter().any(|factor| !(0.0..=1.0).contains(factor)) {
            let [r, g, b] = factor;
            self.warn(place, format!("the factor is [{r}, {g}, {b}]; expected 0 to 1: the nearest is used"));
        }
    }

    /// A factor clamped to [0, 1], with a warning if it is not in there; `otherwise` if there is none.
    fn unit(&mut self, factor: Option<f64>, otherwise: f32, place: &str) -> f32 {
        let Some(factor) = factor else { return otherwise };
        if factor > 1.0 {
            self.warn(place, format!("the factor is {factor}; expected 0 to 1: 1 is used"));
        }
        self.at_least(0.0, factor, place).min(1.0)
    }

    /// A number of at least `least`, with a warning if it is smaller; 1e30 at most.
    fn at_least(&mut self, least: f32, number: f64, place: &str) -> f32 {
        if number < least.into() {
            self.warn(place, format!("the value is {number}; expected at least {least}: {least} is used"));
        }
        positive(number.max(least.into()))
    }

    /// Warns of a property of the material.
    fn warn(&mut self, place: &str, message: String) {
        let at = self.document.at(&format!("{}{place}", self.pointer));
        self.context.warn(&at, message);
    }

    fn ior(&mut self, ior: Option<f64>) -> f32 {
        match ior.unwrap_or(Ior::GLASS.into()) {
            0.0 => 0.0,
            ior if ior >= 1.0 => ior.min(1e6) as f32,
            ior => {
                let message = format!("the index of refraction {ior} is invalid; {} is used", Ior::GLASS);
                self.warn("/extensions/KHR_materials_ior/ior", message);
                Ior::GLASS
            }
        }
    }

    fn normals(&mut self, info: Option<&TextureInfo>, place: &str) -> Result<Option<NormalTexture>> {
        let pointer = format!("{}{place}", self.pointer);
        let used = Use { info, pointer: &pointer };
        let texture = self.textures.image(used, Channel::Rgb, Meaning::Normal, 1.0, false, self.scene)?;
        let scale = info.and_then(|info| info.scale).unwrap_or(1.0) as f32;
        let scale = if scale.is_finite() { scale } else { 1.0 };
        Ok(texture.map(|texture| NormalTexture { texture, scale }))
    }

    /// The set of texture coordinates that defines the tangents of the surface.
    fn grain(&self, entry: &json::Material, kind: &MaterialKind, has_normals: bool) -> Option<u32> {
        let MaterialKind::Principled(look) = kind else { return None };
        let extensions = &entry.extensions;
        let coat = extensions.clearcoat.as_ref().and_then(|coat| coat.clearcoat_normal_texture.as_ref());
        let brushed = extensions.anisotropy.as_ref().and_then(|own| own.anisotropy_texture.as_ref());
        if !(has_normals || look.clearcoat_normal.is_some() || look.anisotropy.is_some()) {
            return None;
        }
        let info = entry.normal_texture.as_ref().or(coat).or(brushed);
        let set = info.map(|info| {
            let transformed = info.extensions.transform.as_ref().and_then(|transform| transform.tex_coord);
            transformed.or(info.tex_coord).unwrap_or_default()
        });
        Some(set.map_or(0, |set| u32::try_from(set.0).unwrap_or(u32::MAX)))
    }

    fn emission(&mut self, entry: &json::Material, two_sided: bool) -> Result<Option<Emission>> {
        if entry.extensions.unlit.is_some() {
            return Ok(None);
        }
        let strength = entry.extensions.emissive_strength.as_ref().and_then(|own| own.emissive_strength);
        let pointer = "/extensions/KHR_materials_emissive_strength/emissiveStrength";
        let strength = f64::from(self.at_least(0.0, strength.unwrap_or(1.0), pointer));
        let factor = entry.emissive_factor.unwrap_or([0.0; 3]);
        let factor = factor.map(|factor| self.at_least(0.0, factor * strength, "/emissiveFactor"));
        if factor == [0.0; 3] {
            return Ok(None);
        }
        let radiance = self.color(factor, entry.emissive_texture.as_ref(), "/emissiveTexture")?;
        Ok(Some(Emission::new(radiance, two_sided)))
    }

    /// The alpha of the surface.
    fn alpha(
        &mut self,
        entry: &json::Material,
        base: Scalar,
        vertex_colors: VertexColors,
    ) -> Result<Option<Scalar>> {
        let mode = entry.alpha_mode.as_deref().unwrap_or("OPAQUE");
        if mode != "MASK" && mode != "BLEND" {
            if mode != "OPAQUE" {
                self.warn("/alphaMode", format!("the mode {mode:?} is not known; the material is opaque"));
            }
            return Ok(None);
        }
        let value = match (vertex_colors.opacities, base) {
            (true, base) => {
                let own = self.textures.push(TextureKind::VertexAlpha, &self.pointer, self.scene);
                let scaled = match base {
                    Scalar::Value(1.0) => None,
                    Scalar::Value(value) => Some(Color::gray(value)),
                    Scalar::Texture(id) => Some(Color::Texture(id)),
                };
                let product = scaled.map(|a| TextureKind::Product { a, b: Color::Texture(own) });
                Scalar::Texture(
                    product.map_or(own, |kind| self.textures.push(kind, &self.pointer, self.scene)),
                )
            }
            (false, base) => base,
        };
        let edge = self.at_least(0.0, entry.alpha_cutoff.unwrap_or(0.5), "/alphaCutoff");
        Ok(match (mode, value) {
            ("MASK", Scalar::Value(value)) => (value < edge).then_some(Scalar::Value(0.0)),
            ("MASK", value) => {
                let kind = TextureKind::Threshold { value, edge };
                Some(Scalar::Texture(self.textures.push(kind, &self.pointer, self.scene)))
            }
            (_, Scalar::Value(value)) => (value < 1.0).then_some(Scalar::Value(value)),
            (_, value) => Some(value),
        })
    }

    fn color(&mut self, factor: [f32; 3], info: Option<&TextureInfo>, place: &str) -> Result<Color> {
        let pointer = format!("{}{place}", self.pointer);
        self.textures.color(factor, Use { info, pointer: &pointer }, self.scene)
    }

    fn number(
        &mut self,
        factor: f32,
        info: Option<&TextureInfo>,
        place: &str,
        channel: Channel,
    ) -> Result<Scalar> {
        let pointer = format!("{}{place}", self.pointer);
        self.textures.number(factor, Use { info, pointer: &pointer }, channel, self.scene)
    }
}

/// A number clamped to [0, 1e30].
fn positive(number: f64) -> f32 {
    number.clamp(0.0, 1e30) as f32
}
