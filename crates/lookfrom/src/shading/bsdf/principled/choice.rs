//! The probabilities of the lobes of a principled BSDF: in proportion to their albedos, as far as the path's throughput
//! lets their colours matter.

use lookfrom_simd::{Float, Mask, Real};

use super::Model;
use super::prepared::PreparedSurface;

/// Probabilities of the lobes.
#[derive(Debug)]
pub(super) struct Choice<R: Real> {
    pub(super) coat: R,
    pub(super) sheen: R,
    /// Reflection or transmission by a facet.
    pub(super) facet: R,
    pub(super) matte: R,
    pub(super) matte_through: R,
    /// Whether any lobe carries light.
    pub(super) exists: R::Mask,
}

impl<R: Real> Choice<R> {
    #[inline(always)]
    pub(super) fn new<M: Model<R>>(prepared: &PreparedSurface<R, M>) -> Self {
        let surface = &prepared.surface;
        let (zero, one) = (prepared.wo.z.like(0.0), prepared.wo.z.like(1.0));
        let coat = match &prepared.coat {
            Some(coat) => coat.taken,
            None => zero,
        };
        let (sheen, of_sheen) = match &prepared.sheen {
            Some(sheen) => (sheen.taken, sheen.albedo(prepared.wo.z) * prepared.weigh(sheen.color)),
            None => (zero, zero),
        };
        let below = (one - coat) * (one - sheen);
        let facet = surface.facet(Float::min(prepared.wo.z, one), prepared.is_inside);
        let all = prepared.mirror.all() * below;
        let facet = prepared.weigh(facet.mirrored) * all + prepared.weigh(facet.passed) * all;
        let through = prepared.is_inside.like(true);
        let passes = surface.leaf.gt(zero) | surface.has_glass();
        let mut matte_through = zero;
        if passes.any() {
            let albedo = prepared.weigh(prepared.matte_albedo(through));
            matte_through = R::select(passes, albedo * below, zero);
        }
        let matte = prepared.weigh(prepared.matte_albedo(!through)) * below;
        // glTF's sheen is below the coat, OpenPBR's fuzz above.
        let (sheen, coat) = match surface.model.open_pbr() {
            None => (of_sheen * (one - coat), coat),
            Some(_) => (of_sheen, coat * (one - sheen)),
        };
        let sum = coat + sheen + facet + matte + matte_through;
        Self {
            coat: coat / sum,
            sheen: sheen / sum,
            facet: facet / sum,
            matte: matte / sum,
            matte_through: matte_through / sum,
            exists: sum.gt(zero),
        }
    }
}
