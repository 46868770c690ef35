//! The footprint of a camera's pixels: the smallest difference between the rays of neighbours.

use glam::{DMat3, DVec3};

use crate::core::warp;
use crate::shading::footprint::PixelFootprint;
use crate::view::camera::Camera;

/// Number of pixels that are looked at, along the picture's diagonal.
const PIXELS: usize = 512;

/// That of the narrowest pixels, in x and in y, along the picture's diagonal.
pub(super) fn of_pixels(camera: &Camera) -> PixelFootprint {
    let world_from_camera = DMat3::from_mat4(camera.r3);
    let camera_from_world = world_from_camera.inverse();
    let ray = |pixel: [f64; 2]| {
        let ray = camera.ray(pixel, [0.5; 2]);
        // Where a lens blocks it, it is another ray.
        (ray.weight != 0.0).then(|| [ray.a_from_eye, ray.direction].map(|v| camera_from_world * v))
    };
    let [width, height] = camera.size.map(f64::from);
    let mut origins = [DVec3::INFINITY; 2];
    let mut directions = [DVec3::INFINITY; 2];
    for index in 0..PIXELS {
        let along = index as f64 / (PIXELS - 1) as f64;
        let at = [along * width, along * height];
        let Some([origin, direction]) = ray(at) else { continue };
        let z = direction.normalize();
        let (x, y) = warp::basis_about::<f64>(z.into());
        let [x, y] = [x, y].map(DVec3::from);
        let local = |v: DVec3| DVec3::new(v.dot(x), v.dot(y), v.dot(z));
        for (axis, next) in [[at[0] + 1.0, at[1]], [at[0], at[1] + 1.0]].into_iter().enumerate() {
            let Some([next_origin, next_direction]) = ray(next) else { continue };
            let moved = [local(next_origin - origin), local(next_direction.normalize() - z)];
            for (least, moved) in [&mut origins, &mut directions].into_iter().zip(moved) {
                if moved.length() < least[axis].length() {
                    least[axis] = moved;
                }
            }
        }
    }
    PixelFootprint { eye: camera.lookfrom(), world_from_camera, camera_from_world, origins, directions }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lookfrom_scene::camera::{Camera as Written, Projection, View};

    fn footprint(projection: Projection) -> PixelFootprint {
        let view = View::Look { lookfrom: DVec3::new(1.0, 2.0, 3.0), lookat: DVec3::ZERO, up: DVec3::Y };
        of_pixels(&Camera::new(&Written { view, projection, ..Written::default() }, 200, 100).unwrap())
    }

    /// Intersection of a ray of a camera with a plane, from the origin of the world.
    fn meets(camera: &Camera, pixel: [f64; 2], (p, n): (DVec3, DVec3)) -> DVec3 {
        let ray = camera.ray(pixel, [0.5; 2]);
        let origin = camera.lookfrom() + ray.a_from_eye;
        origin + ray.direction * ((p - origin).dot(n) / ray.direction.dot(n))
    }

    /// The differences of neighbouring rays where pixels are all alike, and elsewhere not larger. Of parallel rays on the axis alone: other
    /// points are not seen in the direction from the camera.
    #[test]
    fn footprints_are_differences_of_rays() {
        let view = View::Look { lookfrom: DVec3::new(3.0, 2.0, -4.0), lookat: DVec3::ZERO, up: DVec3::Y };
        let wide = Projection::Perspective { fov: 60.0 };
        let narrow = [Projection::Perspective { fov: 5.0 }, Projection::Orthographic { height: 3.0 }];
        for projection in narrow.into_iter().chain([wide.clone()]) {
            let is_narrow = projection != wide;
            let is_parallel = matches!(projection, Projection::Orthographic { .. });
            let camera = Camera::new(&Written { view, projection, ..Written::default() }, 400, 300).unwrap();
            let pixels = of_pixels(&camera);
            for k in 0..200 {
                let of = |index: u64| (crate::core::hash::pair(k, index) >> 11) as f64 / (1_u64 << 53) as f64;
                let pixel = if is_parallel { [200.0, 150.0] } else { [400.0 * of(0), 300.0 * of(1)] };
                let ray = camera.ray(pixel, [0.5; 2]);
                let at = camera.lookfrom() + ray.a_from_eye + ray.direction * (0.1 + 10.0 * of(2));
                // A plane that is not seen from its edge.
                let toward = -ray.direction.normalize();
                let n = (toward + 0.8 * DVec3::new(of(3), of(4), of(5)).normalize()).normalize();
                let dpdu = n.cross(DVec3::new(0.3, 1.0, -0.2)).normalize() * (0.1 + of(6));
                let dpdv = n.cross(dpdu).normalize() + 0.5 * dpdu;
                let found = pixels.at(at, n, [dpdu.as_vec3(), dpdv.as_vec3()]);
                for (axis, next) in
                    [[pixel[0] + 1.0, pixel[1]], [pixel[0], pixel[1] + 1.0]].into_iter().enumerate()
                {
                    let step = meets(&camera, next, (at, n)) - at;
                    let length = f64::from(found.p[axis].length());
                    if is_narrow {
                        let apart = (found.p[axis].as_dvec3() - step).length();
                        assert!(apart < 0.06 * step.length(), "{} {step}", found.p[axis]);
                    }
                    assert!(
                        length < 1.6 * step.length(),
                        "{length} of {}, narrow: {is_narrow}",
                        step.length()
                    );
                    // u and v move the point by as much.
                    let by_uv = f64::from(found.uv[axis].x) * dpdu + f64::from(found.uv[axis].y) * dpdv;
                    assert!((by_uv - found.p[axis].as_dvec3()).length() < 1e-4 * length, "{by_uv}");
                }
            }
        }
    }

    #[test]
    fn pixels_of_a_pinhole_differ_in_direction_and_parallel_ones_in_origin() {
        let PixelFootprint { origins, directions, eye, .. } =
            footprint(Projection::Perspective { fov: 10.0 });
        assert_eq!((eye, origins), (DVec3::new(1.0, 2.0, 3.0), [DVec3::ZERO; 2]));
        // Narrowest in the corner, where they are seen from the side: by at most cos² of the angle to it.
        let pixel = 2.0 * libm::tan(5_f64.to_radians()) / 100.0;
        for direction in directions {
            assert!((0.95..1.0).contains(&(direction.length() / pixel)), "{direction} {pixel}");
        }
        let PixelFootprint { origins, directions, .. } = footprint(Projection::Orthographic { height: 5.0 });
        assert_eq!(directions, [DVec3::ZERO; 2]);
        for origin in origins {
            assert!((origin.length() - 0.05).abs() < 1e-12, "{origin}");
        }
    }
}
