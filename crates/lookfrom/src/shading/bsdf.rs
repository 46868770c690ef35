//! BSDFs: scattering functions as values in a local frame.
//!
//! The scattering functions of the path tracer: no textures, no scene, no shading frame. In the local frame, z is the
//! shading normal on the outside; `wo` and `wi` have unit length and both point away from the surface; `wo.z < 0` means
//! that the surface is seen from inside. All lanes are treated alike, whatever they mean. Textures and the transformation
//! of directions are left to [`crate::shading::material`] and the integrators.
//!
//! Definitions and clamping follow pbrt-v4 (Pharr, Jakob & Humphreys 2023). glTF's material is in [`principled`].

mod albedo;
mod class;
pub mod conductor;
pub mod dielectric;
pub mod diffuse;
pub mod disney;
mod factors;
pub mod fresnel;
pub mod hair;
pub mod henyey_greenstein;
mod kept;
pub mod lanes;
pub mod layered;
pub mod lobes;
pub mod measured;
pub mod microfacet;
pub mod normalized_fresnel;
mod one;
pub mod open_pbr;
pub mod phase;
pub mod plastic;
pub mod principled;
pub mod subsurface;
pub mod thin_dielectric;
pub mod tinted;
pub mod two_lobes;
pub mod whitted;

use glam::Vec3;
use lookfrom_scene::material::Energy;
use lookfrom_simd::{Float, Mask, Real};

use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use conductor::Conductor;
use dielectric::Dielectric;
use diffuse::{Diffuse, DiffuseTransmission};
use lanes::{ClassTraits, LaneBsdf};
use layered::{CoatLayer, Layered};
use lobes::Lobes;
use microfacet::Microfacets;
use thin_dielectric::ThinDielectric;

pub use class::{Bsdf, BsdfClass, Description, Parameter, PreparedClass, ScatteringFunction};
pub(crate) use class::{Variant, bsdf_classes, types};
pub use factors::MicrofacetFactors;
pub use one::PreparedBsdf;
pub(crate) use one::Uniform;

/// A direction sampled by [`Bsdf::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Unit length.
    pub wi: Vec3,
    /// Value of the BSDF, without the cosine. For specular lobes it includes the same delta function
    /// factor as `pdf`.
    pub f: Spectrum,
    /// Density of `wi` over solid angle; for specular lobes the probability of the lobe.
    pub pdf: f32,
    /// The one lobe that was sampled: a side and a spread.
    pub lobe: Lobes,
    /// The relative index of refraction (transmitted over incident side) where light was refracted and `f`
    /// scaled by 1/η²; else 1.
    pub eta: f32,
    /// True if only the ratio `f / pdf` is meaningful. The density for MIS is then [`Bsdf::pdf`].
    pub pdf_is_proportional: bool,
}

/// A direction chosen by a BSDF of any width: what [`BsdfSample`] is for one.
#[derive(Clone, Copy, Debug)]
pub struct DirectionSample<R: Real> {
    /// Unit length.
    pub wi: Vector<R>,
    /// Without the cosine.
    pub f: Spectrum<R>,
    /// Density over solid angle; for specular lobes the probability of the lobe.
    pub pdf: R,
    /// As [`BsdfSample::eta`].
    pub eta: R,
    /// True for a specular lobe.
    pub is_specular: R::Mask,
    /// True for a diffuse lobe; one that is neither is glossy.
    pub is_diffuse: R::Mask,
    /// True if light passes through the surface.
    pub is_transmission: R::Mask,
    /// True if there is such a direction; elsewhere the rest means nothing.
    pub is_valid: R::Mask,
}

impl<R: Real> DirectionSample<R> {
    /// `yes` where the mask is set, `no` elsewhere.
    #[inline(always)]
    pub(crate) fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self {
            wi: Vector::select(mask, yes.wi, no.wi),
            f: Spectrum::select(mask, yes.f, no.f),
            pdf: R::select(mask, yes.pdf, no.pdf),
            eta: R::select(mask, yes.eta, no.eta),
            is_specular: mask.choose(yes.is_specular, no.is_specular),
            is_diffuse: mask.choose(yes.is_diffuse, no.is_diffuse),
            is_transmission: mask.choose(yes.is_transmission, no.is_transmission),
            is_valid: mask.choose(yes.is_valid, no.is_valid),
        }
    }

    /// Valid only where light would come from the direction.
    #[inline(always)]
    pub(crate) fn if_lit(self) -> Self {
        let is_lit = self.pdf.gt(self.pdf.like(0.0)) & !is_grazing(self.wi) & !self.f.is_black();
        Self { is_valid: self.is_valid & is_lit, ..self }
    }

    /// Valid only where it carries light and all its values are finite.
    #[inline(always)]
    pub(crate) fn if_useful(self) -> Self {
        let Self { is_valid, f, pdf, .. } = self.if_lit();
        Self { is_valid: is_valid & f.is_finite() & pdf.lt(pdf.like(f32::INFINITY)), ..self }
    }
}

impl DirectionSample<f32> {
    /// As a scalar sample of a class of BSDFs.
    #[inline]
    fn scalar(self, traits: ClassTraits) -> Option<BsdfSample> {
        let Self { wi, f, pdf, eta, is_specular, is_diffuse, is_transmission, is_valid } = self;
        let lobe = Lobes::sampled(is_specular, is_diffuse, is_transmission);
        let pdf_is_proportional = traits.pdf_is_proportional;
        is_valid.then(|| BsdfSample { wi: wi.into(), f, pdf, lobe, eta, pdf_is_proportional })
    }
}

