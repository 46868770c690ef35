//! The factor S_w of a BSSRDF, as a BSDF: how light that has diffused below a smooth boundary depends on the direction in which it
//! has entered.
//!
//! It is Fresnel's transmission, with a factor such that its integral over the hemisphere, with the cosine, is 1; for radiance it has
//! another factor η², which undoes that of the refraction where a path has entered. As in pbrt-v4.

use std::f32::consts::PI;

use glam::Vec3;

use super::diffuse::cosine_direction;
use super::lobes::Lobes;
use super::{BsdfSample, Description, Mode, ScatteringFunction, fresnel, same_side};
use crate::core::spectrum::Spectrum;
use crate::core::warp;
use crate::shading::bssrdf::fresnel_moment;

/// Light that leaves a medium in which it has diffused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalizedFresnel {
    /// Index of refraction, inside over outside.
    pub(crate) eta: f32,
    /// The integral of Fresnel's transmission and the cosine over the hemisphere: 0 … π.
    pub(crate) norm: f32,
}

impl NormalizedFresnel {
    /// The light that leaves by a boundary with this index of refraction.
    pub fn new(eta: f32) -> Self {
        let eta = fresnel::valid_eta(eta);
        let norm = PI * (1.0 - 2.0 * fresnel_moment(eta.into(), 1)) as f32;
        Self { eta, norm }
    }
}

impl ScatteringFunction for NormalizedFresnel {
    fn f(&self, wo: Vec3, wi: Vec3, mode: Mode) -> Spectrum {
        if !same_side(wo, wi) {
            return Spectrum::BLACK;
        }
        let transmitted = 1.0 - fresnel::dielectric(wi.z.abs(), self.eta);
        let factor = if mode == Mode::Radiance { self.eta * self.eta } else { 1.0 };
        Spectrum([factor * transmitted / self.norm; 4])
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, _: Mode, _: Lobes) -> f32 {
        if same_side(wo, wi) { warp::cosine_hemisphere_pdf(wi.z.abs()) } else { 0.0 }
    }

    fn sample(&self, wo: Vec3, _: f32, u: [f32; 2], mode: Mode, _: Lobes) -> Option<BsdfSample> {
        let wi = Vec3::from(cosine_direction(u, wo.z));
        let (f, pdf) = (self.f(wo, wi, mode), self.pdf(wo, wi, mode, Lobes::ALL));
        Some(BsdfSample::new(wi, f, pdf, self.lobes()))
    }

    fn lobes(&self) -> Lobes {
        Lobes::REFLECTION | Lobes::DIFFUSE
    }

    fn diffuse_share(&self, _: Vec3, _: Vec3, _: Spectrum) -> Spectrum {
        Spectrum([1.0; 4])
    }

    fn description(&self) -> Description {
        Description {
            kind: "normalized Fresnel",
            does: "light that has diffused below the surface leaves: f = η² (1 − F) / norm",
            numbers: vec![("eta", self.eta.into()), ("norm", self.norm.into())],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shading::bsdf::tests::{direction, numbers};

    /// Its integral with the cosine is 1 for importance, and η² for radiance.
    #[test]
    fn it_is_normalized() {
        const COUNT: u32 = 1000;
        for eta in [1.0, 1.1, 1.33, 1.5, 2.4] {
            let bsdf = NormalizedFresnel::new(eta);
            for (mode, expected) in [(Mode::Importance, 1.0), (Mode::Radiance, eta * eta)] {
                let part = |i: u32| {
                    let wi = direction(90.0 * (i as f32 + 0.5) / COUNT as f32, 30.0);
                    let sin = (1.0 - wi.z * wi.z).sqrt();
                    bsdf.f(Vec3::Z, wi, mode).0[0] * wi.z * sin
                };
                let integral = PI * PI / COUNT as f32 * (0..COUNT).map(part).sum::<f32>();
                assert!((integral / expected - 1.0).abs() < 2e-4, "η {eta}: {integral}");
            }
        }
    }

    #[test]
    fn samples_are_on_the_side_of_the_viewer() {
        let bsdf = NormalizedFresnel::new(1.4);
        for wo in [Vec3::Z, -Vec3::Z] {
            for index in 0..100 {
                let (uc, u) = numbers(1, index);
                let sample = bsdf.sample(wo, uc, u, Mode::Radiance, Lobes::ALL).expect("a direction");
                assert!(sample.wi.z * wo.z > 0.0);
                assert_eq!(sample.pdf, bsdf.pdf(wo, sample.wi, Mode::Radiance, Lobes::ALL));
            }
        }
        assert_eq!(bsdf.f(Vec3::Z, -Vec3::Z, Mode::Radiance), Spectrum::BLACK);
    }
}
