//! Hidden lights, and the clipping planes of cameras.

use crate::support::{Compiled, scene};
use lookfrom_scene::Scene;

/// A camera that looks along −z at a grey wall at a distance of 4, of which a lamp at a distance of 2 hides the left half, through a pane.
fn behind_a_lamp(settings: &str, camera: &str) -> Scene {
    scene(&format!(
        r#"
        [image]
        width = 2
        height = 1
        filter = "box"
        background = "transparent"
        [render]
        integrator = "path"
        samples = 1024
        {settings}
        [camera]
        lookfrom = [0, 0, 4]
        lookat = [0, 0, 0]
        fov = 20
        {camera}
        [materials.grey]
        type = "diffuse"
        reflectance = 0.5
        [materials.black]
        type = "diffuse"
        reflectance = 0
        [materials.glass]
        type = "thin_dielectric"
        ior = 1.5
        [[quad]]
        corner = [-9, -9, 0]
        edge_u = [18, 0, 0]
        edge_v = [0, 18, 0]
        material = "grey"
        [[quad]]
        corner = [-2, -1, 2]
        edge_u = [2, 0, 0]
        edge_v = [0, 2, 0]
        material = "black"
        emission = 3
        two_sided = true
        [[quad]]
        corner = [-2, -2, 3]
        edge_u = [4, 0, 0]
        edge_v = [0, 4, 0]
        material = "glass"
        "#
    ))
}

/// Green and alpha of both pixels.
fn pixels(scene: Scene) -> [[f32; 2]; 2] {
    let film = Compiled::new(scene).film();
    [0, 1].map(|x| {
        let [black, white] = [0.0, 1.0].map(|gray| film.mean_before(x, 0, [gray; 3])[1]);
        [film.mean(x, 0)[1], 1.0 - (white - black)]
    })
}

#[test]
fn hidden_lights_are_passed_and_still_shine() {
    let seen = pixels(behind_a_lamp("thin_passages_count = false", ""));
    let hidden = pixels(behind_a_lamp("thin_passages_count = false\nhide_lights = true", ""));
    // Nine tenths of the lamp's light pass the pane.
    assert!(seen[0][0] > 2.5 && hidden[0][0] < 1.0, "{seen:?} {hidden:?}");
    // The wall behind is lit in both halves, by as much as where the lamp is seen.
    assert!(hidden[0][0] > 0.5 * seen[1][0] && (hidden[1][0] / seen[1][0] - 1.0).abs() < 0.05);
    assert!(hidden.iter().all(|[_, alpha]| *alpha > 0.99), "{hidden:?}");
    // Where the pane counts for the depth, the lamp is not seen by the camera itself.
    let counted = pixels(behind_a_lamp("hide_lights = true", ""));
    assert!(counted[0][0] > 2.5, "{counted:?}");
}

#[test]
fn rays_of_the_camera_meet_only_what_is_within_its_clip() {
    let with = |clip: &str| pixels(behind_a_lamp("", clip));
    let all = with("");
    // Beyond the pane and the lamp there is the wall, which reflects at most half of the light.
    let wall = with("clip = [2.5, 10]");
    assert!(wall[0][0] < 1.0 && (wall[1][0] / all[1][0] - 1.0).abs() < 0.2, "{wall:?} {all:?}");
    // The wall is too far: behind the lamp's rim is nothing.
    let lamp = with("clip = [1.5, 3]");
    assert!((lamp[0][0] - 3.0).abs() < 1e-3 && lamp[1] == [0.0, 0.0], "{lamp:?}");
    assert_eq!(with("clip = [0, 0.5]"), [[0.0, 0.0]; 2]);
    // Rays of a parallel camera start nearer than the eye, where that is far away.
    let parallel = |lookfrom: f64, clip: [f64; 2]| {
        let mut scene = behind_a_lamp("", "");
        let camera = scene.camera.as_mut().expect("a camera");
        camera.projection = lookfrom_scene::camera::Projection::Orthographic { height: 1.0 };
        camera.clip = Some(clip);
        let (from, at) = (glam::DVec3::new(0.0, 0.0, lookfrom), glam::DVec3::ZERO);
        camera.view = lookfrom_scene::camera::View::Look { lookfrom: from, lookat: at, up: glam::DVec3::Y };
        pixels(scene)
    };
    for lookfrom in [4.0, 4000.0] {
        let lamp = parallel(lookfrom, [lookfrom - 2.5, lookfrom - 1.0]);
        assert!((lamp[0][0] - 3.0).abs() < 1e-3 && lamp[1] == [0.0, 0.0], "{lookfrom}: {lamp:?}");
    }
}
