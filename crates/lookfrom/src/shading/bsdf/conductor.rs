//! Conductors, smooth or rough.
//!
//! Light that one facet sends to another is lost, as in pbrt, or leaves along the directions of single scattering,
//! which is increased by what its albedo lacks: `f · (1 + F̄ Ē / (1 − F̄ (1 − Ē)) · (1 − E(ω_o)) / E(ω_o))` (Turquin 2019, with the
//! colour of Kulla & Conty 2017), where E is the albedo of facets that reflect all light, Ē its mean and F̄ the mean
//! Fresnel reflectance. White metal then reflects all light; `f` is not reciprocal.
//!
//! Cook & Torrance 1982; Walter et al. 2007; Heitz 2014.

use glam::Vec3;
use lookfrom_scene::material::Energy;
use lookfrom_simd::{Float, Mask, Real};

use super::albedo;
use super::microfacet::Microfacets;
use super::{
    Description, DirectionSample, Lobes, MicrofacetFactors, ScatteringFunction, fresnel, is_grazing,
    lanes::{ClassTraits, LaneBsdf},
    layered::{Base, DiffuseInterior},
    same_side,
};
use crate::core::optics;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// A metal with index of refraction `eta` and extinction `k`, both divided by the surrounding index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor<R = f32> {
    /// Index of refraction over the surrounding one.
    pub(crate) eta: Spectrum<R>,
    /// Extinction over the surrounding index.
    pub(crate) k: Spectrum<R>,
    /// Roughness of the surface.
    pub(crate) roughness: Microfacets<R>,
    /// Factor of the Fresnel reflectance.
    pub(crate) specular: Spectrum<R>,
    /// 1 for [`Energy::Conserved`], 0 for [`Energy::SingleScattering`].
    pub(crate) conserves: R,
}

/// The cosine at which the Fresnel reflectance stands for its mean over the hemisphere: there Schlick's curve has
/// its mean, 1/21.
const MEAN_COSINE: f32 = 0.456;

/// Multiple scattering between facets, for an outgoing direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MultipleScattering<R = f32> {
    /// E(ω_o): the albedo of single scattering by facets that reflect all light.
    pub albedo: R,
    /// Ē: its mean over all directions.
    pub mean_albedo: R,
    /// F̄: the mean Fresnel reflectance.
    pub mean_fresnel: Spectrum<R>,
}

impl<R: Real> MultipleScattering<R> {
    /// All scattered light over that of single scattering.
    #[inline(always)]
    pub fn gain(&self) -> Spectrum<R> {
        let one = self.albedo.like(1.0);
        let hidden = (one - self.albedo) / self.albedo;
        self.mean_fresnel.map(
            #[inline(always)]
            |fresnel| one + fresnel * self.mean_albedo / (one - fresnel * (one - self.mean_albedo)) * hidden,
        )
    }
}

impl Conductor {
    /// By index and extinction over the surrounding index, with single scattering.
    pub fn new(eta: Spectrum, k: Spectrum, roughness: impl Into<Microfacets>) -> Self {
        let specular = Spectrum([1.0; 4]);
        Self { eta, k, roughness: roughness.into(), specular, conserves: 0.0 }
    }

    /// This conductor with a factor of its Fresnel reflectance.
    #[must_use]
    pub fn with_specular_reflectance(self, specular: Spectrum) -> Self {
        Self { specular, ..self }
    }

    /// This conductor with the light between its facets or without it; its table is that of Trowbridge and Reitz's, with correlated
    /// masking.
    #[must_use]
    pub fn with_energy(self, energy: Energy) -> Self {
        Self { conserves: f32::from(energy == Energy::Conserved), ..self }
    }
}

impl ScatteringFunction for Conductor {
    fn lobes(&self) -> Lobes {
        Lobes::REFLECTION | if self.roughness.is_smooth() { Lobes::SPECULAR } else { Lobes::GLOSSY }
    }

    fn regularize(&mut self) {
        self.roughness.regularize();
    }

    fn factors(&self, wo: Vec3, wi: Vec3, is_specular: bool) -> Vec<MicrofacetFactors> {
        self.factors(wo, wi, is_specular).into_iter().collect()
    }

    fn description(&self) -> Description {
        let mut numbers =
            vec![("eta", self.eta.into()), ("k", self.k.into()), ("alpha", self.roughness.into())];
        if self.specular != Spectrum([1.0; 4]) {
            numbers.push(("specular reflectance", self.specular.into()));
        }
        Description {
            kind: "conductor",
            does: match (self.roughness.is_smooth(), self.roughness.is_beckmann()) {
                (true, _) => "smooth metal: specular reflection, tinted by Fresnel's equations",
                (false, false) => "rough metal: microfacets of roughness alpha",
                (false, true) => "rough metal: Beckmann's microfacets of roughness alpha",
            },
            numbers,
        }
    }
}

impl<R: Real> Conductor<R> {
    /// Fresnel reflectance of the microfacets, times the factor, for a cosine of incidence.
    #[inline(always)]
    pub(super) fn reflectance(&self, cos: R) -> Spectrum<R> {
        fresnel::conductor(cos, self.eta, self.k) * self.specular
    }

