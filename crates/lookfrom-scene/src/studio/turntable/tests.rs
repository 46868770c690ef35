use glam::Vec3;

use super::*;
use crate::camera::{Camera, Projection};
use crate::error::Location;
use crate::material::Color;
use crate::scene::{MaterialId, MeshId};
use crate::shape::{Emission, Mesh, Sphere};
use crate::studio::{FILL, TAN_HALF_FOV, add_studio_and_camera};

/// A scene of boxes, given by two corners each, as one mesh.
fn boxes(source_format: SourceFormat, of: &[[[f32; 3]; 2]]) -> Scene {
    let mut mesh = Mesh::default();
    for [min, max] in of {
        let first = mesh.positions.len() as u32;
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { min[axis] } else { max[axis] };
            mesh.positions.push(Vec3::new(pick(0), pick(1), pick(2)));
        }
        mesh.triangles.extend([[0, 1, 2], [3, 4, 5], [5, 6, 7]].map(|t| t.map(|vertex| first + vertex)));
    }
    let mut scene = Scene { source_format, ..Scene::default() };
    scene.meshes.push(mesh);
    scene.shapes.push(Shape::new(Location::default(), Geometry::Mesh(MeshId(0)), MaterialId(0)));
    scene
}

/// The projections of the vertices: x and y in [−1, 1].
fn projected(scene: &Scene) -> Vec<[f64; 2]> {
    let camera = scene.camera.as_ref().unwrap();
    let View::Look { lookfrom, lookat, up } = camera.view else { panic!("not a lookat") };
    assert!(matches!(camera.projection, Projection::Perspective { .. }));
    let w = (lookat - lookfrom).normalize();
    let u = up.cross(w).normalize();
    let v = w.cross(u);
    let vertices = scene.meshes[0].positions.iter().map(|position| position.as_dvec3() - lookfrom);
    vertices
        .map(|to| {
            let depth = to.dot(w);
            assert!(depth > 0.0, "behind the eye");
            [-to.dot(u) / (depth * TAN_HALF_FOV * aspect(scene)), to.dot(v) / (depth * TAN_HALF_FOV)]
        })
        .collect()
}

#[test]
fn nothing_is_cut_at_any_angle_and_the_size_stays() {
    let long = vec![[[-5.0, -0.5, -0.5], [5.0, 0.5, 0.5]]];
    let tall = vec![[[-0.5, -5.0, -0.5], [0.5, 5.0, 0.5]]];
    let deep = vec![[[100.0, 0.0, -3.0], [101.0, 1.0, 7.0]]];
    let angle = vec![[[0.0, 0.0, 0.0], [10.0, 1.0, 1.0]], [[0.0, 0.0, 0.0], [1.0, 1.0, 10.0]]];
    for model in [long, tall, deep, angle] {
        for up in [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::Y, DVec3::new(1.0, 2.0, -1.0)] {
            for [width, height] in [[512, 512], [900, 300], [200, 700]] {
                let mut scene = boxes(SourceFormat::Model, &model);
                (scene.image.width, scene.image.height) = (width, height);
                let turntable = Turntable::new(&scene, Some(up), None);
                let (mut most, mut distances) = (0.0_f64, Vec::new());
                for step in 0..36 {
                    scene.camera = None;
                    turntable.frame(&mut scene, &Viewpoint::THREE_QUARTER);
                    scene.camera =
                        scene.camera.as_ref().map(|camera| turntable.turned(camera, 10.0 * f64::from(step)));
                    for point in projected(&scene) {
                        let largest = point[0].abs().max(point[1].abs());
                        assert!(largest <= FILL + 1e-9, "{model:?}, up {up}, step {step}: {point:?}");
                        most = most.max(largest);
                    }
                    let View::Look { lookfrom, .. } = scene.camera.as_ref().unwrap().view else { panic!() };
                    distances.push(lookfrom.distance(turntable.pivot));
                }
                assert!(distances.iter().all(|d| (d / distances[0] - 1.0).abs() < 1e-12), "{distances:?}");
                // It is no farther away than necessary, apart from the 10° between two steps.
                assert!(most > 0.95 * FILL, "{model:?}, up {up}, {width} × {height}: {most}");
            }
        }
    }
}

