//! Fit of a camera, perspective or orthographic, to points, and to circles swept by points that rotate around an axis.
//!
//! A point is inside the right edge of the image where x − eye.x ≤ k (z − eye.z), and so on for the four edges: each edge is
//! a plane whose offset grows with a linear function of the point. Opposite edges together bound eye.z; the eye is halfway
//! between them. For the circle swept by a point, the maximum of the linear function counts. For parallel rays k is 0: the
//! edges do not depend on the eye, which is before the nearest point.

use glam::DVec3;

use super::{FILL, Viewpoint};
use crate::camera::{Camera, Projection, View};

/// The least distance of the eye from the nearest point, and the least height of an orthographic picture, relative to the offset of
/// that point from the centre: of lines that are seen from their end, and of corners seen through wide lenses.
const LEAST: f64 = 1e-3;

/// The four frustum planes of a camera, moved outward by each included point.
pub(super) struct Framing {
    /// The origin of the offsets.
    center: DVec3,
    /// The axis of circles, of unit length.
    axis: DVec3,
    /// The up vector of the camera.
    vertical: DVec3,
    forward: DVec3,
    /// Right and up in the image.
    axes: [DVec3; 2],
    /// The vertical field of view; `None` for parallel rays.
    fov: Option<f64>,
    /// Width over height.
    aspect: f64,
    /// The tangents of half the horizontal and vertical fields of view; 0 for parallel rays.
    slopes: [f64; 2],
    /// The offset of the nearest point towards the camera.
    nearest: f64,
    /// For each axis of the image, the maximum offset of its upper and of its lower edge.
    edges: [[f64; 2]; 2],
}

impl Framing {
    /// A view of a scene; `basis` is right, up and towards the viewer, of unit length, and `aspect` the image's aspect ratio
    /// (width over height).
    pub(super) fn new(center: DVec3, basis: [DVec3; 3], aspect: f64, viewpoint: &Viewpoint) -> Self {
        let aspect = if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 };
        let [to_camera, vertical] = viewpoint.axes(basis);
        let forward = -to_camera;
        let right = forward.cross(vertical).normalize();
        let slope = viewpoint.slope();
        Self {
            center,
            axis: basis[1],
            vertical,
            forward,
            axes: [right, right.cross(forward)],
            fov: viewpoint.fov,
            aspect,
            slopes: [FILL * slope * aspect, FILL * slope],
            nearest: f64::NEG_INFINITY,
            edges: [[f64::NEG_INFINITY; 2]; 2],
        }
    }

    /// Includes a point.
    pub(super) fn include(&mut self, point: DVec3) {
        let offset = point - self.center;
        self.nearest = self.nearest.max(-offset.dot(self.forward));
        for (axis, along) in self.axes.map(|axis| offset.dot(axis)).into_iter().enumerate() {
            let depth = self.slopes[axis] * offset.dot(self.forward);
            self.edges[axis][0] = self.edges[axis][0].max(along - depth);
            self.edges[axis][1] = self.edges[axis][1].max(-along - depth);
        }
    }

    /// Includes the circle swept by a point that rotates around the vertical axis through the centre.
    pub(super) fn include_turning(&mut self, point: DVec3) {
        let offset = point - self.center;
        let height = offset.dot(self.axis);
        let radius = (offset - height * self.axis).length();
        // The maximum of a linear function, the dot product with its gradient.
        let farthest = |gradient: DVec3| {
            let along = gradient.dot(self.axis);
            let across = (gradient - along * self.axis).length();
            height * along + radius * across
        };
        self.nearest = self.nearest.max(farthest(-self.forward));
        for axis in 0..2 {
            for (edge, sign) in [1.0, -1.0].into_iter().enumerate() {
                let gradient = sign * self.axes[axis] - self.slopes[axis] * self.forward;
                self.edges[axis][edge] = self.edges[axis][edge].max(farthest(gradient));
            }
        }
    }

    /// The nearest camera in this direction that shows all included points, of which there must be at least one.
    pub(super) fn camera(self) -> Camera {
        let Self { center, vertical, forward, axes: [right, up], slopes, edges, .. } = self;
        let [x, y] = edges.map(|[above, below]| 0.5 * (above - below));
        let (z, projection) = match self.fov {
            Some(fov) => {
                let depth_for = |axis: usize| -(edges[axis][0] + edges[axis][1]) / (2.0 * slopes[axis]);
                let before = -self.nearest - LEAST * self.nearest.max(0.0);
                (depth_for(0).min(depth_for(1)).min(before), Projection::Perspective { fov })
            }
            None => {
                let [width, height] = edges.map(|[above, below]| (above + below) / FILL);
                let height = height.max(width / self.aspect).max(LEAST * self.nearest);
                (-self.nearest - height, Projection::Orthographic { height })
            }
        };
        let lookat = center + x * right + y * up;
        let view = View::Look { lookfrom: lookat + z * forward, lookat, up: vertical };
        Camera { view, projection, ..Camera::default() }
    }
}
