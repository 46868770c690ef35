//! The factor S_w of a BSSRDF, as a BSDF: how light that has diffused below a smooth boundary depends on the direction in which it
//! has entered.
//!
//! It is Fresnel's transmission, with a factor such that its integral over the hemisphere, with the cosine, is 1; for radiance it has
//! another factor η², which undoes that of the refraction where a path has entered. As in pbrt-v4.

use std::f32::consts::PI;

use lookfrom_simd::{Float, Real, Simd, f32x8, prelude::*};

use super::diffuse::{cosine_direction, cosine_pdf, cosine_sample};
use super::lanes::{ClassTraits, LaneBsdf, RowBsdf};
use super::lobes::Lobes;
use super::{Description, DirectionSample, ScatteringFunction, fresnel, same_side};
use crate::core::lanes::{LANES, by_lane};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::bssrdf::fresnel_moment;

/// Light that leaves a medium in which it has diffused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalizedFresnel<R = f32> {
    /// Index of refraction, inside over outside.
    pub(crate) eta: R,
    /// The integral of Fresnel's transmission and the cosine over the hemisphere: 0 … π.
    pub(crate) norm: R,
}

impl NormalizedFresnel {
    /// The light that leaves by a boundary with this index of refraction.
    pub fn new(eta: f32) -> Self {
        let eta = fresnel::valid_eta(eta);
        let norm = PI * (1.0 - 2.0 * fresnel_moment(eta.into(), 1)) as f32;
        Self { eta, norm }
    }
}

impl<R: Real> NormalizedFresnel<R> {
    #[inline(always)]
    fn value(&self, wo: Vector<R>, wi: Vector<R>) -> Spectrum<R> {
        let (zero, one) = (wi.z.like(0.0), wi.z.like(1.0));
        let transmitted = one - fresnel::dielectric(Float::abs(wi.z), self.eta);
        let value = self.eta * self.eta * transmitted / self.norm;
        Spectrum::splat(R::select(same_side(wo, wi) & self.norm.gt(zero), value, zero))
    }
}

impl ScatteringFunction for NormalizedFresnel {
    fn lobes(&self) -> Lobes {
        Lobes::REFLECTION | Lobes::DIFFUSE
    }

    fn description(&self) -> Description {
        Description {
            kind: "normalized Fresnel",
            does: "light that has diffused below the surface leaves: f = η² (1 − F) / norm",
            numbers: vec![("eta", self.eta.into()), ("norm", self.norm.into())],
        }
    }
}

impl<R: Real> LaneBsdf<R> for NormalizedFresnel<R> {
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
        self.value(wo, wi)
    }

    #[inline(always)]
    fn pdf(&self, &wo: &Vector<R>, wi: Vector<R>) -> R {
        cosine_pdf(wo, wi)
    }

    #[inline(always)]
    fn sample(&self, &wo: &Vector<R>, _: R, u: [R; 2]) -> DirectionSample<R> {
        let wi = cosine_direction(u, wo.z);
        cosine_sample(wo, wi, self.value(wo, wi))
    }

    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        self.eta.gt(self.eta.like(0.0))
    }

    #[inline(always)]
    fn diffuse_share(&self, wo: &Vector<R>, _: Vector<R>, _: Spectrum<R>) -> Spectrum<R> {
        Spectrum::splat(wo.z.like(1.0))
    }
}

impl RowBsdf for NormalizedFresnel {
    type Lanes<S: Simd> = NormalizedFresnel<f32x8<S>>;

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        NormalizedFresnel {
            eta: f32x8::load_array(simd, by_lane!(lane => rows[lane].eta)),
            norm: f32x8::load_array(simd, by_lane!(lane => rows[lane].norm)),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::shading::bsdf::Bsdf;
    use crate::shading::bsdf::tests::{direction, numbers};

    /// Its integral with the cosine is η².
    #[test]
    fn it_is_normalized() {
        const COUNT: u32 = 1000;
        for eta in [1.0, 1.1, 1.33, 1.5, 2.4] {
            let bsdf = Bsdf::NormalizedFresnel(NormalizedFresnel::new(eta));
            let part = |i: u32| {
                let wi = direction(90.0 * (i as f32 + 0.5) / COUNT as f32, 30.0);
                let sin = (1.0 - wi.z * wi.z).sqrt();
                bsdf.f(Vec3::Z, wi).0[0] * wi.z * sin
            };
            let integral = PI * PI / COUNT as f32 * (0..COUNT).map(part).sum::<f32>();
            assert!((integral / (eta * eta) - 1.0).abs() < 2e-4, "η {eta}: {integral}");
        }
    }

    #[test]
    fn samples_are_on_the_side_of_the_viewer() {
        let bsdf = Bsdf::NormalizedFresnel(NormalizedFresnel::new(1.4));
        for wo in [Vec3::Z, -Vec3::Z] {
            for index in 0..100 {
                let (uc, u) = numbers(1, index);
                let sample = bsdf.sample(wo, uc, u).expect("a direction");
                assert!(sample.wi.z * wo.z > 0.0);
                assert_eq!(sample.pdf, bsdf.pdf(wo, sample.wi));
            }
        }
        assert_eq!(bsdf.f(Vec3::Z, -Vec3::Z), Spectrum::BLACK);
    }
}
