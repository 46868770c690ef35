//! Materials: reflectance, transmission and emission of surfaces, and the values that textures may vary.

use glam::Vec3;

use crate::error::Location;
use crate::scene::{CurveId, ImageId, MaterialId, TextureId};

/// A colour that may vary over the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Color {
    /// Linear Rec. 709, the same everywhere.
    Value([f32; 3]),
    /// From a texture.
    Texture(TextureId),
    /// By wavelength, the same everywhere.
    Curve(CurveId),
}

impl Color {
    /// Nothing.
    pub const BLACK: Self = Self::Value([0.0; 3]);
    /// The same amount of each primary.
    pub const fn gray(value: f32) -> Self {
        Self::Value([value; 3])
    }
}

/// A number that may vary over the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scalar {
    /// The same everywhere.
    Value(f32),
    /// The mean of a texture's three channels.
    Texture(TextureId),
}

/// A named look.
#[derive(Clone, Debug)]
pub struct Material {
    /// The name that shapes use.
    pub name: String,
    /// The location in the file.
    pub at: Location,
    /// What kind of look.
    pub kind: MaterialKind,
    /// What turns or bends the shading normal.
    pub bump_mapping: BumpMapping,
}

impl Material {
    /// A look without bump mapping.
    pub fn new(name: impl Into<String>, at: Location, kind: MaterialKind) -> Self {
        Self { name: name.into(), at, kind, bump_mapping: BumpMapping::None }
    }

    /// Whether it matters which way u runs over the surface.
    pub fn has_grain(&self) -> bool {
        let uneven = |roughness: &Roughness| roughness.u != roughness.v;
        self.bump_mapping != BumpMapping::None
            || match &self.kind {
                MaterialKind::Conductor { roughness, .. } | MaterialKind::Dielectric { roughness, .. } => {
                    uneven(roughness)
                }
                MaterialKind::CoatedDiffuse { coat, .. } => uneven(&coat.roughness),
                MaterialKind::CoatedConductor { roughness, coat, .. } => {
                    uneven(roughness) || uneven(&coat.roughness)
                }
                MaterialKind::Principled(look) => {
                    look.clearcoat_normal.is_some() || look.anisotropy.is_some()
                }
                _ => false,
            }
    }
}

/// What turns or bends the shading normal; the form stays as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum BumpMapping {
    /// Nothing.
    #[default]
    None,
    /// Heights along the normal, in the shape's unit of length.
    Bump(Scalar),
    /// A picture of normals in the tangent frame (u, v, outward): x, y, z are 2·texel − 1. Row 0 is v = 1.
    NormalMap(ImageId),
    /// The same from a texture, as glTF means it.
    NormalTexture(NormalTexture),
}

/// Normals from a texture in the tangent frame (u, v, outward): `(scale, scale, 1) · (2·texel − 1)`, made of unit length.
/// v is to the left of u where the mesh's tangents say so (their w), else where texture coordinates do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalTexture {
    /// Read as linear RGB.
    pub texture: TextureId,
    /// Multiplies x and y.
    pub scale: f32,
}

/// The looks there are.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialKind {
    /// Whitted's model.
    Whitted(Whitted),
    /// Reflects the same to all sides (Lambert).
    Diffuse {
        /// The part of light that is reflected.
        reflectance: Color,
    },
    /// Reflects and lets through, the same to all sides.
    DiffuseTransmission {
        /// The part that is reflected.
        reflectance: Color,
        /// The part that is let through.
        transmittance: Color,
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
        reflectance: Color,
        /// The coat.
        coat: Coat,
    },
    /// A metal under a dielectric coat.
    CoatedConductor {
        /// The base's optical constants.
        metal: Metal,
        /// Of the base.
        roughness: Roughness,
        /// The coat.
        coat: Coat,
    },
    /// One or the other, by chance at each meeting.
    Mix {
        /// The looks that are mixed; never, through any number of steps, this one.
        materials: [MaterialId; 2],
        /// The probability of the second.
        amount: Scalar,
    },
    /// glTF's metallic-roughness material and its extensions.
    Principled(Box<Principled>),
    /// Seen in its colour whatever the light, which it neither reflects nor lets through (`KHR_materials_unlit`).
    Unlit {
        /// Radiance that it is seen with.
        color: Color,
    },
    /// A floor that is seen only by the shadows on it: matte, as bright as what lies behind it where nothing is in the way
    /// of the light from infinitely far, darker where something is.
    ShadowCatcher {
        /// Where the floor looks: of unit length, in the world.
        normal: Vec3,
    },
    /// No surface at all: the border of a medium.
    Interface,
}

