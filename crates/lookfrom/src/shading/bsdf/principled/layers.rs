//! Fibres and a coat over a principled surface, for one outgoing direction.

use lookfrom_simd::{Float, Mask, Real};

use super::fuzz::{self, Fuzz};
use super::sheen::{self, Sheen};
use super::{Model, Principled};
use crate::core::math::schlick;
use crate::core::optics;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::core::warp;
use crate::shading::bsdf::MicrofacetFactors;
use crate::shading::bsdf::albedo;
use crate::shading::bsdf::conductor::half_vector;
use crate::shading::bsdf::is_grazing;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;

/// Reflectance of the coat, of index 1.5, at normal incidence.
const COAT_F0: f32 = 0.04;

/// The fibres of a model, seen from a direction.
#[derive(Debug)]
enum Kind<R: Real> {
    Sheen(Sheen<R>),
    Fuzz(Fuzz<R>),
}

/// glTF's sheen below the coat, or OpenPBR's fuzz on top of all layers.
#[derive(Debug)]
pub(super) struct Fibres<R: Real> {
    fibres: Kind<R>,
    pub(super) color: Spectrum<R>,
    greatest: R,
    roughness: R,
    exists: R::Mask,
    /// Its albedo along `wo`, which attenuates the layers below; 0 where there is no sheen.
    pub(super) taken: R,
}

impl<R: Real> Fibres<R> {
    /// `None` where no surface has any.
    #[inline(always)]
    pub(super) fn new<M: Model<R>>(look: &Principled<R, M>, wo: Vector<R>, cos: R) -> Option<Self> {
        let exists = !look.sheen_color.is_black();
        if !exists.any() {
            return None;
        }
        let roughness = look.sheen_roughness;
        let mut fibres = Self {
            fibres: match look.model.open_pbr() {
                None => Kind::Sheen(Sheen::new(roughness)),
                Some(_) => Kind::Fuzz(Fuzz::new(roughness, wo)),
            },
            color: look.sheen_color,
            greatest: R::select(exists, look.sheen_greatest, cos.like(0.0)),
            roughness,
            exists,
            taken: cos.like(0.0),
        };
        fibres.taken = fibres.taken(cos);
        Some(fibres)
    }

    #[inline(always)]
    pub(super) fn albedo(&self, cos: R) -> R {
        match self.fibres {
            Kind::Sheen(_) => albedo::sheen(cos, self.roughness),
            Kind::Fuzz(_) => fuzz::albedo(cos, self.roughness),
        }
    }

    #[inline(always)]
    pub(super) fn taken(&self, cos: R) -> R {
        Float::min(self.greatest * self.albedo(cos), cos.like(1.0))
    }

    /// Its BSDF for two directions above the surface.
    #[inline(always)]
    pub(super) fn f(&self, wo: Vector<R>, wi: Vector<R>) -> Spectrum<R> {
        let f = match &self.fibres {
            Kind::Sheen(sheen) => sheen.f(wo, wi),
            Kind::Fuzz(fuzz) => fuzz.f(wi),
        };
        let f = R::select(self.exists, f, wo.z.like(0.0));
        self.color * f
    }

    /// The density of the directions that are sampled, which are above the surface.
    #[inline(always)]
    pub(super) fn pdf(&self, wi: Vector<R>) -> R {
        match &self.fibres {
            Kind::Sheen(_) => wi.z.like(sheen::PDF),
            Kind::Fuzz(fuzz) => fuzz.pdf(wi),
        }
    }

    /// A direction above the surface.
    #[inline(always)]
    pub(super) fn sample(&self, u: [R; 2]) -> Vector<R> {
        match &self.fibres {
            Kind::Sheen(_) => warp::uniform_cone(u, u[0].like(1.0)),
            Kind::Fuzz(fuzz) => fuzz.sample(u),
        }
    }
}

/// A clear coat.
#[derive(Debug)]
pub(super) struct Coat<R: Real> {
    pub(super) amount: R,
    roughness: TrowbridgeReitz<R>,
    alpha: R,
    /// The axes of the coat's frame; the last is its normal.
    frame: [Vector<R>; 3],
    /// ω_o in this frame.
    pub(super) wo: Vector<R>,
    /// Its albedo along `wo`, which attenuates the layers below; 0 where there is no coat.
    pub(super) taken: R,
}

impl<R: Real> Coat<R> {
    /// `None` where no surface has a coat.
    #[inline(always)]
    pub(super) fn new<M: Model<R>>(look: &Principled<R, M>, wo: Vector<R>) -> Option<Self> {
        let (zero, one) = (wo.z.like(0.0), wo.z.like(1.0));
        let amount = look.clearcoat;
        if !amount.gt(zero).any() {
            return None;
        }
        let roughness = look.clearcoat_roughness;
        let n = look.clearcoat_normal;
        let ((s, t), alpha) = match look.model.open_pbr() {
            None => {
                let alpha = R::select(roughness.is_smooth(), zero, Float::min(roughness.alpha_x, one));
                (warp::basis_about(n), alpha)
            }
            Some(open) => (Self::along(open.coat_tangent, n), albedo::even_alpha(roughness)),
        };
        let mut coat = Self { amount, roughness, alpha, frame: [s, t, n], wo, taken: zero };
        coat.wo = coat.local(wo);
        coat.taken = coat.taken(&look.model, coat.wo);
        Some(coat)
    }

    /// The axes about a normal, of which the first is toward a direction.
    #[inline(always)]
    fn along(direction: Vector<R>, n: Vector<R>) -> (Vector<R>, Vector<R>) {
        let (s, exists) = (direction - n * n.dot(direction)).try_normalize();
        let (other, _) = warp::basis_about(n);
        let s = Vector::select(exists, s, other);
        (s, n.cross(s))
    }