#[test]
fn a_scene_turns_around_what_its_camera_looks_at() {
    let mut scene = boxes(SourceFormat::Scene, &[[[-1.0; 3], [1.0; 3]]]);
    let lamp = Geometry::Sphere(Sphere { center: DVec3::new(400.0, 900.0, 0.0), radius: 20.0 });
    scene.shapes.push(Shape {
        emission: Some(Emission::new(Color::gray(1.0), false)),
        ..Shape::new(Location::default(), lamp, MaterialId(0))
    });
    let lookat = DVec3::new(0.5, 0.25, -0.5);
    let view = View::Look { lookfrom: DVec3::new(0.5, 3.0, 7.0), lookat, up: DVec3::Y };
    scene.camera = Some(Camera { view, ..Camera::default() });
    let turntable = Turntable::new(&scene, None, None);
    turntable.frame(&mut scene, &Viewpoint::THREE_QUARTER);
    scene.camera = scene.camera.as_ref().map(|camera| turntable.turned(camera, 90.0));
    let View::Look { lookfrom, lookat: after, .. } = scene.camera.as_ref().unwrap().view else { panic!() };
    assert!(after.distance(lookat) < 1e-12, "{after}");
    assert!(lookfrom.distance(DVec3::new(8.0, 3.0, -0.5)) < 1e-12, "{lookfrom}");

    // Without a target the axis goes through the visible subject, with a target of another format through that.
    let matrix = DMat4::from_translation(DVec3::new(0.0, 0.0, 5.0));
    scene.camera = Some(Camera { view: View::Matrix(matrix), ..Camera::default() });
    assert_eq!(Turntable::new(&scene, None, None).pivot, DVec3::ZERO);
    assert_eq!(Turntable::new(&scene, None, Some(DVec3::X)).pivot, DVec3::X);
}

#[test]
fn lamps_domes_and_floors_without_end_do_not_move_the_axis() {
    let shape = |geometry| Shape::new(Location::default(), geometry, MaterialId(0));
    let mut scene = boxes(SourceFormat::Scene, &[[[1.0; 3], [3.0; 3]]]);
    let matrix = DMat4::from_translation(DVec3::new(0.0, 2.0, 9.0));
    scene.camera = Some(Camera { view: View::Matrix(matrix), ..Camera::default() });
    let floor = Geometry::Quad {
        corner: DVec3::new(-1000.0, 0.0, -3000.0),
        edge_u: 2000.0 * DVec3::X,
        edge_v: 3001.0 * DVec3::Z,
    };
    // Tilted, and made of triangles.
    let backdrop = Mesh {
        positions: [[-90.0, -90.0, -30.0], [90.0, -90.0, -10.0], [0.0, 190.0, 5.0]]
            .map(Vec3::from_array)
            .to_vec(),
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    scene.meshes.push(backdrop);
    let dome = Geometry::Sphere(Sphere { center: DVec3::new(5.0, -70.0, 3.0), radius: 500.0 });
    let lamp = Geometry::Sphere(Sphere { center: DVec3::new(0.0, 20.0, 0.0), radius: 1.0 });
    scene.shapes.extend([floor, Geometry::Mesh(MeshId(1)), dome].map(shape));
    scene
        .shapes
        .push(Shape { emission: Some(Emission::new(Color::gray(1.0), false)), ..shape(lamp.clone()) });
    let middle = |scene: &Scene| Turntable::new(scene, None, None).pivot;
    assert_eq!(middle(&scene), DVec3::splat(2.0));

    // A table top is part of the subject; and so are emissive shapes of a model.
    scene.shapes[1].geometry =
        Geometry::Quad { corner: DVec3::new(-1.0, 0.0, 1.0), edge_u: 4.0 * DVec3::X, edge_v: 2.0 * DVec3::Z };
    assert_eq!(middle(&scene), DVec3::new(1.0, 1.5, 2.0));
    scene.source_format = SourceFormat::Model;
    assert_eq!(middle(&scene), DVec3::new(1.0, 10.5, 1.0));

    // With only a floor and a light, the floor is the subject; with only lights, they are.
    let mut flat = Scene { camera: scene.camera.clone(), ..Scene::default() };
    flat.shapes.push(Shape { emission: Some(Emission::new(Color::gray(1.0), false)), ..shape(lamp) });
    assert_eq!(middle(&flat), DVec3::new(0.0, 20.0, 0.0));
    flat.shapes.push(shape(Geometry::Disk { center: DVec3::X, normal: DVec3::Y, radius: 100.0 }));
    assert_eq!(middle(&flat), DVec3::X);
}

#[test]
fn the_turned_camera_keeps_its_distance_and_comes_back() {
    let mut scene = Scene::default();
    let turntable = Turntable::new(&scene, Some(DVec3::Z), None);
    turntable.frame(&mut scene, &Viewpoint::THREE_QUARTER);
    add_studio_and_camera(&mut scene, Some(DVec3::Z));
    let places = |scene: &Scene| match scene.camera.as_ref().unwrap().view {
        View::Look { lookfrom, lookat, .. } => (lookfrom, lookat),
        View::Matrix(_) => panic!("not a lookat"),
    };
    let before = places(&scene);
    for _ in 0..3 {
        scene.camera = scene.camera.as_ref().map(|camera| turntable.turned(camera, 120.0));
        let now = places(&scene);
        assert!((now.0.z - before.0.z).abs() < 1e-9 && now.0.is_finite());
        assert!((now.0.distance(now.1) - before.0.distance(before.1)).abs() < 1e-9);
    }
    let after = places(&scene);
    assert!(after.0.distance(before.0) < 1e-9 && after.1.distance(before.1) < 1e-9);
}
