//! The base of a principled surface: a microfacet boundary over a metal, a diffuse body or a transmissive one.

use lookfrom_simd::{Float, Mask, Real};

use super::film::ThinFilm;
use super::{Model, Principled};
use crate::core::math::schlick;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::bsdf::albedo::{self, Split};
use crate::shading::bsdf::fresnel;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;

/// The cosine at which the film's reflectance stands for its mean.
pub(super) const MEAN_COSINE: f32 = 0.7;

/// The base under coat and sheen.
#[derive(Debug)]
pub(super) struct Surface<R: Real, M> {
    pub(super) model: M,
    pub(super) base: Spectrum<R>,
    pub(super) f0: Spectrum<R>,
    f0_greatest: R,
    pub(super) f90: R,
    pub(super) metal: R,
    /// Weights of the diffuse and the transmissive body in the whole surface.
    pub(super) matte: R,
    pub(super) glass: R,
    /// Diffuse transmission of the diffuse body.
    pub(super) leaf: R,
    pub(super) leaf_color: Spectrum<R>,
    pub(super) roughness: TrowbridgeReitz<R>,
    /// √(α_x α_y); 0 where it is smooth.
    pub(super) alpha: R,
    /// Index of refraction, inside over outside.
    pub(super) eta: R,
    pub(super) is_solid: R::Mask,
    /// Its weight and itself; `None` where no surface has one.
    film: Option<(R, ThinFilm<R>)>,
    /// The dielectric's mean reflectance with the film.
    filmed: Spectrum<R>,
    /// The mean albedo of the specular layer, and the mean fraction that it leaves for the body below.
    pub(super) mean: Split<R>,
    pub(super) mean_left: Spectrum<R>,
}

/// Reflected and transmitted light of a facet.
#[derive(Debug)]
pub(super) struct Facet<R> {
    pub(super) mirrored: Spectrum<R>,
    pub(super) passed: Spectrum<R>,
}

/// Between a reflectance at normal and one at grazing incidence.
#[inline(always)]
fn toward<R: Real>(f0: Spectrum<R>, f90: R, s: R) -> Spectrum<R> {
    f0 + (Spectrum::splat(f90) - f0) * s
}

impl<R: Real, M: Model<R>> Surface<R, M> {
    #[inline(always)]
    pub(super) fn new(look: &Principled<R, M>) -> Self {
        let roughness = look.roughness;
        let (zero, one) = (look.eta.like(0.0), look.eta.like(1.0));
        let black = Spectrum::splat(zero);
        let alpha = albedo::even_alpha(roughness);
        let body = one - look.metallic;
        let iridescence = look.iridescence * look.film.presence();
        let mut surface = Self {
            model: look.model,
            base: look.base_color,
            f0: look.f0,
            f0_greatest: look.f0_greatest,
            f90: look.f90,
            metal: look.metallic,
            matte: body * (one - look.transmission),
            glass: body * look.transmission,
            leaf: look.diffuse_transmission,
            leaf_color: look.diffuse_transmission_color,
            roughness,
            alpha,
            eta: look.eta,
            is_solid: look.is_solid,
            film: iridescence.gt(zero).any().then_some((iridescence, look.film)),
            mean: albedo::reflector_mean(roughness, alpha),
            filmed: black,
            mean_left: black,
        };
        if surface.matte.gt(zero).any() {
            let cos = zero.like(MEAN_COSINE);
            if let Some((_, film)) = &surface.film {
                surface.filmed = film.fresnel(cos, surface.f0);
            }
            surface.mean_left = surface.left(cos, surface.mean);
        }
        surface
    }

    /// The specular albedo for a Fresnel term, along a direction above the surface.
    #[inline(always)]
    pub(super) fn mirror(&self, up: Vector<R>) -> Split<R> {
        albedo::reflector(up, self.roughness, self.alpha)
    }

    /// The reflectance with the film, for the reflectance `f0` at normal incidence and `plain`
    /// without the film.
    #[inline(always)]
    pub(super) fn under_film(&self, cos: R, f0: Spectrum<R>, plain: Spectrum<R>) -> Spectrum<R> {
        match &self.film {
            Some((amount, film)) => plain * (amount.like(1.0) - *amount) + film.fresnel(cos, f0) * *amount,
            None => plain,
        }
    }

    /// The fraction of the light that this layer's albedo leaves for the body below.
    #[inline(always)]
    pub(super) fn left(&self, cos: R, split: Split<R>) -> Spectrum<R> {
        let (zero, one) = (cos.like(0.0), cos.like(1.0));
        let hidden = one - split.all();
        let mean = self.mean.all();
        let again = albedo::multiple(self.f0_greatest + (self.f90 - self.f0_greatest) / 21.0, mean);
        let plain = Float::max(one - split.of(self.f0_greatest, self.f90) - again * hidden, zero);
        let Some((amount, film)) = &self.film else { return Spectrum::splat(plain) };
        let is_mean = Float::eq(cos, cos.like(MEAN_COSINE)).all();
        let here = if is_mean { self.filmed } else { film.fresnel(cos, self.f0) };
        let filmed = here.zip(
            self.filmed,
            #[inline(always)]
            |here, around| {
                Float::max(one - here * split.all() - albedo::multiple(around, mean) * hidden, zero)
            },
        );
        filmed * *amount + Spectrum::splat(plain * (one - *amount))
    }

    /// Reflection and transmission of the glass at a cosine to a facet, on the side of `wo`. Not inlined, since it is
    /// needed in many places.
    #[inline(never)]
    pub(super) fn pane(&self, cos: R, is_inside: R::Mask) -> Facet<R> {
        cos.at_level(
            #[inline(always)]
            || self.pane_of(cos, is_inside),
        )
    }

