//! Kinds of materials.

use std::sync::Arc;

use glam::Vec3;

use super::{
    Coat, Color, Disney, Energy, Hair, Ior, Metal, OpenPbr, Pigment, Plastic, Principled, Roughness, Scalar,
    Subsurface, SubsurfaceMedium, Tint, Whitted,
};
use crate::measured::Measured;
use crate::scene::MaterialId;

/// The kinds of materials.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialKind {
    /// Whitted's model.
    Whitted(Whitted),
    /// Lambertian reflection.
    Diffuse {
        /// The fraction of light that is reflected.
        reflectance: Color,
    },
    /// Diffuse reflection and transmission.
    DiffuseTransmission {
        /// The fraction of light that is reflected.
        reflectance: Color,
        /// The fraction of light that is transmitted.
        transmittance: Color,
        /// Multiplies both.
        scale: f32,
    },
    /// A metal.
    Conductor {
        /// Its optical constants.
        metal: Metal,
        /// Roughness of its surface.
        roughness: Roughness,
        /// Multiple scattering between its microfacets: kept or lost.
        energy: Energy,
        /// Factor of the Fresnel reflectance: 1 in nature.
        specular_reflectance: Color,
    },
    /// A dielectric such as glass or water, which encloses an interior.
    Dielectric {
        /// Index of refraction, inside over outside.
        eta: Ior,
        /// Roughness of its surface.
        roughness: Roughness,
        /// Multiple scattering between its microfacets: kept or lost.
        energy: Energy,
        /// Its colours.
        tint: Tint,
    },
    /// A sheet so thin that transmitted light is not deflected.
    ThinDielectric {
        /// Index of refraction of the sheet relative to the surrounding medium.
        eta: Ior,
        /// Its colours.
        tint: Tint,
    },
    /// A diffuse base under a dielectric coat.
    CoatedDiffuse {
        /// Reflectance of the base.
        reflectance: Color,
        /// The coat.
        coat: Coat,
    },
    /// A metal under a dielectric coat.
    CoatedConductor {
        /// The base's optical constants.
        metal: Metal,
        /// Roughness of the base.
        roughness: Roughness,
        /// The coat.
        coat: Coat,
    },
    /// A diffuse base under a dielectric surface, with the light between them in closed form.
    Plastic(Box<Plastic>),
    /// Light is scattered below a dielectric surface: skin, wax, marble, milk.
    Subsurface(Box<Subsurface>),
    /// Fibres of hair or fur.
    Hair(Box<Hair>),
    /// A material that was measured.
    Measured(Arc<Measured>),
    /// A stochastic mix: one of two materials is chosen at random at each intersection.
    Mix {
        /// The two materials; neither may contain this one, directly or indirectly.
        materials: [MaterialId; 2],
        /// The probability of the second.
        amount: Scalar,
    },
    /// glTF's metallic-roughness material and its extensions.
    Principled(Box<Principled>),
    /// OpenPBR's surface.
    OpenPbr(Box<OpenPbr>),
    /// Disney's principled surface.
    Disney(Box<Disney>),
    /// A constant radiance, whatever the lighting; no light is reflected or transmitted (`KHR_materials_unlit`).
    Unlit {
        /// Its radiance.
        color: Color,
    },
    /// A floor of which only shadows are visible: diffuse, as bright as the background where nothing occludes the light from
    /// infinity, darker where something does.
    ShadowCatcher {
        /// The floor's normal: of unit length, in world space.
        normal: Vec3,
    },
    /// No surface: only a medium interface.
    Interface,
}

impl MaterialKind {
    /// Reflectance, and transmittance, of a diffuse sheet where a file does not set it: pbrt-v4's.
    pub const DIFFUSE_SHEET: f32 = 0.25;
    /// Probability of the second material of a mix where a file does not set it.
    pub const MIX_AMOUNT: f32 = 0.5;

