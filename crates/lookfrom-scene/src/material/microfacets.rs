//! Microfacets: their roughness, the distribution of their normals, and the light between them.

use super::Scalar;

/// Roughness of a microfacet surface, along u and v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// Along u.
    pub u: Scalar,
    /// Along v.
    pub v: Scalar,
    /// Whether the values are user-facing ones in [0, 1], whose square root is α; otherwise they are α.
    pub remap: bool,
    /// The kind of microfacets.
    pub microfacets: Microfacets,
}

impl Roughness {
    /// A perfectly smooth surface.
    pub const SMOOTH: Self = Self {
        u: Scalar::Value(0.0),
        v: Scalar::Value(0.0),
        remap: true,
        microfacets: Microfacets {
            distribution: Distribution::TrowbridgeReitz,
            masking: Masking::Correlated,
        },
    };

    /// By α along u and v, with the usual microfacets.
    pub fn of_alphas(u: Scalar, v: Scalar) -> Self {
        Self { u, v, remap: false, microfacets: Microfacets::default() }
    }
}

/// A kind of microfacets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Microfacets {
    /// The distribution of their normals.
    pub distribution: Distribution,
    /// The part of them that is visible from two directions.
    pub masking: Masking,
}

/// A distribution of microfacet normals, whose width is α.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Distribution {
    /// Trowbridge & Reitz (1975), or GGX (Walter et al. 2007): highlights with long tails.
    #[default]
    TrowbridgeReitz,
    /// Beckmann & Spizzichino (1963): slopes are normally distributed, and α is √2 times their standard deviation.
    Beckmann,
}

/// Smith's masking-shadowing function of two directions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Masking {
    /// Height-correlated masking and shadowing (Heitz 2014, equation 99), as in pbrt-v4.
    #[default]
    Correlated,
    /// The product of the functions of both directions (Walter et al. 2007), as in Mitsuba 3: darker where both are grazing.
    Separable,
}

/// Multiple scattering between the microfacets of a rough surface (Heitz et al. 2016): kept or lost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Energy {
    /// It leaves in the end: a white surface reflects or transmits all light at any roughness.
    #[default]
    Conserved,
    /// It is lost, as in pbrt: scattering is that of single microfacets (Walter et al. 2007; Heitz 2014), and reciprocal.
    SingleScattering,
}
