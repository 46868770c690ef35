//! Diffuse (Lambertian) reflection and transmission.
//!
//! Lambert 1760.

use std::f32::consts::FRAC_1_PI;

use lookfrom_simd::{Float, Mask, Real};

use super::{
    Description, DirectionSample, Lobes, ScatteringFunction, is_grazing,
    lanes::{ClassTraits, LaneBsdf},
    layered::{Base, DiffuseInterior},
    same_side,
};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::core::warp;

/// Lambertian reflection, on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffuse<R = f32> {
    /// Albedo.
    pub(crate) reflectance: Spectrum<R>,
}

impl Diffuse {
    /// By its reflectance, clamped to 0 … 1.
    pub fn new(reflectance: Spectrum) -> Self {
        Self { reflectance: reflectance.map(|r| r.clamp(0.0, 1.0)) }
    }
}

impl ScatteringFunction for Diffuse {
    fn lobes(&self) -> Lobes {
        if self.reflectance.is_black() { Lobes::NONE } else { Lobes::REFLECTION | Lobes::DIFFUSE }
    }

    fn description(&self) -> Description {
        Description {
            kind: "diffuse",
            does: "Lambertian: equally bright from all directions, f = reflectance / π",
            numbers: vec![("reflectance", self.reflectance.into())],
        }
    }
}

impl<R: Real> LaneBsdf<R> for Diffuse<R> {
    type Prepared = Vector<R>;

    #[inline(always)]
    fn traits(&self) -> ClassTraits {
        ClassTraits { needs_lobe: false, ..ClassTraits::PLAIN }
    }

    #[inline(always)]
    fn prepare(&self, wo: Vector<R>) -> Vector<R> {
        wo
    }

    #[inline(always)]
    fn f(&self, &wo: &Vector<R>, wi: Vector<R>) -> Spectrum<R> {
        let black = Spectrum::splat(wo.z.like(0.0));
        Spectrum::select(same_side(wo, wi), self.reflectance * wo.z.like(FRAC_1_PI), black)
    }

    #[inline(always)]
    fn pdf(&self, &wo: &Vector<R>, wi: Vector<R>) -> R {
        cosine_pdf(wo, wi)
    }

    #[inline(always)]
    fn sample(&self, &wo: &Vector<R>, _: R, u: [R; 2]) -> DirectionSample<R> {
        let wi = cosine_direction(u, wo.z);
        cosine_sample(wo, wi, self.reflectance * wo.z.like(FRAC_1_PI))
    }

    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        !self.reflectance.is_black()
    }

    #[inline(always)]
    fn diffuse_share(&self, wo: &Vector<R>, _: Vector<R>, _: Spectrum<R>) -> Spectrum<R> {
        Spectrum::splat(wo.z.like(1.0))
    }
}

/// The density of [`cosine_direction`] on the side of `wo`.
#[inline(always)]
pub(super) fn cosine_pdf<R: Real>(wo: Vector<R>, wi: Vector<R>) -> R {
    let pdf = warp::cosine_hemisphere_pdf(Float::abs(wi.z));
    R::select(same_side(wo, wi), pdf, wo.z.like(0.0))
}

/// A sample of diffuse reflection: a [`cosine_direction`] on the side of `wo`, and the value of the BSDF for it.
#[inline(always)]
pub(super) fn cosine_sample<R: Real>(wo: Vector<R>, wi: Vector<R>, f: Spectrum<R>) -> DirectionSample<R> {
    let is_valid = !is_grazing(wo);
    let no = is_valid.like(false);
    DirectionSample {
        wi,
        f,
        pdf: warp::cosine_hemisphere_pdf(Float::abs(wi.z)),
        eta: wo.z.like(1.0),
        is_specular: no,
        is_diffuse: !no,
        is_transmission: no,
        is_valid,
    }
}

impl<R: Real> Base<R> for Diffuse<R> {
    type Interior = DiffuseInterior<R>;
    const COATED: [&str; 2] =
        ["coated diffuse", "diffuse under a clear coat: a random walk between the two layers"];

    #[inline(always)]
    fn is_specular(&self) -> R::Mask {
        self.reflectance.is_black().like(false)
    }

    #[inline(always)]
    fn lambertian<'a>(
        &self,
        interior: &'a DiffuseInterior<R>,
    ) -> Option<(Spectrum<R>, &'a DiffuseInterior<R>)> {
        Some((self.reflectance, interior))
    }
}

/// Reflects the fraction `reflectance` of the light and transmits the fraction `transmittance`, both uniformly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmission<R = f32> {
    /// 0 … 1.
    pub(crate) reflectance: Spectrum<R>,
    /// 0 … 1.
    pub(crate) transmittance: Spectrum<R>,
}

