//! Dielectrics, smooth or rough, and thin dielectrics.
//!
//! Walter et al. 2007; Veach 1997, § 5.2 (why transmitted radiance is scaled by 1/η² and importance is not).

use glam::Vec3;

use super::microfacet::TrowbridgeReitz;
use super::{BsdfSample, Lobes, Mode, fresnel, is_grazing};
use crate::core::math;
use crate::core::spectrum::Spectrum;

/// The boundary of a dielectric whose index of refraction is `eta` times that outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// Inside over outside.
    pub(crate) eta: f32,
    /// Roughness of the surface.
    pub(crate) roughness: TrowbridgeReitz,
}

/// The microfacet that scatters between a pair of directions at a rough boundary.
struct Facet {
    /// Its normal, z > 0.
    wm: Vec3,
    /// Its Fresnel reflectance.
    fresnel: f32,
    /// True if the directions are on one side.
    reflects: bool,
    /// The index beyond the boundary over the one on the side of `wo`; 1 for reflection.
    eta: f32,
}

impl Dielectric {
    /// By the index of refraction inside over outside (0 counts as 1).
    pub fn new(eta: f32, roughness: TrowbridgeReitz) -> Self {
        Self { eta: fresnel::valid_eta(eta), roughness }
    }

    /// True if light leaves in discrete directions only. A boundary between equal indices is specular,
    /// however rough.
    #[inline]
    fn is_specular(&self) -> bool {
        self.eta == 1.0 || self.roughness.is_smooth()
    }

    #[inline]
    pub(super) fn lobes(&self) -> Lobes {
        let sides =
            if self.eta == 1.0 { Lobes::TRANSMISSION } else { Lobes::REFLECTION | Lobes::TRANSMISSION };
        sides | if self.is_specular() { Lobes::SPECULAR } else { Lobes::GLOSSY }
    }

    pub(super) fn regularize(&mut self) {
        self.roughness.regularize();
    }

    /// The microfacet that scatters `wo` to `wi`, or `None` where there is none.
    #[inline]
    fn facet(&self, wo: Vec3, wi: Vec3) -> Option<Facet> {
        if self.is_specular() || is_grazing(wo) || is_grazing(wi) {
            return None;
        }
        let reflects = wo.z * wi.z > 0.0;
        let eta = if reflects { 1.0 } else { fresnel::relative_eta(wo.z, self.eta) };
        let wm = (wi * eta + wo).try_normalize()?;
        let wm = if wm.z < 0.0 { -wm } else { wm };
        // Facets seen from behind do not scatter.
        if wm.dot(wi) * wi.z < 0.0 || wm.dot(wo) * wo.z < 0.0 {
            return None;
        }
        Some(Facet { wm, fresnel: fresnel::dielectric(wo.dot(wm), self.eta), reflects, eta })
    }

    /// `f` for reflection or refraction by the facet.
    #[inline]
    fn facet_f(&self, wo: Vec3, wi: Vec3, facet: &Facet, mode: Mode) -> Spectrum {
        let &Facet { wm, fresnel, reflects, eta } = facet;
        let visible = self.roughness.d(wm) * self.roughness.g(wo, wi) / (wo.z * wi.z).abs();
        let f = if reflects {
            0.25 * visible * fresnel
        } else {
            let transmitted =
                visible * (1.0 - fresnel) * wo.dot(wm).abs() * refraction_jacobian(wo, wi, wm, eta);
            radiance_scale(transmitted, eta, mode)
        };
        Spectrum([f; 4])
    }

    /// Density of `wi` by way of the facet, given the probability of its side.
    #[inline]
    fn facet_pdf(&self, wo: Vec3, wi: Vec3, facet: &Facet, probability: f32) -> f32 {
        let visible = self.roughness.visible_per_cosine(wo, facet.wm);
        let jacobian = if facet.reflects {
            0.25
        } else {
            wo.dot(facet.wm).abs() * refraction_jacobian(wo, wi, facet.wm, facet.eta)
        };
        visible * jacobian * probability
    }