    /// `f` with the half vector `wm`; both directions on one side, neither grazing; `seen` is D G.
    #[inline(always)]
    fn rough_f(&self, [wo, wi, wm]: [Vector<R>; 3], seen: R) -> Spectrum<R> {
        let fresnel = self.reflectance(Float::abs(wo.dot(wm)));
        let once = fresnel * (seen / (wo.z * 4.0 * wi.z));
        let conserves = self.conserves.gt(wo.z.like(0.0));
        if !conserves.any() {
            return once;
        }
        Spectrum::select(conserves, once * self.multiple_scattering(wo).gain(), once)
    }

    /// The light that facets of a rough surface send to one another, along `wo`.
    #[inline(always)]
    pub(super) fn multiple_scattering(&self, wo: Vector<R>) -> MultipleScattering<R> {
        let roughness = self.roughness.alpha;
        let alpha = albedo::even_alpha(roughness);
        let up = Vector { z: Float::abs(wo.z), ..wo };
        MultipleScattering {
            albedo: albedo::reflector(up, roughness, alpha).all(),
            mean_albedo: albedo::reflector_mean(roughness, alpha).all(),
            mean_fresnel: self.reflectance(wo.z.like(MEAN_COSINE)),
        }
    }

    #[inline(always)]
    fn sample_smooth(&self, wo: Vector<R>) -> DirectionSample<R> {
        let is_valid = !is_grazing(wo);
        let wi = Vector { x: -wo.x, y: -wo.y, z: wo.z };
        let cos = Float::abs(wi.z);
        let f = self.reflectance(cos) / cos;
        let (is_specular, no) = (is_valid.like(true), is_valid.like(false));
        DirectionSample {
            wi,
            f,
            pdf: cos.like(1.0),
            eta: cos.like(1.0),
            is_specular,
            is_diffuse: no,
            is_transmission: no,
            is_valid,
        }
    }

    #[inline(always)]
    fn sample_rough(&self, wo: Vector<R>, u: [R; 2]) -> DirectionSample<R> {
        let wm = self.roughness.sample(wo, u);
        let wi = optics::reflect(wo, wm);
        let d = self.roughness.d(wm);
        let [g, g1] = self.roughness.g_and_g1(wo, wi);
        let pdf = d * g1 / Float::abs(wo.z) * 0.25;
        let is_valid = same_side(wo, wi);
        let no = is_valid.like(false);
        let f = self.rough_f([wo, wi, wm], d * g);
        DirectionSample {
            wi,
            f,
            pdf,
            eta: pdf.like(1.0),
            is_specular: no,
            is_diffuse: no,
            is_transmission: no,
            is_valid,
        }
    }
}

/// The normal of the microfacets that reflect `wi` toward `wo`, with z ≥ 0, and whether there is one.
#[inline(always)]
pub(super) fn half_vector<R: Real>(wo: Vector<R>, wi: Vector<R>) -> (Vector<R>, R::Mask) {
    let (wm, exists) = (wo + wi).try_normalize();
    (wm.negate_where(wm.z.lt(wm.z.like(0.0))), exists)
}

/// The [`half_vector`] of one pair of directions.
pub(super) fn try_half_vector(wo: Vec3, wi: Vec3) -> Option<Vec3> {
    let (wm, exists) = half_vector(wo.into(), wi.into());
    exists.then(|| wm.into())
}

impl<R: Real> LaneBsdf<R> for Conductor<R> {
    type Prepared = Vector<R>;

    #[inline(always)]
    fn traits(&self) -> ClassTraits {
        ClassTraits { needs_lobe: false, ..ClassTraits::PLAIN }
    }

    #[inline(always)]
    fn prepare(&self, wo: Vector<R>) -> Vector<R> {
        wo
    }

    #[inline(always)]
    fn f(&self, &wo: &Vector<R>, wi: Vector<R>) -> Spectrum<R> {
        let (wm, exists) = half_vector(wo, wi);
        let is_lit = exists & same_side(wo, wi) & !self.roughness.is_smooth();
        let black = Spectrum::splat(wo.z.like(0.0));
        if !is_lit.any() {
            return black;
        }
        let seen = self.roughness.d(wm) * self.roughness.g(wo, wi);
        Spectrum::select(is_lit, self.rough_f([wo, wi, wm], seen), black)
    }

    #[inline(always)]
    fn pdf(&self, &wo: &Vector<R>, wi: Vector<R>) -> R {
        let (wm, exists) = half_vector(wo, wi);
        let is_lit = exists & same_side(wo, wi) & !self.roughness.is_smooth();
        R::select(is_lit, self.roughness.visible_per_cosine(wo, wm) * 0.25, wo.z.like(0.0))
    }

    #[inline(always)]
    fn sample(&self, &wo: &Vector<R>, _: R, u: [R; 2]) -> DirectionSample<R> {
        let is_smooth = self.roughness.is_smooth();
        if is_smooth.all() {
            self.sample_smooth(wo)
        } else if is_smooth.any() {
            DirectionSample::select(is_smooth, self.sample_smooth(wo), self.sample_rough(wo, u))
        } else {
            self.sample_rough(wo, u)
        }
    }

    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        !self.roughness.is_smooth()
    }
}

impl<R: Real> Base<R> for Conductor<R> {
    type Interior = ();
    const COATED: [&str; 2] =
        ["coated conductor", "metal under a clear coat: a random walk between the two layers"];

    #[inline(always)]
    fn is_specular(&self) -> R::Mask {
        self.roughness.is_smooth()
    }

    #[inline(always)]
    fn lambertian<'a>(&self, (): &'a ()) -> Option<(Spectrum<R>, &'a DiffuseInterior<R>)> {
        None
    }
}
