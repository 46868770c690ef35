//! Dielectrics that colour what they reflect and let through, as Mitsuba's do: not as in nature.

use glam::Vec3;
use lookfrom_simd::{Real, Simd, f32x8};

use super::dielectric::Dielectric;
use super::lanes::{LaneBsdf, RowBsdf};
use super::{Description, DirectionSample, Lobes, MicrofacetFactors, ScatteringFunction};
use crate::core::lanes::{LANES, by_lane, gather_spectrum};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// Factors of reflected and of transmitted light, within 0 … 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tint<R = f32> {
    /// The factor of reflected light.
    pub(crate) reflectance: Spectrum<R>,
    /// The factor of transmitted light.
    pub(crate) transmittance: Spectrum<R>,
}

impl Tint {
    /// No tint.
    pub const NONE: Self = Self { reflectance: Spectrum([1.0; 4]), transmittance: Spectrum([1.0; 4]) };
}

impl<R: Real> Tint<R> {
    /// The factor of light between two directions.
    #[inline(always)]
    fn between(&self, wo: Vector<R>, wi: Vector<R>) -> Spectrum<R> {
        let reflects = (wo.z * wi.z).gt(wo.z.like(0.0));
        Spectrum::select(reflects, self.reflectance, self.transmittance)
    }
}

impl<S: Simd> Tint<f32x8<S>> {
    /// One in each lane.
    #[inline(always)]
    pub(super) fn gather(simd: S, rows: &[Tint; LANES]) -> Self {
        Self {
            reflectance: gather_spectrum(simd, &by_lane!(lane => rows[lane].reflectance)),
            transmittance: gather_spectrum(simd, &by_lane!(lane => rows[lane].transmittance)),
        }
    }
}

/// A dielectric boundary with a tint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TintedDielectric<R = f32> {
    pub(crate) boundary: Dielectric<R>,
    pub(crate) tint: Tint<R>,
}

impl<R: Real> LaneBsdf<R> for TintedDielectric<R> {
    type Prepared = Vector<R>;

    #[inline(always)]
    fn prepare(&self, wo: Vector<R>) -> Vector<R> {
        wo
    }

    #[inline(always)]
    fn f(&self, &wo: &Vector<R>, wi: Vector<R>) -> Spectrum<R> {
        LaneBsdf::f(&self.boundary, &wo, wi) * self.tint.between(wo, wi)
    }

    #[inline(always)]
    fn pdf(&self, &wo: &Vector<R>, wi: Vector<R>) -> R {
        LaneBsdf::pdf(&self.boundary, &wo, wi)
    }

    #[inline(always)]
    fn sample(&self, &wo: &Vector<R>, uc: R, u: [R; 2]) -> DirectionSample<R> {
        let sample = LaneBsdf::sample(&self.boundary, &wo, uc, u);
        DirectionSample { f: sample.f * self.tint.between(wo, sample.wi), ..sample }
    }

    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        self.boundary.has_density()
    }
}

impl ScatteringFunction for TintedDielectric {
    fn lobes(&self) -> Lobes {
        self.boundary.lobes()
    }

    fn regularize(&mut self) {
        self.boundary.regularize();
    }

    fn factors(&self, wo: Vec3, wi: Vec3, is_specular: bool) -> Vec<MicrofacetFactors> {
        let tint = self.tint.between(wo.into(), wi.into());
        let mut factors = ScatteringFunction::factors(&self.boundary, wo, wi, is_specular);
        factors.iter_mut().for_each(|facet| facet.part *= tint);
        factors
    }

    fn description(&self) -> Description {
        let mut description = self.boundary.description();
        description.numbers.extend([
            ("specular reflectance", self.tint.reflectance.into()),
            ("specular transmittance", self.tint.transmittance.into()),
        ]);
        description
    }
}

impl RowBsdf for TintedDielectric {
    type Lanes<S: Simd> = TintedDielectric<f32x8<S>>;

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        TintedDielectric {
            boundary: Dielectric::gather(simd, &by_lane!(lane => &rows[lane].boundary)),
            tint: Tint::gather(simd, &by_lane!(lane => rows[lane].tint)),
        }
    }
}