impl DiffuseTransmission {
    /// Each is clamped to 0 … 1; the caller ensures that their sum is at most 1, as in pbrt.
    pub fn new(reflectance: Spectrum, transmittance: Spectrum) -> Self {
        let [reflectance, transmittance] =
            [reflectance, transmittance].map(|part| part.map(|lane| lane.clamp(0.0, 1.0)));
        Self { reflectance, transmittance }
    }
}

impl<R: Real> DiffuseTransmission<R> {
    /// The probability of reflection, and whether either side carries light.
    #[inline(always)]
    fn reflection_probability(&self) -> (R, R::Mask) {
        let (r, t) = (self.reflectance.max_lane(), self.transmittance.max_lane());
        let (sum, zero) = (r + t, r.like(0.0));
        (R::select(sum.gt(zero), r / sum, zero), sum.gt(zero))
    }

    #[inline(always)]
    fn value(&self, wo: Vector<R>, wi: Vector<R>) -> Spectrum<R> {
        let part = Spectrum::select(same_side(wo, wi), self.reflectance, self.transmittance);
        let is_lit = !is_grazing(wo) & !is_grazing(wi);
        Spectrum::select(is_lit, part * wo.z.like(FRAC_1_PI), Spectrum::splat(wo.z.like(0.0)))
    }

    #[inline(always)]
    fn density(&self, wo: Vector<R>, wi: Vector<R>) -> R {
        let (reflection, is_lit) = self.reflection_probability();
        let is_lit = is_lit & !is_grazing(wo) & !is_grazing(wi);
        let probability = R::select(same_side(wo, wi), reflection, wo.z.like(1.0) - reflection);
        R::select(is_lit, probability * warp::cosine_hemisphere_pdf(Float::abs(wi.z)), wo.z.like(0.0))
    }

    /// As [`super::Bsdf::sample`].
    #[inline(always)]
    fn sampled(&self, wo: Vector<R>, uc: R, u: [R; 2]) -> DirectionSample<R> {
        let one = uc.like(1.0);
        let (reflection, is_valid) = self.reflection_probability();
        let is_transmission = !uc.lt(reflection);
        let wi = cosine_direction(u, R::select(is_transmission, -wo.z, wo.z));
        let probability = R::select(is_transmission, one - reflection, reflection);
        let no = is_valid.like(false);
        DirectionSample {
            wi,
            f: self.value(wo, wi),
            pdf: probability * warp::cosine_hemisphere_pdf(Float::abs(wi.z)),
            eta: one,
            is_specular: no,
            is_diffuse: !no,
            is_transmission,
            is_valid,
        }
    }
}

impl<R: Real> LaneBsdf<R> for DiffuseTransmission<R> {
    type Prepared = Vector<R>;

    #[inline(always)]
    fn prepare(&self, wo: Vector<R>) -> Vector<R> {
        wo
    }

    #[inline(always)]
    fn f(&self, &wo: &Vector<R>, wi: Vector<R>) -> Spectrum<R> {
        self.value(wo, wi)
    }

    #[inline(always)]
    fn pdf(&self, &wo: &Vector<R>, wi: Vector<R>) -> R {
        self.density(wo, wi)
    }

    #[inline(always)]
    fn sample(&self, &wo: &Vector<R>, uc: R, u: [R; 2]) -> DirectionSample<R> {
        self.sampled(wo, uc, u)
    }

    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        !(self.reflectance.is_black() & self.transmittance.is_black())
    }

    #[inline(always)]
    fn diffuse_share(&self, wo: &Vector<R>, _: Vector<R>, _: Spectrum<R>) -> Spectrum<R> {
        Spectrum::splat(wo.z.like(1.0))
    }
}

impl ScatteringFunction for DiffuseTransmission {
    fn lobes(&self) -> Lobes {
        let mut lobes = Lobes::NONE;
        if !self.reflectance.is_black() {
            lobes |= Lobes::REFLECTION | Lobes::DIFFUSE;
        }
        if !self.transmittance.is_black() {
            lobes |= Lobes::TRANSMISSION | Lobes::DIFFUSE;
        }
        lobes
    }

    fn description(&self) -> Description {
        Description {
            kind: "diffuse transmission",
            does: "Lambertian on both sides, like paper: f = reflectance / π or transmittance / π",
            numbers: vec![
                ("reflectance", self.reflectance.into()),
                ("transmittance", self.transmittance.into()),
            ],
        }
    }
}

/// A cosine-distributed direction about the z axis, on the side of the sign of `side`.
#[inline(always)]
pub(super) fn cosine_direction<R: Real>(u: [R; 2], side: R) -> Vector<R> {
    let up = warp::cosine_about_z(u);
    // Zeros are positive, so that a direction has the same bits however it is composed.
    let zero = side.like(0.0);
    Vector { x: up.x + zero, y: up.y + zero, z: Float::copysign(up.z, side) }
}
