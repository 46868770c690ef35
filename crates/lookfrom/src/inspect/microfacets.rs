//! Microfacets in reports: D, G and F of each boundary of a BSDF for two directions, and their product.

use serde::Serialize;

use super::report::Factor;
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::MicrofacetFactors;

/// A boundary with microfacets that scatters light between two directions. Its part of the BSDF is, for reflection,
/// `weight · part · D G / (4 |cos_o cos_i|)`, for refraction
/// `weight · part · D G |cos_om cos_im| / (|cos_o cos_i| (cos_im + cos_om / η)² η²)`, and where it is smooth
/// `weight · part / (|cos_i| η²)`, the factor of a delta function; multiple scattering multiplies it by its gain.
#[derive(Clone, Debug, Serialize)]
pub struct MicrofacetReport {
    /// `conductor`, `dielectric`, `thin dielectric` or `coat`; of glTF's layers `specular`, `glass` or `clear coat`.
    pub boundary: &'static str,
    /// Whether the facets refract light; otherwise they reflect it (a thin sheet also to its other side).
    pub refracts: bool,
    /// α along u and v.
    pub alpha: [f32; 2],
    /// ω_m: the normal of the facets, unit length; of a reflection the half vector.
    pub half_vector: [f32; 3],
    /// The absolute cosine of the direction to the viewer, and the boundary's normal.
    pub cos_o: f32,
    /// The absolute cosine of the direction to the light, and the normal.
    pub cos_i: f32,
    /// The cosine of the direction to the viewer, and ω_m.
    pub cos_om: f32,
    /// The cosine of the direction to the light, and ω_m.
    pub cos_im: f32,
    /// D(ω_m): the density of facets with that normal; `None` where the boundary is smooth.
    pub d: Option<f32>,
    /// G: Smith's masking and shadowing; `None` where it is smooth.
    pub g: Option<f32>,
    /// F: the Fresnel reflectance of the facets.
    pub fresnel: Factor,
    /// The share of light that the facets send this way: F where they reflect it, else 1 − F; tinted by the layers above and the body, if
    /// it passes them.
    pub part: Factor,
    /// η: the index of refraction on the side of the light over that on the side of the viewer where light is
    /// refracted; else 1.
    pub eta: f32,
    /// The weight of the boundary, below the layers above it.
    pub weight: f32,
    /// What light between the facets of a conductor adds; `None` where it is lost or there is none.
    pub multiple_scattering: Option<MultipleScatteringReport>,
    /// The boundary's part of the BSDF: the product.
    pub value: Factor,
}

/// Light that one facet of a conductor sends to another, over that of single scattering:
/// `gain = 1 + F̄ Ē / (1 − F̄ (1 − Ē)) · (1 − E) / E`.
#[derive(Clone, Debug, Serialize)]
pub struct MultipleScatteringReport {
    /// E(ω_o): the albedo of single scattering by facets that reflect all light.
    pub albedo: f32,
    /// Ē: its mean over all directions.
    pub mean_albedo: f32,
    /// F̄: the mean Fresnel reflectance.
    pub mean_fresnel: Factor,
    /// All light over that of single scattering.
    pub gain: Factor,
}

impl MicrofacetReport {
    /// Of factors with ω_m in the world; `factor` keeps the lanes that are in use.
    pub(super) fn new(factors: &MicrofacetFactors, factor: impl Fn(Spectrum) -> Factor) -> Self {
        let value = factor(factors.value());
        let &MicrofacetFactors {
            boundary,
            refracts,
            roughness,
            wm,
            d,
            g,
            fresnel,
            part,
            eta,
            weight,
            multiple_scattering,
            ..
        } = factors;
        let ([cos_o, cos_i], [cos_om, cos_im]) = (factors.cos, factors.cos_m);
        Self {
            boundary,
            refracts,
            alpha: [roughness.alpha_x, roughness.alpha_y],
            half_vector: wm.to_array(),
            cos_o,
            cos_i,
            cos_om,
            cos_im,
            d,
            g,
            fresnel: factor(fresnel),
            part: factor(part),
            eta,
            weight,
            multiple_scattering: multiple_scattering.map(|more| MultipleScatteringReport {
                albedo: more.albedo,
                mean_albedo: more.mean_albedo,
                mean_fresnel: factor(more.mean_fresnel),
                gain: factor(more.gain()),
            }),
            value,
        }
    }
}
