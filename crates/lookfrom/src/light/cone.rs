//! Cones of directions: orientation bounds of a light tree.

use glam::Vec3;
use std::f32::consts::PI;

/// All directions whose cosine to `axis` is at least `cos`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cone {
    /// Unit length.
    pub(super) axis: Vec3,
    /// From 1 (the axis alone) to −1 (everything).
    pub(super) cos: f32,
}

impl Cone {
    /// Every direction.
    pub(super) const ALL: Self = Self { axis: Vec3::Z, cos: -1.0 };

    /// The smallest cone around both, up to rounding.
    pub(super) fn union(self, other: Self) -> Self {
        if self == other || self.cos <= -1.0 {
            return self;
        }
        let (half_a, half_b) = (angle(self.cos), angle(other.cos));
        let between = angle(self.axis.dot(other.axis));
        if (between + half_b).min(PI) <= half_a {
            return self;
        }
        if (between + half_a).min(PI) <= half_b {
            return other;
        }
        let half = 0.5 * (half_a + between + half_b);
        let normal = self.axis.cross(other.axis);
        if half >= PI || normal.length_squared() == 0.0 {
            return Self::ALL;
        }
        // Rotate the first axis toward the other one (Rodrigues; the rotation axis is perpendicular to both).
        let (sin, cos) = libm::sincosf(half - half_a);
        let axis = self.axis * cos + normal.normalize().cross(self.axis) * sin;
        Self { axis: axis.normalize(), cos: libm::cosf(half) }
    }
}

/// The angle of a cosine, clamped to ±1 against rounding.
pub(super) fn angle(cos: f32) -> f32 {
    libm::acosf(cos.clamp(-1.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::warp;

    #[test]
    fn a_union_holds_both() {
        let mut seed = 1_u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / 16_777_216.0
        };
        for _ in 0..2000 {
            let [a, b] = [(); 2].map(|()| Cone {
                axis: warp::uniform_sphere([next(), next()]),
                cos: 1.0 - 2.0 * next() * next(),
            });
            let both = a.union(b);
            for cone in [a, b] {
                // a direction on the rim of the cone
                let (s, t) = warp::orthonormal_basis(cone.axis);
                let (sin_phi, cos_phi) = libm::sincosf(2.0 * PI * next());
                let sin = (1.0 - cone.cos * cone.cos).max(0.0).sqrt();
                let rim = cone.axis * cone.cos + (s * cos_phi + t * sin_phi) * sin;
                assert!(rim.dot(both.axis) >= both.cos - 1e-3, "{a:?} {b:?} {both:?}");
            }
        }
    }
}