    pub(super) fn f(&self, wo: Vec3, wi: Vec3, mode: Mode) -> Spectrum {
        self.facet(wo, wi).map_or(Spectrum::BLACK, |facet| self.facet_f(wo, wi, &facet, mode))
    }

    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3, lobes: Lobes) -> f32 {
        let Some(facet) = self.facet(wo, wi) else { return 0.0 };
        let [r, t] = lobes.allowed([facet.fresnel, 1.0 - facet.fresnel]);
        if r + t == 0.0 {
            return 0.0;
        }
        let part = if facet.reflects { r } else { t };
        self.facet_pdf(wo, wi, &facet, part / (r + t))
    }

    pub(super) fn sample(
        &self,
        wo: Vec3,
        uc: f32,
        u: [f32; 2],
        mode: Mode,
        lobes: Lobes,
    ) -> Option<BsdfSample> {
        if is_grazing(wo) {
            return None;
        }
        if self.is_specular() {
            return self.sample_smooth(wo, uc, mode, lobes);
        }
        // Sample a visible normal, and then a side by the facet's Fresnel reflectance.
        let wm = self.roughness.sample(wo, u);
        let fresnel = fresnel::dielectric(wo.dot(wm), self.eta);
        let [r, t] = lobes.allowed([fresnel, 1.0 - fresnel]);
        if r + t == 0.0 {
            return None;
        }
        let reflection = r / (r + t);
        let reflects = uc < reflection;
        let (wi, eta) = if reflects {
            (math::reflect(wo, wm), 1.0)
        } else {
            let towards = if wo.dot(wm) < 0.0 { -wm } else { wm };
            let eta = fresnel::relative_eta(wo.dot(wm), self.eta);
            (math::refract(wo, towards, eta)?, eta)
        };
        if is_grazing(wi) || (wo.z * wi.z > 0.0) != reflects {
            return None;
        }
        let facet = Facet { wm, fresnel, reflects, eta };
        let (probability, side) =
            if reflects { (reflection, Lobes::REFLECTION) } else { (1.0 - reflection, Lobes::TRANSMISSION) };
        let f = self.facet_f(wo, wi, &facet, mode);
        let pdf = self.facet_pdf(wo, wi, &facet, probability);
        Some(BsdfSample { eta, ..BsdfSample::new(wi, f, pdf, side | Lobes::GLOSSY) })
    }

    #[inline]
    fn sample_smooth(&self, wo: Vec3, uc: f32, mode: Mode, lobes: Lobes) -> Option<BsdfSample> {
        let fresnel = fresnel::dielectric(wo.z, self.eta);
        let [r, t] = lobes.allowed([fresnel, 1.0 - fresnel]);
        if r + t == 0.0 {
            return None;
        }
        let reflection = r / (r + t);
        if uc < reflection {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            let f = Spectrum([fresnel / wi.z.abs(); 4]);
            return Some(BsdfSample::new(wi, f, reflection, Lobes::REFLECTION | Lobes::SPECULAR));
        }
        let eta = fresnel::relative_eta(wo.z, self.eta);
        let wi = math::refract(wo, Vec3::new(0.0, 0.0, 1.0_f32.copysign(wo.z)), eta)?;
        if is_grazing(wi) {
            return None;
        }
        let f = Spectrum([radiance_scale((1.0 - fresnel) / wi.z.abs(), eta, mode); 4]);
        let lobe = Lobes::TRANSMISSION | Lobes::SPECULAR;
        Some(BsdfSample { eta, ..BsdfSample::new(wi, f, 1.0 - reflection, lobe) })
    }
}

/// `|dω_m / dω_i|` of refraction by a facet; 0 where it has no finite value.
#[inline]
pub(super) fn refraction_jacobian(wo: Vec3, wi: Vec3, wm: Vec3, eta: f32) -> f32 {
    let sum = wi.dot(wm) + wo.dot(wm) / eta;
    let squared = sum * sum;
    if squared > 0.0 { (wi.dot(wm).abs() / squared).min(f32::MAX) } else { 0.0 }
}

/// Scale of transmitted light: radiance is spread over η² times the solid angle on the side of `wo`,
/// importance is not.
#[inline]
pub(super) fn radiance_scale(f: f32, eta: f32, mode: Mode) -> f32 {
    match mode {
        Mode::Radiance => f / (eta * eta),
        Mode::Importance => f,
    }
}

/// A dielectric sheet so thin that light leaves at the point where it entered: all internal reflections
/// are summed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectric {
    /// Index of the sheet over the surrounding one.
    pub(crate) eta: f32,
}

impl ThinDielectric {
    /// By the index of refraction of the sheet over the surrounding one (0 counts as 1).
    pub fn new(eta: f32) -> Self {
        Self { eta: fresnel::valid_eta(eta) }
    }

    #[inline]
    pub(super) fn sample(&self, wo: Vec3, uc: f32, lobes: Lobes) -> Option<BsdfSample> {
        // R + T R T + T R³ T + … = R + T² R / (1 − R²)
        let once = math::fresnel_dielectric(wo.z.abs(), self.eta);
        let fresnel =
            if once < 1.0 { once + (1.0 - once) * (1.0 - once) * once / (1.0 - once * once) } else { once };
        let [r, t] = lobes.allowed([fresnel, 1.0 - fresnel]);
        if r + t == 0.0 {
            return None;
        }
        let reflection = r / (r + t);
        let (wi, part, probability, side) = if uc < reflection {
            (Vec3::new(-wo.x, -wo.y, wo.z), fresnel, reflection, Lobes::REFLECTION)
        } else {
            (-wo, 1.0 - fresnel, 1.0 - reflection, Lobes::TRANSMISSION)
        };
        let f = Spectrum([part / wi.z.abs(); 4]);
        Some(BsdfSample::new(wi, f, probability, side | Lobes::SPECULAR))
    }

    pub(super) fn lobes(&self) -> Lobes {
        Lobes::REFLECTION | Lobes::TRANSMISSION | Lobes::SPECULAR
    }
}
