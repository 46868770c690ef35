//! Boundaries of dielectrics, smooth or rough.
//!
//! Light that one facet sends to another is lost, as in pbrt; or facets do not shadow what leaves them, and light that would
//! leave to the wrong side leaves mirrored at the surface, so that all of it leaves (`docs/decisions/0017`; then `f` is not
//! reciprocal).
//!
//! Walter et al. 2007; Veach 1997, § 5.2 (why transmitted radiance is scaled by 1/η² and importance is not).

use glam::Vec3;
use lookfrom_scene::material::Energy;
use lookfrom_simd::{Float, Mask, Real};

use super::microfacet::Microfacets;
use super::{
    Description, DirectionSample, Lobes, MicrofacetFactors, ScatteringFunction, across, fresnel, is_grazing,
};
use crate::core::optics;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// A dielectric boundary; `eta` is the index of refraction inside divided by the one outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric<R = f32> {
    /// Inside over outside.
    pub(crate) eta: R,
    /// Roughness of the boundary.
    pub(crate) roughness: Microfacets<R>,
    /// 1 for [`Energy::Conserved`], 0 for [`Energy::SingleScattering`].
    pub(crate) conserves: R,
}

/// A microfacet that scatters light between two directions.
#[derive(Clone, Copy)]
pub(super) struct Facet<R: Real> {
    /// Its normal, z ≥ 0.
    pub(super) wm: Vector<R>,
    /// Its Fresnel reflectance.
    pub(super) fresnel: R,
    /// True for reflection, false for refraction.
    pub(super) reflects: R::Mask,
    /// The index of refraction on the side of `wi` over the one on the side of `wo`.
    pub(super) eta: R,
    /// Whether there is one.
    pub(super) exists: R::Mask,
}

impl Dielectric {
    /// By its relative index and its roughness, with single scattering. Index 0 and NaN count as 1, as in pbrt.
    pub fn new(eta: f32, roughness: impl Into<Microfacets>) -> Self {
        Self { eta: fresnel::valid_eta(eta), roughness: roughness.into(), conserves: 0.0 }
    }

    /// This boundary with the light between its facets or without it.
    #[must_use]
    pub fn with_energy(self, energy: Energy) -> Self {
        Self { conserves: f32::from(energy == Energy::Conserved), ..self }
    }
}

impl ScatteringFunction for Dielectric {
    /// With equal indices nothing is reflected or refracted.
    fn lobes(&self) -> Lobes {
        let sides =
            if self.eta == 1.0 { Lobes::TRANSMISSION } else { Lobes::REFLECTION | Lobes::TRANSMISSION };
        sides | if self.is_specular() { Lobes::SPECULAR } else { Lobes::GLOSSY }
    }

    fn regularize(&mut self) {
        self.roughness.regularize();
    }

    fn factors(&self, wo: Vec3, wi: Vec3, is_specular: bool) -> Vec<MicrofacetFactors> {
        self.factors_of("dielectric", wo, wi, is_specular)
    }

    fn description(&self) -> Description {
        Description {
            kind: "dielectric",
            does: match (self.roughness.is_smooth(), self.roughness.is_beckmann()) {
                (true, _) => "smooth glass: reflects and refracts, in the ratio of Fresnel's equations",
                (false, false) => "rough glass: microfacets of roughness alpha that reflect and refract",
                (false, true) => {
                    "rough glass: Beckmann's microfacets of roughness alpha that reflect and refract"
                }
            },
            numbers: vec![("eta", self.eta.into()), ("alpha", self.roughness.into())],
        }
    }
}

impl<R: Real> Dielectric<R> {
    /// True if it only reflects and refracts in single directions.
    #[inline(always)]
    pub(super) fn is_specular(&self) -> R::Mask {
        Float::eq(self.eta, self.eta.like(1.0)) | self.roughness.is_smooth()
    }

