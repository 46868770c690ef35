//! The factors D, G and F of microfacet BSDFs for two directions, as the inspector shows them.
//!
//! They are what [`Bsdf::f`](super::Bsdf::f) multiplies, one set for each boundary with microfacets. Diffuse lobes, sheen, and what
//! is scattered between the layers of a coat have no such factors.
//!
//! Cook & Torrance 1982 (reflection); Walter et al. 2007 (refraction).

use glam::Vec3;

use super::conductor::{Conductor, MultipleScattering, try_half_vector};
use super::dielectric::Dielectric;
use super::microfacet::{Microfacets, TrowbridgeReitz};
use super::plastic::Plastic;
use super::thin_dielectric::ThinDielectric;
use super::{fresnel, is_grazing, same_side};
use crate::core::spectrum::Spectrum;

/// The factors of one boundary that scatters light from `wi` to `wo` by its microfacets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MicrofacetFactors {
    /// The boundary: `conductor`, `dielectric`, `thin dielectric` (both of its sides together), `coat`; of glTF's layers
    /// `specular`, `glass`, `clear coat`.
    pub boundary: &'static str,
    /// Whether the facets refract light; otherwise they reflect it (a thin sheet also to its other side).
    pub refracts: bool,
    /// α.
    pub roughness: TrowbridgeReitz,
    /// ω_m: the normal of the facets, unit length; the half vector of a reflection.
    pub wm: Vec3,
    /// Absolute cosines of ω_o and ω_i to the normal.
    pub cos: [f32; 2],
    /// Cosines of ω_o and ω_i to ω_m.
    pub cos_m: [f32; 2],
    /// D(ω_m); `None` where the boundary is smooth.
    pub d: Option<f32>,
    /// G(ω_o, ω_i), or only G₁(ω_o) where light that leaves a facet is never shadowed; `None` where it is smooth.
    pub g: Option<f32>,
    /// F: the Fresnel reflectance of the facets; where the boundary is a mix, that of its parts by their weights.
    pub fresnel: Spectrum,
    /// The share of light that the facets send this way: F where they reflect it, else 1 − F; tinted by the layers above and the body, if
    /// it passes them.
    pub part: Spectrum,
    /// The index of refraction on the side of `wi` over the one on the side of `wo`, where light is refracted; else 1.
    pub eta: f32,
    /// The weight of the boundary, below the layers above it.
    pub weight: f32,
    /// The light that facets of a conductor send to one another.
    pub multiple_scattering: Option<MultipleScattering>,
}

impl MicrofacetFactors {
    /// Factors of a boundary of its own, by facets with the normal `wm`, or of a smooth one: with D, G and cosines, and with a
    /// reflectance of 0.
    fn of_boundary(
        boundary: &'static str,
        microfacets: Microfacets,
        is_smooth: bool,
        [wo, wi, wm]: [Vec3; 3],
    ) -> Self {
        Self {
            boundary,
            refracts: false,
            roughness: microfacets.alpha,
            wm,
            cos: [wo.z.abs(), wi.z.abs()],
            cos_m: [wo.dot(wm), wi.dot(wm)],
            d: (!is_smooth).then(|| microfacets.d(wm.into())),
            g: (!is_smooth).then(|| microfacets.g(wo.into(), wi.into())),
            fresnel: Spectrum::BLACK,
            part: Spectrum::BLACK,
            eta: 1.0,
            weight: 1.0,
            multiple_scattering: None,
        }
    }

    /// Its part of the BSDF, by their formula: `weight · part · D G / (4 |cos_o cos_i|)` for reflection, and
    /// `weight · part · D G |cos_om cos_im| / (|cos_o cos_i| (cos_im + cos_om / η)² η²)` for refraction. Where the boundary
    /// is smooth, the factor of a delta function: `weight · part / (|cos_i| η²)`. Multiple scattering multiplies it by its gain.
    pub fn value(&self) -> Spectrum {
        let &Self { cos: [cos_o, cos_i], cos_m: [cos_om, cos_im], eta, part, weight, .. } = self;
        let (Some(d), Some(g)) = (self.d, self.g) else {
            return part * (weight / (cos_i * eta * eta));
        };
        let sum = cos_im + cos_om / eta;
        let jacobian = match self.refracts {
            true => (cos_om * cos_im).abs() / (sum * sum * eta * eta),
            false => 0.25,
        };
        let once = part * (weight * d * g * jacobian / (cos_o * cos_i));
        self.multiple_scattering.map_or(once, |more| once * more.gain())
    }
}