    /// Its colours.
    pub fn colors(&self) -> Vec<Color> {
        let of_metal = |metal: &Metal| match *metal {
            Metal::Indices { eta, k, .. } => vec![eta, k],
            Metal::Reflectance(color) => vec![color],
        };
        match self {
            Self::Whitted(k) => {
                let mut colors = vec![k.diffuse, k.specular, k.mirror, k.transmission];
                colors.extend(k.ambient);
                colors
            }
            Self::Diffuse { reflectance } => vec![*reflectance],
            Self::DiffuseTransmission { reflectance, transmittance, .. } => {
                vec![*reflectance, *transmittance]
            }
            Self::Conductor { metal, specular_reflectance, .. } => {
                let mut colors = of_metal(metal);
                colors.push(*specular_reflectance);
                colors
            }
            Self::CoatedDiffuse { reflectance, coat } => vec![*reflectance, coat.albedo],
            Self::Plastic(plastic) => vec![plastic.reflectance, plastic.specular_reflectance],
            Self::CoatedConductor { metal, coat, .. } => {
                let mut colors = of_metal(metal);
                colors.push(coat.albedo);
                colors
            }
            Self::Principled(look) => {
                vec![look.base_color, look.specular_color, look.sheen_color, look.diffuse_transmission_color]
            }
            Self::OpenPbr(look) => look.colors().map(|(_, color)| color).into(),
            Self::Disney(look) => vec![look.base_color],
            Self::Subsurface(below) => below.medium.colors().into(),
            Self::Hair(hair) => hair.pigment.colors(),
            Self::Unlit { color } => vec![*color],
            Self::Dielectric { tint, .. } | Self::ThinDielectric { tint, .. } => {
                tint.colors().map(|(_, color)| color).into()
            }
            Self::Mix { .. } | Self::Measured(_) | Self::ShadowCatcher { .. } | Self::Interface => Vec::new(),
        }
    }

    /// Its colours that are reflectances or transmittances, by name: 1 is all light.
    pub fn reflectances(&self) -> Vec<(&'static str, Color)> {
        match self {
            Self::Whitted(k) => vec![
                ("diffuse", k.diffuse),
                ("specular", k.specular),
                ("mirror", k.mirror),
                ("transmission", k.transmission),
            ],
            Self::DiffuseTransmission { reflectance, transmittance, .. } => {
                vec![("reflectance", *reflectance), ("transmittance", *transmittance)]
            }
            Self::Diffuse { reflectance } => vec![("reflectance", *reflectance)],
            Self::CoatedDiffuse { reflectance, coat } => {
                vec![("reflectance", *reflectance), ("coat_albedo", coat.albedo)]
            }
            Self::Plastic(plastic) => vec![
                ("reflectance", plastic.reflectance),
                ("specular_reflectance", plastic.specular_reflectance),
            ],
            Self::Conductor { metal, specular_reflectance, .. } => {
                let mut colors = vec![("specular_reflectance", *specular_reflectance)];
                if let Metal::Reflectance(reflectance) = metal {
                    colors.push(("reflectance", *reflectance));
                }
                colors
            }
            Self::CoatedConductor { metal, coat, .. } => {
                let mut colors = vec![("coat_albedo", coat.albedo)];
                if let Metal::Reflectance(reflectance) = metal {
                    colors.push(("reflectance", *reflectance));
                }
                colors
            }
            Self::Principled(look) => vec![
                ("base_color", look.base_color),
                ("sheen_color", look.sheen_color),
                ("diffuse_transmission_color", look.diffuse_transmission_color),
            ],
            Self::OpenPbr(look) => look.colors().into(),
            Self::Disney(look) => vec![("base_color", look.base_color)],
            Self::Subsurface(below) => match below.medium {
                SubsurfaceMedium::Reflectance { reflectance, .. } => vec![("reflectance", reflectance)],
                SubsurfaceMedium::Coefficients { .. } => Vec::new(),
            },
            Self::Hair(hair) => match hair.pigment {
                Pigment::Reflectance(reflectance) => vec![("reflectance", reflectance)],
                Pigment::Absorption(_) | Pigment::Melanin { .. } => Vec::new(),
            },
            Self::Dielectric { tint, .. } | Self::ThinDielectric { tint, .. } => tint.colors().into(),
            Self::Mix { .. }
            | Self::Measured(_)
            | Self::Unlit { .. }
            | Self::ShadowCatcher { .. }
            | Self::Interface => Vec::new(),
        }
    }
}
