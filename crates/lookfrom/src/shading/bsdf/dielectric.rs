//! Dielectrics, smooth or rough, and thin dielectrics.
//!
//! Walter et al. 2007; Veach 1997, § 5.2 (why transmitted radiance is scaled by 1/η² and importance is not).

use glam::Vec3;
use lookfrom_simd::{Float, Mask, Real};

use super::microfacet::TrowbridgeReitz;
use super::{BsdfSample, DirectionSample, Lobes, Mode, fresnel, is_grazing};
use crate::core::optics;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// A dielectric boundary; `eta` is the index of refraction inside divided by the one outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric<R = f32> {
    /// Inside over outside.
    pub(crate) eta: R,
    /// Roughness of the boundary.
    pub(crate) roughness: TrowbridgeReitz<R>,
}

/// A microfacet that scatters light between two directions.
#[derive(Clone, Copy)]
pub(super) struct Facet<R: Real> {
    /// Its normal, z ≥ 0.
    pub(super) wm: Vector<R>,
    /// Its Fresnel reflectance.
    fresnel: R,
    /// True for reflection, false for refraction.
    reflects: R::Mask,
    /// The index of refraction on the side of `wi` over the one on the side of `wo`.
    eta: R,
}

impl Dielectric {
    /// By its relative index and its roughness. Index 0 and NaN count as 1, as in pbrt.
    pub fn new(eta: f32, roughness: TrowbridgeReitz) -> Self {
        Self { eta: fresnel::valid_eta(eta), roughness }
    }

    /// The kinds of scattering. With equal indices nothing is reflected or refracted.
    #[inline]
    pub(super) fn lobes(&self) -> Lobes {
        let sides =
            if self.eta == 1.0 { Lobes::TRANSMISSION } else { Lobes::REFLECTION | Lobes::TRANSMISSION };
        sides | if self.is_specular() { Lobes::SPECULAR } else { Lobes::GLOSSY }
    }
}

impl<R: Real> Dielectric<R> {
    /// True if it only reflects and refracts in single directions.
    #[inline(always)]
    pub(super) fn is_specular(&self) -> R::Mask {
        Float::eq(self.eta, self.eta.like(1.0)) | self.roughness.is_smooth()
    }

    /// The facet that scatters light between two directions, and whether there is one.
    #[inline(always)]
    pub(super) fn facet(&self, wo: Vector<R>, wi: Vector<R>) -> (Facet<R>, R::Mask) {
        let (zero, one) = (self.eta.like(0.0), self.eta.like(1.0));
        let reflects = (wo.z * wi.z).gt(zero);
        let eta = R::select(reflects, one, fresnel::relative_eta(wo.z, self.eta));
        let (wm, exists) = (wi * eta + wo).try_normalize();
        let wm = wm.negate_where(wm.z.lt(zero));
        // The backs of facets do not scatter.
        let is_back = (wm.dot(wi) * wi.z).lt(zero) | (wm.dot(wo) * wo.z).lt(zero);
        let is_usable = exists & !is_back & !self.is_specular() & !is_grazing(wo) & !is_grazing(wi);
        (Facet { wm, fresnel: fresnel::dielectric(wo.dot(wm), self.eta), reflects, eta }, is_usable)
    }

    /// `f` by a facet, in each lane of a spectrum.
    #[inline(always)]
    fn facet_f(&self, wo: Vector<R>, wi: Vector<R>, facet: &Facet<R>, mode: Mode) -> R {
        let &Facet { wm, fresnel, reflects, eta } = facet;
        let visible = self.roughness.d(wm) * self.roughness.g(wo, wi) / Float::abs(wo.z * wi.z);
        let reflected = visible * 0.25 * fresnel;
        if reflects.all() {
            return reflected;
        }
        let jacobian = refraction_jacobian(wo, wi, wm, eta);
        let transmitted = visible * (fresnel.like(1.0) - fresnel) * Float::abs(wo.dot(wm)) * jacobian;
        R::select(reflects, reflected, radiance_scale(transmitted, eta, mode))
    }

    /// The density of `wi` by a facet whose side is chosen with a probability.
    #[inline(always)]
    fn facet_pdf(&self, wo: Vector<R>, wi: Vector<R>, facet: &Facet<R>, probability: R) -> R {
        let &Facet { wm, reflects, eta, .. } = facet;
        let visible = self.roughness.visible_per_cosine(wo, wm);
        let refraction = Float::abs(wo.dot(wm)) * refraction_jacobian(wo, wi, wm, eta);
        visible * R::select(reflects, eta.like(0.25), refraction) * probability
    }

    /// As [`super::Bsdf::f`].
    #[inline(always)]
    pub(super) fn f(&self, wo: Vector<R>, wi: Vector<R>, mode: Mode) -> Spectrum<R> {
        let (facet, is_usable) = self.facet(wo, wi);
        let zero = wo.z.like(0.0);
        if !is_usable.any() {
            return Spectrum::splat(zero);
        }
        Spectrum::splat(R::select(is_usable, self.facet_f(wo, wi, &facet, mode), zero))
    }

    /// As [`super::Bsdf::pdf`].
    #[inline(always)]
    pub(super) fn pdf(&self, wo: Vector<R>, wi: Vector<R>, lobes: Lobes) -> R {
        let (facet, is_usable) = self.facet(wo, wi);
        let (zero, one) = (wo.z.like(0.0), wo.z.like(1.0));
        if !is_usable.any() {
            return zero;
        }
        let [r, t] = lobes.allowed([facet.fresnel, one - facet.fresnel]);
        let part = R::select(facet.reflects, r, t);
        let pdf = self.facet_pdf(wo, wi, &facet, part / (r + t));
        R::select(is_usable & (r + t).gt(zero), pdf, zero)
    }