impl MaterialKind {
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
            Self::CoatedConductor { metal, coat, .. } => {
                let mut colors = of_metal(metal);
                colors.push(coat.albedo);
                colors
            }
            Self::Principled(look) => {
                vec![look.base_color, look.specular_color, look.sheen_color, look.diffuse_transmission_color]
            }
            Self::Unlit { color } => vec![*color],
            Self::Dielectric { .. }
            | Self::ThinDielectric { .. }
            | Self::Mix { .. }
            | Self::ShadowCatcher { .. }
            | Self::Interface => Vec::new(),
        }
    }
}

impl MaterialKind {
    /// Its colours that are shares of the light that arrives, by name: 1 is all of it.
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
            Self::Conductor { metal: Metal::Indices { .. }, .. }
            | Self::Dielectric { .. }
            | Self::ThinDielectric { .. }
            | Self::Mix { .. }
            | Self::Unlit { .. }
            | Self::ShadowCatcher { .. }
            | Self::Interface => Vec::new(),
        }
    }
}

/// glTF 2.0's metallic-roughness material with its extensions: a metal, glass or diffuse body, by parts, under sheen and
/// a clear coat. All numbers are those of the extensions, with textures and factors multiplied.
#[derive(Clone, Debug, PartialEq)]
pub struct Principled {
    /// The metal's reflectance straight on; the albedo or tint of what is not metal.
    pub base_color: Color,
    /// 0 is a dielectric, 1 a metal.
    pub metallic: Scalar,
    /// Its square is the model's α.
    pub roughness: Scalar,
    /// How the highlight is drawn out (`KHR_materials_anisotropy`).
    pub anisotropy: Option<Anisotropy>,
    /// Index of refraction (`KHR_materials_ior`); 0 means infinite: Fresnel's reflectance is 1 times the specular colour.
    pub ior: f32,
    /// 20 over Abbe's number (`KHR_materials_dispersion`): 0 is none.
    pub dispersion: f32,
    /// How much a dielectric mirrors (`KHR_materials_specular`).
    pub specular: Scalar,
    /// The colour of what a dielectric mirrors straight on.
    pub specular_color: Color,
    /// How much of what is not mirrored passes through instead of being scattered (`KHR_materials_transmission`).
    pub transmission: Scalar,
    /// Whether the surface bounds a body that bends light (`KHR_materials_volume` with a thickness); otherwise it is a thin
    /// sheet.
    pub is_solid: bool,
    /// Absorption in the body per unit of length of the world, for each primary: ≥ 0.
    pub absorption: [f32; 3],
    /// How much of the diffuse light is let through instead of reflected (`KHR_materials_diffuse_transmission`).
    pub diffuse_transmission: Scalar,
    /// Its colour.
    pub diffuse_transmission_color: Color,
    /// The strength of a clear coat over all (`KHR_materials_clearcoat`); its index of refraction is 1.5.
    pub clearcoat: Scalar,
    /// Its roughness, whose square is α.
    pub clearcoat_roughness: Scalar,
    /// Its own normals; without, those of the mesh, not those of [`Material::bump_mapping`].
    pub clearcoat_normal: Option<NormalTexture>,
    /// The colour of fibres over all (`KHR_materials_sheen`); black is none.
    pub sheen_color: Color,
    /// Their roughness, whose square is the α of Charlie's distribution (Estevez & Kulla 2017).
    pub sheen_roughness: Scalar,
    /// How much of a thin film there is (`KHR_materials_iridescence`, Belcour & Barla 2017).
    pub iridescence: Scalar,
    /// The film's index of refraction.
    pub iridescence_ior: f32,
    /// The film's thickness in nm.
    pub iridescence_thickness: Scalar,
}