impl ThinDielectric {
    pub(super) fn factors(&self, wo: Vec3, wi: Vec3, is_specular: bool) -> Option<MicrofacetFactors> {
        if !is_specular {
            return None;
        }
        let smooth = MicrofacetFactors::of_boundary(
            "thin dielectric",
            TrowbridgeReitz::SMOOTH.into(),
            true,
            [wo, wi, Vec3::Z],
        );
        let fresnel = self.reflectance(wo.z);
        let part = match same_side::<f32>(wo, wi) {
            true => self.tint.reflectance * fresnel,
            false => self.transmittance(wo.z),
        };
        Some(MicrofacetFactors { fresnel: Spectrum([fresnel; 4]), part, ..smooth })
    }
}

impl Conductor {
    pub(super) fn factors(&self, wo: Vec3, wi: Vec3, is_specular: bool) -> Option<MicrofacetFactors> {
        let is_smooth = self.roughness.is_smooth();
        if !same_side(wo, wi) || is_smooth != is_specular {
            return None;
        }
        let wm = if is_smooth { Vec3::Z } else { try_half_vector(wo, wi)? };
        let plain = MicrofacetFactors::of_boundary("conductor", self.roughness, is_smooth, [wo, wi, wm]);
        let cos = plain.cos_m[0].abs();
        let (fresnel, part) = (fresnel::conductor(cos, self.eta, self.k), self.reflectance(cos));
        let multiple_scattering =
            (self.conserves > 0.0 && !is_smooth).then(|| self.multiple_scattering(wo.into()));
        Some(MicrofacetFactors { fresnel, part, multiple_scattering, ..plain })
    }
}

impl Plastic {
    pub(super) fn factors(&self, wo: Vec3, wi: Vec3, is_specular: bool) -> Option<MicrofacetFactors> {
        let is_smooth = self.microfacets.is_smooth();
        if !same_side(wo, wi) || is_smooth != is_specular {
            return None;
        }
        let up = if wo.z < 0.0 { -1.0 } else { 1.0 };
        let wm = if is_smooth { Vec3::Z } else { try_half_vector(up * wo, up * wi)? };
        let plain =
            MicrofacetFactors::of_boundary("coat", self.microfacets, is_smooth, [up * wo, up * wi, wm]);
        let fresnel = fresnel::dielectric(plain.cos_m[0], self.eta);
        Some(MicrofacetFactors {
            wm: up * wm,
            fresnel: Spectrum([fresnel; 4]),
            part: self.specular * fresnel,
            ..plain
        })
    }
}

impl Dielectric {
    /// As the outside of a coat, by the facets that reflect light.
    pub(super) fn factors_of_coat(&self, wo: Vec3, wi: Vec3) -> Vec<MicrofacetFactors> {
        let up = |w: Vec3| if wo.z < 0.0 { -w } else { w };
        let mut factors = self.factors_of("coat", up(wo), up(wi), false);
        factors.retain(|factors| !factors.refracts);
        factors.into_iter().map(|factors| MicrofacetFactors { wm: up(factors.wm), ..factors }).collect()
    }

    /// By its facet, and by the one to the wrong side.
    pub(super) fn factors_of(
        &self,
        boundary: &'static str,
        wo: Vec3,
        wi: Vec3,
        is_specular: bool,
    ) -> Vec<MicrofacetFactors> {
        if is_grazing(wo) || is_grazing(wi) || self.is_specular() != is_specular {
            return Vec::new();
        }
        let reflects = wo.z * wi.z > 0.0;
        let eta = if reflects { 1.0 } else { fresnel::relative_eta(wo.z, self.eta) };
        let of_facet = |wm: Vec3, to: Vec3| {
            let plain = MicrofacetFactors::of_boundary(boundary, self.roughness, is_specular, [wo, to, wm]);
            let fresnel = fresnel::dielectric(plain.cos_m[0], self.eta);
            MicrofacetFactors {
                refracts: !reflects,
                fresnel: Spectrum([fresnel; 4]),
                part: Spectrum([if reflects { fresnel } else { 1.0 - fresnel }; 4]),
                eta,
                g: match self.conserves() {
                    true => plain.g.map(|_| self.roughness.g1(wo.into())),
                    false => plain.g,
                },
                ..plain
            }
        };
        if is_specular {
            return vec![of_facet(Vec3::Z, wi)];
        }
        self.facets(wo.into(), wi.into())
            .into_iter()
            .zip([wi, Vec3::new(wi.x, wi.y, -wi.z)])
            .filter(|(facet, _)| facet.exists)
            .map(|(facet, to)| of_facet(facet.wm.into(), to))
            .collect()
    }
}
