//! Plastic: a diffuse base under a dielectric surface, as Mitsuba 3 has it.

use super::{Color, Microfacets};

/// A diffuse base of albedo ρ under a dielectric surface. The surface reflects light by its microfacets; what it transmits is
/// scattered by the base and reflected back by the surface from below, any number of times: `T(ω_i) T(ω_o) / η² · ρ / (π (1 − r ρ))`,
/// where T is what gets through the surface along a direction and r the part of diffuse light that comes back to the base.
///
/// `plastic` and `roughplastic` of Mitsuba 3 (Jakob et al. 2022).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic {
    /// ρ, the albedo of the base.
    pub reflectance: Color,
    /// Multiplies what the surface reflects outside; 1 in nature.
    pub specular_reflectance: Color,
    /// Index of refraction η, inside over outside: > 0.
    pub eta: f32,
    /// α of the surface, the same in all directions: ≥ 0, and 0 is smooth.
    pub alpha: f32,
    /// The kind of microfacets.
    pub microfacets: Microfacets,
    /// Whether light is coloured each time it comes back to the base; otherwise it is once, and the series is
    /// `ρ / (π (1 − r))`.
    pub is_nonlinear: bool,
}

impl Plastic {
    /// Index of refraction where a file does not set one: that of common glass, as for other surfaces.
    pub const ETA: f32 = super::Ior::GLASS;
}
