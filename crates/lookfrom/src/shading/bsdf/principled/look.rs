//! The parameters of principled surfaces at any width.

use lookfrom_simd::{Real, Simd, f32x8, prelude::*};

use super::film::Film;
use super::{Parameters, Principled};
use crate::core::lanes::{LANES, by_lane, gather, gather_spectrum};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;

/// As [`Parameters`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look<R: Real = f32> {
    pub(super) base_color: Spectrum<R>,
    pub(super) metallic: R,
    pub(super) roughness: TrowbridgeReitz<R>,
    pub(super) eta: R,
    pub(super) f0: Spectrum<R>,
    pub(super) f0_greatest: R,
    pub(super) f90: R,
    pub(super) transmission: R,
    pub(super) is_solid: R::Mask,
    pub(super) diffuse_transmission: R,
    pub(super) diffuse_transmission_color: Spectrum<R>,
    pub(super) clearcoat: R,
    pub(super) clearcoat_roughness: TrowbridgeReitz<R>,
    pub(super) clearcoat_normal: Vector<R>,
    pub(super) sheen_color: Spectrum<R>,
    pub(super) sheen_greatest: R,
    pub(super) sheen_roughness: R,
    pub(super) iridescence: R,
    pub(super) film: Film<R>,
    pub(super) lane_weights: Spectrum<R>,
}

impl Look {
    #[inline]
    pub(super) fn new(look: &Principled) -> Self {
        let p = look.parameters();
        Self {
            base_color: p.base_color,
            metallic: p.metallic,
            roughness: p.roughness,
            eta: p.eta,
            f0: p.f0,
            f0_greatest: p.f0_greatest,
            f90: p.f90,
            transmission: p.transmission,
            is_solid: p.is_solid,
            diffuse_transmission: p.diffuse_transmission,
            diffuse_transmission_color: p.diffuse_transmission_color,
            clearcoat: p.clearcoat,
            clearcoat_roughness: p.clearcoat_roughness,
            clearcoat_normal: p.clearcoat_normal.into(),
            sheen_color: p.sheen_color,
            sheen_greatest: p.sheen_greatest,
            sheen_roughness: p.sheen_roughness,
            iridescence: p.iridescence,
            film: p.film,
            lane_weights: p.lane_weights,
        }
    }
}

impl<R: Real> Look<R> {
    /// True if there is a lobe that is not specular.
    #[inline(always)]
    pub(super) fn has_density(&self) -> R::Mask {
        let (zero, one) = (self.metallic.like(0.0), self.metallic.like(1.0));
        let is_diffuse = self.metallic.lt(one) & self.transmission.lt(one);
        let has_coat = self.clearcoat.gt(zero) & !self.clearcoat_roughness.is_smooth();
        !self.roughness.is_smooth() | is_diffuse | has_coat | !self.sheen_color.is_black()
    }
}

impl<S: Simd> Look<f32x8<S>> {
    /// One in each lane. Films are all of colours or all of wavelengths.
    #[inline(always)]
    pub(crate) fn gather(simd: S, rows: &[&Principled; LANES]) -> Self {
        let p: [Parameters; LANES] = by_lane!(lane => rows[lane].parameters());
        macro_rules! load {
            ($($field:tt)*) => { f32x8::load_array(simd, by_lane!(lane => p[lane].$($field)*)) };
        }
        macro_rules! spectrum {
            ($field:ident) => { gather_spectrum(simd, &by_lane!(lane => p[lane].$field)) };
        }
        let coat_alpha = load!(clearcoat_roughness.alpha_x);
        let solid = f32x8::load_array(simd, by_lane!(lane => if p[lane].is_solid { 1.0 } else { 0.0 }));
        Self {
            base_color: spectrum!(base_color),
            metallic: load!(metallic),
            roughness: TrowbridgeReitz {
                alpha_x: load!(roughness.alpha_x),
                alpha_y: load!(roughness.alpha_y),
            },
            eta: load!(eta),
            f0: spectrum!(f0),
            f0_greatest: load!(f0_greatest),
            f90: load!(f90),
            transmission: load!(transmission),
            is_solid: solid.simd_gt(0.0),
            diffuse_transmission: load!(diffuse_transmission),
            diffuse_transmission_color: spectrum!(diffuse_transmission_color),
            clearcoat: load!(clearcoat),
            clearcoat_roughness: TrowbridgeReitz { alpha_x: coat_alpha, alpha_y: coat_alpha },
            clearcoat_normal: gather(simd, &by_lane!(lane => p[lane].clearcoat_normal.to_array())),
            sheen_color: spectrum!(sheen_color),
            sheen_greatest: load!(sheen_greatest),
            sheen_roughness: load!(sheen_roughness),
            iridescence: load!(iridescence),
            film: gather_films(simd, &by_lane!(lane => p[lane].film)),
            lane_weights: spectrum!(lane_weights),
        }
    }
}

#[inline(always)]
fn gather_films<S: Simd>(simd: S, films: &[Film; LANES]) -> Film<f32x8<S>> {
    let lambda = by_lane!(lane => Spectrum(films[lane].wavelengths.unwrap_or_default()));
    let wavelengths = gather_spectrum(simd, &lambda);
    Film {
        eta: f32x8::load_array(simd, by_lane!(lane => films[lane].eta)),
        thickness: f32x8::load_array(simd, by_lane!(lane => films[lane].thickness)),
        wavelengths: (!wavelengths.is_black()).any_true().then_some(wavelengths.0),
    }
}