    /// The facet that scatters light between two directions, and the one that sends it to the wrong side, from where it leaves
    /// along `wi`, where energy is conserved.
    #[inline(always)]
    pub(super) fn facets(&self, wo: Vector<R>, wi: Vector<R>) -> [Facet<R>; 2] {
        let reflects = (wo.z * wi.z).gt(wo.z.like(0.0));
        let first = self.facet_to(wo, wi, reflects);
        let conserves = self.conserves();
        if !conserves.any() {
            return [first, Facet { exists: conserves, ..first }];
        }
        let wrong = self.facet_to(wo, across(wi), reflects);
        [first, Facet { exists: wrong.exists & conserves, ..wrong }]
    }

    /// The facet that reflects or refracts light between two directions.
    #[inline(always)]
    fn facet_to(&self, wo: Vector<R>, wi: Vector<R>, reflects: R::Mask) -> Facet<R> {
        let (zero, one) = (self.eta.like(0.0), self.eta.like(1.0));
        let eta = R::select(reflects, one, fresnel::relative_eta(wo.z, self.eta));
        let (wm, is_defined) = (wi * eta + wo).try_normalize();
        let wm = wm.negate_where(wm.z.lt(zero));
        let (cos_o, cos_i) = (wo.dot(wm), wi.dot(wm));
        // The backs of facets do not scatter.
        let is_back =
            (cos_o * wo.z).lt(zero) | reflects.choose((cos_i * cos_o).lt(zero), (cos_i * cos_o).gt(zero));
        let exists = is_defined & !is_back & !self.is_specular() & !is_grazing(wo) & !is_grazing(wi);
        Facet { wm, fresnel: fresnel::dielectric(cos_o, self.eta), reflects, eta, exists }
    }

    /// True where all light leaves.
    #[inline(always)]
    pub(super) fn conserves(&self) -> R::Mask {
        self.conserves.gt(self.conserves.like(0.0))
    }

    /// `f` by a facet, in each lane of a spectrum; `seen` is D G.
    #[inline(always)]
    fn facet_f([wo, wi]: [Vector<R>; 2], facet: &Facet<R>, seen: R, mode: Mode) -> R {
        let &Facet { wm, fresnel, reflects, eta, .. } = facet;
        let visible = seen / Float::abs(wo.z * wi.z);
        let reflected = visible * 0.25 * fresnel;
        if reflects.all() {
            return reflected;
        }
        let jacobian = refraction_jacobian(wo, wi, wm, eta);
        let transmitted = visible * (fresnel.like(1.0) - fresnel) * Float::abs(wo.dot(wm)) * jacobian;
        R::select(reflects, reflected, radiance_scale(transmitted, eta, mode))
    }

    /// The density of `wi` by a facet whose side is chosen with a probability; `seen` is D G₁.
    #[inline(always)]
    fn facet_pdf([wo, wi]: [Vector<R>; 2], facet: &Facet<R>, seen: R, probability: R) -> R {
        let &Facet { wm, reflects, eta, .. } = facet;
        let visible = seen / Float::abs(wo.z);
        let refraction = Float::abs(wo.dot(wm)) * refraction_jacobian(wo, wi, wm, eta);
        visible * R::select(reflects, eta.like(0.25), refraction) * probability
    }

    /// As [`Self::facet_pdf`].
    #[inline(always)]
    fn facet_density(&self, [wo, wi]: [Vector<R>; 2], facet: &Facet<R>, probability: R) -> R {
        let seen = self.roughness.d(facet.wm) * self.roughness.g1(wo);
        Self::facet_pdf([wo, wi], facet, seen, probability)
    }

    /// As [`super::Bsdf::f`].
    #[inline(always)]
    pub(super) fn f(&self, wo: Vector<R>, wi: Vector<R>, mode: Mode) -> Spectrum<R> {
        let (zero, conserves) = (wo.z.like(0.0), self.conserves());
        let facets = self.facets(wo, wi);
        let [facet, _] = &facets;
        let mut f = zero;
        if facet.exists.any() {
            let seen = self.roughness.d(facet.wm) * self.roughness.g(wo, wi);
            f = R::select(facet.exists, Self::facet_f([wo, wi], facet, seen, mode), zero);
        }
        if conserves.any() {
            f = R::select(conserves, self.unmasked_f(wo, wi, &facets, mode), f);
        }
        Spectrum::splat(f)
    }

