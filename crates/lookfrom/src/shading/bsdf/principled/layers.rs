//! Sheen and clear coat over a principled surface, for one outgoing direction.

use glam::Vec3;

use super::Principled;
use super::albedo;
use super::sheen::Sheen;
use crate::core::math::{self, schlick};
use crate::core::spectrum::Spectrum;
use crate::core::warp;
use crate::shading::bsdf::conductor::try_half_vector;
use crate::shading::bsdf::is_grazing;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;

/// Reflectance of the coat, of index 1.5, at normal incidence.
const COAT_F0: f32 = 0.04;

/// The sheen on top of all layers.
pub(super) struct Fibres {
    pub(super) fibres: Sheen,
    pub(super) color: Spectrum,
    pub(super) greatest: f32,
    pub(super) roughness: f32,
    /// Its albedo along `wo`, which attenuates the layers below.
    pub(super) taken: f32,
}

impl Fibres {
    pub(super) fn new(look: &Principled, cos: f32) -> Option<Self> {
        if look.sheen_color.is_black() {
            return None;
        }
        let roughness = look.sheen_roughness.value();
        let mut fibres = Self {
            fibres: Sheen::new(roughness),
            color: look.sheen_color.lanes(),
            greatest: look.sheen_greatest.value(),
            roughness,
            taken: 0.0,
        };
        fibres.taken = fibres.taken(cos);
        Some(fibres)
    }

    pub(super) fn albedo(&self, cos: f32) -> f32 {
        albedo::sheen(cos, self.roughness)
    }

    pub(super) fn taken(&self, cos: f32) -> f32 {
        (self.greatest * self.albedo(cos)).min(1.0)
    }

    pub(super) fn f(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.fibres.f(wo, wi)
    }
}

/// A clear coat.
pub(super) struct Coat {
    pub(super) amount: f32,
    pub(super) roughness: TrowbridgeReitz,
    pub(super) alpha: f32,
    /// The axes of the coat's frame; the last is its normal.
    pub(super) frame: [Vec3; 3],
    /// ω_o in this frame.
    pub(super) wo: Vec3,
    /// Its albedo along `wo`, which attenuates the layers below.
    pub(super) taken: f32,
}

impl Coat {
    pub(super) fn new(look: &Principled, wo: Vec3) -> Option<Self> {
        let amount = look.coat.value();
        if amount == 0.0 {
            return None;
        }
        let roughness = TrowbridgeReitz { alpha_x: look.coat_alpha, alpha_y: look.coat_alpha };
        let n = look.parameters().clearcoat_normal;
        let (s, t) = warp::orthonormal_basis(n);
        let alpha = if roughness.is_smooth() { 0.0 } else { look.coat_alpha.min(1.0) };
        let mut coat = Self { amount, roughness, alpha, frame: [s, t, n], wo, taken: 0.0 };
        coat.wo = coat.local(wo);
        coat.taken = coat.taken(coat.wo.z);
        Some(coat)
    }

    pub(super) fn local(&self, w: Vec3) -> Vec3 {
        Vec3::from_array(self.frame.map(|axis| w.dot(axis)))
    }

    /// Its albedo for light of the given cosine to its normal; 0 from behind.
    pub(super) fn taken(&self, cos: f32) -> f32 {
        if cos > 0.0 { self.amount * albedo::mirror(cos.min(1.0), self.alpha).of(COAT_F0, 1.0) } else { 0.0 }
    }

    /// `wi` in its frame and the half vector, where both directions are above it.
    pub(super) fn facet(&self, wi: Vec3) -> Option<(Vec3, Vec3)> {
        let wi = self.local(wi);
        if self.alpha == 0.0 || self.wo.z <= 0.0 || wi.z <= 0.0 || is_grazing(self.wo) || is_grazing(wi) {
            return None;
        }
        Some((wi, try_half_vector(self.wo, wi)?))
    }

    /// Its BSDF per cosine to the normal of the surface below.
    pub(super) fn f(&self, wi: Vec3) -> f32 {
        let Some((local, wm)) = self.facet(wi) else { return 0.0 };
        let fresnel = COAT_F0 + (1.0 - COAT_F0) * schlick(self.wo.dot(wm));
        let visible = self.roughness.d(wm.into()) * self.roughness.g(self.wo.into(), local.into());
        self.amount * fresnel * visible / (4.0 * self.wo.z * wi.z)
    }

    pub(super) fn pdf(&self, wi: Vec3) -> f32 {
        self.facet(wi)
            .map_or(0.0, |(_, wm)| 0.25 * self.roughness.visible_per_cosine(self.wo.into(), wm.into()))
    }

    /// Samples a direction above the coat and above the surface.
    pub(super) fn sample(&self, u: [f32; 2]) -> Option<Vec3> {
        if self.wo.z <= 0.0 || is_grazing(self.wo) {
            return None;
        }
        let wm = if self.alpha == 0.0 { Vec3::Z } else { self.roughness.sample(self.wo.into(), u).into() };
        let local = math::reflect(self.wo, wm);
        let [s, t, n] = self.frame;
        let wi = (local.x * s + local.y * t + local.z * n).normalize();
        (local.z > 0.0 && wi.z > 0.0 && !is_grazing(wi)).then_some(wi)
    }
}
