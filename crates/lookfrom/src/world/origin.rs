//! The origin of render space, in which all coordinates of single precision are.

use glam::DVec3;
use lookfrom_scene::Scene;
use lookfrom_scene::camera::{Camera, Projection, View};
use lookfrom_scene::scene::Bounds;

/// Distance of a parallel camera from the scene, in radii of the scene, beyond which render space has its origin nearer.
const FAR: f64 = 8.0;

/// The origin of render space: the camera's position; of a parallel camera far away, where nothing is nearer than the scene,
/// the point of its axis beside the scene's middle; of one that measures irradiance the middle of the surface.
pub(super) fn of_render_space(camera: &Camera, scene: &Scene) -> DVec3 {
    let lookfrom = camera.view.lookfrom();
    if let Projection::Irradiance { surface } = &camera.projection {
        let of_surface = scene.shapes_named(surface).map(|shape| shape.bounds(&scene.meshes));
        let middle = of_surface.fold(Bounds::EMPTY, Bounds::union).center();
        return if middle.is_finite() { middle } else { lookfrom };
    }
    let bounds = scene.bounds();
    if !matches!(camera.projection, Projection::Orthographic { .. }) || bounds.is_empty() {
        return lookfrom;
    }
    let middle = 0.5 * (bounds.min + bounds.max);
    let w = match camera.view {
        View::Look { lookat, .. } => lookat - lookfrom,
        View::Matrix(matrix) => matrix.z_axis.truncate(),
    };
    let way = w.normalize_or_zero() * (middle - lookfrom).dot(w.normalize_or_zero());
    let is_far = way.is_finite() && way.length() > FAR * bounds.radius();
    if is_far { lookfrom + way } else { lookfrom }
}
