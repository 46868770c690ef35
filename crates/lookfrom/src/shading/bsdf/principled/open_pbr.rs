//! Additions of OpenPBR 1.1 to the layers of principled surfaces.
//!
//! Portsmouth, Kutz & Hill et al. 2024, "OpenPBR Surface Specification" (Academy Software Foundation):
//! - **metal** whose reflectance is tinted near grazing incidence;
//! - a **diffuse base** that may be rough;
//! - a **coat** with an index, a colour, and a darkening of its own;
//! - **fuzz** on top of all.

use lookfrom_simd::{Float, Mask, Real};

use super::layers::Coat;
use super::{Model, Principled};
use crate::core::elementary;
use crate::core::math::{both, schlick};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// (1 − μ)⁵ at the cosine for which the tint of metals is told, μ = 1/7: 82°.
const EDGE_SCHLICK: f32 = 7776.0 / 16807.0;
/// 1 / (μ (1 − μ)⁶) there.
const EDGE_SCALE: f32 = 823_543.0 / 46_656.0;

/// Parameters of OpenPBR that glTF's model does not have. All weights and colours are within 0 … 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenPbr<R = f32> {
    /// Tint of metals at 82°.
    pub specular_color: Spectrum<R>,
    /// Factor of the reflection by metal.
    pub specular_weight: R,
    /// Colour of light that the transmissive body passes on.
    pub transmission_color: Spectrum<R>,
    /// Roughness of the diffuse base.
    pub diffuse_roughness: R,
    /// The coat's transmittance at normal incidence, to and fro.
    pub coat_color: Spectrum<R>,
    /// The coat's index of refraction, at least 1.
    pub coat_eta: R,
    /// Its reflectance at normal incidence.
    pub coat_f0: R,
    /// Its reflectance at grazing incidence in Schlick's approximation.
    pub coat_f90: R,
    /// The direction of its grain, in the local frame.
    pub coat_tangent: Vector<R>,
    /// The strength of the darkening by interreflection below the coat, 0 … 1.
    pub coat_darkening: R,
    /// The factor of everything below the coat that comes of it: of [`Model::seen`].
    pub darkened: Spectrum<R>,
}

impl Default for OpenPbr {
    /// Without any of these layers.
    fn default() -> Self {
        Self {
            specular_color: Spectrum([1.0; 4]),
            specular_weight: 1.0,
            transmission_color: Spectrum([1.0; 4]),
            diffuse_roughness: 0.0,
            coat_color: Spectrum([1.0; 4]),
            coat_eta: 1.6,
            coat_f0: reflectance(1.6),
            coat_f90: grazing_reflectance(1.6),
            coat_tangent: Vector { x: 1.0, y: 0.0, z: 0.0 },
            coat_darkening: 1.0,
            darkened: Spectrum([1.0; 4]),
        }
    }
}

/// Reflectance of a dielectric of an index of refraction at normal incidence.
pub fn reflectance(eta: f32) -> f32 {
    let ratio = (eta - 1.0) / (eta + 1.0);
    ratio * ratio
}

/// Mean reflectance of a smooth dielectric under even light, by its index of refraction of at least 1 (Walsh 1926).
pub fn mean_reflectance(eta: f32) -> f32 {
    let n = f64::from(eta).min(1e3);
    // Below this nothing is left of it but rounding errors.
    if !(n > 1.001) {
        return 0.0;
    }
    let n2 = n * n;
    let (above, n4) = ((n + 1.0) * (n + 1.0), n2 * n2);
    let mean = 0.5
        + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * above)
        + n2 * (n2 - 1.0) * (n2 - 1.0) / ((n2 + 1.0) * (n2 + 1.0) * (n2 + 1.0))
            * libm::log((n - 1.0) / (n + 1.0))
        - 2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0) * (n4 - 1.0)) * libm::log(n);
    mean.clamp(0.0, 1.0) as f32
}

/// The reflectance at grazing incidence with which Schlick's approximation has the mean of Fresnel's equations, for an
/// index of refraction of at least 1; 0 for 1, 1 from about 1.45 on.
pub fn grazing_reflectance(eta: f32) -> f32 {
    let f0 = reflectance(eta);
    // Schlick's mean is F0 + (F90 − F0) / 21.
    (f0 + 21.0 * (mean_reflectance(eta) - f0)).clamp(0.0, 1.0)
}

/// Roughness of the base as it appears through a coat of a weight and a roughness.
pub fn roughness_below(coat: f32, coat_roughness: f32, base: f32) -> f32 {
    let to_the_fourth = |x: f32| x * x * (x * x);
    let sum = (to_the_fourth(base) + 2.0 * to_the_fourth(coat_roughness)).min(1.0);
    base + coat * (sum.sqrt().sqrt() - base)
}

/// Reflectance at normal incidence of the dielectric base, times the specular weight: by its index over that of the
/// surrounding body, beneath a coat of a weight and an index.
pub fn base_reflectance(eta: f32, coat: f32, coat_eta: f32, weight: f32) -> f32 {
    let bare = reflectance(eta + coat * (eta / coat_eta - eta));
    (bare * weight).min(1.0)
}

/// The index of refraction with a reflectance at normal incidence.
pub fn index_of_reflectance(f0: f32) -> f32 {
    let root = f0.clamp(0.0, 0.999).sqrt();
    (1.0 + root) / (1.0 - root)
}

