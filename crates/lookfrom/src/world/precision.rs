//! Precision of positions: the region in which a world is as precise as at its origin.
//!
//! At a distance D from the origin a position is rounded by up to 2⁻²⁴ D. That is less than a sixteenth of a pixel of a
//! picture 4,096 pixels wide as long as it is less than 2⁻¹⁶ of the distance to the visible surface, which must be at
//! least D / 256.

use glam::DVec3;

use super::World;

/// Maximum ratio of a camera's distance from the origin to its distance from the nearest surface.
const FARTHEST: f64 = 256.0;

impl World {
    /// Whether a view from a point of the world (not of render space) is as precise as one from the origin of render
    /// space: whether the camera is at most 256 times farther from the origin than from the nearest surface. Triangles,
    /// spheres and instances of them count; other shapes have no distance query.
    pub fn is_precise_from(&self, eye: DVec3) -> bool {
        let eye = eye - self.origin;
        let reach = (eye.length() / FARTHEST) as f32;
        reach == 0.0 || self.bvh.closest_point(eye.as_vec3().to_array(), reach).is_none()
    }
}
