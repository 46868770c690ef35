//! The values of Disney's lobes, and the density with which they are sampled.

use std::f32::consts::{FRAC_1_PI, PI};

use lookfrom_simd::{Float, Mask, Real};

use super::{Choice, Disney, SeenDisney};
use crate::core::elementary;
use crate::core::math::schlick;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;
use crate::shading::bsdf::{across, fresnel, is_grazing};

/// The BSDF and the density for a pair of directions.
#[derive(Clone, Copy)]
pub(super) struct Scattered<R: Real> {
    /// As [`Bsdf::f`](crate::shading::bsdf::Bsdf::f).
    pub(super) f: Spectrum<R>,
    /// The part of it that is diffuse.
    pub(super) diffuse: Spectrum<R>,
    /// As [`Bsdf::pdf`](crate::shading::bsdf::Bsdf::pdf).
    pub(super) pdf: R,
}

/// The facet that reflects light between two directions or lets it pass.
#[derive(Clone, Copy)]
struct Facet<R: Real> {
    /// The incident direction, turned to the front with the outgoing one ([`SeenDisney::is_turned`]).
    wi: Vector<R>,
    /// Its normal, z ≥ 0; through a sheet light passes mirrored at the surface.
    wm: Vector<R>,
    /// The cosines of both directions to it.
    cos_o: R,
    cos_i: R,
    /// The index of refraction on the side of `wi` over that on the other, where light is refracted; else 1.
    eta: R,
    /// Light is reflected …
    reflects: R::Mask,
    /// … or refracted into a body …
    refracts: R::Mask,
    /// … or passes a sheet.
    passes_sheet: R::Mask,
    /// Whether there is one.
    exists: R::Mask,
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

    /// The facet between the outgoing direction and `wi`.
    #[inline(always)]
    fn facet(&self, seen: &SeenDisney<R>, wi: Vector<R>) -> Facet<R> {
        let (zero, one) = (wi.z.like(0.0), wi.z.like(1.0));
        let (wo, wi) = (seen.wo, wi.negate_where(seen.is_turned));
        let reflects = (wo.z * wi.z).gt(zero);
        let refracts = !reflects & !self.is_thin;
        let passes_sheet = !reflects & self.is_thin;
        let eta = R::select(refracts, fresnel::relative_eta(wo.z, self.eta), one);
        let mirrored = Vector::select(passes_sheet, across(wi), wi);
        let (wm, is_defined) = (mirrored * eta + wo).try_normalize();
        let wm = wm.negate_where(wm.z.lt(zero));
        let (cos_o, cos_i) = (wo.dot(wm), wi.dot(wm));
        let is_refracting = (cos_o * wo.z).gt(zero) & (cos_i * wi.z).gt(zero);
        Facet {
            wi,
            wm,
            cos_o,
            cos_i,
            eta,
            reflects,
            refracts,
            passes_sheet,
            exists: is_defined & (reflects | refracts.choose(is_refracting, cos_i.lt(zero))),
        }
    }

    /// `f` by the microfacets that reflect light or let it pass, and their part of the density.
    #[inline(always)]
    fn microfacets(
        &self,
        seen: &SeenDisney<R>,
        facet: &Facet<R>,
        choice: &Choice<R>,
        dielectric: R,
    ) -> (Spectrum<R>, R) {
        let &Facet { wi, wm, cos_o, cos_i, eta, reflects, refracts, passes_sheet, .. } = facet;
        let (wo, one) = (seen.wo, eta.like(1.0));
        let (mut facets, mut per_facet) = (seen.facets, one.like(0.25));
        let mut color = self.specular(seen, cos_o, dielectric);
        if !reflects.all() {
            let sheet = self.facets_of_thin_transmission();
            facets.alpha_x = R::select(passes_sheet, sheet.alpha_x, facets.alpha_x);
            facets.alpha_y = R::select(passes_sheet, sheet.alpha_y, facets.alpha_y);
            let sum = cos_o + eta * cos_i;
            let jacobian = Float::abs(cos_o * cos_i) * eta * eta / (sum * sum);
            per_facet = R::select(refracts, jacobian, per_facet);
            let scale = one / (eta * eta);
            let base = Spectrum::select(self.is_thin, self.base, self.base.map(Float::sqrt));
            let passed = base * (seen.glass * (one - dielectric) * scale);
            color = Spectrum::select(reflects, color, passed);
        }
        let density = facets.d(wm) * facets.g1(wo) * per_facet / Float::abs(wo.z);
        let f = color * (density * facets.g1(wi) / Float::abs(wi.z));
        (f, R::select(reflects, choice.reflection, choice.transmission) * density)
    }

