//! Whitted's model at a point: its coefficients, the light that they reflect, the branches of the ray tree, and the same as a BSDF, so
//! that scenes written for it can be path traced.
//!
//! Whitted 1980: `I = k_a I_a + k_d Σ (N·L_j) I_j + k_s Σ (N·H_j)ⁿ I_j + k_r S + k_t T`, with Blinn's half vector
//! `H` between `L` and the viewing direction (Blinn 1977).
//!
//! As a BSDF: `f |cos θ_i| = k_d cos θ_i / π + k_s (N·H)ⁿ / π` on the side of `wo`; `k_r` into the reflected and `k_t` into
//! the refracted direction. There is no 1/η² for transmitted light, and energy conservation and reciprocity depend on the
//! chosen coefficients.

use std::f32::consts::{FRAC_1_PI, TAU};

use lookfrom_simd::{Float, Mask, Real, Simd, f32x8, prelude::*};

use super::conductor::half_vector;
use super::diffuse::cosine_direction;
use super::lanes::{LaneBsdf, RowBsdf};
use super::{Description, DirectionSample, Lobes, ScatteringFunction, is_grazing, same_side};
use crate::core::elementary;
use crate::core::lanes::{LANES, by_lane, gather_spectrum};
use crate::core::optics;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::core::warp;

/// Whitted's coefficients at a point, or at several side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WhittedCoefficients<R: Real = f32> {
    /// `k_a`, without an effect on the BSDF.
    pub ambient: Spectrum<R>,
    /// `k_d`.
    pub diffuse: Spectrum<R>,
    /// `k_s`.
    pub specular: Spectrum<R>,
    /// `n`, at least 0.
    pub shininess: R,
    /// `k_r`.
    pub mirror: Spectrum<R>,
    /// `k_t`.
    pub transmission: Spectrum<R>,
    /// Index of refraction, inside over outside.
    pub ior: R,
    /// True if the angle determines the split between reflection and refraction (Fresnel).
    pub fresnel: R::Mask,
}

/// The two directions in which the ray tree branches, each with its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branches<R: Real = f32> {
    /// Toward `S`, unit length, and its weight.
    pub mirrored: (Vector<R>, Spectrum<R>),
    /// Toward `T`, unit length, and its weight.
    pub refracted: (Vector<R>, Spectrum<R>),
    /// False for total reflection and where nothing is transmitted.
    pub is_refracted: R::Mask,
    /// The Fresnel reflectance; 1 for total internal reflection. Without a meaning where the angle does not matter.
    pub fresnel: R,
    /// True for total internal reflection: Snell's law has no solution.
    pub total_reflection: R::Mask,
}

impl<R: Real> WhittedCoefficients<R> {
    /// True if direct light contributes.
    #[inline(always)]
    pub fn is_lit(&self) -> R::Mask {
        !(self.diffuse.is_black() & self.specular.is_black())
    }

    /// `k_d (N·L)` and `k_s (N·H)ⁿ`, for `N·L > 0`; `n`, `wo`, `wi` of unit length, `n` on the side of `wo`.
    #[inline(always)]
    pub fn lit(&self, n: Vector<R>, wo: Vector<R>, wi: Vector<R>) -> (Spectrum<R>, Spectrum<R>) {
        let diffuse = self.diffuse * n.dot(wi);
        if self.specular.is_black().all() {
            return (diffuse, self.specular);
        }
        let (half, exists) = (wo + wi).try_normalize();
        let zero = self.shininess.like(0.0);
        let cos = R::select(exists, Float::max(n.dot(half), zero), zero);
        (diffuse, self.specular * elementary::power(cos, self.shininess))
    }

    /// True if the ray tree branches: where light is reflected or transmitted.
    #[inline(always)]
    pub fn has_branches(&self) -> R::Mask {
        !(self.mirror.is_black() & self.transmission.is_black())
    }

    /// The branches of the ray tree, where there are any. `n` and `wo` of unit length on one side; `front` where that is the
    /// outside.
    ///
    /// With `fresnel` the fraction `F` of the larger of `k_r` and `k_t` is reflected, and `(1 − F) k_t` is
    /// refracted. Total internal reflection sends everything into the reflected direction.
    #[inline(always)]
    pub fn branches(&self, n: Vector<R>, wo: Vector<R>, front: R::Mask) -> Branches<R> {
        let (k_r, k_t) = (self.mirror, self.transmission);
        let has_transmission = !k_t.is_black();
        let one = self.ior.like(1.0);
        let black = Spectrum::splat(self.ior.like(0.0));
        let (mut mirror, mut refracted, mut fresnel) = (k_r, (n, black), one);
        let mut is_refracted = has_transmission.like(false);
        let mut total_reflection = is_refracted;
        if (has_transmission | self.fresnel).any() {
            let eta = R::select(front, self.ior, one / self.ior);
            let (bent, is_bent) = optics::refract(wo, n, eta);
            total_reflection = !is_bent & has_transmission;
            mirror = Spectrum::select(total_reflection, k_r + k_t, k_r);
            let mut transmission = Spectrum::select(total_reflection, black, k_t);
            if self.fresnel.any() {
                fresnel = optics::fresnel_dielectric(n.dot(wo), eta);
                mirror = Spectrum::select(self.fresnel, k_r.zip(k_t, Float::max) * fresnel, mirror);
                transmission = Spectrum::select(self.fresnel, k_t * (one - fresnel), transmission);
            }
            refracted = (bent.normalize(), transmission);
            is_refracted = is_bent & !transmission.is_black();
        }
        let mirrored = (optics::reflect(wo, n).normalize(), mirror);
        Branches { mirrored, refracted, is_refracted, fresnel, total_reflection }
    }
}

