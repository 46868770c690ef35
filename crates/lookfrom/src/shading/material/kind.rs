//! Compiled materials: those of [`lookfrom_scene::material`] with typed inputs and folded constants.

use std::sync::Arc;

use glam::Vec3;
use lookfrom_scene::material::{self as written, CoatEstimate, Energy};
use lookfrom_scene::scene::CurveId;

use super::disney::DisneyMaterial;
use super::hair::HairMaterial;
use super::open_pbr::OpenPbrMaterial;
use crate::shading::bsdf::layered::CoatInterior;
use crate::shading::bsdf::measured::MeasuredTables;
use crate::shading::bsdf::microfacet::{Microfacets, TrowbridgeReitz};
use crate::shading::bsdf::normalized_fresnel::NormalizedFresnel;
use crate::shading::bsdf::plastic::Interface;
use crate::shading::bsdf::principled as bsdf;
use crate::shading::bssrdf::table::ProfileTable;
use crate::shading::texture::{FloatTexture, PicturedFloat, SpectrumTexture, TexturePoint, Textures};

/// The types of materials.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum MaterialKind {
    /// Whitted's model.
    Whitted(Box<WhittedMaterial>),
    /// Diffuse (Lambertian) reflection.
    Diffuse {
        /// Fraction of light that is reflected: an albedo, or Whitted's `k_d`, which is unbounded.
        reflectance: SpectrumTexture,
    },
    /// Diffuse reflection and transmission.
    DiffuseTransmission {
        /// Fraction of light that is reflected.
        reflectance: SpectrumTexture,
        /// Fraction of light that is transmitted.
        transmittance: SpectrumTexture,
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
        /// Factor of the Fresnel reflectance.
        specular_reflectance: SpectrumTexture,
    },
    /// A dielectric such as glass or water: the inside is a body.
    Dielectric {
        /// Index of refraction, inside over outside.
        eta: Ior,
        /// Roughness of its surface.
        roughness: Roughness,
        /// Multiple scattering between its microfacets: kept or lost.
        energy: Energy,
    },
    /// A dielectric with colours of its own.
    TintedDielectric {
        /// As of [`Self::Dielectric`].
        eta: Ior,
        /// As of [`Self::Dielectric`].
        roughness: Roughness,
        /// As of [`Self::Dielectric`].
        energy: Energy,
        /// Its colours.
        tint: Box<TintTextures>,
    },
    /// A dielectric sheet so thin that light passes undeviated.
    ThinDielectric {
        /// Index of refraction of the sheet over that of its surroundings.
        eta: Ior,
        /// Its colours, if it has any.
        tint: Option<Box<TintTextures>>,
    },
    /// A diffuse base under a dielectric coat.
    CoatedDiffuse {
        /// Reflectance of the base.
        reflectance: SpectrumTexture,
        /// The coat.
        coat: Box<CoatMaterial>,
    },
    /// A metal under a dielectric coat.
    CoatedConductor {
        /// The base's optical constants.
        metal: Metal,
        /// Roughness of the base.
        roughness: Roughness,
        /// The coat.
        coat: Box<CoatMaterial>,
    },
    /// A diffuse base under a dielectric surface, with the light between them in closed form.
    Plastic(Box<PlasticMaterial>),
    /// Light is scattered below a dielectric surface.
    Subsurface(Box<SubsurfaceMaterial>),
    /// Fibres of hair or fur.
    Hair(Box<HairMaterial>),
    /// A material that was measured.
    Measured(&'static MeasuredTables),
    /// One of two materials, chosen at random at each hit.
    Mix {
        /// Indices of the mixed materials; never this one, directly or through other mixtures.
        materials: [u32; 2],
        /// The probability of the second.
        amount: FloatTexture,
    },
    /// glTF's metallic-roughness material and its extensions.
    Principled(Box<PrincipledMaterial>),
    /// OpenPBR's surface.
    OpenPbr(Box<OpenPbrMaterial>),
    /// Disney's principled surface.
    Disney(Box<DisneyMaterial>),
    /// Visible in its colour whatever the light, which it neither reflects nor transmits.
    Unlit {
        /// Its radiance.
        color: SpectrumTexture,
        /// That colour as a reflectance.
        albedo: SpectrumTexture,
    },
    /// A floor of which only the shadows on it are visible.
    ShadowCatcher {
        /// The floor's normal: of unit length, in the world.
        normal: Vec3,
    },
    /// No scattering at all: the boundary of a medium.
    Interface,
}