    /// The cosine of a direction to the coat's normal.
    #[inline(always)]
    pub(super) fn cosine<M>(look: &Principled<R, M>, w: Vector<R>) -> R {
        look.clearcoat_normal.dot(w)
    }

    /// Its reflectances at normal and at grazing incidence.
    #[inline(always)]
    fn fresnel<M: Model<R>>(model: &M, like: R) -> [R; 2] {
        match model.open_pbr() {
            None => [like.like(COAT_F0), like.like(1.0)],
            Some(open) => [open.coat_f0, open.coat_f90],
        }
    }

    /// Its reflectance at a cosine to a facet.
    #[inline(always)]
    fn reflectance<M: Model<R>>(model: &M, cos: R) -> R {
        match model.open_pbr() {
            None => schlick(cos) * (1.0 - COAT_F0) + COAT_F0,
            Some(open) => open.coat_f0 + (open.coat_f90 - open.coat_f0) * schlick(cos),
        }
    }

    #[inline(always)]
    pub(super) fn local(&self, w: Vector<R>) -> Vector<R> {
        let [s, t, n] = self.frame;
        Vector { x: w.dot(s), y: w.dot(t), z: w.dot(n) }
    }

    /// True where it reflects in a single direction.
    #[inline(always)]
    pub(super) fn is_sharp(&self) -> R::Mask {
        Float::eq(self.alpha, self.alpha.like(0.0))
    }

    /// Its albedo for light along a direction in its frame; 0 from behind.
    #[inline(always)]
    pub(super) fn taken<M: Model<R>>(&self, model: &M, local: Vector<R>) -> R {
        let cos = local.z;
        let (zero, one) = (cos.like(0.0), cos.like(1.0));
        let mirror = match model.open_pbr() {
            None => albedo::mirror(Float::min(cos, one), self.alpha),
            Some(_) => {
                let up = Vector { z: Float::max(cos, zero), ..local };
                albedo::reflector(up, self.roughness, self.alpha)
            }
        };
        let [f0, f90] = Self::fresnel(model, cos);
        R::select(cos.gt(zero), self.amount * mirror.of(f0, f90), zero)
    }

    /// `wi` in its frame, the half vector, and whether both directions are above it.
    #[inline(always)]
    fn facet(&self, wi: Vector<R>) -> (Vector<R>, Vector<R>, R::Mask) {
        let zero = wi.z.like(0.0);
        let wi = self.local(wi);
        let is_lit = self.wo.z.gt(zero) & wi.z.gt(zero) & !is_grazing(self.wo) & !is_grazing(wi);
        let (wm, exists) = half_vector(self.wo, wi);
        (wi, wm, exists & is_lit & !self.is_sharp())
    }

    /// Its BSDF per cosine to the normal of the surface below.
    #[inline(always)]
    pub(super) fn f<M: Model<R>>(&self, model: &M, wi: Vector<R>) -> R {
        let zero = wi.z.like(0.0);
        let (local, wm, is_lit) = self.facet(wi);
        let is_lit = is_lit & self.amount.gt(zero);
        if !is_lit.any() {
            return zero;
        }
        let fresnel = Self::reflectance(model, self.wo.dot(wm));
        let visible = self.roughness.d(wm) * self.roughness.g(self.wo, local);
        R::select(is_lit, self.amount * fresnel * visible / (self.wo.z * 4.0 * wi.z), zero)
    }

    #[inline(always)]
    pub(super) fn pdf(&self, wi: Vector<R>) -> R {
        let (_, wm, is_lit) = self.facet(wi);
        let pdf = self.roughness.visible_per_cosine(self.wo, wm) * 0.25;
        R::select(is_lit, pdf, wi.z.like(0.0))
    }

    /// Samples a direction above the coat and above the surface; also whether there is one.
    #[inline(always)]
    pub(super) fn sample(&self, u: [R; 2]) -> (Vector<R>, R::Mask) {
        let (zero, one) = (self.alpha.like(0.0), self.alpha.like(1.0));
        let up = Vector { x: zero, y: zero, z: one };
        let wm = Vector::select(self.is_sharp(), up, self.roughness.sample(self.wo, u));
        let local = optics::reflect(self.wo, wm);
        let [s, t, n] = self.frame;
        let wi = (s * local.x + t * local.y + n * local.z).normalize();
        let is_above = local.z.gt(zero) & wi.z.gt(zero) & !is_grazing(wi);
        (wi, is_above & self.wo.z.gt(zero) & !is_grazing(self.wo))
    }
}

impl Coat<f32> {
    /// The factors of its facets, with ω_m in the frame of the surface; `None` where it is smooth, or not lit.
    pub(super) fn factors<M: Model<f32>>(&self, model: &M, wi: Vector<f32>) -> Option<MicrofacetFactors> {
        let (local, wm, is_lit) = self.facet(wi);
        let cos_m = [self.wo.dot(wm), local.dot(wm)];
        let fresnel = Spectrum::splat(Self::reflectance(model, cos_m[0]));
        let [s, t, n] = self.frame;
        is_lit.then(|| MicrofacetFactors {
            boundary: "clear coat",
            refracts: false,
            roughness: self.roughness,
            wm: (s * wm.x + t * wm.y + n * wm.z).into(),
            cos: [self.wo.z, wi.z],
            cos_m,
            d: Some(self.roughness.d(wm)),
            g: Some(self.roughness.g(self.wo, local)),
            fresnel,
            part: fresnel,
            eta: 1.0,
            weight: self.amount,
            multiple_scattering: None,
        })
    }
}
