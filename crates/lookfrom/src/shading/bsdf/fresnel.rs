//! Fresnel reflectance of smooth boundaries.
//!
//! Fresnel 1823, for unpolarised light; the form for a complex index of refraction follows Born & Wolf 1959.

use lookfrom_simd::{Float, Real};

use crate::core::optics;
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
#[inline(always)]
pub fn dielectric<R: Real>(cos_theta: R, eta: R) -> R {
    optics::fresnel_dielectric(Float::abs(cos_theta), relative_eta(cos_theta, eta))
}

/// The index of refraction beyond the surface divided by the one on the incident side, by the sign of the
/// cosine.
#[inline(always)]
pub(super) fn relative_eta<R: Real>(cos_theta: R, eta: R) -> R {
    R::select(cos_theta.lt(eta.like(0.0)), eta.like(1.0) / eta, eta)
}

/// Fresnel reflectance of a metal of index `eta` and extinction `k` (both over the index outside), lane by lane,
/// for the cosine of the angle to the normal; a negative cosine counts as 0.
#[inline(always)]
pub fn conductor<R: Real>(cos_theta: R, eta: Spectrum<R>, k: Spectrum<R>) -> Spectrum<R> {
    let cos = Float::clamp(cos_theta, 0.0, 1.0);
    let ([eta0, eta1, eta2, eta3], [k0, k1, k2, k3]) = (eta.0, k.0);
    let [a, b] = [conductor_at(cos, eta0, k0), conductor_at(cos, eta1, k1)];
    Spectrum([a, b, conductor_at(cos, eta2, k2), conductor_at(cos, eta3, k3)])
}

/// Reflectance of a conductor at one wavelength, for a cosine within 0 … 1.
#[inline(always)]
fn conductor_at<R: Real>(cos: R, eta: R, k: R) -> R {
    /// Far below any real value; prevents 0 / 0 in unused lanes.
    const TINY: f32 = 1e-30;
    let (eta, k) = (Float::clamp(eta, 0.0, GREATEST), Float::clamp(k, 0.0, GREATEST));
    let cos2 = cos * cos;
    let sin2 = cos.like(1.0) - cos2;
    // (a + ib)² = (η + ik)² − sin²θ, so a is the real part of the index times the refracted cosine.
    let difference = (eta - k) * (eta + k) - sin2;
    let product = eta * k;
    let modulus = Float::sqrt(difference * difference + product * 4.0 * product);
    // Compute the larger of a and b from the sum that does not cancel, the other from a b = η k.
    let greater = Float::sqrt((modulus + Float::abs(difference)) * 0.5);
    let lesser = product / (greater + TINY);
    let a = R::select(difference.lt(cos.like(0.0)), lesser, greater);
    let twice = a * 2.0 * cos;
    let perpendicular = (modulus + cos2 - twice) / (modulus + cos2 + twice);
    // At normal incidence there is one polarisation only: the factor becomes one.
    let (even, odd) = (cos2 * modulus + sin2 * sin2 + TINY, twice * sin2);
    perpendicular * 0.5 * ((even - odd) / (even + odd) + 1.0)
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
