//! Projections of the world onto a drawing: from the side, from above, from behind the camera, and as the camera sees it.

use glam::{DMat4, DVec2, DVec3, DVec4};
use lookfrom_scene::camera::Projection as OfCamera;

use super::SvgView;
use crate::view::camera::Camera;

/// A view of the world: x to the right, y up, z away from the viewer.
pub(super) struct Projection {
    view_from_world: DMat4,
    /// Whether points are divided by their z; otherwise the projection is parallel.
    is_perspective: bool,
    /// The least z that is drawn.
    near: f64,
}

impl Projection {
    /// `None` for the camera's view where it sees all around. A perspective has nothing that is nearer to the eye than
    /// `near`.
    pub(super) fn new(camera: &Camera, view: SvgView, near: f64) -> Option<Self> {
        let axes = &camera.r3;
        let [left, up, forward] =
            [axes.x_axis, axes.y_axis, axes.z_axis].map(|axis| axis.truncate().normalize());
        // The world's y is up, unless the camera looks along it.
        let level = forward.reject_from_normalized(DVec3::Y);
        let (ahead, upward) =
            if level.length() > 0.3 { (level.normalize(), DVec3::Y) } else { (forward, up) };
        let right = ahead.cross(upward);
        let is_perspective = match (view, &camera.projection) {
            (SvgView::Camera, OfCamera::Perspective { .. } | OfCamera::LensSystem(_)) => true,
            (SvgView::Camera, OfCamera::Orthographic { .. }) => false,
            (SvgView::Camera, _) => return None,
            _ => false,
        };
        let [x, y, z] = match view {
            SvgView::Side => [ahead, upward, -right],
            SvgView::Top => [ahead, -right, -upward],
            SvgView::Front => [right, upward, ahead],
            SvgView::Camera | SvgView::Sheet | SvgView::Lens => [-left, up, forward],
        };
        let eye = if view == SvgView::Camera { camera.lookfrom() } else { DVec3::ZERO };
        let rows = DMat4::from_cols(x.extend(0.0), y.extend(0.0), z.extend(0.0), DVec4::W).transpose();
        let near = if is_perspective { near } else { f64::NEG_INFINITY };
        Some(Self { view_from_world: rows * DMat4::from_translation(-eye), is_perspective, near })
    }

    /// A point of the drawing from one in view space.
    fn flat(&self, point: DVec3) -> DVec2 {
        if self.is_perspective { point.truncate() / point.z } else { point.truncate() }
    }

    /// A point of the world, unless it is behind the viewer.
    pub(super) fn point(&self, point: DVec3) -> Option<DVec2> {
        let point = self.view_from_world.transform_point3(point);
        (point.z >= self.near).then(|| self.flat(point))
    }

    /// The part of a line segment that is before the viewer.
    pub(super) fn segment(&self, ends: [DVec3; 2]) -> Option<[DVec2; 2]> {
        let [a, b] = ends.map(|end| self.view_from_world.transform_point3(end));
        let cut = |from: DVec3, to: DVec3| match from.z < self.near {
            true => from.lerp(to, (self.near - from.z) / (to.z - from.z)),
            false => from,
        };
        (a.z >= self.near || b.z >= self.near).then(|| [cut(a, b), cut(b, a)].map(|end| self.flat(end)))
    }

    /// The part of a convex polygon that is before the viewer (Sutherland & Hodgman 1974).
    pub(super) fn polygon(&self, corners: &[DVec3]) -> Vec<DVec2> {
        let corners: Vec<DVec3> =
            corners.iter().map(|corner| self.view_from_world.transform_point3(*corner)).collect();
        let mut before = Vec::new();
        for (index, &to) in corners.iter().enumerate() {
            let from = corners[(index + corners.len() - 1) % corners.len()];
            if (from.z < self.near) != (to.z < self.near) {
                before.push(from.lerp(to, (self.near - from.z) / (to.z - from.z)));
            }
            if to.z >= self.near {
                before.push(to);
            }
        }
        before.into_iter().map(|corner| self.flat(corner)).collect()
    }

    /// The eye of a perspective, or the direction away from the viewer, as a homogeneous point of the world.
    pub(super) fn viewer(&self) -> DVec4 {
        let from_view = self.view_from_world.inverse();
        from_view * if self.is_perspective { DVec4::W } else { DVec4::new(0.0, 0.0, -1.0, 0.0) }
    }
}
