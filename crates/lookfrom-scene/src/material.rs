//! How surfaces look.

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
    /// Where it was written.
    pub at: Location,
    /// What kind of look.
    pub kind: MaterialKind,
    /// What turns or bends the shading normal.
    pub relief: Relief,
}

impl Material {
    /// A look without a relief.
    pub fn new(name: impl Into<String>, at: Location, kind: MaterialKind) -> Self {
        Self { name: name.into(), at, kind, relief: Relief::None }
    }

    /// Whether it matters which way u runs over the surface.
    pub fn has_grain(&self) -> bool {
        let uneven = |roughness: &Roughness| roughness.u != roughness.v;
        self.relief != Relief::None
            || match &self.kind {
                MaterialKind::Conductor { roughness, .. } | MaterialKind::Dielectric { roughness, .. } => {
                    uneven(roughness)
                }
                MaterialKind::CoatedDiffuse { coat, .. } => uneven(&coat.roughness),
                MaterialKind::CoatedConductor { roughness, coat, .. } => {
                    uneven(roughness) || uneven(&coat.roughness)
                }
                _ => false,
            }
    }
}

/// What turns or bends the shading normal; the form stays as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Relief {
    /// Nothing.
    #[default]
    None,
    /// Heights along the normal, in the shape's unit of length.
    Bump(Scalar),
    /// A picture of normals in the tangent frame (u, v, outward): x, y, z are 2·texel − 1. Row 0 is v = 1.
    NormalMap(ImageId),
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
            Self::Dielectric { .. } | Self::ThinDielectric { .. } | Self::Mix { .. } | Self::Interface => {
                Vec::new()
            }
        }
    }
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
