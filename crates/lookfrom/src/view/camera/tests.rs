//! Cameras of the notes, and those that are refused.

use lookfrom_simd::{Kernel, Level, Simd, dispatch, f32x8, f64x8, prelude::*};

use super::*;
use crate::core::lanes::scatter_f64;

fn look(lookfrom: [f64; 3], lookat: [f64; 3], up: [f64; 3]) -> Written {
    Written {
        view: View::Look { lookfrom: lookfrom.into(), lookat: lookat.into(), up: up.into() },
        ..Written::default()
    }
}

#[test]
fn the_exercise_of_the_notes() {
    // d = 1, lookfrom at the origin, lookat = (0, 0, d), up = (0, 1, 0): M_vw is the identity, exactly.
    let camera = Camera::new(&look([0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]), 640, 480).unwrap();
    assert_eq!(camera.t4 * camera.r3, DMat4::IDENTITY);
}

#[test]
fn the_middle_of_the_image_looks_at_lookat() {
    let camera = Camera::new(&look([3.0, 1.0, -4.0], [-2.0, 5.0, 7.0], [0.1, 1.0, 0.2]), 300, 200).unwrap();
    let ray = camera.ray([150.0, 100.0], [0.5; 2]);
    let toward = DVec3::new(-5.0, 4.0, 11.0).normalize();
    assert!((ray.direction - toward).length() < 1e-15);
    assert!((ray.p_world - DVec3::new(3.0, 1.0, -4.0) - toward).length() < 1e-14);
}

#[test]
fn theta_is_vertical_and_y_is_up_and_x_is_right() {
    let mut written = look([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]);
    written.projection = Projection::Perspective { fov: 90.0 };
    let camera = Camera::new(&written, 400, 200).unwrap();
    // Looking along −z with y up, the right of the image is +x: the right-handed world of the notes.
    let top_right = camera.ray([400.0, 200.0], [0.5; 2]).direction;
    assert!((top_right - DVec3::new(2.0, 1.0, -1.0)).length() < 1e-14, "{top_right}");
}

#[test]
fn t_is_one_on_the_image_plane_whatever_the_lens() {
    let mut written = look([1.0, 2.0, 3.0], [0.0; 3], [0.0, 1.0, 0.0]);
    written.distance = 2.5;
    written.lens = Some(Lens { radius: 0.3, focus_distance: 4.0 });
    let camera = Camera::new(&written, 64, 48).unwrap();
    let pinhole = camera.ray([10.0, 40.0], [0.5; 2]);
    for u in [[0.1, 0.9], [0.7, 0.2], [0.99, 0.01]] {
        let ray = camera.ray([10.0, 40.0], u);
        assert!((ray.direction.dot(camera.w()) - 2.5).abs() < 1e-12);
        assert!(ray.a_from_eye.length() <= 0.3 + 1e-12 && ray.a_from_eye.dot(camera.w()).abs() < 1e-12);
        let sharp = |ray: &CameraRay| ray.a_from_eye + ray.direction * (4.0 / 2.5);
        assert!((sharp(&ray) - sharp(&pinhole)).length() < 1e-12);
    }
}

#[test]
fn orthographic_rays_are_parallel() {
    let mut written = look([0.0, 0.0, 5.0], [0.0; 3], [0.0, 1.0, 0.0]);
    written.projection = Projection::Orthographic { height: 4.0 };
    let camera = Camera::new(&written, 200, 100).unwrap();
    let corner = camera.ray([200.0, 100.0], [0.5; 2]);
    assert!((corner.a_from_eye - DVec3::new(4.0, 2.0, 0.0)).length() < 1e-14);
    assert!((corner.direction - DVec3::new(0.0, 0.0, -1.0)).length() < 1e-14);
}

