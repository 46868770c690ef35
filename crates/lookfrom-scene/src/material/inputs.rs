//! The numbers of a material, and the textures that it uses.

use std::ops::RangeInclusive;

use super::{BumpMapping, Coat, Color, Material, MaterialKind, Pigment, Principled, Roughness, Scalar};
use crate::scene::TextureId;

/// A number of a material: its name in our own format, itself, and what it may be.
pub type Number = (&'static str, Scalar, RangeInclusive<f32>);

const SHARE: RangeInclusive<f32> = 0.0..=1.0;
const AT_LEAST_ZERO: RangeInclusive<f32> = 0.0..=f32::INFINITY;

impl Material {
    /// The textures that it uses, not those that they use, nor those of the materials that it is mixed of.
    pub fn textures(&self) -> Vec<TextureId> {
        let colors = self.kind.colors().into_iter().filter_map(|color| match color {
            Color::Texture(id) => Some(id),
            Color::Value(_) | Color::Curve(_) => None,
        });
        let mut scalars: Vec<Scalar> = self.kind.numbers().into_iter().map(|(_, scalar, _)| scalar).collect();
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
    /// Its numbers that may be textures, and factors. Readers of other formats take them as they are written: of a value beyond the
    /// range, also one of a texture, the nearest end counts.
    pub fn numbers(&self) -> Vec<Number> {
        match self {
            Self::DiffuseTransmission { scale, .. } => {
                vec![("scale", Scalar::Value(*scale), AT_LEAST_ZERO)]
            }
            Self::Conductor { roughness, .. } | Self::Dielectric { roughness, .. } => {
                roughness.numbers("roughness").into()
            }
            Self::CoatedDiffuse { coat, .. } => coat.numbers(),
            Self::CoatedConductor { roughness, coat, .. } => {
                let mut numbers = coat.numbers();
                numbers.extend(roughness.numbers("base_roughness"));
                numbers
            }
            Self::Subsurface(below) => below.roughness.numbers("roughness").into(),
            Self::Hair(hair) => {
                let mut numbers = vec![
                    ("ior", hair.eta, AT_LEAST_ZERO),
                    ("roughness", hair.beta_m, SHARE),
                    ("radial_roughness", hair.beta_n, SHARE),
                    ("offset", hair.alpha, -90.0..=90.0),
                ];
                if let Pigment::Melanin { eumelanin, pheomelanin } = hair.pigment {
                    numbers.push(("eumelanin", eumelanin, AT_LEAST_ZERO));
                    numbers.push(("pheomelanin", pheomelanin, AT_LEAST_ZERO));
                }
                numbers
            }
            Self::Mix { amount, .. } => vec![("amount", *amount, SHARE)],
            Self::Principled(look) => look.numbers().into(),
            Self::OpenPbr(look) => {
                let ranged = |(key, scalar)| match key {
                    "specular_weight" | "thin_film_thickness" => (key, scalar, AT_LEAST_ZERO),
                    _ => (key, scalar, SHARE),
                };
                look.scalars().map(ranged).into()
            }
            Self::Disney(look) => {
                let ranged = |(key, scalar)| match key {
                    "eta" => ("ior", scalar, AT_LEAST_ZERO),
                    "sheen" => (key, scalar, AT_LEAST_ZERO),
                    "diff_trans" => (key, scalar, 0.0..=2.0),
                    _ => (key, scalar, SHARE),
                };
                look.scalars().map(ranged).into()
            }
            Self::Whitted(_)
            | Self::Diffuse { .. }
            | Self::ThinDielectric { .. }
            | Self::Plastic(_)
            | Self::Measured(_)
            | Self::Unlit { .. }
            | Self::ShadowCatcher { .. }
            | Self::Interface => Vec::new(),
        }
    }
}

impl Roughness {
    fn numbers(&self, key: &'static str) -> [Number; 2] {
        [self.u, self.v].map(|scalar| (key, scalar, AT_LEAST_ZERO))
    }
}

impl Coat {
    fn numbers(&self) -> Vec<Number> {
        let [u, v] = self.roughness.numbers("roughness");
        vec![u, v, ("thickness", self.thickness, AT_LEAST_ZERO), ("g", self.g, -1.0..=1.0)]
    }
}

impl Principled {
    fn numbers(&self) -> [Number; 10] {
        [
            ("metallic", self.metallic, SHARE),
            ("roughness", self.roughness, SHARE),
            ("specular", self.specular, SHARE),
            ("transmission", self.transmission, SHARE),
            ("diffuse_transmission", self.diffuse_transmission, SHARE),
            ("clearcoat", self.clearcoat, SHARE),
            ("clearcoat_roughness", self.clearcoat_roughness, SHARE),
            ("sheen_roughness", self.sheen_roughness, SHARE),
            ("iridescence", self.iridescence, SHARE),
            ("iridescence_thickness", self.iridescence_thickness, AT_LEAST_ZERO),
        ]
    }
}
