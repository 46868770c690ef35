//! Whitted's model as a BSDF, so that scenes written for it can be path traced.
//!
//! `f |cos θ_i| = k_d cos θ_i / π + k_s (N·H)ⁿ / π` on the side of `wo`; `k_r` into the reflected and `k_t` into
//! the refracted direction, with the weights of [`crate::shading::material`]. It computes exactly what Whitted ray
//! tracing does: there is no 1/η² for transmitted light, and energy conservation and reciprocity depend on the
//! chosen coefficients.
//!
//! Whitted 1980, Blinn 1977.

use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, TAU};

use super::diffuse::cosine_direction;
use super::{
    BsdfSample, Description, Lobes, Mode, ScatteringFunction, conductor::try_half_vector, is_grazing,
    same_side,
};
use crate::core::elementary;
use crate::core::math;
use crate::core::optics;
use crate::core::spectrum::Spectrum;
use crate::core::warp;

/// Whitted's coefficients without the ambient one, with the same names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WhittedBsdf {
    /// `k_d`.
    pub diffuse: Spectrum,
    /// `k_s`.
    pub specular: Spectrum,
    /// `n`, at least 0.
    pub shininess: f32,
    /// `k_r`.
    pub mirror: Spectrum,
    /// `k_t`.
    pub transmission: Spectrum,
    /// Index of refraction, inside over outside.
    pub ior: f32,
    /// True if the angle determines the split between reflection and refraction (Fresnel).
    pub fresnel: bool,
}

/// Weights of the specular directions, for one outgoing direction.
struct Branches {
    mirror: Spectrum,
    refracted: Option<(Vec3, Spectrum)>,
}

/// Probabilities of the four lobes.
struct Choice {
    diffuse: f32,
    glossy: f32,
    mirror: f32,
    refraction: f32,
}

impl WhittedBsdf {
    /// The specular directions with their weights.
    #[inline]
    fn branches(&self, wo: Vec3) -> Branches {
        if self.mirror.is_black() && self.transmission.is_black() {
            return Branches { mirror: Spectrum::BLACK, refracted: None };
        }
        let n = Vec3::new(0.0, 0.0, 1.0_f32.copysign(wo.z));
        let eta = if wo.z > 0.0 { self.ior } else { 1.0 / self.ior };
        let bent = math::refract(wo, n, eta).filter(|&wi| !is_grazing(wi));
        let (mirror, transmission) = if self.fresnel {
            let part = optics::fresnel_dielectric(n.dot(wo), eta);
            (self.mirror.zip(self.transmission, f32::max) * part, self.transmission * (1.0 - part))
        } else if bent.is_none() {
            (self.mirror + self.transmission, Spectrum::BLACK)
        } else {
            (self.mirror, self.transmission)
        };
        let refracted = bent.filter(|_| !transmission.is_black()).map(|wi| (wi.normalize(), transmission));
        Branches { mirror, refracted }
    }

    /// Each lobe with a probability about proportional to its weight, among those that `lobes` allows;
    /// `None` where none is left.
    #[inline]
    fn choice(&self, branches: &Branches, lobes: Lobes) -> Option<Choice> {
        // The highlight's albedo seen from above: ∫ 4 (N·H)ⁿ⁺¹ / π dω_H = 8 / (n + 2), less the part below
        // the surface.
        let highlight = 8.0 / (self.shininess + 4.0);
        let [diffuse, _] = lobes.allowed([self.diffuse.max_lane(), 0.0]);
        let [glossy, _] = lobes.allowed([self.specular.max_lane() * highlight, 0.0]);
        let refracted = branches.refracted.map_or(0.0, |(_, weight)| weight.max_lane());
        let [mirror, refraction] = lobes.allowed([branches.mirror.max_lane(), refracted]);
        let sum = diffuse + glossy + mirror + refraction;
        (sum > 0.0).then(|| Choice {
            diffuse: diffuse / sum,
            glossy: glossy / sum,
            mirror: mirror / sum,
            refraction: refraction / sum,
        })
    }

    #[inline]
    fn value(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        if !same_side(wo, wi) {
            return Spectrum::BLACK;
        }
        let highlight = if self.specular.is_black() {
            Spectrum::BLACK
        } else {
            let cos = try_half_vector(wo, wi).map_or(0.0, |h| h.z);
            self.specular * (elementary::power(cos, self.shininess) / wi.z.abs())
        };
        (self.diffuse + highlight) * FRAC_1_PI
    }

