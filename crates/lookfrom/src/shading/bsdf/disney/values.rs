//! The values of Disney's lobes, and the density with which they are sampled.

use std::f32::consts::{FRAC_1_PI, PI};

use lookfrom_simd::{Float, Mask, Real};

use super::{Disney, SeenDisney};
use crate::core::elementary;
use crate::core::math::schlick;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;
use crate::shading::bsdf::{Lobes, Mode, across, fresnel, is_grazing};

/// What a surface scatters from one direction to another.
#[derive(Clone, Copy)]
pub(super) struct Scattered<R: Real> {
    /// As [`Bsdf::f`](crate::shading::bsdf::Bsdf::f).
    pub(super) f: Spectrum<R>,
    /// The part of it that is diffuse.
    pub(super) diffuse: Spectrum<R>,
    /// As [`Bsdf::pdf`](crate::shading::bsdf::Bsdf::pdf).
    pub(super) pdf: R,
}

/// `D` of Burley's distribution GTR1 with the roughness α for the cosine of a facet's normal.
#[inline(always)]
fn gtr1<R: Real>(alpha: R, cos: R) -> R {
    let squared = alpha * alpha;
    let less = squared - 1.0;
    less / (elementary::ln(squared) * PI * (less * cos * cos + 1.0))
}

/// `normal`, the reflectance at normal incidence, at the angle whose weight Schlick's formula gives.
#[inline(always)]
fn toward_white<R: Real>(normal: Spectrum<R>, weight: R) -> Spectrum<R> {
    normal.map(
        #[inline(always)]
        |r| r + (weight.like(1.0) - r) * weight,
    )
}

impl<R: Real> Disney<R> {
    /// The weight of white in Schlick's reflectance: in the thinner medium the angle there counts.
    #[inline(always)]
    fn schlick_weight(&self, cos: R) -> R {
        let (zero, one) = (cos.like(0.0), cos.like(1.0));
        let relative = fresnel::relative_eta(cos, self.eta);
        let refracted = Float::sqrt(Float::max(one - (one - cos * cos) / (relative * relative), zero));
        schlick(R::select(relative.gt(one), Float::abs(cos), refracted))
    }

    /// The reflectance of the specular layer for a cosine to a facet, which is negative inside, where Fresnel's is `dielectric`.
    #[inline(always)]
    fn specular(&self, seen: &SeenDisney<R>, cos: R, dielectric: R) -> Spectrum<R> {
        let one = cos.like(1.0);
        let weight = self.schlick_weight(cos);
        let relative = fresnel::relative_eta(cos, self.eta);
        let root = (relative - 1.0) / (relative + 1.0);
        let body = one - self.metallic;
        let plain = Spectrum::splat(body * (one - self.spec_tint) * dielectric);
        let metal = toward_white(self.base, weight) * self.metallic;
        let tinted = toward_white(self.tint * (root * root), weight) * (body * self.spec_tint);
        // Microfacets of a sheet are those of its glass.
        let outside = (plain + metal + tinted) * R::select(self.is_thin, seen.glass, one);
        Spectrum::select(seen.is_inside, Spectrum::splat(seen.glass * dielectric), outside)
    }

    /// The diffuse lobe with its sheen, for directions on the front; `cos` is the one of `wi` to the facet.
    #[inline(always)]
    fn diffuse(&self, seen: &SeenDisney<R>, wi: Vector<R>, cos: R) -> Spectrum<R> {
        let one = cos.like(1.0);
        let wo = seen.wo;
        let (fresnel_o, fresnel_i) = (schlick(Float::abs(wo.z)), schlick(Float::abs(wi.z)));
        let retro = self.roughness * 2.0 * cos * cos;
        let lambertian = (one - fresnel_o * 0.5) * (one - fresnel_i * 0.5);
        let reflected = retro * (fresnel_i + fresnel_o + fresnel_i * fresnel_o * (retro - 1.0));
        let shape = lambertian + reflected;
        // Hanrahan & Krueger's light below the surface, approximated (Burley 2012, § 5.3).
        let grazing = retro * 0.5 - 1.0;
        let below = (grazing * fresnel_o + 1.0) * (grazing * fresnel_i + 1.0);
        let flat = (below * (one / (Float::abs(wo.z) + Float::abs(wi.z)) - 0.5) + 0.5) * 1.25;
        let shape = shape + (flat - shape) * self.flatness;

        let reflected = one - self.diff_trans;
        let sheen = R::select(self.is_thin, seen.matte * reflected, one - self.metallic);
        let base = self.base * (seen.matte * FRAC_1_PI * reflected * shape);
        let color = self.tint.map(
            #[inline(always)]
            |tint| (tint - 1.0) * self.sheen_tint + 1.0,
        );
        base + color * (self.sheen * sheen * schlick(Float::abs(cos)))
    }

