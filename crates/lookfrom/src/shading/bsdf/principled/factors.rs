//! The factors of a principled BSDF's microfacets, for the inspector, and its diffuse part.

use super::Model;
use super::facing::Facing;
use super::prepared::is_below;
use super::scattering::LocalScattering;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::bsdf::{MicrofacetFactors, across, is_grazing};

impl<M: Model<f32>> LocalScattering<f32, M> {
    /// As [`crate::shading::bsdf::Bsdf::factors`].
    pub(in crate::shading::bsdf) fn factors(&self, wi: Vector<f32>) -> Vec<MicrofacetFactors> {
        let prepared = self.prepared();
        let (wo, surface) = (prepared.wo, &prepared.surface);
        if is_grazing(wo) || is_grazing(wi) {
            return Vec::new();
        }
        let mirrored = |w: Vector<f32>| if prepared.is_inside { across(w) } else { w };
        let wi = mirrored(wi);
        let through = is_below(wi);
        let (below_coat, below_sheen) = prepared.below(wi);
        // OpenPBR's coat has a colour, and is below its fuzz.
        let (weight, tint, of_coat) = match surface.model.open_pbr() {
            None => (below_coat * below_sheen, Spectrum::splat(1.0), 1.0),
            Some(_) => (1.0, prepared.below_all(wi), below_sheen),
        };
        let is_rough_body = surface.is_rough_body();
        let (first, back) = prepared.facets(wi);
        let of_facet = |facing: &Facing<f32>, to: Vector<f32>| MicrofacetFactors {
            boundary: "specular",
            refracts: false,
            roughness: surface.roughness,
            wm: mirrored(facing.wm).into(),
            cos: [wo.z, to.z.abs()],
            cos_m: [facing.cos, to.dot(facing.wm)],
            d: Some(surface.roughness.d(facing.wm)),
            g: Some(surface.roughness.g1(wo)),
            fresnel: Spectrum::BLACK,
            part: Spectrum::BLACK,
            eta: 1.0,
            weight,
            multiple_scattering: None,
        };

        let mut all = Vec::new();
        if first.exists && !(is_rough_body && through) {
            // A thin sheet transmits what a reflector would reflect, to the other side.
            let up = Vector { z: wi.z.abs(), ..wi };
            let glass = if is_rough_body { 0.0 } else { surface.glass };
            let facet = surface.facet_with(glass, first.cos, prepared.is_inside);
            all.push(MicrofacetFactors {
                g: Some(surface.roughness.g(wo, up)),
                fresnel: facet.mirrored,
                part: if through { facet.passed } else { facet.mirrored },
                ..of_facet(&first, up)
            });
        }
        if is_rough_body {
            // Light that would leave to the wrong side is mirrored at the surface.
            for (facing, to) in [Some((first, wi)), back.map(|back| (back, across(wi)))].into_iter().flatten()
            {
                if !facing.exists {
                    continue;
                }
                let pane = surface.pane(facing.cos, prepared.is_inside);
                let plain = of_facet(&facing, to);
                all.push(MicrofacetFactors {
                    boundary: "glass",
                    refracts: through,
                    fresnel: pane.mirrored,
                    part: if through { pane.passed * surface.tint() } else { pane.mirrored },
                    eta: if through { prepared.relative_eta() } else { 1.0 },
                    weight: plain.weight * surface.glass,
                    ..plain
                });
            }
        }
        all.iter_mut().for_each(|factors| factors.part *= tint);
        if let Some(coat) = prepared.coat.as_ref().filter(|_| !through)
            && let Some(factors) = coat.factors(&surface.model, wi)
        {
            let weight = factors.weight * of_coat;
            all.push(MicrofacetFactors { wm: mirrored(factors.wm.into()).into(), weight, ..factors });
        }
        all.retain(|factors| factors.weight > 0.0 && !factors.part.is_black());
        all
    }
}