    /// `f` by a facet and by the one to the wrong side, all of whose light leaves.
    #[inline(always)]
    fn unmasked_f(&self, wo: Vector<R>, wi: Vector<R>, facets: &[Facet<R>; 2], mode: Mode) -> R {
        let [first, _] = facets;
        let per_cosine = self.sum_of_densities(
            wo,
            wi,
            facets,
            #[inline(always)]
            |facet| R::select(facet.reflects, facet.fresnel, wo.z.like(1.0) - facet.fresnel),
        );
        let zero = wi.z.like(0.0);
        let f = R::select(per_cosine.gt(zero), per_cosine / Float::abs(wi.z), zero);
        R::select(first.reflects, f, radiance_scale(f, first.eta, mode))
    }

    /// The density of `wi` by a facet and by the one to the wrong side, whose sides are chosen with probabilities.
    #[inline(always)]
    fn sum_of_densities(
        &self,
        wo: Vector<R>,
        wi: Vector<R>,
        [first, wrong]: &[Facet<R>; 2],
        probability: impl Fn(&Facet<R>) -> R,
    ) -> R {
        let zero = wo.z.like(0.0);
        let mut sum = R::select(first.exists, self.facet_density([wo, wi], first, probability(first)), zero);
        if wrong.exists.any() {
            let other = self.facet_density([wo, across(wi)], wrong, probability(wrong));
            sum = sum + R::select(wrong.exists, other, zero);
        }
        sum
    }

    /// As [`super::Bsdf::pdf`].
    #[inline(always)]
    pub(super) fn pdf(&self, wo: Vector<R>, wi: Vector<R>, lobes: Lobes) -> R {
        self.pdf_of(wo, wi, &self.facets(wo, wi), lobes)
    }

    #[inline(always)]
    fn pdf_of(&self, wo: Vector<R>, wi: Vector<R>, facets: &[Facet<R>; 2], lobes: Lobes) -> R {
        let (zero, one) = (wo.z.like(0.0), wo.z.like(1.0));
        if !(facets[0].exists | facets[1].exists).any() {
            return zero;
        }
        self.sum_of_densities(
            wo,
            wi,
            facets,
            #[inline(always)]
            |facet| {
                let [r, t] = lobes.allowed([facet.fresnel, one - facet.fresnel]);
                let probability = R::select(facet.reflects, r, t) / (r + t);
                R::select((r + t).gt(zero), probability, zero)
            },
        )
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
        let conserves = self.conserves();
        let stays = (wo.z * wi.z).gt(zero);
        let is_on_side = reflects.choose(stays, !stays);
        let wi = Vector::select(conserves & !is_on_side, across(wi), wi);
        let exists = (reflects | is_refracted) & (is_on_side | conserves);
        let is_valid = exists & (r + t).gt(zero) & !is_grazing(wo) & !is_grazing(wi);
        let facet = Facet { wm, fresnel, reflects, eta, exists };
        let probability = R::select(reflects, reflection, one - reflection);
        let d = self.roughness.d(wm);
        let [g, g1] = self.roughness.g_and_g1(wo, wi);
        let mut f = Self::facet_f([wo, wi], &facet, d * g, mode);
        let mut pdf = Self::facet_pdf([wo, wi], &facet, d * g1, probability);
        if conserves.any() {
            let facets = self.facets(wo, wi);
            f = R::select(conserves, self.unmasked_f(wo, wi, &facets, mode), f);
            pdf = R::select(conserves, self.pdf_of(wo, wi, &facets, lobes), pdf);
        }
        DirectionSample {
            wi,
            f: Spectrum::splat(f),
            pdf,
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

/// The transported quantity: radiance on paths from the camera, importance on paths from lights, and from below through a coat
/// (Veach 1997). Only refraction depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    /// Paths that start at the camera.
    Radiance,
    /// Paths that start at lights.
    Importance,
}

/// Radiance is scaled by 1/η² on refraction.
#[inline(always)]
pub(super) fn radiance_scale<R: Real>(f: R, eta: R, mode: Mode) -> R {
    match mode {
        Mode::Radiance => f / (eta * eta),
        Mode::Importance => f,
    }
}
