//! The textures that a material uses.

use super::{BumpMapping, Coat, Color, Material, MaterialKind, Pigment, Principled, Roughness, Scalar};
use crate::scene::TextureId;

impl Material {
    /// The textures that it uses, not those that they use, nor those of the materials that it is mixed of.
    pub fn textures(&self) -> Vec<TextureId> {
        let colors = self.kind.colors().into_iter().filter_map(|color| match color {
            Color::Texture(id) => Some(id),
            Color::Value(_) | Color::Curve(_) => None,
        });
        let mut scalars = self.kind.scalars();
        let mut textures: Vec<TextureId> = colors.collect();
        match self.bump_mapping {
            BumpMapping::Bump(height) => scalars.push(height),
            BumpMapping::NormalTexture(map) => textures.push(map.texture),
            BumpMapping::None | BumpMapping::NormalMap(_) => {}
        }
        if let MaterialKind::Principled(look) = &self.kind {
            textures.extend(look.anisotropy.and_then(|grain| grain.texture));
            textures.extend(look.clearcoat_normal.as_ref().map(|map| map.texture));
        }
        if let MaterialKind::OpenPbr(look) = &self.kind {
            textures.extend(look.directions());
        }
        textures.extend(scalars.into_iter().filter_map(|scalar| match scalar {
            Scalar::Texture(id) => Some(id),
            Scalar::Value(_) => None,
        }));
        textures
    }
}

impl MaterialKind {
    /// Its numbers.
    fn scalars(&self) -> Vec<Scalar> {
        match self {
            Self::Conductor { roughness, .. } | Self::Dielectric { roughness, .. } => {
                roughness.scalars().into()
            }
            Self::CoatedDiffuse { coat, .. } => coat.scalars(),
            Self::CoatedConductor { roughness, coat, .. } => {
                let mut scalars = coat.scalars();
                scalars.extend(roughness.scalars());
                scalars
            }
            Self::Subsurface(below) => below.roughness.scalars().into(),
            Self::Hair(hair) => {
                let mut scalars = vec![hair.eta, hair.beta_m, hair.beta_n, hair.alpha];
                if let Pigment::Melanin { eumelanin, pheomelanin } = hair.pigment {
                    scalars.extend([eumelanin, pheomelanin]);
                }
                scalars
            }
            Self::Mix { amount, .. } => vec![*amount],
            Self::Principled(look) => look.scalars().into(),
            Self::OpenPbr(look) => look.scalars().map(|(_, scalar)| scalar).into(),
            Self::Disney(look) => look.scalars().map(|(_, scalar)| scalar).into(),
            Self::Whitted(_)
            | Self::Diffuse { .. }
            | Self::DiffuseTransmission { .. }
            | Self::ThinDielectric { .. }
            | Self::Measured(_)
            | Self::Unlit { .. }
            | Self::ShadowCatcher { .. }
            | Self::Interface => Vec::new(),
        }
    }
}

impl Roughness {
    fn scalars(&self) -> [Scalar; 2] {
        [self.u, self.v]
    }
}

impl Coat {
    fn scalars(&self) -> Vec<Scalar> {
        vec![self.roughness.u, self.roughness.v, self.thickness, self.g]
    }
}

impl Principled {
    fn scalars(&self) -> [Scalar; 10] {
        [
            self.metallic,
            self.roughness,
            self.specular,
            self.transmission,
            self.diffuse_transmission,
            self.clearcoat,
            self.clearcoat_roughness,
            self.sheen_roughness,
            self.iridescence,
            self.iridescence_thickness,
        ]
    }
}
