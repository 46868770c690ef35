//! Capsules around shapes that a map has placed.

use glam::{DMat3, DVec3};
use lookfrom_bvh::{Affine, Capsule};

/// The capsule of a radius around a segment, larger by more than the rounding of its ends and of a ray's way to object space.
pub(super) fn around(ends: [DVec3; 2], radius: f64) -> Capsule {
    let greatest = ends[0].abs().max(ends[1].abs()).max_element();
    let radius = (radius + greatest * f64::from(f32::EPSILON)) as f32;
    Capsule { ends: ends.map(|end| end.as_vec3().to_array()), radius: radius.next_up() }
}

/// An upper bound of the factor by which a map lengthens vectors, at most a hundredth too large: the largest eigenvalue λ of A = MᵀM is at
/// most the trace of A, and λⁿ is that of Aⁿ.
pub(super) fn stretch(map: &Affine) -> f64 {
    let matrix = DMat3::from_cols_array_2d(&map.matrix);
    let trace = |m: &DMat3| m.x_axis.x + m.y_axis.y + m.z_axis.z;
    let (mut power, mut bound, mut exponent) = (matrix * matrix.transpose(), 1.0, 0.5);
    for _ in 0..7 {
        let sum = trace(&power);
        bound *= libm::pow(sum, exponent);
        let scaled = power * (1.0 / sum);
        (power, exponent) = (scaled * scaled, 0.5 * exponent);
    }
    bound
}

/// The distance of a hit from a capsule's segment, but for the rounding of t.
#[cfg(test)]
pub(super) fn distance_to_hit(capsule: &Capsule, ray: &lookfrom_bvh::Ray, t: f32) -> f64 {
    let [from, to] = capsule.ends;
    let [a, b, o, d] = [from, to, ray.origin, ray.direction].map(|v| DVec3::from_array(v.map(f64::from)));
    let point = o + f64::from(t) * d;
    let share = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    point.distance(a.lerp(b, share)) - f64::from(f32::EPSILON * t) * d.length()
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::core::hash;

    fn vector(seed: u64) -> Vec3 {
        [0, 1, 2].map(|k| (hash::mix(3 * seed + k) >> 40) as f32 / 8_388_608.0 - 1.0).into()
    }

    #[test]
    fn the_stretch_of_a_map_is_at_most_a_hundredth_too_large() {
        for seed in 0..2000 {
            let scale = f64::powi(2.0, (hash::mix(seed) % 41) as i32 - 20);
            let matrix = [1, 2, 3].map(|row| (scale * vector(seed * 4 + row).as_dvec3()).to_array());
            let map = Affine { matrix, ..Affine::IDENTITY };
            let lengthened = |v: DVec3| DVec3::from_array(map.vector(v.to_array())).length() / v.length();
            // Some steps of the power iteration, for the true one.
            let transposed = DMat3::from_cols_array_2d(&matrix);
            let mut v = DVec3::new(0.6, 0.5, 0.4);
            for _ in 0..2000 {
                v = (transposed * DVec3::from_array(map.vector(v.to_array()))).normalize();
            }
            let (most, bound) = (lengthened(v), stretch(&map));
            assert!((1.0 + 1e-12) * bound >= most && bound <= 1.01 * most, "{map:?}: {most} {bound}");
        }
    }
}
