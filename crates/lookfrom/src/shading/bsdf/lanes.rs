//! BSDFs of eight paths side by side: what the path tracer asks of a class of them, and how their rows are gathered.

use lookfrom_simd::{Real, Simd, f32x8, prelude::*};

use super::conductor::Conductor;
use super::dielectric::{Dielectric, Mode};
use super::diffuse::{Diffuse, DiffuseTransmission};
use super::henyey_greenstein::HenyeyGreenstein;
use super::layered::{Base, DiffuseInterior, Layered};
use super::lobes::Lobes;
use super::microfacet::{Microfacets, TrowbridgeReitz};
use super::open_pbr::OpenPbrSurface;
use super::principled::Principled;
use super::principled::open_pbr::OpenPbr;
use super::{DirectionSample, ScatteringFunction, Variant};
use crate::core::lanes::{LANES, by_lane, gather_spectrum};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// Properties that all BSDFs of a class have in common.
#[derive(Clone, Copy, Debug)]
pub struct ClassTraits {
    /// As [`super::BsdfSample::pdf_is_proportional`].
    pub pdf_is_proportional: bool,
    /// Whether sampling takes a number to choose a lobe.
    pub needs_lobe: bool,
    /// Whether light passes only between directions for which the geometric and the shading normal agree whether they
    /// are on one side. pbrt's materials do without this test.
    pub needs_agreement: bool,
}

impl ClassTraits {
    /// The properties of most classes.
    pub const PLAIN: Self = Self { pdf_is_proportional: false, needs_lobe: true, needs_agreement: false };
}

/// BSDFs of one class at any width, for paths from the camera. Directions are those of [`Bsdf`](super::Bsdf).
pub trait LaneBsdf<R: Real> {
    /// A BSDF seen from an outgoing direction, computed once: that direction itself, where there is nothing to compute.
    type Prepared;

    /// The properties of the class.
    #[inline(always)]
    fn traits(&self) -> ClassTraits {
        ClassTraits::PLAIN
    }
    /// The BSDF prepared for the outgoing direction `wo`, which the other methods take.
    fn prepare(&self, wo: Vector<R>) -> Self::Prepared;
    /// As [`Bsdf::f`](super::Bsdf::f).
    fn f(&self, prepared: &Self::Prepared, wi: Vector<R>) -> Spectrum<R>;
    /// As [`Bsdf::pdf`](super::Bsdf::pdf).
    fn pdf(&self, prepared: &Self::Prepared, wi: Vector<R>) -> R;
    /// [`Self::f`] and [`Self::pdf`]; the density means nothing where the value is black.
    #[inline(always)]
    fn f_and_pdf(&self, prepared: &Self::Prepared, wi: Vector<R>) -> (Spectrum<R>, R) {
        (self.f(prepared, wi), self.pdf(prepared, wi))
    }
    /// As [`Bsdf::sample`](super::Bsdf::sample).
    fn sample(&self, prepared: &Self::Prepared, uc: R, u: [R; 2]) -> DirectionSample<R>;
    /// True if there is a lobe that is not specular.
    fn has_density(&self) -> R::Mask;
    /// The share of diffuse lobes in the value `f` for light from `wi`, 0 … 1 by lane of the spectrum; glossy ones have the
    /// rest. Sheen counts as diffuse, and so does what is scattered between a coat and a diffuse base.
    #[inline(always)]
    fn diffuse_share(&self, _prepared: &Self::Prepared, wi: Vector<R>, _f: Spectrum<R>) -> Spectrum<R> {
        Spectrum::splat(wi.z.like(0.0))
    }
}

/// A class of BSDFs, as scalars.
pub(crate) trait RowBsdf: Variant + ScatteringFunction {
    /// Eight of them.
    type Lanes<S: Simd>: LaneBsdf<f32x8<S>>;

    /// One in each lane.
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S>;
}

impl<R: Real> LaneBsdf<R> for Dielectric<R> {
    type Prepared = Vector<R>;

    #[inline(always)]
    fn prepare(&self, wo: Vector<R>) -> Vector<R> {
        wo
    }
    #[inline(always)]
    fn f(&self, &wo: &Vector<R>, wi: Vector<R>) -> Spectrum<R> {
        self.f(wo, wi, Mode::Radiance)
    }
    #[inline(always)]
    fn pdf(&self, &wo: &Vector<R>, wi: Vector<R>) -> R {
        self.pdf(wo, wi, Lobes::ALL)
    }
    #[inline(always)]
    fn sample(&self, &wo: &Vector<R>, uc: R, u: [R; 2]) -> DirectionSample<R> {
        self.sample(wo, uc, u, Mode::Radiance, Lobes::ALL)
    }
    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        !self.is_specular()
    }
}

impl<R: Real, B: Base<R>> LaneBsdf<R> for Layered<B, R> {
    type Prepared = Vector<R>;

    #[inline(always)]
    fn traits(&self) -> ClassTraits {
        ClassTraits { pdf_is_proportional: true, ..ClassTraits::PLAIN }
    }
    #[inline(always)]
    fn prepare(&self, wo: Vector<R>) -> Vector<R> {
        wo
    }
    #[inline(always)]
    fn f(&self, &wo: &Vector<R>, wi: Vector<R>) -> Spectrum<R> {
        self.f(wo, wi)
    }
    #[inline(always)]
    fn pdf(&self, &wo: &Vector<R>, wi: Vector<R>) -> R {
        self.pdf(wo, wi)
    }
    #[inline(always)]
    fn sample(&self, &wo: &Vector<R>, uc: R, u: [R; 2]) -> DirectionSample<R> {
        self.sample(wo, uc, u)
    }
    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        self.has_density()
    }
    #[inline(always)]
    fn diffuse_share(&self, &wo: &Vector<R>, wi: Vector<R>, f: Spectrum<R>) -> Spectrum<R> {
        let below = self.base.diffuse_share(&self.base.prepare(wo), wi, f);
        let glossy = Spectrum::splat(self.off_the_coat(wo, wi)).share_of(f);
        below * (Spectrum::splat(wo.z.like(1.0)) - glossy)
    }
}