/// True if the direction lies in the surface, or so nearly that the square of its cosine is useless; also for NaN.
#[inline(always)]
pub(crate) fn is_grazing<R: Real>(w: impl Into<Vector<R>>) -> R::Mask {
    let z = w.into().z;
    !Float::abs(z).gt(z.like(1e-12))
}

/// The direction mirrored at the surface.
#[inline(always)]
pub(crate) fn across<R: Real>(w: Vector<R>) -> Vector<R> {
    Vector { x: w.x, y: w.y, z: -w.z }
}

/// True if both directions are on the same side of the surface, neither grazing.
#[inline(always)]
pub(crate) fn same_side<R: Real>(wo: impl Into<Vector<R>>, wi: impl Into<Vector<R>>) -> R::Mask {
    let (wo, wi) = (wo.into(), wi.into());
    (wo.z * wi.z).gt(wo.z.like(0.0)) & !is_grazing(wo) & !is_grazing(wi)
}

impl Bsdf {
    /// pbrt's `diffuse`.
    pub fn diffuse(reflectance: Spectrum) -> Self {
        Self::Diffuse(Diffuse::new(reflectance))
    }

    /// pbrt's `diffusetransmission`, both already multiplied by its `scale`.
    pub fn diffuse_transmission(reflectance: Spectrum, transmittance: Spectrum) -> Self {
        Self::DiffuseTransmission(DiffuseTransmission::new(reflectance, transmittance))
    }

    /// pbrt's `dielectric`.
    pub fn dielectric(eta: f32, roughness: impl Into<Microfacets>) -> Self {
        Self::Dielectric(Dielectric::new(eta, roughness))
    }

    /// pbrt's `thindielectric`.
    pub fn thin_dielectric(eta: f32) -> Self {
        Self::ThinDielectric(ThinDielectric::new(eta))
    }

    /// pbrt's `conductor` by index of refraction and extinction.
    pub fn conductor(eta: Spectrum, k: Spectrum, roughness: impl Into<Microfacets>) -> Self {
        Self::Conductor(Conductor::new(eta, k, roughness))
    }

    /// pbrt's `conductor` by its reflectance at normal incidence.
    pub fn conductor_of_reflectance(reflectance: Spectrum, roughness: impl Into<Microfacets>) -> Self {
        let (eta, k) = fresnel::conductor_of_reflectance(reflectance);
        Self::conductor(eta, k, roughness)
    }

    /// This conductor or dielectric with the light between its microfacets or without it; other BSDFs as they are.
    #[must_use]
    pub fn with_energy(self, energy: Energy) -> Self {
        match self {
            Self::Conductor(bsdf) => Self::Conductor(bsdf.with_energy(energy)),
            Self::Dielectric(bsdf) => Self::Dielectric(bsdf.with_energy(energy)),
            other => other,
        }
    }

    /// pbrt's `coateddiffuse`, with walks of the seed 0.
    pub fn coated_diffuse(reflectance: Spectrum, coat: &CoatLayer) -> Self {
        Self::CoatedDiffuse(Layered::coated_diffuse(Diffuse::new(reflectance), coat, 0.0))
    }

    /// pbrt's `coatedconductor` by the metal's index of refraction and extinction in air: both are divided by the
    /// coat's index; with walks of the seed 0.
    pub fn coated_conductor(
        eta: Spectrum,
        k: Spectrum,
        roughness: impl Into<Microfacets>,
        coat: &CoatLayer,
    ) -> Self {
        Self::CoatedConductor(Layered::coated_conductor(eta, k, roughness, coat, 0.0))
    }

    /// The BSDF: the fraction of light from `wi` that leaves along `wo`, per solid angle and without the cosine of
    /// `wi`. Black for specular lobes and grazing directions.
    pub fn f(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        LaneBsdf::f(self, &self.prepare(wo.into()), wi.into())
    }

    /// Density over solid angle with which [`Self::sample`] chooses `wi`. Specular lobes contribute 0; layered surfaces return
    /// an estimate.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        LaneBsdf::pdf(self, &self.prepare(wo.into()), wi.into())
    }

    /// Samples a direction with a density about proportional to `f |cos θ_i|`, by three numbers in [0, 1). `None` where the
    /// sample would carry no light; otherwise `pdf > 0` and all values are finite.
    pub fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        LaneBsdf::sample(self, &self.prepare(wo.into()), uc, u).scalar(self.traits())
    }

    /// The set of lobes that it has.
    #[inline]
    pub fn lobes(&self) -> Lobes {
        self.class().lobes()
    }

    /// Increases the roughness of nearly specular lobes, for the later bounces of a path: less noise for a
    /// little blur.
    pub fn regularize(&mut self) {
        self.class_mut().regularize();
    }

    /// The factors for light from `wi` to `wo`. `is_specular` asks for those of a direction that was sampled from a
    /// smooth boundary, which has no value for any other.
    pub fn factors(&self, wo: Vec3, wi: Vec3, is_specular: bool) -> Vec<MicrofacetFactors> {
        self.class().factors(wo, wi, is_specular)
    }

    /// Its name, what it does, and its numbers.
    pub fn description(&self) -> Description {
        self.class().description()
    }
}

#[cfg(test)]
mod tests;