impl Default for Principled {
    /// glTF's default material.
    fn default() -> Self {
        Self {
            base_color: Color::gray(1.0),
            metallic: Scalar::Value(1.0),
            roughness: Scalar::Value(1.0),
            anisotropy: None,
            ior: 1.5,
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
            iridescence_ior: 1.3,
            iridescence_thickness: Scalar::Value(400.0),
        }
    }
}

/// How a highlight is drawn out along a direction of the surface (`KHR_materials_anisotropy`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anisotropy {
    /// 0 is none, 1 as far as it goes.
    pub strength: f32,
    /// From the tangent (u) toward the bitangent (v), in radians.
    pub rotation: f32,
    /// Red and green, 2·texel − 1, are a direction in the tangent frame, which is then turned; blue multiplies the strength.
    pub texture: Option<TextureId>,
}

/// The optical constants of a metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Metal {
    /// By the complex index of refraction η + i k, relative to vacuum.
    Indices {
        /// η.
        eta: Color,
        /// k.
        k: Color,
    },
    /// By the colour at normal incidence: η = 1 and the k that gives it.
    Reflectance(Color),
}

/// An index of refraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ior {
    /// The same for all wavelengths.
    Value(f32),
    /// By wavelength: light is dispersed.
    Curve(CurveId),
}

/// How rough a microfacet surface is (Trowbridge & Reitz 1975), along u and v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// Along u.
    pub u: Scalar,
    /// Along v.
    pub v: Scalar,
    /// Whether the numbers are a user's 0 … 1 whose square root is the model's α; otherwise they are α.
    pub remap: bool,
}

impl Roughness {
    /// None.
    pub const SMOOTH: Self = Self { u: Scalar::Value(0.0), v: Scalar::Value(0.0), remap: true };
}

/// A dielectric layer over a base, and the medium between (Guo, Hašan & Zhao 2018).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat {
    /// Index of refraction.
    pub eta: Ior,
    /// Of its outer surface.
    pub roughness: Roughness,
    /// Of the layer.
    pub thickness: Scalar,
    /// Of the medium in the layer: the part of light that a particle scatters; black is no medium.
    pub albedo: Color,
    /// Of the medium: Henyey & Greenstein's mean cosine, in (−1, 1).
    pub g: Scalar,
    /// How often light may bounce between coat and base.
    pub max_depth: u32,
    /// How many random walks are averaged.
    pub samples: u32,
}

/// The model of Whitted 1980, with Blinn's highlight:
/// `I = k_a I_a + k_d Σ (N·L) I_j + k_s Σ (N·H)^n I_j + k_r S + k_t T`.
#[derive(Clone, Debug, PartialEq)]
pub struct Whitted {
    /// `k_a`, the answer to ambient light; `None` means the same as `diffuse`.
    pub ambient: Option<Color>,
    /// `k_d`.
    pub diffuse: Color,
    /// `k_s`, the strength of the highlight.
    pub specular: Color,
    /// `n`, the sharpness of the highlight: ≥ 0.
    pub shininess: f32,
    /// `k_r`, how much of the mirrored direction is seen.
    pub mirror: Color,
    /// `k_t`, how much of the refracted direction is seen.
    pub transmission: Color,
    /// Index of refraction of the inside relative to the outside: > 0.
    pub ior: f32,
    /// Whether Fresnel's equations share out the light between the mirrored and the refracted ray; otherwise
    /// `mirror` and `transmission` alone do (total internal reflection happens either way).
    pub fresnel: bool,
    /// Absorption in the inside per unit of length (Beer's law), for each primary: ≥ 0.
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
            ior: 1.5,
            fresnel: false,
            absorption: [0.0; 3],
        }
    }
}
