//! Materials: reflectance, transmission and emission of surfaces, and the values that textures may vary.

mod disney;
mod hair;
mod inputs;
mod microfacets;
mod open_pbr;
mod plastic;
mod subsurface;

use std::sync::Arc;

use glam::Vec3;

pub use disney::Disney;
pub use hair::{Hair, Pigment};
pub use microfacets::{Distribution, Energy, Masking, Microfacets, Roughness};
pub use open_pbr::{OpenPbr, Tangent};
pub use plastic::Plastic;
pub use subsurface::{Subsurface, SubsurfaceMedium};

use crate::error::Location;
use crate::measured::Measured;
use crate::scene::{CurveId, ImageId, MaterialId, MediumId, TextureId};

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
    },
    /// A dielectric such as glass or water, which encloses an interior.
    Dielectric {
        /// Index of refraction, inside over outside.
        eta: Ior,
        /// Roughness of its surface.
        roughness: Roughness,
        /// Multiple scattering between its microfacets: kept or lost.
        energy: Energy,
    },
    /// A sheet so thin that transmitted light is not deflected.
    ThinDielectric {
        /// Index of refraction of the sheet relative to the surrounding medium.
        eta: Ior,
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
            Metal::Indices { eta, k } => vec![eta, k],
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
            Self::Conductor { metal, .. } => of_metal(metal),
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
            Self::Dielectric { .. }
            | Self::ThinDielectric { .. }
            | Self::Mix { .. }
            | Self::Measured(_)
            | Self::ShadowCatcher { .. }
            | Self::Interface => Vec::new(),
        }
    }
}

impl MaterialKind {
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
            Self::Conductor { metal: Metal::Reflectance(reflectance), .. } => {
                vec![("reflectance", *reflectance)]
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
            Self::Conductor { metal: Metal::Indices { .. }, .. }
            | Self::Dielectric { .. }
            | Self::ThinDielectric { .. }
            | Self::Mix { .. }
            | Self::Measured(_)
            | Self::Unlit { .. }
            | Self::ShadowCatcher { .. }
            | Self::Interface => Vec::new(),
        }
    }
}

/// glTF 2.0's metallic-roughness material with its extensions: a weighted mix of metal, dielectric and diffuse base, under
/// sheen and a clear coat. All parameters are those of the extensions, with textures and factors multiplied.
#[derive(Clone, Debug, PartialEq)]
pub struct Principled {
    /// Normal-incidence reflectance of the metal; albedo or tint of the dielectric.
    pub base_color: Color,
    /// 0 is a dielectric, 1 a metal.
    pub metallic: Scalar,
    /// Perceptual roughness: α is its square.
    pub roughness: Scalar,
    /// Anisotropy of the highlight (`KHR_materials_anisotropy`).
    pub anisotropy: Option<Anisotropy>,
    /// Index of refraction (`KHR_materials_ior`); 0 means infinity: the Fresnel reflectance is 1 times the specular colour.
    pub ior: f32,
    /// 20 divided by the Abbe number (`KHR_materials_dispersion`); 0 means no dispersion.
    pub dispersion: f32,
    /// Strength of a dielectric's specular reflection (`KHR_materials_specular`).
    pub specular: Scalar,
    /// Colour of a dielectric's specular reflection at normal incidence.
    pub specular_color: Color,
    /// The fraction of light not reflected specularly that is transmitted instead of scattered
    /// (`KHR_materials_transmission`).
    pub transmission: Scalar,
    /// Whether the surface bounds a refracting volume (`KHR_materials_volume` with a thickness); otherwise it is a thin
    /// sheet.
    pub is_solid: bool,
    /// Absorption coefficient of the volume in world units, for each primary: ≥ 0. [`Material::medium`] replaces it.
    pub absorption: [f32; 3],
    /// The fraction of diffuse light that is transmitted instead of reflected (`KHR_materials_diffuse_transmission`).
    pub diffuse_transmission: Scalar,
    /// Colour of the diffuse transmission.
    pub diffuse_transmission_color: Color,
    /// Strength of a clear coat (`KHR_materials_clearcoat`); its index of refraction is 1.5.
    pub clearcoat: Scalar,
    /// Perceptual roughness of the clear coat: α is its square.
    pub clearcoat_roughness: Scalar,
    /// Normal map of the clear coat; `None` for the mesh's normals, without [`Material::bump_mapping`].
    pub clearcoat_normal: Option<NormalTexture>,
    /// Colour of the sheen of fibres (`KHR_materials_sheen`); black means no sheen.
    pub sheen_color: Color,
    /// Roughness of the sheen, whose square is the α of the Charlie distribution (Estevez & Kulla 2017).
    pub sheen_roughness: Scalar,
    /// Strength of the thin-film effect (`KHR_materials_iridescence`, Belcour & Barla 2017).
    pub iridescence: Scalar,
    /// Index of refraction of the film.
    pub iridescence_ior: f32,
    /// Thickness of the film in nm.
    pub iridescence_thickness: Scalar,
}

impl Principled {
    /// Index of refraction of a thin film where a file does not set one (`KHR_materials_iridescence`).
    pub const FILM_IOR: f32 = 1.3;
    /// Thickness of a thin film in nm where a file does not set one (`KHR_materials_iridescence`).
    pub const FILM_THICKNESS: f32 = 400.0;
}

