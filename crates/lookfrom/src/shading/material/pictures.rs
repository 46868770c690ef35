//! The pictures that a material's scattering function depends on, to be looked up before it is evaluated, and whether it
//! varies over the surface at all.

use super::{BumpMapping, CoatMaterial, MaterialKind, Metal, Roughness, TintTextures};
use crate::shading::texture::{FloatTexture, PictureSet, SpectrumTexture, Textures};

/// The pictures of a material, and whether it may vary over the surface.
pub(super) fn of(kind: &MaterialKind, bump_mapping: &BumpMapping, textures: &Textures) -> (PictureSet, bool) {
    let mut walk = Walk { textures, pictures: PictureSet::EMPTY, varies: false };
    match kind {
        MaterialKind::Diffuse { reflectance } => walk.color(reflectance),
        MaterialKind::DiffuseTransmission { reflectance, transmittance, .. } => {
            walk.color(reflectance);
            walk.color(transmittance);
        }
        MaterialKind::Conductor { metal, roughness, specular_reflectance, .. } => {
            walk.metal(metal);
            walk.roughness(roughness);
            walk.color(specular_reflectance);
        }
        MaterialKind::Dielectric { roughness, .. } => walk.roughness(roughness),
        MaterialKind::TintedDielectric { roughness, tint, .. } => {
            walk.roughness(roughness);
            walk.tint(tint);
        }
        MaterialKind::ThinDielectric { tint: Some(tint), .. } => walk.tint(tint),
        MaterialKind::CoatedDiffuse { reflectance, coat } => {
            walk.color(reflectance);
            walk.coat(coat);
        }
        MaterialKind::CoatedConductor { metal, roughness, coat } => {
            walk.metal(metal);
            walk.roughness(roughness);
            walk.coat(coat);
        }
        MaterialKind::Plastic(plastic) => {
            walk.color(&plastic.reflectance);
            walk.color(&plastic.specular_reflectance);
        }
        MaterialKind::Whitted(whitted) => {
            walk.color(&whitted.diffuse);
            walk.color(&whitted.specular);
            walk.color(&whitted.mirror);
            walk.color(&whitted.transmission);
        }
        MaterialKind::Principled(look) => {
            walk.color(&look.base_color);
            walk.number(look.metallic);
            walk.number(look.roughness);
            walk.number(look.transmission);
            walk.number(look.clearcoat);
            // Other inputs of it are seldom pictures.
            walk.varies = true;
        }
        MaterialKind::OpenPbr(look) => {
            walk.color(&look.base_color);
            walk.number(look.base_metalness);
            walk.number(look.specular_roughness);
            walk.number(look.coat_weight);
            // As above.
            walk.varies = true;
        }
        _ => walk.varies = true,
    }
    match bump_mapping {
        BumpMapping::None => {}
        BumpMapping::NormalTexture(map) => walk.color(&map.texture),
        BumpMapping::Bump(_) | BumpMapping::NormalMap(_) => walk.varies = true,
    }
    (walk.pictures, walk.varies)
}

/// A walk through a material's inputs.
struct Walk<'a> {
    textures: &'a Textures,
    pictures: PictureSet,
    varies: bool,
}

impl Walk<'_> {
    fn color(&mut self, color: &SpectrumTexture) {
        self.varies |= color.varies();
        self.textures.add_pictures(color, &mut self.pictures);
    }

    fn number(&mut self, number: FloatTexture) {
        self.varies |= number.varies();
        self.textures.add_pictures_of_float(number, &mut self.pictures);
    }

    fn tint(&mut self, tint: &TintTextures) {
        self.color(&tint.reflectance);
        self.color(&tint.transmittance);
    }

    fn metal(&mut self, metal: &Metal) {
        match metal {
            Metal::Indices { eta, k } => {
                self.color(eta);
                self.color(k);
            }
            Metal::Reflectance(color) => self.color(color),
        }
    }

    fn roughness(&mut self, roughness: &Roughness) {
        if let Roughness::Varying { along, .. } = roughness {
            along.iter().for_each(|number| self.number(*number));
        }
    }

    fn coat(&mut self, coat: &CoatMaterial) {
        self.roughness(&coat.roughness);
        self.number(coat.thickness);
        self.number(coat.g);
        self.color(&coat.albedo);
    }
}
