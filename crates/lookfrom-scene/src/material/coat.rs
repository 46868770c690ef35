//! Coats over a base.

use super::{Color, Ior, Roughness, Scalar};

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
