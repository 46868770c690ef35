//! BSDFs of eight paths side by side: what the path tracer asks of a class of them, and how their rows are gathered.

use lookfrom_simd::{Real, Simd, f32x8, prelude::*};

use super::conductor::Conductor;
use super::dielectric::Dielectric;
use super::diffuse::Diffuse;
use super::henyey_greenstein::HenyeyGreenstein;
use super::layered::{Base, DiffuseInterior, Layered};
use super::lobes::Lobes;
use super::microfacet::TrowbridgeReitz;
use super::principled::{Look, Principled};
use super::{Bsdf, DirectionSample, Mode};
use crate::core::lanes::{LANES, by_lane, gather_spectrum};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// Properties that all BSDFs of a class have in common.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// As [`super::BsdfSample::pdf_is_proportional`].
    pub pdf_is_proportional: bool,
    /// Whether sampling takes a number to choose a lobe.
    pub needs_lobe: bool,
    /// Whether light passes only between directions for which the geometric and the shading normal agree whether they
    /// are on one side. pbrt's materials do without this test.
    pub needs_agreement: bool,
}

/// BSDFs of one class at any width, for paths from the camera. Directions are those of [`Bsdf`].
pub trait LaneBsdf<R: Real> {
    /// The properties of the class.
    const KIND: Kind;
    /// What is computed once for an outgoing direction: that direction itself, where there is nothing to compute.
    type View;

    /// The view from the outgoing direction `wo`, which the other methods take.
    fn view(&self, wo: Vector<R>) -> Self::View;
    /// As [`Bsdf::f`].
    fn f(&self, view: &Self::View, wi: Vector<R>) -> Spectrum<R>;
    /// As [`Bsdf::pdf`].
    fn pdf(&self, view: &Self::View, wi: Vector<R>) -> R;
    /// [`Self::f`] and [`Self::pdf`]; the density means nothing where the value is black.
    #[inline(always)]
    fn f_and_pdf(&self, view: &Self::View, wi: Vector<R>) -> (Spectrum<R>, R) {
        (self.f(view, wi), self.pdf(view, wi))
    }
    /// As [`Bsdf::sample`].
    fn sample(&self, view: &Self::View, uc: R, u: [R; 2]) -> DirectionSample<R>;
    /// True if there is a lobe that is not specular.
    fn has_density(&self) -> R::Mask;
}

/// The classes of BSDFs that are computed in lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BsdfClass {
    /// [`Diffuse`].
    Diffuse,
    /// [`Conductor`].
    Conductor,
    /// [`Dielectric`].
    Dielectric,
    /// [`Layered`], on a diffuse base.
    CoatedDiffuse,
    /// [`Layered`], on a conductor.
    CoatedConductor,
    /// [`Principled`].
    Principled,
}

impl BsdfClass {
    /// Number of classes.
    pub(crate) const COUNT: usize = 6;

    /// All of them, in their order.
    pub(crate) const ALL: [Self; Self::COUNT] = [
        Self::Diffuse,
        Self::Conductor,
        Self::Dielectric,
        Self::CoatedDiffuse,
        Self::CoatedConductor,
        Self::Principled,
    ];

    /// The class of a BSDF, if it is computed in lanes.
    #[inline]
    pub(crate) fn of(bsdf: &Bsdf) -> Option<Self> {
        match bsdf {
            Bsdf::Diffuse(_) => Some(Self::Diffuse),
            Bsdf::Conductor(_) => Some(Self::Conductor),
            Bsdf::Dielectric(_) => Some(Self::Dielectric),
            Bsdf::CoatedDiffuse(_) => Some(Self::CoatedDiffuse),
            Bsdf::CoatedConductor(_) => Some(Self::CoatedConductor),
            Bsdf::Principled(_) => Some(Self::Principled),
            _ => None,
        }
    }
}

/// A class of BSDFs, as scalars.
pub(crate) trait RowBsdf: Copy {
    /// Eight of them.
    type Lanes<S: Simd>: LaneBsdf<f32x8<S>>;

    /// The BSDF, if it is of this class.
    fn of(bsdf: &Bsdf) -> Option<&Self>;

    /// As [`Bsdf::regularize`].
    fn regularize(&mut self);

    /// One in each lane.
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S>;
}

impl<R: Real> LaneBsdf<R> for Dielectric<R> {
    const KIND: Kind = Kind { pdf_is_proportional: false, needs_lobe: true, needs_agreement: false };
    type View = Vector<R>;