/// The parameters of Whitted's model, see [`lookfrom_scene::material::Whitted`].
#[derive(Clone, Debug)]
pub struct WhittedMaterial {
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
    /// True if Fresnel's equations divide the light between the reflected and the refracted ray.
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
    /// By the reflectance at normal incidence: η = 1 and the k that gives it.
    Reflectance(SpectrumTexture),
}

/// An index of refraction.
#[derive(Clone, Copy, Debug)]
pub enum Ior {
    /// One value for all wavelengths.
    Value(f32),
    /// By wavelength: light is dispersed.
    Curve(CurveId),
}

/// Roughness of a microfacet surface.
#[derive(Clone, Copy, Debug)]
pub enum Roughness {
    /// One value everywhere.
    Constant(Microfacets),
    /// It varies over the surface.
    Varying {
        /// Along u and v.
        along: [FloatTexture; 2],
        /// True if the numbers are a user's 0 … 1 whose square root is α.
        remap: bool,
        /// The kind of microfacets.
        microfacets: written::Microfacets,
    },
}

impl Roughness {
    /// The microfacet distribution at a point.
    #[inline]
    pub(super) fn at(&self, textures: &Textures, point: &TexturePoint) -> Microfacets {
        match self {
            Self::Constant(microfacets) => *microfacets,
            Self::Varying { along, remap, microfacets } => {
                let roughness = along.map(|texture| textures.float(texture, point));
                Microfacets::new(TrowbridgeReitz::from_roughness(roughness, *remap), *microfacets)
            }
        }
    }
}

/// A dielectric layer over a base, and the medium between.
#[derive(Clone, Debug)]
pub struct CoatMaterial {
    /// Index of refraction.
    pub eta: Ior,
    /// Roughness of its outer surface.
    pub roughness: Roughness,
    /// Thickness of the layer.
    pub thickness: FloatTexture,
    /// Single-scattering albedo of the medium in the layer; black is no medium.
    pub albedo: SpectrumTexture,
    /// Mean cosine of the Henyey–Greenstein phase function.
    pub g: FloatTexture,
    /// Maximum number of bounces between coat and base.
    pub max_depth: u16,
    /// Number of random walks that are averaged.
    pub samples: u16,
    /// The weights of these samples.
    pub estimate: CoatEstimate,
    /// Knowledge of its inside, where the coat is the same everywhere and has no particles, and is not pbrt's.
    pub interior: Option<CoatInterior>,
}

/// Colours of a dielectric, see [`lookfrom_scene::material::Tint`].
#[derive(Clone, Debug)]
pub struct TintTextures {
    /// The factor of reflected light.
    pub reflectance: SpectrumTexture,
    /// The factor of transmitted light.
    pub transmittance: SpectrumTexture,
}

/// A diffuse base under a dielectric surface, see [`lookfrom_scene::material::Plastic`].
#[derive(Clone, Debug)]
pub struct PlasticMaterial {
    /// Albedo of the base.
    pub reflectance: SpectrumTexture,
    /// Multiplies what the surface reflects.
    pub specular_reflectance: SpectrumTexture,
    /// Whether light is coloured each time it comes back to the base.
    pub is_nonlinear: bool,
    /// The surface.
    pub interface: &'static Interface,
}

/// A medium below a dielectric surface, see [`lookfrom_scene::material::Subsurface`].
#[derive(Clone, Debug)]
pub struct SubsurfaceMaterial {
    /// The medium.
    pub medium: SubsurfaceMedium,
    /// Multiplies its coefficients, or its mean free path.
    pub scale: f32,
    /// Index of refraction, inside over outside.
    pub eta: f32,
    /// Roughness of the surface.
    pub roughness: Roughness,
    /// The directions in which light leaves.
    pub(super) exit: NormalizedFresnel,
    /// The profiles of all media with its phase function and index of refraction.
    pub(crate) profiles: Arc<ProfileTable>,
}

