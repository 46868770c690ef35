//! Report on the camera: each matrix from the pixel to the world, each product, each point.

use glam::{DMat4, DVec4};

use super::report::{CameraSteps, MatrixStep};
use crate::render::{Renderer, SampleId};

pub(super) fn camera_steps(renderer: &Renderer, id: SampleId) -> CameraSteps {
    let camera = renderer.view().camera();
    let (ray, _) = renderer.camera_ray(id);
    let rows = |matrix: &DMat4| matrix.transpose().to_cols_array_2d();
    let mut product = DMat4::IDENTITY;
    let mut step = |name, does, matrix: &DMat4, point: DVec4| {
        product = *matrix * product;
        MatrixStep { name, does, matrix: rows(matrix), product: rows(&product), point: point.to_array() }
    };
    let steps = vec![
        step(
            "T1",
            "the centre of the image to the axis, the image plane to the distance d",
            &camera.t1,
            ray.after_t1,
        ),
        step("S2", "pixels to lengths; x flipped, since u points to the left", &camera.s2, ray.after_s2),
        step("R3", "view to world, about the camera: [u v w]", &camera.r3, ray.after_r3),
        step("T4", "the camera to lookfrom", &camera.t4, ray.p_world.extend(1.0)),
    ];
    let [u, v, w] =
        [camera.r3.x_axis, camera.r3.y_axis, camera.r3.z_axis].map(|axis| axis.truncate().to_array());
    let a = camera.lookfrom() + ray.a_from_eye;
    CameraSteps {
        lookfrom: camera.lookfrom().to_array(),
        u,
        v,
        w,
        p_k: ray.p_k.to_array(),
        steps,
        p_world: ray.p_world.to_array(),
        a: a.to_array(),
        b: if camera.lens.is_some() { a + ray.direction } else { ray.p_world }.to_array(),
        direction: ray.direction.to_array(),
        lens: camera.lens.is_some(),
    }
}
