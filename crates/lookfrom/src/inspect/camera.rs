//! Report on the camera: each matrix from the pixel to the world, each product, each point.

use std::f64::consts::{PI, TAU};

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
    let mut steps = if camera.projection.is_measurement() {
        Vec::new()
    } else if mapping.is_some() {
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
    let mut a = camera.lookfrom() + ray.a_from_eye;
    let (mut direction, mut p_world) = (ray.direction, ray.p_world);
    if let Some((_, motion)) = renderer.camera_motion(id) {
        (a, p_world) = (motion.transform_point3(a), motion.transform_point3(p_world));
        direction = motion.transform_vector3(direction);
        let point = if mapping.is_some() { direction.extend(0.0) } else { p_world.extend(1.0) };
        steps.push(step("M", "the camera as far as it has moved since the shutter opened", &motion, point));
    }
    let b = a + direction;
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
            Projection::LensSystem(_) => "lens system",
            Projection::Irradiance { .. } => "irradiance",
        },
        p_k: ray.p_k.to_array(),
        steps,
        world_from_view: rows(&camera.world_from_view()),
        p_world: if mapping.is_some() { b } else { p_world }.to_array(),
        a: a.to_array(),
        b: if camera.has_lens() || mapping.is_some() { b } else { p_world }.to_array(),
        direction: direction.to_array(),
        lens: camera.has_lens(),
        mapping,
        lens_system: super::lens_system::report(renderer, id, ray.weight),
    }
}

/// The way from the pixel to a direction where there is no matrix of an image plane: the camera sees all around, or measures.
fn mapping(camera: &Camera, ray: &CameraRay) -> Option<SphereMapping> {
    let [u, v] = [0, 1].map(|k| ray.p_k[k] / f64::from(camera.size[k]));
    let (does, formula, numbers) = match camera.projection {
        Projection::Perspective { .. } | Projection::Orthographic { .. } | Projection::LensSystem(_) => {
            return None;
        }
        Projection::Equirectangular => (
            LONGITUDE_LATITUDE,
            "θ = π (1 − v), φ = 2π (u − ½); (−sin θ sin φ, cos θ, sin θ cos φ)",
            vec![("θ", PI * (1.0 - v)), ("φ", TAU * (u - 0.5))],
        ),
        Projection::EquirectangularPbrt => (
            LONGITUDE_LATITUDE,
            "θ = π (1 − v), φ = 2π u; (−sin θ cos φ, cos θ, sin θ sin φ)",
            vec![("θ", PI * (1.0 - v)), ("φ", TAU * u)],
        ),
        Projection::Irradiance { .. } => (
            "without effect: rays start anywhere on the surface that is measured, in proportion to its area A",
            "E = ∫∫ L cos θ dω da / A, with directions of the density cos θ / π: light counts π times, and as much more as the place is \
             sampled too rarely",
            vec![("weight", f64::from(ray.weight))],
        ),
        Projection::Octahedral => {
            let [x, y] = [2.0 * u - 1.0, 1.0 - 2.0 * v];
            let s = 1.0 - x.abs() - y.abs();
            let r = 1.0 - s.abs();
            let phi = if r == 0.0 { 1.0 } else { (y.abs() - x.abs()) / r + 1.0 } * 0.25 * PI;
            (
                "the square is an octahedron unfolded, and that is blown up to a sphere",
                "x = 2u − 1, y = 1 − 2v, s = 1 − |x| − |y|, r = 1 − |s|, φ = π/4 ((|y| − |x|) / r + 1), q = r √(2 − r²); (−sgn(x) \
                 cos φ q, sgn(s) (1 − r²), sgn(y) sin φ q)",
                vec![
                    ("x", x),
                    ("y", y),
                    ("s", s),
                    ("r", r),
                    ("φ", phi),
                    ("q", r * (2.0 - r * r).max(0.0).sqrt()),
                ],
            )
        }
    };
    let in_view = camera.r3.inverse().transform_vector3(ray.direction);
    Some(SphereMapping { does, uv: [u, v], formula, numbers, direction_in_view: in_view.to_array() })
}

const LONGITUDE_LATITUDE: &str = "u is the angle around, v the angle up: longitude and latitude";