    /// As [`super::Bsdf::sample`].
    #[inline(always)]
    pub(super) fn sample(
        &self,
        wo: Vector<R>,
        uc: R,
        u: [R; 2],
        mode: Mode,
        lobes: Lobes,
    ) -> DirectionSample<R> {
        let is_specular = self.is_specular();
        if is_specular.all() {
            self.sample_smooth(wo, uc, mode, lobes)
        } else if is_specular.any() {
            let smooth = self.sample_smooth(wo, uc, mode, lobes);
            DirectionSample::select(is_specular, smooth, self.sample_rough(wo, uc, u, mode, lobes))
        } else {
            self.sample_rough(wo, uc, u, mode, lobes)
        }
    }

    #[inline(always)]
    fn sample_rough(&self, wo: Vector<R>, uc: R, u: [R; 2], mode: Mode, lobes: Lobes) -> DirectionSample<R> {
        let (zero, one) = (uc.like(0.0), uc.like(1.0));
        // Choose a visible facet, and then a side by its reflectance.
        let wm = self.roughness.sample(wo, u);
        let cos = wo.dot(wm);
        let fresnel = fresnel::dielectric(cos, self.eta);
        let [r, t] = lobes.allowed([fresnel, one - fresnel]);
        let reflection = r / (r + t);
        let reflects = uc.lt(reflection);
        let eta = fresnel::relative_eta(cos, self.eta);
        let (refracted, is_refracted) = optics::refract(wo, wm.negate_where(cos.lt(zero)), eta);
        let wi = Vector::select(reflects, optics::reflect(wo, wm), refracted);
        let eta = R::select(reflects, one, eta);
        let stays = (wo.z * wi.z).gt(zero);
        let is_on_side = (stays & reflects) | (!stays & !reflects & is_refracted);
        let is_valid = is_on_side & (r + t).gt(zero) & !is_grazing(wo) & !is_grazing(wi);
        let facet = Facet { wm, fresnel, reflects, eta };
        let probability = R::select(reflects, reflection, one - reflection);
        DirectionSample {
            wi,
            f: Spectrum::splat(self.facet_f(wo, wi, &facet, mode)),
            pdf: self.facet_pdf(wo, wi, &facet, probability),
            eta,
            is_specular: reflects.like(false),
            is_diffuse: reflects.like(false),
            is_transmission: !reflects,
            is_valid,
        }
    }

    #[inline(always)]
    fn sample_smooth(&self, wo: Vector<R>, uc: R, mode: Mode, lobes: Lobes) -> DirectionSample<R> {
        let (zero, one) = (uc.like(0.0), uc.like(1.0));
        let fresnel = fresnel::dielectric(wo.z, self.eta);
        let [r, t] = lobes.allowed([fresnel, one - fresnel]);
        let reflection = r / (r + t);
        let reflects = uc.lt(reflection);
        let eta = fresnel::relative_eta(wo.z, self.eta);
        let normal = Vector { x: zero, y: zero, z: Float::copysign(one, wo.z) };
        let (refracted, is_refracted) = optics::refract(wo, normal, eta);
        let wi = Vector::select(reflects, Vector { x: -wo.x, y: -wo.y, z: wo.z }, refracted);
        let cos = Float::abs(wi.z);
        let f = R::select(reflects, fresnel / cos, radiance_scale((one - fresnel) / cos, eta, mode));
        DirectionSample {
            wi,
            f: Spectrum::splat(f),
            pdf: R::select(reflects, reflection, one - reflection),
            eta: R::select(reflects, one, eta),
            is_specular: reflects.like(true),
            is_diffuse: reflects.like(false),
            is_transmission: !reflects,
            is_valid: (reflects | (is_refracted & !is_grazing(wi))) & (r + t).gt(zero) & !is_grazing(wo),
        }
    }
}

/// Solid angle of half vectors over solid angle of refracted directions, divided by `|wo·wm|`; 0 where it is
/// undefined.
#[inline(always)]
pub(super) fn refraction_jacobian<R: Real>(wo: Vector<R>, wi: Vector<R>, wm: Vector<R>, eta: R) -> R {
    let zero = eta.like(0.0);
    let sum = wi.dot(wm) + wo.dot(wm) / eta;
    let squared = sum * sum;
    let jacobian = Float::min(Float::abs(wi.dot(wm)) / squared, eta.like(f32::MAX));
    R::select(squared.gt(zero), jacobian, zero)
}

/// Radiance is scaled by 1/η² on refraction.
#[inline(always)]
pub(super) fn radiance_scale<R: Real>(f: R, eta: R, mode: Mode) -> R {
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

    /// Reflectance of both interfaces with all reflections between them: R + T R T + T R³ T + … = R + T² R / (1 − R²), as in
    /// pbrt-v4.
    #[inline]
    pub(super) fn reflectance(&self, wo: Vec3) -> f32 {
        let once = optics::fresnel_dielectric(wo.z.abs(), self.eta);
        if once < 1.0 { once + (1.0 - once) * (1.0 - once) * once / (1.0 - once * once) } else { once }
    }

    #[inline]
    pub(super) fn sample(&self, wo: Vec3, uc: f32, lobes: Lobes) -> Option<BsdfSample> {
        let fresnel = self.reflectance(wo);
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