/// The index of refraction whose reflectance at normal incidence is `weight` times that of another.
pub fn modulated_index(eta: f32, weight: f32) -> f32 {
    if weight == 1.0 {
        return eta;
    }
    let index = index_of_reflectance(reflectance(eta) * weight);
    if eta < 1.0 { 1.0 / index } else { index }
}

impl<R: Real> OpenPbr<R> {
    /// The F82-tint model (Kutz, Hašan & Edmondson 2021): a metal's reflectance at a cosine, from the one at normal incidence
    /// and that of Schlick's approximation (`plain`), such that at 82° it is the tint times the latter.
    #[inline(always)]
    pub(in crate::shading::bsdf) fn tinted_metal(
        &self,
        cos: R,
        f0: Spectrum<R>,
        plain: Spectrum<R>,
    ) -> Spectrum<R> {
        let (zero, one) = (cos.like(0.0), cos.like(1.0));
        let scale = cos * schlick(cos) * (one - cos) * EDGE_SCALE;
        (plain - self.lost_at_edge(f0) * scale).map(
            #[inline(always)]
            |lane| Float::max(lane, zero),
        )
    }

    /// The mean of [`Self::tinted_metal`] under even light.
    #[inline(always)]
    pub(in crate::shading::bsdf) fn mean_of_metal(&self, f0: Spectrum<R>) -> Spectrum<R> {
        let one = Spectrum::splat(self.specular_weight.like(1.0));
        let schlick = f0 + (one - f0) * self.specular_weight.like(1.0 / 21.0);
        // 2 ∫ μ² (1 − μ)⁶ dμ = 1 / 126.
        (schlick - self.lost_at_edge(f0) * self.specular_weight.like(EDGE_SCALE / 126.0)).map(
            #[inline(always)]
            |lane| Float::max(lane, lane.like(0.0)),
        )
    }

    /// The reflectance that the tint takes away at 82°.
    #[inline(always)]
    fn lost_at_edge(&self, f0: Spectrum<R>) -> Spectrum<R> {
        let one = Spectrum::splat(self.specular_weight.like(1.0));
        let plain = f0 + (one - f0) * self.specular_weight.like(EDGE_SCHLICK);
        plain * (one - self.specular_color)
    }

    /// The cosine in the coat of light that arrives at a cosine.
    #[inline(always)]
    fn cosine_in_coat(&self, cos: R) -> R {
        let one = cos.like(1.0);
        let inside = one - Float::max(one - cos * cos, cos.like(0.0)) / (self.coat_eta * self.coat_eta);
        Float::sqrt(Float::max(inside, cos.like(1e-6)))
    }

    /// The coat's transmittance for light that passes it at the first cosine, and at the second where `twice`.
    #[inline(always)]
    pub(in crate::shading::bsdf) fn coat_transmittance(
        &self,
        cosines: [R; 2],
        twice: R::Mask,
    ) -> Spectrum<R> {
        let one = self.coat_eta.like(1.0);
        let [first, second] = both(
            cosines,
            #[inline(always)]
            |cos| one / self.cosine_in_coat(cos),
        );
        let way = (first + R::select(twice, second, one.like(0.0))) * 0.5;
        self.coat_color.map(
            #[inline(always)]
            |lane| Float::min(elementary::power(lane, way), one),
        )
    }
}

impl<R: Real> Model<R> for OpenPbr<R> {
    #[inline(always)]
    fn open_pbr(&self) -> Option<&OpenPbr<R>> {
        Some(self)
    }

    /// Light to and fro between the coat and what is below (the specification's section "Darkening"; Elias, Simonot & Menu
    /// 2001): `(1 − K) / (1 − E_b K)`, with the base's albedo E_b at normal incidence, and K between Fresnel's reflectance,
    /// for a smooth base, and the mean internal reflectance, for a rough one.
    #[inline(always)]
    fn seen(look: &Principled<R, Self>, wo: Vector<R>) -> Self {
        let open = look.model;
        let (zero, one) = (wo.z.like(0.0), wo.z.like(1.0));
        let share = look.clearcoat * open.coat_darkening;
        if !share.gt(zero).any() {
            return open;
        }
        let cos = Float::clamp(Coat::cosine(look, wo), 0.0, 1.0);
        let smooth = open.coat_f0 + (open.coat_f90 - open.coat_f0) * schlick(cos);
        let mean = open.coat_f0 + (open.coat_f90 - open.coat_f0) / 21.0;
        let rough = one - (one - mean) / (open.coat_eta * open.coat_eta);
        let alpha = &look.roughness;
        let roughness =
            Float::sqrt(Float::sqrt((alpha.alpha_x * alpha.alpha_x + alpha.alpha_y * alpha.alpha_y) * 0.5));
        let dielectric = one + (Float::min(roughness, one) - 1.0) * look.f0_greatest;
        let roughness = dielectric + (Float::min(roughness, one) - dielectric) * look.metallic;
        let again = smooth + (rough - smooth) * roughness;
        let diffuse = look.base_color * (one - look.diffuse_transmission)
            + look.diffuse_transmission_color * look.diffuse_transmission;
        let body = diffuse * (one - look.transmission) + open.transmission_color * look.transmission;
        let dielectric = look.f0 + body * (one - look.f0_greatest);
        let metal = look.base_color * (open.specular_weight * look.metallic);
        let base = dielectric * (one - look.metallic) + metal;
        let darkened = base.map(
            #[inline(always)]
            |albedo| {
                let left = (one - again) / (one - Float::min(albedo, one.like(0.9999)) * again);
                one + (Float::min(left, one) - 1.0) * share
            },
        );
        Self { darkened, ..open }
    }
}
