//! Eight principled surfaces side by side.

use lookfrom_simd::{Simd, f32x8, prelude::*};

use super::film::ThinFilm;
use super::open_pbr::OpenPbr;
use super::{Gltf, Principled};
use crate::core::lanes::{LANES, by_lane, gather, gather_spectrum};
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;

impl<S: Simd> Principled<f32x8<S>> {
    /// One in each lane. Films are all of colours or all of wavelengths.
    #[inline(always)]
    pub(in crate::shading::bsdf) fn gather_rows(simd: S, rows: &[&Principled; LANES]) -> Self {
        Self::gathered(simd, rows, Gltf)
    }
}

impl<S: Simd> Principled<f32x8<S>, OpenPbr<f32x8<S>>> {
    /// One of OpenPBR in each lane.
    #[inline(always)]
    pub(in crate::shading::bsdf) fn gather_open_pbr(
        simd: S,
        rows: &[&Principled<f32, OpenPbr>; LANES],
    ) -> Self {
        macro_rules! load {
            ($($field:tt)*) => { f32x8::load_array(simd, by_lane!(lane => rows[lane].$($field)*)) };
        }
        macro_rules! spectrum {
            ($field:ident) => { gather_spectrum(simd, &by_lane!(lane => rows[lane].model.$field)) };
        }
        let model = OpenPbr {
            specular_color: spectrum!(specular_color),
            specular_weight: load!(model.specular_weight),
            transmission_color: spectrum!(transmission_color),
            diffuse_roughness: load!(model.diffuse_roughness),
            coat_color: spectrum!(coat_color),
            coat_eta: load!(model.coat_eta),
            coat_f0: load!(model.coat_f0),
            coat_f90: load!(model.coat_f90),
            coat_tangent: gather(simd, &by_lane!(lane => rows[lane].model.coat_tangent.into())),
            coat_darkening: load!(model.coat_darkening),
            darkened: spectrum!(darkened),
        };
        let clearcoat_roughness = TrowbridgeReitz {
            alpha_x: load!(clearcoat_roughness.alpha_x),
            alpha_y: load!(clearcoat_roughness.alpha_y),
        };
        Self { clearcoat_roughness, ..Self::gathered(simd, rows, model) }
    }
}

impl<S: Simd, M> Principled<f32x8<S>, M> {
    /// One in each lane, with the same roughness along both axes of the coat.
    #[inline(always)]
    fn gathered<N>(simd: S, rows: &[&Principled<f32, N>; LANES], model: M) -> Self {
        macro_rules! load {
            ($($field:tt)*) => { f32x8::load_array(simd, by_lane!(lane => rows[lane].$($field)*)) };
        }
        macro_rules! spectrum {
            ($field:ident) => { gather_spectrum(simd, &by_lane!(lane => rows[lane].$field)) };
        }
        let coat_alpha = load!(clearcoat_roughness.alpha_x);
        let solid = f32x8::load_array(simd, by_lane!(lane => if rows[lane].is_solid { 1.0 } else { 0.0 }));
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
            clearcoat_normal: gather(simd, &by_lane!(lane => rows[lane].clearcoat_normal.into())),
            sheen_color: spectrum!(sheen_color),
            sheen_greatest: load!(sheen_greatest),
            sheen_roughness: load!(sheen_roughness),
            iridescence: load!(iridescence),
            film: gather_films(simd, &by_lane!(lane => rows[lane].film)),
            lane_weights: spectrum!(lane_weights),
            model,
        }
    }
}

#[inline(always)]
fn gather_films<S: Simd>(simd: S, films: &[ThinFilm; LANES]) -> ThinFilm<f32x8<S>> {
    let lambda = by_lane!(lane => Spectrum(films[lane].wavelengths.unwrap_or_default()));
    let wavelengths = gather_spectrum(simd, &lambda);
    ThinFilm {
        eta: f32x8::load_array(simd, by_lane!(lane => films[lane].eta)),
        thickness: f32x8::load_array(simd, by_lane!(lane => films[lane].thickness)),
        wavelengths: (!wavelengths.is_black()).any_true().then_some(wavelengths.0),
    }
}
