//! How surfaces look.

use crate::error::Location;
use crate::scene::TextureId;

/// A colour that may vary over the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Color {
    /// Linear Rec. 709, the same everywhere.
    Value([f32; 3]),
    /// From a texture.
    Texture(TextureId),
}

impl Color {
    /// Nothing.
    pub const BLACK: Self = Self::Value([0.0; 3]);
    /// The same amount of each primary.
    pub const fn gray(value: f32) -> Self {
        Self::Value([value; 3])
    }
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
}

/// The looks there are.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialKind {
    /// Whitted's model.
    Whitted(Whitted),
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
