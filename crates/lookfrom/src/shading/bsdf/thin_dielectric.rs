//! Thin sheets of dielectrics.

use glam::Vec3;
use lookfrom_simd::{Float, Mask, Real, Simd, f32x8, prelude::*};

use super::lanes::{LaneBsdf, RowBsdf};
use super::tinted::Tint;
use super::{
    Description, DirectionSample, Lobes, MicrofacetFactors, ScatteringFunction, fresnel, is_grazing,
};
use crate::core::lanes::{LANES, by_lane};
use crate::core::optics;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// A dielectric sheet so thin that light leaves at the point where it entered: all internal reflections
/// are summed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectric<R = f32> {
    /// Index of the sheet over the surrounding one.
    pub(crate) eta: R,
    /// Its colours.
    pub(crate) tint: Tint<R>,
}

impl ThinDielectric {
    /// By the index of refraction of the sheet over the surrounding one (0 counts as 1).
    pub fn new(eta: f32) -> Self {
        Self { eta: fresnel::valid_eta(eta), tint: Tint::NONE }
    }

    /// This sheet with colours.
    #[must_use]
    pub fn with_tint(self, tint: Tint) -> Self {
        Self { tint, ..self }
    }
}

impl<R: Real> ThinDielectric<R> {
    /// The light that passes it, by the cosine to the normal.
    #[inline(always)]
    pub(crate) fn transmittance(&self, cos: R) -> Spectrum<R> {
        self.tint.transmittance * (cos.like(1.0) - self.reflectance(cos))
    }

    /// Reflectance of both interfaces with all reflections between them: R + T R T + T R³ T + … = R + T² R / (1 − R²), as in
    /// pbrt-v4. By the cosine to the normal.
    #[inline(always)]
    pub(crate) fn reflectance(&self, cos: R) -> R {
        let one = cos.like(1.0);
        let once = optics::fresnel_dielectric(Float::abs(cos), self.eta);
        let more = (one - once) * (one - once) * once / (one - once * once);
        R::select(once.lt(one), once + more, once)
    }
}

impl<R: Real> LaneBsdf<R> for ThinDielectric<R> {
    type Prepared = Vector<R>;

    #[inline(always)]
    fn prepare(&self, wo: Vector<R>) -> Vector<R> {
        wo
    }

    #[inline(always)]
    fn f(&self, _: &Vector<R>, wi: Vector<R>) -> Spectrum<R> {
        Spectrum::splat(wi.z.like(0.0))
    }

    #[inline(always)]
    fn pdf(&self, _: &Vector<R>, wi: Vector<R>) -> R {
        wi.z.like(0.0)
    }

    #[inline(always)]
    fn sample(&self, &wo: &Vector<R>, uc: R, _: [R; 2]) -> DirectionSample<R> {
        let (zero, one) = (uc.like(0.0), uc.like(1.0));
        let r = self.reflectance(wo.z);
        let t = one - r;
        let reflection = r / (r + t);
        let reflects = uc.lt(reflection);
        let part = Spectrum::select(reflects, self.tint.reflectance * r, self.tint.transmittance * t);
        DirectionSample {
            wi: Vector { x: -wo.x, y: -wo.y, z: R::select(reflects, wo.z, -wo.z) },
            f: part / Float::abs(wo.z),
            pdf: R::select(reflects, reflection, one - reflection),
            eta: one,
            is_specular: reflects.like(true),
            is_diffuse: reflects.like(false),
            is_transmission: !reflects,
            is_valid: (r + t).gt(zero) & !is_grazing(wo),
        }
    }

    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        self.eta.lt(self.eta).like(false)
    }
}

impl ScatteringFunction for ThinDielectric {
    fn lobes(&self) -> Lobes {
        Lobes::REFLECTION | Lobes::TRANSMISSION | Lobes::SPECULAR
    }

    fn factors(&self, wo: Vec3, wi: Vec3, is_specular: bool) -> Vec<MicrofacetFactors> {
        self.factors(wo, wi, is_specular).into_iter().collect()
    }

    fn description(&self) -> Description {
        Description {
            kind: "thin dielectric",
            does: "a thin pane: reflects light, or transmits it straight on",
            numbers: vec![
                ("eta", self.eta.into()),
                ("specular reflectance", self.tint.reflectance.into()),
                ("specular transmittance", self.tint.transmittance.into()),
            ],
        }
    }
}

impl RowBsdf for ThinDielectric {
    type Lanes<S: Simd> = ThinDielectric<f32x8<S>>;

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        ThinDielectric {
            eta: f32x8::load_array(simd, by_lane!(lane => rows[lane].eta)),
            tint: Tint::gather(simd, &by_lane!(lane => rows[lane].tint)),
        }
    }
}
