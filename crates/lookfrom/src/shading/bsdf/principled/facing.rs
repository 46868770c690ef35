//! The microfacets of a principled surface that scatter one direction to another.

use lookfrom_simd::{Mask, Real};

use super::Model;
use super::prepared::{PreparedSurface, is_below};
use crate::core::vector::Vector;
use crate::shading::bsdf::across;
use crate::shading::bsdf::dielectric::refraction_jacobian;

/// A facet that scatters `wo` to some direction.
#[derive(Clone, Copy)]
pub(super) struct Facing<R: Real> {
    /// Its normal.
    pub(super) wm: Vector<R>,
    /// The cosine of `wo` to it.
    pub(super) cos: R,
    /// Density of that direction over solid angle when facets are sampled by visible normals.
    pub(super) density: R,
    /// Whether there is one.
    pub(super) exists: R::Mask,
}

/// All facets that scatter `wo` to a direction. A rough body has two: the second one sends light to the wrong side,
/// which then leaves mirrored at the surface. It is `None` where no surface is a rough body.
pub(super) type Facings<R> = (Facing<R>, Option<Facing<R>>);

impl<R: Real, M: Model<R>> PreparedSurface<R, M> {
    /// The facet that reflects `wo` to `wi`, or refracts it there (`through`).
    #[inline(always)]
    fn facet(&self, wi: Vector<R>, through: R::Mask) -> Facing<R> {
        let surface = &self.surface;
        let (zero, one) = (wi.z.like(0.0), wi.z.like(1.0));
        let wo = self.wo;
        let is_sharp = surface.is_smooth() | (through & (!surface.has_glass() | surface.passes_sharply()));
        let refracts = through & surface.is_solid;
        // A thin sheet transmits what a reflector would reflect, to the other side.
        let wi = Vector::select(through & !surface.is_solid, across(wi), wi);
        let eta = R::select(refracts, self.relative_eta(), one);
        let (wm, exists) = (wi * eta + wo).try_normalize();
        let wm = wm.negate_where(wm.z.lt(zero));
        let cos = wo.dot(wm);
        let jacobian = R::select(refracts, cos * refraction_jacobian(wo, wi, wm, eta), one.like(0.25));
        let density = surface.roughness.visible_per_cosine(wo, wm) * jacobian;
        let is_front = cos.gt(zero) & (!refracts | wi.dot(wm).lt(zero));
        Facing { wm, cos, density, exists: exists & is_front & !is_sharp }
    }

    /// The facets that scatter `wo` to `wi`.
    #[inline(always)]
    pub(super) fn facets(&self, wi: Vector<R>) -> Facings<R> {
        let through = is_below(wi);
        let is_rough_body = self.surface.is_rough_body();
        let first = self.facet(wi, through);
        if !is_rough_body.any() {
            return (first, None);
        }
        let back = self.facet(across(wi), through);
        (first, Some(Facing { exists: back.exists & is_rough_body, ..back }))
    }
}
