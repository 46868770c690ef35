//! Precision of positions: where a world is as exact as at its origin.
//!
//! At a distance D from the origin a position is rounded by up to 2⁻²⁴ D. That is less than a sixteenth of a pixel of a picture
//! 4,096 pixels wide as long as it is less than 2⁻¹⁶ of the distance to what is seen, so the limit is D / 256.

use glam::DVec3;

use super::World;

/// How many times farther from the origin than from the nearest surface an eye may be.
const FARTHEST: f64 = 256.0;

impl World {
    /// Whether a view from a place of the world (not of render space) is as good as one from the origin of render space: whether the
    /// eye is at most 256 times farther from the origin than from the nearest surface. Triangles, spheres and instances of them
    /// count; other shapes do not say how near they are.
    pub fn is_precise_from(&self, eye: DVec3) -> bool {
        let eye = eye - self.origin;
        let reach = (eye.length() / FARTHEST) as f32;
        reach == 0.0 || self.bvh.closest_point(eye.as_vec3().to_array(), reach).is_none()
    }
}