/// A medium below a surface.
#[derive(Clone, Debug)]
pub enum SubsurfaceMedium {
    /// By its coefficients, per unit of length.
    Coefficients {
        /// The absorption coefficient.
        absorption: SpectrumTexture,
        /// The scattering coefficient.
        scattering: SpectrumTexture,
    },
    /// By its effect.
    Reflectance {
        /// The fraction of the light that has entered which leaves again.
        reflectance: SpectrumTexture,
        /// The mean free path.
        mean_free_path: SpectrumTexture,
    },
}

/// Perturbations of the shading normal.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum BumpMapping {
    /// Nothing.
    None,
    /// Heights along the normal, in the world's unit of length.
    Bump(PicturedFloat),
    /// A normal map in the tangent frame (u, v, outward), by its image index: x, y, z are 2·texel − 1. Row 0 is v =
    /// 1.
    NormalMap(usize),
    /// A normal map by a texture, as in glTF.
    NormalTexture(NormalTexture),
}

/// A normal map in the tangent frame: `(scale, scale, 1) · (2·texel − 1)`, normalised.
#[derive(Clone, Copy, Debug)]
pub struct NormalTexture {
    /// Evaluated as linear RGB.
    pub texture: SpectrumTexture,
    /// Scales x and y.
    pub scale: f32,
}

/// glTF 2.0's metallic-roughness material with its extensions, see [`lookfrom_scene::material::Principled`].
#[derive(Clone, Debug)]
pub struct PrincipledMaterial {
    /// The metal's reflectance at normal incidence; the albedo or tint of the non-metallic part.
    pub base_color: SpectrumTexture,
    /// 0 is a dielectric, 1 a metal.
    pub metallic: FloatTexture,
    /// Its square is the model's α.
    pub roughness: FloatTexture,
    /// Anisotropy of the specular reflection.
    pub anisotropy: Option<Anisotropy>,
    /// Index of refraction; 0 means infinite.
    pub ior: f32,
    /// 20 over the Abbe number: 0 is none.
    pub dispersion: f32,
    /// Strength of the dielectric's specular reflection.
    pub specular: FloatTexture,
    /// The dielectric's specular colour at normal incidence.
    pub specular_color: SpectrumTexture,
    /// Fraction of the light that is not reflected specularly which is transmitted instead of
    /// scattered diffusely.
    pub transmission: FloatTexture,
    /// True if the surface bounds a refractive body; otherwise it is a thin sheet.
    pub is_solid: bool,
    /// Fraction of the diffuse light that is transmitted instead of reflected.
    pub diffuse_transmission: FloatTexture,
    /// Colour of the diffuse transmission.
    pub diffuse_transmission_color: SpectrumTexture,
    /// The strength of the clear coat on top.
    pub clearcoat: FloatTexture,
    /// Roughness of the clear coat, whose square is α.
    pub clearcoat_roughness: FloatTexture,
    /// Normal map of the clear coat; without one, the mesh's normals.
    pub clearcoat_normal: Option<NormalTexture>,
    /// The colour of the sheen (fibres on top); black is none.
    pub sheen_color: SpectrumTexture,
    /// Roughness of the sheen, whose square is the α of the Charlie distribution.
    pub sheen_roughness: FloatTexture,
    /// Weight of the thin film.
    pub iridescence: FloatTexture,
    /// The film's index of refraction.
    pub iridescence_ior: f32,
    /// The film's thickness in nm.
    pub iridescence_thickness: FloatTexture,
    /// The BSDF, where all of it but base colour, metalness and roughness is the same everywhere outside of bodies.
    pub(super) template: Option<bsdf::Principled>,
}

/// Anisotropy of a specular lobe along a direction of the surface.
#[derive(Clone, Copy, Debug)]
pub struct Anisotropy {
    /// 0 is none, 1 is the maximum.
    pub strength: f32,
    /// Sine and cosine of the angle from the tangent (u) toward the bitangent (v).
    pub sin_cos: [f32; 2],
    /// Red and green, 2·texel − 1, are a direction in the tangent frame, which is then rotated; blue multiplies the
    /// strength.
    pub texture: Option<SpectrumTexture>,
}
