//! The base of a principled surface: a microfacet boundary over a metal, a diffuse body or a transmissive one.

use super::albedo::{self, Split};
use super::{Film, Principled};
use crate::core::math::schlick;
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::fresnel;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;

/// The cosine at which the film's reflectance stands for its mean.
pub(super) const MEAN_COSINE: f32 = 0.7;

/// The base under coat and sheen.
pub(super) struct Surface {
    pub(super) base: Spectrum,
    pub(super) f0: Spectrum,
    pub(super) f0_greatest: f32,
    pub(super) f90: f32,
    pub(super) metal: f32,
    /// Weights of the diffuse and the transmissive body in the whole surface.
    pub(super) matte: f32,
    pub(super) glass: f32,
    /// Diffuse transmission of the diffuse body.
    pub(super) leaf: f32,
    pub(super) leaf_color: Spectrum,
    pub(super) roughness: TrowbridgeReitz,
    /// α of the isotropic reflector with the same albedo.
    pub(super) alpha: f32,
    /// Index of refraction, inside over outside.
    pub(super) eta: f32,
    pub(super) is_solid: bool,
    pub(super) film: Option<(f32, Film)>,
    /// The dielectric's mean reflectance with the film.
    pub(super) filmed: Spectrum,
    /// The mean albedo of the specular layer, and the mean fraction that it leaves for the body below.
    pub(super) mean: Split,
    pub(super) mean_left: Spectrum,
}

/// Reflected and transmitted light of a facet.
pub(super) struct Facet {
    pub(super) mirrored: Spectrum,
    pub(super) passed: Spectrum,
}

/// The energy of multiple scattering between facets, by the mean Fresnel reflectance and the mean albedo of one
/// bounce.
pub(super) fn multiple(fresnel: f32, mean: f32) -> f32 {
    fresnel * fresnel * mean / (1.0 - fresnel * (1.0 - mean))
}

impl Surface {
    pub(super) fn new(look: &Principled) -> Self {
        let p = look.parameters();
        let roughness = p.roughness;
        let alpha =
            if roughness.is_smooth() { 0.0 } else { (roughness.alpha_x * roughness.alpha_y).sqrt().min(1.0) };
        let body = 1.0 - p.metallic;
        let mut surface = Self {
            base: p.base_color,
            f0: p.f0,
            f0_greatest: p.f0_greatest,
            f90: p.f90,
            metal: p.metallic,
            matte: body * (1.0 - p.transmission),
            glass: body * p.transmission,
            leaf: p.diffuse_transmission,
            leaf_color: p.diffuse_transmission_color,
            roughness,
            alpha,
            eta: p.eta,
            is_solid: p.is_solid,
            film: (p.iridescence > 0.0).then_some((p.iridescence, p.film)),
            mean: if alpha == 0.0 { albedo::SMOOTH_MEAN } else { albedo::mirror_mean(alpha) },
            filmed: Spectrum::BLACK,
            mean_left: Spectrum::BLACK,
        };
        if let Some((_, film)) = &surface.film
            && surface.matte > 0.0
        {
            surface.filmed = film.fresnel(MEAN_COSINE, surface.f0);
        }
        if surface.matte > 0.0 {
            surface.mean_left = surface.left(MEAN_COSINE, surface.mean);
        }
        surface
    }

    /// The reflectance with the film, for the reflectance `f0` at normal incidence and `plain`
    /// without the film.
    #[inline]
    pub(super) fn under_film(&self, cos: f32, f0: Spectrum, plain: Spectrum) -> Spectrum {
        match &self.film {
            Some((amount, film)) => plain * (1.0 - amount) + film.fresnel(cos, f0) * *amount,
            None => plain,
        }
    }

    /// Reflectance of the metal.
    #[inline]
    pub(super) fn metal(&self, cos: f32) -> Spectrum {
        let s = schlick(cos);
        self.under_film(cos, self.base, self.base.map(|f0| f0 + (1.0 - f0) * s))
    }

    /// Reflectance of the specular layer over the diffuse body.
    #[inline]
    pub(super) fn lacquer(&self, cos: f32) -> Spectrum {
        let s = schlick(cos);
        self.under_film(cos, self.f0, self.f0.map(|f0| f0 + (self.f90 - f0) * s))
    }

