//! Fit of a perspective camera to points, and to circles swept by points that rotate around an axis.
//!
//! A point is inside the right edge of the image where x − eye.x ≤ k (z − eye.z), and so on for the four edges: each edge is
//! a plane whose offset grows with a linear function of the point. Opposite edges together bound eye.z; the eye is halfway
//! between them. For the circle swept by a point, the maximum of the linear function counts.

use glam::DVec3;

use super::{FILL, FOV, TAN_HALF_FOV, TO_CAMERA};
use crate::camera::{Camera, Projection, View};

/// The four frustum planes of a camera, moved outward by each included point.
pub(super) struct Framing {
    /// The origin of the offsets.
    center: DVec3,
    /// The up vector in the world, of unit length.
    vertical: DVec3,
    forward: DVec3,
    /// Right and up in the image.
    axes: [DVec3; 2],
    /// The tangents of half the horizontal and vertical fields of view.
    slopes: [f64; 2],
    /// For each axis of the image, the maximum offset of its upper and of its lower edge.
    edges: [[f64; 2]; 2],
}

impl Framing {
    /// A three-quarter view from slightly above; `basis` is right, up and towards the viewer, of unit length, and `aspect`
    /// the image's aspect ratio (width over height).
    pub(super) fn new(center: DVec3, basis: [DVec3; 3], aspect: f64) -> Self {
        let aspect = if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 };
        let to_camera = TO_CAMERA[0] * basis[0] + TO_CAMERA[1] * basis[1] + TO_CAMERA[2] * basis[2];
        let forward = -to_camera.normalize();
        let right = forward.cross(basis[1]).normalize();
        Self {
            center,
            vertical: basis[1],
            forward,
            axes: [right, right.cross(forward)],
            slopes: [FILL * TAN_HALF_FOV * aspect, FILL * TAN_HALF_FOV],
            edges: [[f64::NEG_INFINITY; 2]; 2],
        }
    }

    /// Includes a point.
    pub(super) fn include(&mut self, point: DVec3) {
        let offset = point - self.center;
        for (axis, along) in self.axes.map(|axis| offset.dot(axis)).into_iter().enumerate() {
            let depth = self.slopes[axis] * offset.dot(self.forward);
            self.edges[axis][0] = self.edges[axis][0].max(along - depth);
            self.edges[axis][1] = self.edges[axis][1].max(-along - depth);
        }
    }

    /// Includes the circle swept by a point that rotates around the vertical axis through the centre.
    pub(super) fn include_turning(&mut self, point: DVec3) {
        let offset = point - self.center;
        let height = offset.dot(self.vertical);
        let radius = (offset - height * self.vertical).length();
        for axis in 0..2 {
            for (edge, sign) in [1.0, -1.0].into_iter().enumerate() {
                // The edge's linear function is the dot product with this vector.
                let gradient = sign * self.axes[axis] - self.slopes[axis] * self.forward;
                let along = gradient.dot(self.vertical);
                let across = (gradient - along * self.vertical).length();
                self.edges[axis][edge] = self.edges[axis][edge].max(height * along + radius * across);
            }
        }
    }

    /// The nearest camera in this direction that shows all included points, of which there must be at least one.
    pub(super) fn camera(self) -> Camera {
        let Self { center, vertical, forward, axes: [right, up], slopes, edges } = self;
        let [x, y] = edges.map(|[above, below]| 0.5 * (above - below));
        let depth_for = |axis: usize| -(edges[axis][0] + edges[axis][1]) / (2.0 * slopes[axis]);
        let z = depth_for(0).min(depth_for(1));
        let lookat = center + x * right + y * up;
        let view = View::Look { lookfrom: lookat + z * forward, lookat, up: vertical };
        Camera { view, projection: Projection::Perspective { fov: FOV }, ..Camera::default() }
    }
}