/// The model seen from an outgoing direction: the branches, and the probabilities of the four lobes.
#[derive(Clone, Copy, Debug)]
pub struct SeenWhitted<R: Real> {
    wo: Vector<R>,
    /// The weight of the reflected direction.
    mirror: Spectrum<R>,
    refracted: (Vector<R>, Spectrum<R>),
    diffuse_probability: R,
    glossy_probability: R,
    mirror_probability: R,
    refraction_probability: R,
    /// Whether any lobe carries light.
    exists: R::Mask,
}

impl<R: Real> WhittedCoefficients<R> {
    /// The model seen from `wo`. Each lobe has a probability about proportional to its weight.
    #[inline(always)]
    fn seen_from(&self, wo: Vector<R>) -> SeenWhitted<R> {
        let (zero, one) = (wo.z.like(0.0), wo.z.like(1.0));
        let black = Spectrum::splat(zero);
        let (mut mirror, mut refracted) = (black, (wo, black));
        if self.has_branches().any() {
            let n = Vector { x: zero, y: zero, z: Float::copysign(one, wo.z) };
            let branches = self.branches(n, wo, wo.z.gt(zero));
            let (direction, weight) = branches.refracted;
            mirror = branches.mirrored.1;
            refracted = (direction, Spectrum::select(branches.is_refracted, weight, black));
        }
        // The highlight's albedo seen from above: ∫ 4 (N·H)ⁿ⁺¹ / π dω_H = 8 / (n + 2), less the part below
        // the surface.
        let highlight = one.like(8.0) / (self.shininess + 4.0);
        let (diffuse, glossy) = (self.diffuse.max_lane(), self.specular.max_lane() * highlight);
        let (reflected, transmitted) = (mirror.max_lane(), refracted.1.max_lane());
        let sum = diffuse + glossy + reflected + transmitted;
        let exists = sum.gt(zero);
        let sum = R::select(exists, sum, one);
        SeenWhitted {
            wo,
            mirror,
            refracted,
            diffuse_probability: diffuse / sum,
            glossy_probability: glossy / sum,
            mirror_probability: reflected / sum,
            refraction_probability: transmitted / sum,
            exists,
        }
    }

    /// The BSDF, and the density of the lobes that are not specular. Not inlined, since it is needed several times.
    #[inline(never)]
    fn scattered(&self, seen: &SeenWhitted<R>, wi: Vector<R>) -> (Spectrum<R>, R) {
        wi.z.at_level(
            #[inline(always)]
            || {
                let wo = seen.wo;
                let (zero, cos) = (wo.z.like(0.0), Float::abs(wi.z));
                let is_lit = same_side(wo, wi);
                let mut f = self.diffuse;
                let mut pdf = seen.diffuse_probability * warp::cosine_hemisphere_pdf(cos);
                let is_glossy = !self.specular.is_black();
                if is_glossy.any() {
                    let (half, exists) = half_vector(wo, wi);
                    let power = elementary::power(R::select(exists, half.z, zero), self.shininess);
                    f += self.specular * R::select(is_glossy, power / cos, zero);
                    let of_half = (self.shininess + 1.0) * (1.0 / TAU) * power;
                    let per_half = Float::max(Float::abs(wo.dot(half)), zero.like(f32::MIN_POSITIVE)) * 4.0;
                    let glossy = seen.glossy_probability * of_half / per_half;
                    pdf = pdf + R::select(exists & is_glossy, glossy, zero);
                }
                (
                    Spectrum::select(is_lit, f * zero.like(FRAC_1_PI), Spectrum::splat(zero)),
                    R::select(is_lit & seen.exists, pdf, zero),
                )
            },
        )
    }

    /// A half vector distributed by the n-th power of its cosine, on the side of the sign of `side`.
    #[inline(always)]
    fn sample_half(&self, [u, v]: [R; 2], side: R) -> Vector<R> {
        // sin²θ = 1 − u^(2/(n+1)), without the subtraction.
        let exponent = elementary::ln(u) * (u.like(-2.0) / (self.shininess + 1.0));
        let sin2 = Float::clamp(elementary::one_minus_exp(exponent), 0.0, 1.0);
        let (sin_phi, cos_phi) = elementary::sin_cos_of_turns(v);
        let sin = Float::sqrt(sin2);
        let cos = Float::sqrt(u.like(1.0) - sin2);
        Vector { x: sin * cos_phi, y: sin * sin_phi, z: Float::copysign(cos, side) }
    }