    /// The fraction of the light that this layer's albedo leaves for the body below.
    pub(super) fn left(&self, cos: f32, split: Split) -> Spectrum {
        let hidden = 1.0 - split.all();
        let mean = self.mean.all();
        let plain = {
            let again = multiple(self.f0_greatest + (self.f90 - self.f0_greatest) / 21.0, mean);
            1.0 - split.of(self.f0_greatest, self.f90) - again * hidden
        };
        let plain = plain.max(0.0);
        match &self.film {
            None => Spectrum([plain; 4]),
            Some((amount, film)) => {
                let here = if cos == MEAN_COSINE { self.filmed } else { film.fresnel(cos, self.f0) };
                let filmed = here.zip(self.filmed, |here, around| {
                    (1.0 - here * split.all() - multiple(around, mean) * hidden).max(0.0)
                });
                filmed * *amount + Spectrum([plain * (1.0 - amount); 4])
            }
        }
    }

    /// Reflection and transmission of the glass at a cosine to a facet, on the side of `wo`.
    pub(super) fn pane(&self, cos: f32, is_inside: bool) -> Facet {
        // Of the two angles, the one on the side of the lower index counts: outside, unless the body's index is
        // lower than that of its surroundings.
        let bends = self.is_solid && self.bends();
        let eta = if bends && self.eta < 1.0 { 1.0 / self.eta } else { self.eta };
        let cos = if bends && is_inside == (self.eta > 1.0) {
            let sin2 = eta * eta * (1.0 - cos * cos).max(0.0);
            if sin2 >= 1.0 {
                return Facet { mirrored: Spectrum([1.0; 4]), passed: Spectrum::BLACK };
            }
            (1.0 - sin2).sqrt()
        } else {
            cos
        };
        // Fresnel's curve rescaled to 0 … 1.
        let s = if eta == 0.0 {
            schlick(cos)
        } else {
            let straight = ((eta - 1.0) / (eta + 1.0)) * ((eta - 1.0) / (eta + 1.0));
            (fresnel::dielectric(cos, eta) - straight) / (1.0 - straight).max(1e-6)
        };
        let s = s.clamp(0.0, 1.0);
        let of = |f0: f32| f0 + (self.f90 - f0) * s;
        let (mirrored, passed) = (self.f0.map(of), 1.0 - of(self.f0_greatest));
        match &self.film {
            None => Facet { mirrored, passed: Spectrum([passed; 4]) },
            Some((amount, film)) => {
                let filmed = film.fresnel(cos, self.f0);
                Facet {
                    mirrored: mirrored * (1.0 - amount) + filmed * *amount,
                    passed: filmed.map(|f| passed * (1.0 - amount) + (1.0 - f) * amount),
                }
            }
        }
    }

    /// True if the body refracts.
    #[inline]
    pub(super) fn bends(&self) -> bool {
        self.eta != 1.0 && self.eta != 0.0
    }

    /// True if transmission is specular.
    #[inline]
    pub(super) fn passes_sharply(&self) -> bool {
        self.alpha == 0.0 || (self.is_solid && !self.bends())
    }

    /// True if it is a rough refractive body, where each facet refracts into a direction of its own.
    #[inline]
    pub(super) fn is_rough_body(&self) -> bool {
        self.alpha > 0.0 && self.glass > 0.0 && self.is_solid && self.bends()
    }

    /// Weighted reflectance of the metal and of the specular layer over the diffuse body at a cosine.
    pub(super) fn opaque(&self, cos: f32) -> Spectrum {
        let mut mirrored = Spectrum::BLACK;
        if self.metal > 0.0 {
            mirrored += self.metal(cos) * self.metal;
        }
        if self.matte > 0.0 {
            mirrored += self.lacquer(cos) * self.matte;
        }
        mirrored
    }

    /// Reflection and transmission of a facet at a cosine, each with its weights and tint.
    pub(super) fn facet(&self, cos: f32, is_inside: bool) -> Facet {
        let mut mirrored = self.opaque(cos);
        let mut passed = Spectrum::BLACK;
        if self.glass > 0.0 {
            let pane = self.pane(cos, is_inside);
            mirrored += pane.mirrored * self.glass;
            passed = pane.passed * self.base * self.glass;
        }
        Facet { mirrored, passed }
    }
}
