//! Fresnel reflectance of smooth boundaries.
//!
//! Fresnel 1823, for unpolarised light; the form for a complex index of refraction follows Born & Wolf 1959.

use glam::Vec4;

use crate::core::math;
use crate::core::spectrum::Spectrum;

/// The largest index of refraction or extinction that is distinguished; beyond it f32 squares overflow.
const GREATEST: f32 = 1e8;

/// The index of refraction clamped to the domain of the formulas below: positive and within 10±⁶; 0 and NaN become
/// 1, as in pbrt.
#[inline]
pub(super) fn valid_eta(eta: f32) -> f32 {
    if eta > 0.0 { eta.clamp(1e-6, 1e6) } else { 1.0 }
}

/// Fresnel reflectance of a dielectric, for the signed cosine to the normal: negative means from inside. `eta`
/// is the index of refraction inside divided by the one outside.
#[inline]
pub fn dielectric(cos_theta: f32, eta: f32) -> f32 {
    math::fresnel_dielectric(cos_theta.abs(), relative_eta(cos_theta, eta))
}

/// The index of refraction beyond the surface divided by the one on the incident side, by the sign of the
/// cosine.
#[inline]
pub(super) fn relative_eta(cos_theta: f32, eta: f32) -> f32 {
    if cos_theta < 0.0 { 1.0 / eta } else { eta }
}

/// Fresnel reflectance of a metal of index `eta` and extinction `k` (both over the index outside), lane by lane,
/// for the cosine of the angle to the normal; a negative cosine counts as 0.
#[inline]
pub fn conductor(cos_theta: f32, eta: Spectrum, k: Spectrum) -> Spectrum {
    /// Far below any real value; prevents 0 / 0 in unused lanes.
    const TINY: Vec4 = Vec4::splat(1e-30);
    let valid = |lanes: Spectrum| Vec4::from_array(lanes.0).max(Vec4::ZERO).min(Vec4::splat(GREATEST));
    let (eta, k) = (valid(eta), valid(k));
    let cos = cos_theta.clamp(0.0, 1.0);
    let cos2 = cos * cos;
    let sin2 = 1.0 - cos2;
    // (a + ib)² = (η + ik)² − sin²θ, so a is the real part of the index times the refracted cosine.
    let difference = (eta - k) * (eta + k) - sin2;
    let product = eta * k;
    let modulus = (difference * difference + 4.0 * product * product).sqrt();
    // The larger of a and b comes from the sum that does not cancel, the other from a b = η k.
    let greater = (0.5 * (modulus + difference.abs())).sqrt();
    let lesser = product / (greater + TINY);
    let a = Vec4::select(difference.cmpge(Vec4::ZERO), greater, lesser);
    let twice = 2.0 * a * cos;
    let perpendicular = (modulus + cos2 - twice) / (modulus + cos2 + twice);
    // At normal incidence both polarisations agree: the factor becomes one.
    let (even, odd) = (cos2 * modulus + sin2 * sin2 + TINY, twice * sin2);
    Spectrum((0.5 * perpendicular * (1.0 + (even - odd) / (even + odd))).to_array())
}

/// The index and extinction `(η, k)` of a metal with the given `reflectance` at normal incidence, as pbrt chooses
/// them: η = 1 and k = 2 √(r / (1 − r)), with r at most 0.9999.
pub fn conductor_of_reflectance(reflectance: Spectrum) -> (Spectrum, Spectrum) {
    let k = reflectance.map(|r| {
        let r = r.clamp(0.0, 0.9999);
        2.0 * r.sqrt() / (1.0 - r).sqrt()
    });
    (Spectrum([1.0; 4]), k)
}