    /// As [`super::Bsdf::sample`].
    #[inline(always)]
    fn sampled(&self, seen: &SeenWhitted<R>, uc: R, u: [R; 2]) -> DirectionSample<R> {
        let wo = seen.wo;
        let (zero, one) = (uc.like(0.0), uc.like(1.0));

        // Choose a lobe.
        let spread = seen.diffuse_probability + seen.glossy_probability;
        let is_diffuse = uc.lt(seen.diffuse_probability);
        let is_specular = !uc.lt(spread);
        let is_mirrored = (seen.mirror_probability.gt(zero) & uc.lt(spread + seen.mirror_probability))
            | Float::eq(seen.refraction_probability, zero);
        let is_transmission = is_specular & !is_mirrored;

        // Its direction.
        let mut wi = cosine_direction(u, wo.z);
        let is_glossy = !is_diffuse & !is_specular;
        if is_glossy.any() {
            let reflected = optics::reflect(wo, self.sample_half(u, wo.z)).normalize();
            wi = Vector::select(is_glossy, reflected, wi);
        }
        let (mut f, mut pdf) = (Spectrum::splat(zero), zero);
        if !is_specular.all() {
            (f, pdf) = self.scattered(seen, wi);
        }
        let is_lit = same_side(wo, wi);
        if is_specular.any() {
            let mirrored = Vector { x: -wo.x, y: -wo.y, z: wo.z };
            let only = Vector::select(is_mirrored, mirrored, seen.refracted.0);
            let weight = Spectrum::select(is_mirrored, seen.mirror, seen.refracted.1);
            let probability = R::select(is_mirrored, seen.mirror_probability, seen.refraction_probability);
            wi = Vector::select(is_specular, only, wi);
            f = Spectrum::select(is_specular, weight / Float::abs(only.z), f);
            pdf = R::select(is_specular, probability, pdf);
        }
        DirectionSample {
            wi,
            f,
            pdf,
            eta: one,
            is_specular,
            is_diffuse,
            is_transmission,
            is_valid: seen.exists & (is_specular | is_lit) & !is_grazing(wo),
        }
    }
}

impl<R: Real> LaneBsdf<R> for WhittedCoefficients<R> {
    type Prepared = SeenWhitted<R>;

    #[inline(always)]
    fn prepare(&self, wo: Vector<R>) -> SeenWhitted<R> {
        self.seen_from(wo)
    }

    #[inline(always)]
    fn f(&self, seen: &SeenWhitted<R>, wi: Vector<R>) -> Spectrum<R> {
        self.scattered(seen, wi).0
    }

    #[inline(always)]
    fn pdf(&self, seen: &SeenWhitted<R>, wi: Vector<R>) -> R {
        self.scattered(seen, wi).1
    }

    #[inline(always)]
    fn f_and_pdf(&self, seen: &SeenWhitted<R>, wi: Vector<R>) -> (Spectrum<R>, R) {
        self.scattered(seen, wi)
    }

    #[inline(always)]
    fn sample(&self, seen: &SeenWhitted<R>, uc: R, u: [R; 2]) -> DirectionSample<R> {
        self.sampled(seen, uc, u)
    }

    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        self.is_lit()
    }

    #[inline(always)]
    fn diffuse_share(&self, _: &SeenWhitted<R>, wi: Vector<R>, f: Spectrum<R>) -> Spectrum<R> {
        (self.diffuse * wi.z.like(FRAC_1_PI)).share_of(f)
    }
}

impl ScatteringFunction for WhittedCoefficients {
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

impl RowBsdf for WhittedCoefficients {
    type Lanes<S: Simd> = WhittedCoefficients<f32x8<S>>;

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        let is_fresnel = by_lane!(lane => if rows[lane].fresnel { 1.0 } else { 0.0 });
        WhittedCoefficients {
            ambient: gather_spectrum(simd, &by_lane!(lane => rows[lane].ambient)),
            diffuse: gather_spectrum(simd, &by_lane!(lane => rows[lane].diffuse)),
            specular: gather_spectrum(simd, &by_lane!(lane => rows[lane].specular)),
            shininess: f32x8::load_array(simd, by_lane!(lane => rows[lane].shininess)),
            mirror: gather_spectrum(simd, &by_lane!(lane => rows[lane].mirror)),
            transmission: gather_spectrum(simd, &by_lane!(lane => rows[lane].transmission)),
            ior: f32x8::load_array(simd, by_lane!(lane => rows[lane].ior)),
            fresnel: f32x8::load_array(simd, is_fresnel).gt(f32x8::splat(simd, 0.0)),
        }
    }
}

#[cfg(test)]
mod tests;