#[inline(always)]
pub(super) fn gather_microfacets<S: Simd>(simd: S, rows: &[Microfacets; LANES]) -> Microfacets<f32x8<S>> {
    Microfacets {
        alpha: TrowbridgeReitz {
            alpha_x: f32x8::load_array(simd, by_lane!(lane => rows[lane].alpha.alpha_x)),
            alpha_y: f32x8::load_array(simd, by_lane!(lane => rows[lane].alpha.alpha_y)),
        },
        kind: f32x8::load_array(simd, by_lane!(lane => rows[lane].kind)),
    }
}

#[inline(always)]
fn gather_interior<S: Simd>(simd: S, rows: &[&DiffuseInterior; LANES]) -> DiffuseInterior<f32x8<S>> {
    DiffuseInterior {
        internal_reflectance: f32x8::load_array(simd, by_lane!(lane => rows[lane].internal_reflectance)),
        has_transmission: f32x8::load_array(simd, by_lane!(lane => rows[lane].has_transmission)),
        transmission: std::array::from_fn(
            #[inline(always)]
            |k| f32x8::load_array(simd, by_lane!(lane => rows[lane].transmission[k])),
        ),
    }
}

#[inline(always)]
fn gather_nothing<S: Simd>(_: S, _: &[&(); LANES]) {}

impl RowBsdf for Diffuse {
    type Lanes<S: Simd> = Diffuse<f32x8<S>>;

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        Diffuse { reflectance: gather_spectrum(simd, &by_lane!(lane => rows[lane].reflectance)) }
    }
}

impl RowBsdf for DiffuseTransmission {
    type Lanes<S: Simd> = DiffuseTransmission<f32x8<S>>;

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        DiffuseTransmission {
            reflectance: gather_spectrum(simd, &by_lane!(lane => rows[lane].reflectance)),
            transmittance: gather_spectrum(simd, &by_lane!(lane => rows[lane].transmittance)),
        }
    }
}

impl RowBsdf for Conductor {
    type Lanes<S: Simd> = Conductor<f32x8<S>>;

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        Conductor {
            eta: gather_spectrum(simd, &by_lane!(lane => rows[lane].eta)),
            k: gather_spectrum(simd, &by_lane!(lane => rows[lane].k)),
            roughness: gather_microfacets(simd, &by_lane!(lane => rows[lane].roughness)),
            specular: gather_spectrum(simd, &by_lane!(lane => rows[lane].specular)),
            conserves: f32x8::load_array(simd, by_lane!(lane => rows[lane].conserves)),
        }
    }
}

impl RowBsdf for Dielectric {
    type Lanes<S: Simd> = Dielectric<f32x8<S>>;

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        Dielectric {
            eta: f32x8::load_array(simd, by_lane!(lane => rows[lane].eta)),
            roughness: gather_microfacets(simd, &by_lane!(lane => rows[lane].roughness)),
            conserves: f32x8::load_array(simd, by_lane!(lane => rows[lane].conserves)),
        }
    }
}

impl RowBsdf for Principled {
    type Lanes<S: Simd> = Principled<f32x8<S>>;

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        Principled::gather_rows(simd, rows)
    }
}

impl RowBsdf for OpenPbrSurface {
    type Lanes<S: Simd> = Principled<f32x8<S>, OpenPbr<f32x8<S>>>;

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        let layers = by_lane!(lane => rows[lane].layers());
        Principled::gather_open_pbr(simd, &by_lane!(lane => &layers[lane]))
    }
}

macro_rules! layered_class {
    ($base:ident, $gather:ident) => {
        impl RowBsdf for Layered<$base> {
            type Lanes<S: Simd> = Layered<$base<f32x8<S>>, f32x8<S>>;

            #[inline(always)]
            fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
                let g = f32x8::load_array(simd, by_lane!(lane => rows[lane].phase.g));
                Layered {
                    coat: Dielectric::gather(simd, &by_lane!(lane => &rows[lane].coat)),
                    base: $base::gather(simd, &by_lane!(lane => &rows[lane].base)),
                    albedo: gather_spectrum(simd, &by_lane!(lane => rows[lane].albedo)),
                    thickness: f32x8::load_array(simd, by_lane!(lane => rows[lane].thickness)),
                    phase: HenyeyGreenstein { g },
                    max_depth: f32x8::load_array(simd, by_lane!(lane => rows[lane].max_depth)),
                    samples: f32x8::load_array(simd, by_lane!(lane => rows[lane].samples)),
                    unbiased: f32x8::load_array(simd, by_lane!(lane => rows[lane].unbiased)),
                    seed: f32x8::load_array(simd, by_lane!(lane => rows[lane].seed)),
                    interior: $gather(simd, &by_lane!(lane => &rows[lane].interior)),
                }
            }
        }
    };
}

layered_class!(Diffuse, gather_interior);
layered_class!(Conductor, gather_nothing);

#[cfg(test)]
mod tests;
