//! Report on the camera: each matrix from the pixel to the world, each product, each point.

use glam::{DMat4, DVec4};
use lookfrom_scene::camera::Projection;

use super::report::{CameraSteps, MatrixStep, SphereMapping};
use crate::render::{Renderer, SampleId};
use crate::view::camera::{Camera, CameraRay};

pub(super) fn camera_steps(renderer: &Renderer, id: SampleId) -> CameraSteps {
    let camera = renderer.view().camera();
    let (ray, _) = renderer.camera_ray(id);
    let rows = |matrix: &DMat4| matrix.transpose().to_cols_array_2d();
    let mut product = DMat4::IDENTITY;
    let mut step = |name, does, matrix: &DMat4, point: DVec4| {
        product = *matrix * product;
        MatrixStep { name, does, matrix: rows(matrix), product: rows(&product), point: point.to_array() }
    };
    let mapping = mapping(camera, &ray);
    let steps = if mapping.is_some() {
        let direction = ray.direction.extend(0.0);
        vec![step(
            "R3",
            "view to world, about the camera: [u v w]; here of a direction",
            &camera.r3,
            direction,
        )]
    } else {
        vec![
            step(
                "T1",
                "the centre of the image to the axis, the image plane to the distance d",
                &camera.t1,
                ray.after_t1,
            ),
            step("S2", "pixels to lengths; x flipped, since u points to the left", &camera.s2, ray.after_s2),
            step("R3", "view to world, about the camera: [u v w]", &camera.r3, ray.after_r3),
            step("T4", "the camera to lookfrom", &camera.t4, ray.p_world.extend(1.0)),
        ]
    };
    let [u, v, w] =
        [camera.r3.x_axis, camera.r3.y_axis, camera.r3.z_axis].map(|axis| axis.truncate().to_array());
    let a = camera.lookfrom() + ray.a_from_eye;
    CameraSteps {
        lookfrom: camera.lookfrom().to_array(),
        u,
        v,
        w,
        projection: match camera.projection {
            Projection::Perspective { .. } => "perspective",
            Projection::Orthographic { .. } => "orthographic",
            Projection::Equirectangular => "equirectangular",
            Projection::EquirectangularPbrt => "equirectangular, as pbrt's",
            Projection::Octahedral => "octahedral",
        },
        p_k: ray.p_k.to_array(),
        steps,
        world_from_view: rows(&camera.world_from_view()),
        p_world: if mapping.is_some() { a + ray.direction } else { ray.p_world }.to_array(),
        a: a.to_array(),
        b: if camera.lens.is_some() || mapping.is_some() { a + ray.direction } else { ray.p_world }
            .to_array(),
        direction: ray.direction.to_array(),
        lens: camera.lens.is_some(),
        mapping,
    }
}

/// The way from the pixel to a direction where the camera sees all around: no matrix of an image plane.
fn mapping(camera: &Camera, ray: &CameraRay) -> Option<SphereMapping> {
    let does = match camera.projection {
        Projection::Perspective { .. } | Projection::Orthographic { .. } => return None,
        Projection::Equirectangular | Projection::EquirectangularPbrt => {
            "u is the angle around, v the angle up: longitude and latitude"
        }
        Projection::Octahedral => "the square is an octahedron unfolded, and that is blown up to a sphere",
    };
    let [u, v] = [0, 1].map(|k| ray.p_k[k] / f64::from(camera.size[k]));
    let in_view = camera.r3.inverse().transform_vector3(ray.direction);
    Some(SphereMapping { does, uv: [u, v], direction_in_view: in_view.to_array() })
}
