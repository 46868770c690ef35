//! Whitted's coefficients.

use super::{Color, Ior};

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