    /// Density of the non-specular lobes together, given the probabilities of all.
    #[inline]
    fn spread_pdf(&self, wo: Vec3, wi: Vec3, choice: &Choice) -> f32 {
        let mut pdf = choice.diffuse * warp::cosine_hemisphere_pdf(wi.z.abs());
        if choice.glossy > 0.0
            && let Some(h) = try_half_vector(wo, wi)
        {
            let of_half = (self.shininess + 1.0) / TAU * elementary::power(h.z, self.shininess);
            pdf += choice.glossy * of_half / (4.0 * wo.dot(h).abs().max(f32::MIN_POSITIVE));
        }
        pdf
    }

    /// A half vector distributed by the n-th power of its cosine, on the side of the sign of `side`.
    #[inline]
    fn sample_half(&self, [u, v]: [f32; 2], side: f32) -> Vec3 {
        // sin²θ = 1 − u^(2/(n+1)), without the subtraction.
        let exponent = 2.0 / (self.shininess + 1.0) * libm::logf(u);
        let sin2 = (-libm::expm1f(exponent)).clamp(0.0, 1.0);
        let (sin_phi, cos_phi) = libm::sincosf(TAU * v);
        let sin = sin2.sqrt();
        Vec3::new(sin * cos_phi, sin * sin_phi, (1.0 - sin2).sqrt().copysign(side))
    }
}

impl ScatteringFunction for WhittedBsdf {
    fn f(&self, wo: Vec3, wi: Vec3, _: Mode) -> Spectrum {
        self.value(wo, wi)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, _: Mode, lobes: Lobes) -> f32 {
        if !same_side(wo, wi) {
            return 0.0;
        }
        self.choice(&self.branches(wo), lobes).map_or(0.0, |choice| self.spread_pdf(wo, wi, &choice))
    }

    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2], _: Mode, lobes: Lobes) -> Option<BsdfSample> {
        if is_grazing(wo) {
            return None;
        }
        let branches = self.branches(wo);
        let choice = self.choice(&branches, lobes)?;
        let spread = choice.diffuse + choice.glossy;
        if uc < spread {
            let is_diffuse = uc < choice.diffuse;
            let wi = if is_diffuse {
                cosine_direction(u, wo.z).into()
            } else {
                math::reflect(wo, self.sample_half(u, wo.z)).normalize()
            };
            if !same_side(wo, wi) {
                return None;
            }
            let lobe = Lobes::REFLECTION | if is_diffuse { Lobes::DIFFUSE } else { Lobes::GLOSSY };
            return Some(BsdfSample::new(wi, self.value(wo, wi), self.spread_pdf(wo, wi, &choice), lobe));
        }
        let specular = |wi: Vec3, weight: Spectrum, probability, side| {
            BsdfSample::new(wi, weight / wi.z.abs(), probability, side | Lobes::SPECULAR)
        };
        if choice.mirror > 0.0 && uc < spread + choice.mirror || choice.refraction == 0.0 {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            return Some(specular(wi, branches.mirror, choice.mirror, Lobes::REFLECTION));
        }
        let (wi, weight) = branches.refracted?;
        Some(specular(wi, weight, choice.refraction, Lobes::TRANSMISSION))
    }

    fn lobes(&self) -> Lobes {
        let mut lobes = Lobes::NONE;
        if !self.diffuse.is_black() {
            lobes |= Lobes::REFLECTION | Lobes::DIFFUSE;
        }
        if !self.specular.is_black() {
            lobes |= Lobes::REFLECTION | Lobes::GLOSSY;
        }
        if !self.mirror.is_black() {
            lobes |= Lobes::REFLECTION | Lobes::SPECULAR;
        }
        if !self.transmission.is_black() {
            lobes |= Lobes::REFLECTION | Lobes::TRANSMISSION | Lobes::SPECULAR;
        }
        lobes
    }
    fn diffuse_share(&self, _: Vec3, _: Vec3, f: Spectrum) -> Spectrum {
        (self.diffuse * FRAC_1_PI).share_of(f)
    }

    fn description(&self) -> Description {
        Description {
            kind: "whitted",
            does: "the coefficients of Whitted's formula as a BSDF",
            numbers: vec![
                ("k_d", self.diffuse.into()),
                ("k_s", self.specular.into()),
                ("n", self.shininess.into()),
                ("k_r", self.mirror.into()),
                ("k_t", self.transmission.into()),
                ("ior", self.ior.into()),
            ],
        }
    }
}

#[cfg(test)]
mod tests;