impl Default for Principled {
    /// glTF's default material.
    fn default() -> Self {
        Self {
            base_color: Color::gray(1.0),
            metallic: Scalar::Value(1.0),
            roughness: Scalar::Value(1.0),
            anisotropy: None,
            ior: Ior::GLASS,
            dispersion: 0.0,
            specular: Scalar::Value(1.0),
            specular_color: Color::gray(1.0),
            transmission: Scalar::Value(0.0),
            is_solid: false,
            absorption: [0.0; 3],
            diffuse_transmission: Scalar::Value(0.0),
            diffuse_transmission_color: Color::gray(1.0),
            clearcoat: Scalar::Value(0.0),
            clearcoat_roughness: Scalar::Value(0.0),
            clearcoat_normal: None,
            sheen_color: Color::BLACK,
            sheen_roughness: Scalar::Value(0.0),
            iridescence: Scalar::Value(0.0),
            iridescence_ior: Self::FILM_IOR,
            iridescence_thickness: Scalar::Value(Self::FILM_THICKNESS),
        }
    }
}

/// Elongation of the highlight along a direction of the surface (`KHR_materials_anisotropy`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anisotropy {
    /// From 0, isotropic, to 1, the maximum.
    pub strength: f32,
    /// Angle from the tangent (u) toward the bitangent (v), in radians.
    pub rotation: f32,
    /// Red and green, 2·texel − 1, are a direction in the tangent frame, to which `rotation` is added; blue multiplies the
    /// strength.
    pub texture: Option<TextureId>,
}

/// The optical constants of a metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Metal {
    /// The complex index of refraction η + i k, relative to vacuum.
    Indices {
        /// η.
        eta: Color,
        /// k.
        k: Color,
    },
    /// The reflectance at normal incidence: η = 1 and the k that gives it.
    Reflectance(Color),
}

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

/// A dielectric layer over a base, with a medium in between (Guo, Hašan & Zhao 2018).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat {
    /// Index of refraction.
    pub eta: Ior,
    /// Roughness of its outer surface.
    pub roughness: Roughness,
    /// Thickness of the layer.
    pub thickness: Scalar,
    /// Single-scattering albedo of the medium in the layer; black for no medium.
    pub albedo: Color,
    /// Henyey–Greenstein asymmetry parameter of the medium: the mean cosine, in (−1, 1).
    pub g: Scalar,
    /// Maximum number of bounces between coat and base.
    pub max_depth: u32,
    /// Number of random walks that are averaged.
    pub samples: u32,
    /// Weights of its random walks.
    pub estimate: CoatEstimate,
}

impl Coat {
    /// Maximum number of bounces where a file does not set one and pbrt's picture does not decide: so many that Russian
    /// roulette alone ends walks.
    pub const MAX_DEPTH: u32 = 1000;
    /// Thickness where a file does not set one: pbrt-v4's.
    pub const THICKNESS: f32 = 0.01;
}

impl Default for Coat {
    /// Smooth and clear glass, as pbrt-v4's; its walks are ours.
    fn default() -> Self {
        Self {
            eta: Ior::default(),
            roughness: Roughness::SMOOTH,
            thickness: Scalar::Value(Self::THICKNESS),
            albedo: Color::BLACK,
            g: Scalar::Value(0.0),
            max_depth: Self::MAX_DEPTH,
            samples: 1,
            estimate: CoatEstimate::Unbiased,
        }
    }
}

/// The estimate of what a coat and its base reflect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoatEstimate {
    /// That of pbrt-v4, whose two strategies of leaving through a rough coat have weights that do not add up to one: up to 9 %
    /// too bright, and not reciprocal.
    Pbrt,
    /// With weights that add up to one: reciprocal and without bias.
    Unbiased,
}

/// The model of Whitted 1980, with Blinn's highlight:
/// `I = k_a I_a + k_d Σ (N·L) I_j + k_s Σ (N·H)^n I_j + k_r S + k_t T`.
#[derive(Clone, Debug, PartialEq)]
pub struct Whitted {
    /// `k_a`, the reflection of ambient light; `None` for the same as `diffuse`.
    pub ambient: Option<Color>,
    /// `k_d`.
    pub diffuse: Color,
    /// `k_s`, the strength of the highlight.
    pub specular: Color,
    /// `n`, the sharpness of the highlight: ≥ 0.
    pub shininess: f32,
    /// `k_r`, the weight of the reflected ray.
    pub mirror: Color,
    /// `k_t`, the weight of the refracted ray.
    pub transmission: Color,
    /// Index of refraction of the inside relative to the outside: > 0.
    pub ior: f32,
    /// Whether Fresnel's equations distribute the light between the reflected and the refracted ray; otherwise only `mirror`
    /// and `transmission` do (total internal reflection is handled in both cases).
    pub fresnel: bool,
    /// Absorption coefficient of the inside (Beer's law), for each primary: ≥ 0.
    pub absorption: [f32; 3],
}

impl Default for Whitted {
    fn default() -> Self {
        Self {
            ambient: None,
            diffuse: Color::gray(0.8),
            specular: Color::BLACK,
            shininess: 50.0,
            mirror: Color::BLACK,
            transmission: Color::BLACK,
            ior: Ior::GLASS,
            fresnel: false,
            absorption: [0.0; 3],
        }
    }
}
