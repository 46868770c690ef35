//! Reflection, refraction and Fresnel reflectance at a smooth boundary, at any width.

use lookfrom_simd::{Float, Real};

use crate::core::vector::Vector;

/// The reflection of `wo` about the unit normal `n`: both directions point away from the surface,
/// `2 (n·wo) n − wo`.
#[inline(always)]
pub fn reflect<R: Real>(wo: Vector<R>, n: Vector<R>) -> Vector<R> {
    n * (n.dot(wo) * 2.0) - wo
}

/// The direction of refraction by Snell's law for light that arrives along `−wo`, and whether there is one: not for
/// total internal reflection.
///
/// `n` has unit length and is on the side of `wo`; `eta` is the index of refraction beyond the surface divided by
/// the one on the side of `wo`. The result has unit length (up to rounding) for a unit `wo`.
#[inline(always)]
pub fn refract<R: Real>(wo: Vector<R>, n: Vector<R>, eta: R) -> (Vector<R>, R::Mask) {
    let cos_i = n.dot(wo);
    let (zero, one) = (eta.like(0.0), eta.like(1.0));
    let sin2_t = Float::max(one - cos_i * cos_i, zero) / (eta * eta);
    let is_refracted = sin2_t.lt(one);
    let cos_t = Float::sqrt(one - sin2_t);
    let along_wo = Vector { x: wo.x / eta, y: wo.y / eta, z: wo.z / eta };
    (n * (cos_i / eta - cos_t) - along_wo, is_refracted)
}

/// Fresnel reflectance of a dielectric for unpolarised light, for `cos_i = n·wo ≥ 0` and `eta` as in [`refract`].
#[inline(always)]
pub fn fresnel_dielectric<R: Real>(cos_i: R, eta: R) -> R {
    let one = eta.like(1.0);
    let cos_i = Float::clamp(cos_i, 0.0, 1.0);
    let sin2_t = (one - cos_i * cos_i) / (eta * eta);
    let cos_t = Float::sqrt(one - sin2_t);
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let reflected = (parallel * parallel + perpendicular * perpendicular) * 0.5;
    R::select(sin2_t.lt(one), reflected, one)
}