    /// What is scattered from `wi`, with the density for the sides of `lobes`. Not inlined, since it is needed several times.
    #[inline(never)]
    pub(super) fn scattered(
        &self,
        seen: &SeenDisney<R>,
        wi: Vector<R>,
        mode: Mode,
        lobes: Lobes,
    ) -> Scattered<R> {
        wi.z.at_level(
            #[inline(always)]
            || self.scattered_inline(seen, wi, mode, lobes),
        )
    }

    #[inline(always)]
    fn scattered_inline(
        &self,
        seen: &SeenDisney<R>,
        wi: Vector<R>,
        mode: Mode,
        lobes: Lobes,
    ) -> Scattered<R> {
        let (zero, one) = (wi.z.like(0.0), wi.z.like(1.0));
        let black = Spectrum::splat(zero);
        let (wo, wi) = (seen.wo, wi.negate_where(seen.is_turned));
        let reflects = (wo.z * wi.z).gt(zero);
        let refracts = !reflects & !self.is_thin;
        let passes_sheet = !reflects & self.is_thin;
        let is_lit = !is_grazing(wo) & !is_grazing(wi) & (reflects | self.is_thin | seen.glass.gt(zero));
        if !is_lit.any() {
            return Scattered { f: black, diffuse: black, pdf: zero };
        }

        // The facet, which what passes a sheet is mirrored by.
        let eta = R::select(refracts, fresnel::relative_eta(wo.z, self.eta), one);
        let mirrored = Vector::select(passes_sheet, across(wi), wi);
        let (wm, is_defined) = (mirrored * eta + wo).try_normalize();
        let wm = wm.negate_where(wm.z.lt(zero));
        let (cos_o, cos_i) = (wo.dot(wm), wi.dot(wm));
        let is_refracting = (cos_o * wo.z).gt(zero) & (cos_i * wi.z).gt(zero);
        let has_facet = is_defined & (reflects | refracts.choose(is_refracting, cos_i.lt(zero)));

        // Microfacets that reflect light or let it pass.
        let dielectric = fresnel::dielectric(cos_o, self.eta);
        let choice = self.choice(seen, dielectric, lobes);
        let (mut facets, mut per_facet) = (seen.facets, one.like(0.25));
        let mut f = self.specular(seen, cos_o, dielectric);
        if !reflects.all() {
            let sheet = self.facets_of_thin_transmission();
            facets.alpha_x = R::select(passes_sheet, sheet.alpha_x, facets.alpha_x);
            facets.alpha_y = R::select(passes_sheet, sheet.alpha_y, facets.alpha_y);
            let sum = cos_o + eta * cos_i;
            let jacobian = Float::abs(cos_o * cos_i) * eta * eta / (sum * sum);
            per_facet = R::select(refracts, jacobian, per_facet);
            let scale = if mode == Mode::Radiance { one / (eta * eta) } else { one };
            let color = Spectrum::select(self.is_thin, self.base, self.base.map(Float::sqrt));
            let passed = color * (seen.glass * (one - dielectric) * scale);
            f = Spectrum::select(reflects, f, passed);
        }
        let area = facets.d(wm) * facets.g1(wo) * per_facet / Float::abs(wo.z);
        f = f * (area * facets.g1(wi) / Float::abs(wi.z));
        let mut pdf = R::select(reflects, choice.reflection, choice.transmission) * area;

        // The clear coat.
        let is_front = reflects & !seen.is_inside;
        let has_coat = is_front & self.clearcoat.gt(zero);
        if has_coat.any() {
            let coat = TrowbridgeReitz { alpha_x: one.like(0.25), alpha_y: one.like(0.25) };
            let fresnel = self.schlick_weight(cos_o) * 0.96 + 0.04;
            let d = gtr1(self.clearcoat_alpha, wm.z);
            let value = self.clearcoat * 0.25 * fresnel * d * coat.g1(wo) * coat.g1(wi);
            f += Spectrum::splat(R::select(has_coat, value, zero));
            let density = choice.clearcoat * d * wm.z * 0.25 / Float::abs(cos_o);
            pdf = pdf + R::select(has_coat, density, zero);
        }

        // The diffuse base.
        let reflected = Spectrum::select(is_front & has_facet, self.diffuse(seen, wi, cos_i), black);
        let passed = self.base * (seen.matte * FRAC_1_PI * self.diff_trans);
        let diffuse = Spectrum::select(passes_sheet, passed, reflected);
        let probability = R::select(passes_sheet, choice.diffuse_transmission, choice.diffuse);
        let is_diffuse = passes_sheet | reflects & has_facet;
        let density = R::select(is_diffuse, probability * Float::abs(wi.z) * FRAC_1_PI, zero);

        let f = Spectrum::select(has_facet, f, black) + diffuse;
        let pdf = R::select(has_facet, pdf, zero) + density;
        Scattered {
            f: Spectrum::select(is_lit, f, black),
            diffuse: Spectrum::select(is_lit, diffuse, black),
            pdf: R::select(is_lit & choice.exists, pdf, zero),
        }
    }
}