    #[inline(always)]
    fn view(&self, wo: Vector<R>) -> Vector<R> {
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
    const KIND: Kind = Kind { pdf_is_proportional: true, needs_lobe: true, needs_agreement: false };
    type View = Vector<R>;

    #[inline(always)]
    fn view(&self, wo: Vector<R>) -> Vector<R> {
        wo
    }
    #[inline(always)]
    fn f(&self, &wo: &Vector<R>, wi: Vector<R>) -> Spectrum<R> {
        self.f(wo, wi, Mode::Radiance)
    }
    #[inline(always)]
    fn pdf(&self, &wo: &Vector<R>, wi: Vector<R>) -> R {
        self.pdf(wo, wi, Mode::Radiance)
    }
    #[inline(always)]
    fn sample(&self, &wo: &Vector<R>, uc: R, u: [R; 2]) -> DirectionSample<R> {
        self.sample(wo, uc, u, Mode::Radiance)
    }
    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        self.has_density()
    }
}

#[inline(always)]
fn gather_roughness<S: Simd>(simd: S, rows: &[TrowbridgeReitz; LANES]) -> TrowbridgeReitz<f32x8<S>> {
    TrowbridgeReitz {
        alpha_x: f32x8::load_array(simd, by_lane!(lane => rows[lane].alpha_x)),
        alpha_y: f32x8::load_array(simd, by_lane!(lane => rows[lane].alpha_y)),
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

    fn of(bsdf: &Bsdf) -> Option<&Self> {
        if let Bsdf::Diffuse(bsdf) = bsdf { Some(bsdf) } else { None }
    }

    fn regularize(&mut self) {}

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        Diffuse { reflectance: gather_spectrum(simd, &by_lane!(lane => rows[lane].reflectance)) }
    }
}

impl RowBsdf for Conductor {
    type Lanes<S: Simd> = Conductor<f32x8<S>>;

    fn of(bsdf: &Bsdf) -> Option<&Self> {
        if let Bsdf::Conductor(bsdf) = bsdf { Some(bsdf) } else { None }
    }

    fn regularize(&mut self) {
        self.roughness.regularize();
    }

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        Conductor {
            eta: gather_spectrum(simd, &by_lane!(lane => rows[lane].eta)),
            k: gather_spectrum(simd, &by_lane!(lane => rows[lane].k)),
            roughness: gather_roughness(simd, &by_lane!(lane => rows[lane].roughness)),
            conserves: f32x8::load_array(simd, by_lane!(lane => rows[lane].conserves)),
        }
    }
}

impl RowBsdf for Dielectric {
    type Lanes<S: Simd> = Dielectric<f32x8<S>>;

    fn of(bsdf: &Bsdf) -> Option<&Self> {
        if let Bsdf::Dielectric(bsdf) = bsdf { Some(bsdf) } else { None }
    }

    fn regularize(&mut self) {
        self.roughness.regularize();
    }

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        Dielectric {
            eta: f32x8::load_array(simd, by_lane!(lane => rows[lane].eta)),
            roughness: gather_roughness(simd, &by_lane!(lane => rows[lane].roughness)),
            conserves: f32x8::load_array(simd, by_lane!(lane => rows[lane].conserves)),
        }
    }
}

impl RowBsdf for Principled {
    type Lanes<S: Simd> = Look<f32x8<S>>;

    fn of(bsdf: &Bsdf) -> Option<&Self> {
        if let Bsdf::Principled(bsdf) = bsdf { Some(bsdf) } else { None }
    }

    fn regularize(&mut self) {
        self.regularize();
    }

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        Look::gather(simd, rows)
    }
}

macro_rules! layered_class {
    ($base:ident, $variant:ident, $unknown:expr, $gather:ident) => {
        impl RowBsdf for Layered<$base> {
            type Lanes<S: Simd> = Layered<$base<f32x8<S>>, f32x8<S>>;

            fn of(bsdf: &Bsdf) -> Option<&Self> {
                if let Bsdf::$variant(bsdf) = bsdf { Some(bsdf) } else { None }
            }

            fn regularize(&mut self) {
                self.coat.regularize();
                self.base.regularize();
                // It was that of a smoother coat.
                self.interior = $unknown;
            }

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

layered_class!(Diffuse, CoatedDiffuse, DiffuseInterior::new(None), gather_interior);
layered_class!(Conductor, CoatedConductor, (), gather_nothing);

#[cfg(test)]
mod tests;