    /// `f` by the clear coat, and its part of the density.
    #[inline(always)]
    fn coat(&self, seen: &SeenDisney<R>, facet: &Facet<R>, choice: &Choice<R>) -> [R; 2] {
        let quarter = facet.cos_o.like(0.25);
        let coat = TrowbridgeReitz { alpha_x: quarter, alpha_y: quarter };
        let fresnel = self.schlick_weight(facet.cos_o) * 0.96 + 0.04;
        let d = gtr1(self.clearcoat_alpha, facet.wm.z);
        let f = self.clearcoat * 0.25 * fresnel * d * coat.g1(seen.wo) * coat.g1(facet.wi);
        [f, choice.clearcoat * d * facet.wm.z * 0.25 / Float::abs(facet.cos_o)]
    }

    /// The BSDF for light from `wi`, and the density of `wi`. Not inlined, since it is needed several times.
    #[inline(never)]
    pub(super) fn scattered(&self, seen: &SeenDisney<R>, wi: Vector<R>) -> Scattered<R> {
        wi.z.at_level(
            #[inline(always)]
            || {
                let zero = wi.z.like(0.0);
                let black = Spectrum::splat(zero);
                let facet = self.facet(seen, wi);
                let Facet { wi, reflects, passes_sheet, .. } = facet;
                let passes = self.is_thin | seen.glass.gt(zero);
                let is_lit = !is_grazing(seen.wo) & !is_grazing(wi) & (reflects | passes);
                if !is_lit.any() {
                    return Scattered { f: black, diffuse: black, pdf: zero };
                }
                let dielectric = fresnel::dielectric(facet.cos_o, self.eta);
                let choice = self.choice(seen, dielectric);

                // What has a facet.
                let (mut f, mut pdf) = self.microfacets(seen, &facet, &choice, dielectric);
                let is_front = reflects & !seen.is_inside;
                let has_coat = is_front & self.clearcoat.gt(zero);
                if has_coat.any() {
                    let [value, density] = self.coat(seen, &facet, &choice);
                    f += Spectrum::splat(R::select(has_coat, value, zero));
                    pdf = pdf + R::select(has_coat, density, zero);
                }
                let reflected = self.diffuse(seen, wi, facet.cos_i);
                let reflected = Spectrum::select(is_front & facet.exists, reflected, black);

                // Diffuse light that passes has none.
                let passed = self.base * (seen.matte * FRAC_1_PI * self.diff_trans);
                let diffuse = Spectrum::select(passes_sheet, passed, reflected);
                let probability = R::select(passes_sheet, choice.diffuse_transmission, choice.diffuse);
                let is_diffuse = passes_sheet | reflects & facet.exists;
                let density = R::select(is_diffuse, probability * Float::abs(wi.z) * FRAC_1_PI, zero);

                let f = Spectrum::select(facet.exists, f, black) + diffuse;
                let pdf = R::select(facet.exists, pdf, zero) + density;
                Scattered {
                    f: Spectrum::select(is_lit, f, black),
                    diffuse: Spectrum::select(is_lit, diffuse, black),
                    pdf: R::select(is_lit & choice.exists, pdf, zero),
                }
            },
        )
    }
}
