//! Cameras and lights.

use std::path::Path;

use glam::DVec3;
use lookfrom_scene::camera::{Projection, View};
use lookfrom_scene::files::{CameraChoice, ImportOptions};
use lookfrom_scene::light::LightKind;
use lookfrom_scene::material::Color;
use lookfrom_scene::{LoadContext, load};
use serde_json::{Value, json};

use super::{Model, one};

#[test]
fn cameras_look_along_minus_z() {
    let mut model = Model::default();
    let positions = model.square();
    let root = |extra: Value| {
        let mut root = one(
            json!({"attributes": {"POSITION": positions}, "mode": 5}),
            json!({
                "nodes": [
                    {"mesh": 0},
                    {"camera": 0, "translation": [0, 0, 7], "scale": [3, 3, 3]},
                    {"camera": 1, "name": "above"},
                ],
                "scenes": [{"nodes": [0, 1, 2]}],
                "cameras": [
                    {"type": "perspective", "perspective": {"yfov": 1.0, "aspectRatio": 2.0, "znear": 0.1}},
                    {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 2, "znear": 0, "zfar": 9}},
                ],
            }),
        );
        if let (Value::Object(root), Value::Object(extra)) = (&mut root, extra) {
            root.extend(extra);
        }
        root
    };
    let scene = model.scene(root(json!({})));
    let camera = scene.camera.expect("there is one");
    assert!(
        matches!(camera.projection, Projection::Perspective { fov } if (fov - 1.0_f64.to_degrees()).abs() < 1e-12)
    );
    let View::Matrix(matrix) = camera.view else { panic!("a matrix") };
    assert_eq!(matrix.transform_point3(DVec3::ZERO), DVec3::new(0.0, 0.0, 7.0));
    assert_eq!(matrix.transform_vector3(DVec3::Z), DVec3::NEG_Z, "forward");
    assert_eq!(matrix.transform_vector3(DVec3::X), DVec3::NEG_X, "left");
    assert_eq!((scene.image.width, scene.image.height), (640, 320));

    let above = ImportOptions { camera: CameraChoice::Named("above".to_owned()), ..ImportOptions::default() };
    let (scene, _) = model.chosen(root(json!({})), above).expect("it is there");
    assert_eq!(scene.camera.map(|camera| camera.projection), Some(Projection::Orthographic { height: 4.0 }));
    assert_eq!((scene.image.width, scene.image.height), (320, 640));
    let below = ImportOptions { camera: CameraChoice::Named("below".to_owned()), ..ImportOptions::default() };
    let error = model.chosen(root(json!({})), below).expect_err("it is not there").to_string();
    assert!(error.contains("\"above\""), "{error}");

    // As if the file had none, also for the shape of the picture.
    let none = ImportOptions { camera: CameraChoice::None, ..ImportOptions::default() };
    let (scene, warnings) = model.chosen(root(json!({})), none.clone()).expect("it is valid");
    assert!(scene.camera.is_none() && warnings.is_empty(), "{warnings:?}");
    assert_eq!((scene.image.width, scene.image.height), (640, 480));
    let names: Vec<_> = scene.contents.cameras.iter().map(|camera| camera.name.as_deref()).collect();
    assert_eq!(names, [None, Some("above")], "they are there all the same");
    let mut memory = model.memory(root(json!({})));
    memory.0.insert("a.toml".into(), b"import = \"m/a.gltf\"".to_vec());
    let mut context = LoadContext { import: none, ..LoadContext::new(&memory) };
    let scene = load::scene(Path::new("a.toml"), &mut context).expect("it is valid");
    assert!(scene.camera.is_none());
}

#[test]
fn lamps_have_photometric_units() {
    let lights = json!([
        {"type": "point", "intensity": 314.0, "color": [1, 0.5, 0]},
        {"type": "directional", "intensity": std::f64::consts::PI},
        {"type": "spot", "spot": {"outerConeAngle": 0.5}},
    ]);
    let root = json!({
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": lights}},
        "nodes": [
            {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [1, 2, 3]},
            {"extensions": {"KHR_lights_punctual": {"light": 1}}},
            {"extensions": {"KHR_lights_punctual": {"light": 2}}, "rotation": [0, 1, 0, 0]},
        ],
    });
    let (scene, _) = Model::default().read(root).expect("it is valid");
    let [point, sun, spot] = &scene.lights[..] else { panic!("three lights") };
    // A white diffuse surface at a distance of 1, under E = 314 lx, has the radiance E/π.
    let LightKind::Point { position, intensity: Color::Value(color), .. } = &point.kind else {
        panic!("{point:?}")
    };
    assert_eq!(*position, DVec3::new(1.0, 2.0, 3.0));
    assert!((color[0] - 99.949_3).abs() < 1e-3 && (color[1] - 49.974_6).abs() < 1e-3 && color[2] == 0.0);
    assert!(matches!(
        sun.kind,
        LightKind::Distant { direction: DVec3::NEG_Z, intensity: Color::Value([1.0, 1.0, 1.0]) }
    ));
    let LightKind::Spot { direction, cone_angle, inner_angle, .. } = spot.kind else { panic!("{spot:?}") };
    assert!((direction - DVec3::Z).length() < 1e-12);
    assert!((cone_angle - 0.5_f64.to_degrees()).abs() < 1e-9 && inner_angle == 0.0);
}