    #[inline(always)]
    fn pane_of(&self, cos: R, is_inside: R::Mask) -> Facet<R> {
        let (zero, one) = (cos.like(0.0), cos.like(1.0));
        // Of the two angles, the one on the side of the lower index counts: outside, unless the body's index is
        // lower than that of its surroundings.
        let bends = self.is_solid & self.bends();
        let eta = R::select(bends & self.eta.lt(one), one / self.eta, self.eta);
        let is_dense = self.eta.gt(one);
        let is_beyond = bends & is_inside.choose(is_dense, !is_dense);
        let sin2 = eta * eta * Float::max(one - cos * cos, zero);
        let is_total = is_beyond & !sin2.lt(one);
        let cos = R::select(is_beyond, Float::sqrt(one - sin2), cos);
        // Fresnel's curve rescaled to 0 … 1.
        let straight = ((eta - 1.0) / (eta + 1.0)) * ((eta - 1.0) / (eta + 1.0));
        let curve = (fresnel::dielectric(cos, eta) - straight) / Float::max(one - straight, one.like(1e-6));
        let s = R::select(Float::eq(eta, zero), schlick(cos), curve);
        let s = Float::clamp(s, 0.0, 1.0);
        let plain = self.gloss(s);
        let left = one - (self.f0_greatest + (self.f90 - self.f0_greatest) * s);
        let (mirrored, passed) = match &self.film {
            None => (plain, Spectrum::splat(left)),
            Some((amount, film)) => {
                let filmed = film.fresnel(cos, self.f0);
                let (plainly, ones) = (one - *amount, Spectrum::splat(one));
                let passed = Spectrum::splat(left * plainly) + (ones - filmed) * *amount;
                (plain * plainly + filmed * *amount, passed)
            }
        };
        Facet {
            mirrored: Spectrum::select(is_total, Spectrum::splat(one), mirrored),
            passed: Spectrum::select(is_total, Spectrum::splat(zero), passed),
        }
    }

    /// The dielectric's reflectance without the film, by the weight of grazing incidence. glTF's colour is that at normal incidence,
    /// OpenPBR's is of all.
    #[inline(always)]
    pub(super) fn gloss(&self, s: R) -> Spectrum<R> {
        match self.model.open_pbr() {
            None => toward(self.f0, self.f90, s),
            Some(open) => open.specular_color * (self.f0_greatest + (self.f90 - self.f0_greatest) * s),
        }
    }

    /// The colour of light that the transmissive body passes on.
    #[inline(always)]
    pub(super) fn tint(&self) -> Spectrum<R> {
        match self.model.open_pbr() {
            None => self.base,
            Some(open) => open.transmission_color,
        }
    }

    /// True if the body refracts.
    #[inline(always)]
    pub(super) fn bends(&self) -> R::Mask {
        !Float::eq(self.eta, self.eta.like(1.0)) & !Float::eq(self.eta, self.eta.like(0.0))
    }

    /// True if it has no facets.
    #[inline(always)]
    pub(super) fn is_smooth(&self) -> R::Mask {
        Float::eq(self.alpha, self.alpha.like(0.0))
    }

    /// True if a part of it is transmissive.
    #[inline(always)]
    pub(super) fn has_glass(&self) -> R::Mask {
        self.glass.gt(self.glass.like(0.0))
    }

    /// True if a part of it is diffuse.
    #[inline(always)]
    pub(super) fn has_matte(&self) -> R::Mask {
        self.matte.gt(self.matte.like(0.0))
    }

    /// True if transmission is specular.
    #[inline(always)]
    pub(super) fn passes_sharply(&self) -> R::Mask {
        self.is_smooth() | (self.is_solid & !self.bends())
    }

    /// True if it is a rough refractive body, where each facet refracts into a direction of its own.
    #[inline(always)]
    pub(super) fn is_rough_body(&self) -> R::Mask {
        !self.is_smooth() & self.has_glass() & self.is_solid & self.bends()
    }

    /// Weighted reflectance of the metal and of the specular layer over the diffuse body at a cosine.
    #[inline(always)]
    fn opaque(&self, cos: R) -> Spectrum<R> {
        let (zero, one) = (cos.like(0.0), cos.like(1.0));
        let s = schlick(cos);
        let mut mirrored = Spectrum::splat(zero);
        if self.metal.gt(zero).any() {
            let plain = toward(self.base, one, s);
            mirrored += match self.model.open_pbr() {
                None => self.under_film(cos, self.base, plain) * self.metal,
                Some(open) => {
                    let tinted = open.tinted_metal(cos, self.base, plain);
                    self.under_film(cos, self.base, tinted) * (self.metal * open.specular_weight)
                }
            };
        }
        if self.has_matte().any() {
            mirrored += self.under_film(cos, self.f0, self.gloss(s)) * self.matte;
        }
        mirrored
    }

    /// Reflection and transmission of a facet at a cosine, each with its weights and tint.
    #[inline(always)]
    pub(super) fn facet(&self, cos: R, is_inside: R::Mask) -> Facet<R> {
        self.facet_with(self.glass, cos, is_inside)
    }

    /// A facet for another weight of the transmissive part. Not inlined, since it is needed in many places.
    #[inline(never)]
    pub(super) fn facet_with(&self, glass: R, cos: R, is_inside: R::Mask) -> Facet<R> {
        cos.at_level(
            #[inline(always)]
            || {
                let mut mirrored = self.opaque(cos);
                let mut passed = Spectrum::splat(cos.like(0.0));
                if glass.gt(cos.like(0.0)).any() {
                    let pane = self.pane(cos, is_inside);
                    mirrored += pane.mirrored * glass;
                    passed = pane.passed * self.tint() * glass;
                }
                Facet { mirrored, passed }
            },
        )
    }
}
