//! Compiled materials: those of [`lookfrom_scene::material`] with typed inputs and folded constants.

use glam::Vec3;
use lookfrom_scene::scene::CurveId;

use crate::shading::bsdf::microfacet::TrowbridgeReitz;
use crate::shading::texture::{FloatTexture, SpectrumTexture, TexturePoint, Textures};

/// The materials there are.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum MaterialKind {
    /// Whitted's model.
    Whitted(Whitted),
    /// Reflects the same to all sides (Lambert).
    Diffuse {
        /// The part of light that is reflected.
        reflectance: SpectrumTexture,
    },
    /// Reflects and lets through, the same to all sides.
    DiffuseTransmission {
        /// The part that is reflected.
        reflectance: SpectrumTexture,
        /// The part that is let through.
        transmittance: SpectrumTexture,
        /// Multiplies both.
        scale: f32,
    },
    /// A metal.
    Conductor {
        /// Its optical constants.
        metal: Metal,
        /// Of its surface.
        roughness: Roughness,
    },
    /// Glass, water: the inside is a body.
    Dielectric {
        /// Index of refraction, inside over outside.
        eta: Ior,
        /// Of its surface.
        roughness: Roughness,
    },
    /// A pane so thin that light goes straight on.
    ThinDielectric {
        /// Index of refraction of the pane over that around it.
        eta: Ior,
    },
    /// A diffuse base under a dielectric coat.
    CoatedDiffuse {
        /// Of the base.
        reflectance: SpectrumTexture,
        /// The coat.
        coat: Box<Coat>,
    },
    /// A metal under a dielectric coat.
    CoatedConductor {
        /// The base's optical constants.
        metal: Metal,
        /// Of the base.
        roughness: Roughness,
        /// The coat.
        coat: Box<Coat>,
    },
    /// One or the other, by chance at each meeting.
    Mix {
        /// Indices of the materials that are mixed; never, through any number of steps, this one.
        materials: [u32; 2],
        /// The probability of the second.
        amount: FloatTexture,
    },
    /// glTF's metallic-roughness material and its extensions.
    Principled(Box<Principled>),
    /// Seen in its colour whatever the light, which it neither reflects nor lets through.
    Unlit {
        /// Radiance that it is seen with.
        color: SpectrumTexture,
        /// The same as a reflectance.
        albedo: SpectrumTexture,
    },
    /// A floor that is seen only by the shadows on it.
    ShadowCatcher {
        /// Where the floor looks: of unit length, in the world.
        normal: Vec3,
    },
    /// No surface at all: the border of a medium.
    Interface,
}

/// The parameters of Whitted's model, see [`lookfrom_scene::material::Whitted`].
#[derive(Clone, Debug)]
pub struct Whitted {
    /// `k_a`; `None` means the same as `diffuse`.
    pub ambient: Option<SpectrumTexture>,
    /// `k_d`.
    pub diffuse: SpectrumTexture,
    /// `k_s`.
    pub specular: SpectrumTexture,
    /// `n`.
    pub shininess: f32,
    /// `k_r`.
    pub mirror: SpectrumTexture,
    /// `k_t`.
    pub transmission: SpectrumTexture,
    /// Index of refraction of the inside relative to the outside: > 0.
    pub ior: f32,
    /// Whether Fresnel's equations share out the light between the mirrored and the refracted ray.
    pub fresnel: bool,
}

/// The optical constants of a metal.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Metal {
    /// The complex index of refraction η + i k.
    Indices {
        /// η.
        eta: SpectrumTexture,
        /// k.
        k: SpectrumTexture,
    },
    /// By the colour at normal incidence: η = 1 and the k that gives it.
    Reflectance(SpectrumTexture),
}

/// An index of refraction.
#[derive(Clone, Copy, Debug)]
pub enum Ior {
    /// The same for all wavelengths.
    Value(f32),
    /// By wavelength: light is dispersed.
    Curve(CurveId),
}

/// How rough a microfacet surface is.
#[derive(Clone, Copy, Debug)]
pub enum Roughness {
    /// The same everywhere.
    Constant(TrowbridgeReitz),
    /// It varies over the surface.
    Varying {
        /// Along u and v.
        along: [FloatTexture; 2],
        /// Whether the numbers are a user's 0 … 1 whose square root is α.
        remap: bool,
    },
}

