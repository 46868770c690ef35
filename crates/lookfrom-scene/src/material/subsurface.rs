//! Subsurface scattering: light enters a surface, is scattered below it, and leaves it at another point.

use super::{Color, Roughness};

/// A medium below a dielectric surface, so dense that light diffuses in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Subsurface {
    /// The medium.
    pub medium: SubsurfaceMedium,
    /// Multiplies its coefficients, or its mean free path: ≥ 0.
    pub scale: f32,
    /// Mean cosine of the scattering angle (Henyey & Greenstein 1941): between −1 and 1, 0 for all directions alike.
    pub g: f32,
    /// Index of refraction, inside over outside: > 0.
    pub eta: f32,
    /// Roughness of the surface.
    pub roughness: Roughness,
}

impl Subsurface {
    /// Index of refraction where a file does not set it: water's, as in pbrt-v4.
    pub const ETA: f32 = 1.33;
}

/// A medium below a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum SubsurfaceMedium {
    /// By its coefficients, per unit of length.
    Coefficients {
        /// The absorption coefficient.
        absorption: Color,
        /// The scattering coefficient.
        scattering: Color,
    },
    /// By its effect.
    Reflectance {
        /// The fraction of the light that has entered which leaves again: the effective albedo, 0 … 1.
        reflectance: Color,
        /// The mean distance that light travels between two events of scattering or absorption.
        mean_free_path: Color,
    },
}

impl SubsurfaceMedium {
    /// Whole milk (Jensen et al. 2001), in mm: what there is where a file does not say, in pbrt-v4 and here.
    pub const MILK: Self = Self::Coefficients {
        absorption: Color::Value([0.0011, 0.0024, 0.014]),
        scattering: Color::Value([2.55, 3.21, 3.77]),
    };

    /// Its colours.
    pub(super) fn colors(&self) -> [Color; 2] {
        match *self {
            Self::Coefficients { absorption, scattering } => [absorption, scattering],
            Self::Reflectance { reflectance, mean_free_path } => [reflectance, mean_free_path],
        }
    }
}
