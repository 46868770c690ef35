//! Materials: reflectance, transmission and emission of surfaces, and the values that textures may vary.

mod coat;
mod disney;
mod hair;
mod inputs;
mod kind;
mod microfacets;
mod open_pbr;
mod plastic;
mod principled;
mod subsurface;
mod tint;
mod whitted;

pub use coat::{Coat, CoatEstimate};
pub use disney::Disney;
pub use hair::{Hair, Pigment};
pub use inputs::Number;
pub use kind::MaterialKind;
pub use microfacets::{Distribution, Energy, Masking, Microfacets, Roughness};
pub use open_pbr::{OpenPbr, Tangent};
pub use plastic::Plastic;
pub use principled::{Anisotropy, Illuminant, Metal, Principled};
pub use subsurface::{Subsurface, SubsurfaceMedium};
pub use tint::Tint;
pub use whitted::Whitted;

use crate::error::Location;
use crate::scene::{CurveId, ImageId, MediumId, TextureId};

/// A colour, constant or textured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Color {
    /// Linear Rec. 709, constant.
    Value([f32; 3]),
    /// A texture.
    Texture(TextureId),
    /// A spectrum, constant.
    Curve(CurveId),
}

impl Color {
    /// No light.
    pub const BLACK: Self = Self::Value([0.0; 3]);
    /// A grey: the same value in each channel.
    pub const fn gray(value: f32) -> Self {
        Self::Value([value; 3])
    }
}

/// A number, constant or textured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scalar {
    /// A constant.
    Value(f32),
    /// The mean of a texture's three channels.
    Texture(TextureId),
}

impl From<Scalar> for Color {
    /// A grey.
    fn from(number: Scalar) -> Self {
        match number {
            Scalar::Value(value) => Self::gray(value),
            Scalar::Texture(id) => Self::Texture(id),
        }
    }
}

/// A named material.
#[derive(Clone, Debug)]
pub struct Material {
    /// The name that shapes use.
    pub name: String,
    /// The location in the file.
    pub at: Location,
    /// The kind of material.
    pub kind: MaterialKind,
    /// Bump or normal mapping.
    pub bump_mapping: BumpMapping,
    /// Guard of normals that bump or normal mapping bends too far; `None` for that of the scene
    /// ([`crate::scene::VertexNormals`]).
    pub bump_guard: Option<BumpGuard>,
    /// Medium inside closed bodies of it; `None` where they only absorb, by the material itself.
    pub medium: Option<MediumId>,
    /// Its look from behind, when paths are traced.
    pub back_face: BackFace,
}

impl Material {
    /// An estimate of its bytes: as much again is in what it points at.
    pub(crate) const BYTES: u64 = 2 * size_of::<Self>() as u64;

    /// A material without bump mapping.
    pub fn new(name: impl Into<String>, at: Location, kind: MaterialKind) -> Self {
        Self {
            name: name.into(),
            at,
            kind,
            bump_mapping: BumpMapping::None,
            bump_guard: None,
            medium: None,
            back_face: BackFace::Own,
        }
    }

    /// Whether the material depends on the direction of u on the surface.
    pub fn has_grain(&self) -> bool {
        let uneven = |roughness: &Roughness| roughness.u != roughness.v;
        self.bump_mapping != BumpMapping::None
            || match &self.kind {
                MaterialKind::Conductor { roughness, .. } | MaterialKind::Dielectric { roughness, .. } => {
                    uneven(roughness)
                }
                MaterialKind::Subsurface(below) => uneven(&below.roughness),
                MaterialKind::CoatedDiffuse { coat, .. } => uneven(&coat.roughness),
                MaterialKind::CoatedConductor { roughness, coat, .. } => {
                    uneven(roughness) || uneven(&coat.roughness)
                }
                MaterialKind::Principled(look) => {
                    look.clearcoat_normal.is_some() || look.anisotropy.is_some()
                }
                MaterialKind::OpenPbr(look) => {
                    look.geometry_coat_normal.is_some()
                        || look.specular_roughness_anisotropy != Scalar::Value(0.0)
                        || look.coat_roughness_anisotropy != Scalar::Value(0.0)
                }
                MaterialKind::Disney(look) => look.anisotropic != Scalar::Value(0.0),
                MaterialKind::Hair(_) => true,
                MaterialKind::Measured(measured) => !measured.is_isotropic(),
                _ => false,
            }
    }
}

/// Bump or normal mapping: it changes the shading normal, not the geometry.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum BumpMapping {
    /// None.
    #[default]
    None,
    /// A bump map: heights along the normal, in the world's unit of length.
    Bump(Scalar),
    /// A normal map in the tangent frame (u, v, outward): x, y, z are 2·texel − 1. Row 0 is v = 1.
    NormalMap(ImageId),
    /// A normal map from a texture, as in glTF.
    NormalTexture(NormalTexture),
}

/// The look of a surface from behind, where its shading normal points away from the viewer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BackFace {
    /// That of the kind of material: bodies from inside, others as from the front.
    #[default]
    Own,
    /// Black, as Mitsuba's surfaces are without `twosided`.
    Black,
}

/// Mitsuba's treatment of normals that are bent too far: no light comes from a direction that is above the surface by one of the
/// normals and below it by the other, the one with the map and the one without.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BumpGuard {
    /// Whether normals that the viewer sees from behind are turned about the one without the map (Schüßler et al. 2017).
    pub turns: bool,
    /// Whether light fades toward directions in which bumps would shadow one another (Conty Estevez, Lecocq & Stein 2019).
    pub shadows: bool,
}

/// Normals from a texture in the tangent frame (u, v, outward): `(scale, scale, 1) · (2·texel − 1)`, normalised. The
/// handedness of u and v is that of the mesh's tangents (their w) if there are any, else that of its texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalTexture {
    /// Read as linear RGB.
    pub texture: TextureId,
    /// Multiplies x and y.
    pub scale: f32,
}

/// The name of the materials that readers make for the colours of vertices.
pub const VERTEX_COLORS: &str = "vertex colours";

/// An index of refraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ior {
    /// Constant over wavelengths.
    Value(f32),
    /// By wavelength, which disperses light.
    Curve(CurveId),
}

impl Ior {
    /// That of common glass: what a dielectric has where a file does not say, in pbrt-v4, in glTF (`KHR_materials_ior`) and here.
    pub const GLASS: f32 = 1.5;
}

impl Default for Ior {
    fn default() -> Self {
        Self::Value(Self::GLASS)
    }
}