impl Roughness {
    /// The distribution of microfacets at a point.
    #[inline]
    pub(super) fn at(&self, textures: &Textures, point: &TexturePoint) -> TrowbridgeReitz {
        match self {
            Self::Constant(distribution) => *distribution,
            Self::Varying { along, remap } => {
                TrowbridgeReitz::from_roughness(along.map(|texture| textures.float(texture, point)), *remap)
            }
        }
    }
}

/// A dielectric layer over a base, and the medium between.
#[derive(Clone, Debug)]
pub struct Coat {
    /// Index of refraction.
    pub eta: Ior,
    /// Of its outer surface.
    pub roughness: Roughness,
    /// Of the layer.
    pub thickness: FloatTexture,
    /// Of the medium in the layer; black is no medium.
    pub albedo: SpectrumTexture,
    /// Henyey & Greenstein's mean cosine.
    pub g: FloatTexture,
    /// How often light may bounce between coat and base.
    pub max_depth: u16,
    /// How many random walks are averaged.
    pub samples: u16,
}

/// What turns or bends the shading normal.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum BumpMapping {
    /// Nothing.
    None,
    /// Heights along the normal, in the shape's unit of length.
    Bump(FloatTexture),
    /// A picture of normals in the tangent frame (u, v, outward), by its index: x, y, z are 2·texel − 1. Row 0 is v = 1.
    NormalMap(usize),
    /// The same from a texture, as glTF means it.
    NormalTexture(NormalTexture),
}

/// Normals from a texture in the tangent frame: `(scale, scale, 1) · (2·texel − 1)`, made of unit length.
#[derive(Clone, Copy, Debug)]
pub struct NormalTexture {
    /// Read as linear RGB.
    pub texture: SpectrumTexture,
    /// Multiplies x and y.
    pub scale: f32,
}

/// glTF 2.0's metallic-roughness material with its extensions, see [`lookfrom_scene::material::Principled`].
#[derive(Clone, Debug)]
pub struct Principled {
    /// The metal's reflectance straight on; the albedo or tint of what is not metal.
    pub base_color: SpectrumTexture,
    /// 0 is a dielectric, 1 a metal.
    pub metallic: FloatTexture,
    /// Its square is the model's α.
    pub roughness: FloatTexture,
    /// How the highlight is drawn out.
    pub anisotropy: Option<Anisotropy>,
    /// Index of refraction; 0 means infinite.
    pub ior: f32,
    /// 20 over Abbe's number: 0 is none.
    pub dispersion: f32,
    /// How much a dielectric mirrors.
    pub specular: FloatTexture,
    /// The colour of what a dielectric mirrors straight on.
    pub specular_color: SpectrumTexture,
    /// How much of what is not mirrored passes through instead of being scattered.
    pub transmission: FloatTexture,
    /// Whether the surface bounds a body that bends light; otherwise it is a thin sheet.
    pub is_solid: bool,
    /// How much of the diffuse light is let through instead of reflected.
    pub diffuse_transmission: FloatTexture,
    /// Its colour.
    pub diffuse_transmission_color: SpectrumTexture,
    /// The strength of a clear coat over all.
    pub clearcoat: FloatTexture,
    /// Its roughness, whose square is α.
    pub clearcoat_roughness: FloatTexture,
    /// Its own normals; without, those of the mesh.
    pub clearcoat_normal: Option<NormalTexture>,
    /// The colour of fibres over all; black is none.
    pub sheen_color: SpectrumTexture,
    /// Their roughness, whose square is the α of Charlie's distribution.
    pub sheen_roughness: FloatTexture,
    /// How much of a thin film there is.
    pub iridescence: FloatTexture,
    /// The film's index of refraction.
    pub iridescence_ior: f32,
    /// The film's thickness in nm.
    pub iridescence_thickness: FloatTexture,
}

/// How a highlight is drawn out along a direction of the surface.
#[derive(Clone, Copy, Debug)]
pub struct Anisotropy {
    /// 0 is none, 1 as far as it goes.
    pub strength: f32,
    /// Sine and cosine of the angle from the tangent (u) toward the bitangent (v).
    pub sin_cos: [f32; 2],
    /// Red and green, 2·texel − 1, are a direction in the tangent frame, which is then turned; blue multiplies the strength.
    pub texture: Option<SpectrumTexture>,
}
