//! Hair and fur: the material of curves that are fibres.

use super::{Color, Scalar};

/// A fibre of hair (Chiang et al. 2016). Shapes other than curves take their texture coordinate v for the place across it.
#[derive(Clone, Debug, PartialEq)]
pub struct Hair {
    /// Its colour.
    pub pigment: Pigment,
    /// Index of refraction, inside over outside: > 0.
    pub eta: Scalar,
    /// Longitudinal roughness β_m, 0 … 1: along the fibre.
    pub beta_m: Scalar,
    /// Azimuthal roughness β_n, 0 … 1: around the fibre.
    pub beta_n: Scalar,
    /// Angle of the scales on its surface, in degrees.
    pub alpha: Scalar,
}

impl Hair {
    /// Index of refraction where a file does not set it: keratin's.
    pub const ETA: f32 = 1.55;
    /// Roughness of both kinds where a file does not set it: pbrt-v4's.
    pub const ROUGHNESS: f32 = 0.3;
    /// Angle of the scales where a file does not set it, in degrees.
    pub const ALPHA: f32 = 2.0;
}

/// The pigment of a fibre.
#[derive(Clone, Debug, PartialEq)]
pub enum Pigment {
    /// The absorption coefficient, per radius of the fibre.
    Absorption(Color),
    /// By the colour of the light that many such fibres reflect together, 0 … 1.
    Reflectance(Color),
    /// By the concentrations of the pigments of human hair, ≥ 0: 0 is white, 0.3 of eumelanin blond, 1.3 brown, 8 black.
    Melanin {
        /// The concentration of the brown pigment.
        eumelanin: Scalar,
        /// The concentration of the red pigment.
        pheomelanin: Scalar,
    },
}

impl Pigment {
    /// Brown hair: what there is where a file does not say, as in pbrt-v4.
    pub const BROWN: Self = Self::Melanin { eumelanin: Scalar::Value(1.3), pheomelanin: Scalar::Value(0.0) };

    /// Absorption per radius by a concentration of 1 of eumelanin and of pheomelanin, for red, green and blue (d'Eon et al. 2011).
    pub const MELANINS: [[f32; 3]; 2] = [[0.419, 0.697, 1.37], [0.187, 0.4, 1.05]];

    /// Its colours.
    pub(super) fn colors(&self) -> Vec<Color> {
        match *self {
            Self::Absorption(color) | Self::Reflectance(color) => vec![color],
            Self::Melanin { .. } => Vec::new(),
        }
    }
}