#[test]
fn rays_in_lanes_are_the_same() {
    struct Eight<'a>(&'a Camera, [[f64; 2]; 8], [[f32; 2]; 8]);
    impl Kernel for Eight<'_> {
        type Output = [([f64; 3], [f64; 3], f32); 8];
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let [x, y] = [0, 1].map(|axis| f64x8::load_array(simd, self.1.map(|point| point[axis])));
            let [u, v] = [0, 1].map(|axis| f32x8::load_array(simd, self.2.map(|lens| lens[axis])));
            let ray = self.0.flat_ray([x, y], [u, v]);
            let (a, direction) = (scatter_f64(ray.a), scatter_f64(ray.direction));
            let weight: [f32; 8] = ray.weight.into();
            std::array::from_fn(|lane| (a[lane], direction[lane], weight[lane]))
        }
    }
    let mut written = look([3.0, 1.0, -4.0], [-2.0, 5.0, 7.0], [0.1, 1.0, 0.2]);
    let thin = Some(Lens { radius: 0.3, focus_distance: 4.0 });
    let systems = crate::view::lens_system::tests::examples();
    let cases = [
        (Projection::Perspective { fov: 40.0 }, None),
        (Projection::Perspective { fov: 40.0 }, thin),
        (Projection::Orthographic { height: 3.0 }, None),
        (Projection::Orthographic { height: 3.0 }, thin),
    ];
    let systems = systems.into_iter().map(|system| (Projection::LensSystem(Arc::new(system)), None));
    for (projection, lens) in cases.into_iter().chain(systems) {
        (written.projection, written.lens) = (projection, lens);
        let camera = Camera::new(&written, 300, 200).unwrap();
        assert!(camera.is_flat());
        let points = [[0.25, 199.5], [150.0, 100.0], [-0.75, 0.0], [299.1, 13.7]];
        let points: [[f64; 2]; 8] = std::array::from_fn(|lane| points[lane % 4]);
        let lens = std::array::from_fn(|lane| [0.1 + 0.11 * lane as f32, 0.95 - 0.07 * lane as f32]);
        for level in [Level::baseline(), lookfrom_simd::level()] {
            let eight = dispatch(level, Eight(&camera, points, lens));
            for (lane, (a, direction, weight)) in eight.into_iter().enumerate() {
                let ray = camera.ray(points[lane], lens[lane]);
                let one = (ray.a_from_eye.to_array(), ray.direction.to_array(), ray.weight);
                assert_eq!(one, (a, direction, weight), "{:?} lane {lane}", camera.projection);
            }
        }
    }
}

#[test]
fn a_mirroring_matrix_makes_a_mirrored_picture() {
    let plain = Camera::new(&look([0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]), 100, 100).unwrap();
    let mirror = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let mirrored =
        Camera::new(&Written { view: View::Matrix(mirror), ..Written::default() }, 100, 100).unwrap();
    assert_eq!(plain.ray([20.0, 30.0], [0.5; 2]).direction, mirrored.ray([80.0, 30.0], [0.5; 2]).direction);
}

#[test]
fn every_degenerate_camera_is_a_clear_error() {
    let good = || look([0.0, 0.0, 5.0], [0.0; 3], [0.0, 1.0, 0.0]);
    let of = |written: &Written| Camera::new(written, 10, 10).unwrap_err().to_string();
    assert!(of(&look([1.0; 3], [1.0; 3], [0.0, 1.0, 0.0])).contains("same point"));
    assert!(of(&look([0.0; 3], [1.0; 3], [0.0; 3])).contains("up is zero"));
    assert!(of(&look([0.0; 3], [0.0, 2.0, 0.0], [0.0, 1.0, 0.0])).contains("parallel"));
    assert!(of(&look([0.0, f64::NAN, 0.0], [1.0; 3], [0.0, 1.0, 0.0])).contains("lookfrom"));
    for fov in [0.0, -10.0, 180.0, 400.0, f64::NAN, f64::INFINITY] {
        assert!(of(&Written { projection: Projection::Perspective { fov }, ..good() }).contains("fov"));
    }
    for distance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(of(&Written { distance, ..good() }).contains("distance"));
    }
    assert!(of(&Written { view: View::Matrix(DMat4::ZERO), ..good() }).contains("invertible"));
    let lens = Some(Lens { radius: 0.1, focus_distance: 0.0 });
    assert!(of(&Written { lens, ..good() }).contains("focus_distance"));
    assert!(Camera::new(&good(), 0, 10).unwrap_err().to_string().contains("0 × 10"));
    assert!(Camera::new(&good(), 10, 10).is_ok());
}

#[test]
fn pictures_of_everything_around_have_their_columns_in_order() {
    let camera = |projection| {
        let written = Written { projection, ..look([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]) };
        Camera::new(&written, 400, 200).unwrap()
    };
    let sees = |projection: Projection, u: f64, direction: [f64; 3]| {
        let ray = camera(projection.clone()).ray([400.0 * u, 100.0], [0.5; 2]);
        assert!(ray.direction.distance(direction.into()) < 1e-12, "{projection:?} {u}: {}", ray.direction);
    };
    let (left, front, right) = ([-1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]);
    for (u, direction) in [(0.25, left), (0.5, front), (0.75, right), (0.0, [0.0, 0.0, 1.0])] {
        sees(Projection::Equirectangular, u, direction);
    }
    // pbrt-v4's SphericalCamera: (sin θ cos φ, cos θ, sin θ sin φ) with φ = 2π u, x to the right and z forward.
    for (u, direction) in [(0.0, right), (0.25, front), (0.5, left)] {
        sees(Projection::EquirectangularPbrt, u, direction);
    }
}
