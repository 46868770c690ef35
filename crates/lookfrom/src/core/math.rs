//! Vector and scalar functions of rendering that glam lacks.

use glam::{DMat3, DMat4, DVec3, Vec3};
use lookfrom_bvh::Affine;
use lookfrom_simd::{Float, Real};

use crate::core::optics;

/// [`optics::reflect`] of one direction.
pub fn reflect(wo: Vec3, n: Vec3) -> Vec3 {
    optics::reflect(wo.into(), n.into()).into()
}

/// [`optics::refract`] of one direction; `None` for total internal reflection.
pub fn refract(wo: Vec3, n: Vec3, eta: f32) -> Option<Vec3> {
    let (wi, is_refracted) = optics::refract(wo.into(), n.into(), eta);
    is_refracted.then(|| wi.into())
}

/// The power heuristic (Veach & Guibas 1995, β = 2): weight of a sample of density `this`, where the other strategy has
/// density `other`.
#[inline(always)]
pub(crate) fn power_heuristic<R: Real>(this: R, other: R) -> R {
    // In this form nothing overflows.
    let ratio = other / this;
    this.like(1.0) / (ratio * ratio + 1.0)
}

/// Converts an affine matrix to the kernel's type.
pub fn affine(matrix: &DMat4) -> Affine {
    let rows = matrix.transpose();
    Affine {
        matrix: [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.truncate().to_array()),
        translation: matrix.w_axis.truncate().to_array(),
    }
}

/// The matrix of an affine map of the kernel.
pub fn matrix(affine: &Affine) -> DMat4 {
    let [x, y, z] = affine.matrix;
    let linear = DMat3::from_cols_array_2d(&[x, y, z]).transpose();
    DMat4::from_cols(
        linear.x_axis.extend(0.0),
        linear.y_axis.extend(0.0),
        linear.z_axis.extend(0.0),
        DVec3::from_array(affine.translation).extend(1.0),
    )
}

/// The direction of a normal transformed by a matrix, by the transpose of its `inverse`; not of unit length.
pub fn transform_normal(inverse: &DMat4, normal: DVec3) -> DVec3 {
    inverse.transpose().transform_vector3(normal)
}

/// Y of a linear Rec. 709 colour.
pub fn luminance([r, g, b]: [f32; 3]) -> f32 {
    0.212_639 * r + 0.715_169 * g + 0.072_192 * b
}

/// Schlick's (1 − cos θ)⁵: 0 at normal, 1 at grazing incidence.
#[inline(always)]
pub fn schlick<R: Real>(cos: R) -> R {
    let x = Float::clamp(cos.like(1.0) - cos, 0.0, 1.0);
    let x2 = x * x;
    x2 * x2 * x
}

/// The index that a number in [0, 1) chooses, by probabilities.
pub(crate) fn chosen(probabilities: &[f32], u: f32) -> usize {
    let mut left = u;
    for (index, &probability) in probabilities.iter().enumerate() {
        if left < probability {
            return index;
        }
        left -= probability;
    }
    // Rounding has left a rest.
    probabilities.iter().rposition(|probability| *probability > 0.0).unwrap_or_default()
}

/// Applies a closure that is always inlined to both; that of `array::map` may not be, so that it is not compiled for a SIMD level.
#[inline(always)]
pub(crate) fn both<T, U>([first, second]: [T; 2], f: impl Fn(T) -> U) -> [U; 2] {
    [f(first), f(second)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snell_angles() {
        let n = Vec3::Y;
        for degrees in [0.0f32, 10.0, 30.0, 60.0, 85.0] {
            let theta = degrees.to_radians();
            let wo = Vec3::new(libm::sinf(theta), libm::cosf(theta), 0.0);
            let wt = refract(wo, n, 1.5).unwrap();
            // sin θ_t = sin θ_i / 1.5, on the other side, in the same plane
            assert!((wt.x + wo.x / 1.5).abs() < 1e-6 && wt.y < 0.0 && wt.z == 0.0 && wt.is_normalized());
            // And back along the same path.
            let back = refract(wt, -n, 1.0 / 1.5).unwrap();
            assert!((back - wo).length() < 2e-6);
        }
        // The critical angle of glass is asin(1/1.5) = 41.81°.
        let inside = |degrees: f32| {
            let theta = degrees.to_radians();
            refract(Vec3::new(libm::sinf(theta), libm::cosf(theta), 0.0), n, 1.0 / 1.5)
        };
        assert!(inside(41.8).is_some() && inside(41.82).is_none());
    }

    #[test]
    fn fresnel_known_values() {
        assert!((optics::fresnel_dielectric(1.0, 1.5) - 0.04).abs() < 1e-6);
        assert!((optics::fresnel_dielectric(0.0, 1.5) - 1.0).abs() < 1e-6);
        // At Brewster's angle only the perpendicular polarisation is reflected: ½ ((η²−1)/(η²+1))².
        let brewster = 1.0 / (1.0f32 + 1.5 * 1.5).sqrt();
        let expected = 0.5 * (1.25f32 / 3.25).powi(2);
        assert!((optics::fresnel_dielectric(brewster, 1.5) - expected).abs() < 1e-6);
        assert_eq!(optics::fresnel_dielectric(0.5, 1.0 / 1.5), 1.0);
    }
}
