//! Single-sided surfaces that face inward: half of the light passes their backs, as the camera does.

use crate::support::{Compiled, scene};
use glam::{DMat4, DVec3};
use lookfrom::film::Film;
use lookfrom::session::{Options, Session};
use lookfrom_scene::Scene;
use lookfrom_scene::camera::Look;

const ALBEDO: f32 = 0.4;

/// A box of one diffuse material in even light, seen from outside.
fn room(integrator: &str, depth: u32) -> Scene {
    let mut scene = scene(&format!(
        r#"
        [camera]
        lookfrom = [5, 4, 7]
        lookat = [0, 0, 0]
        fov = 10
        [image]
        width = 12
        height = 12
        [render]
        integrator = "{integrator}"
        samples = 256
        depth = {depth}
        [materials.wall]
        type = "diffuse"
        reflectance = {ALBEDO}
        [[box]]
        min = [-2, -2, -2]
        max = [2, 2, 2]
        material = "wall"
        [[light]]
        type = "environment"
        color = 1
        "#
    ));
    for shape in &mut scene.shapes {
        (shape.single_sided, shape.reverse_orientation) = (true, true);
    }
    scene.render.open_fronts = true;
    scene
}

fn mean(film: &Film) -> f64 {
    let pixels = film.picture().pixels;
    pixels.iter().map(|rgb| f64::from(rgb[1])).sum::<f64>() / pixels.len() as f64
}

#[test]
fn inner_walls_are_lit_through_the_backs_of_the_others() {
    let albedo = f64::from(ALBEDO);
    // At each bounce half of the light comes through the walls, and half from them.
    let half = 0.5 * albedo;
    for (integrator, depth, expected) in [
        ("path", 1, half),
        ("path", 2, half + half * half),
        ("path", 60, half / (1.0 - half)),
        ("simple_path", 1, half),
    ] {
        let found = mean(&Compiled::new(room(integrator, depth)).film());
        assert!((found / expected - 1.0).abs() < 0.02, "{integrator} {depth}: {found}, expected {expected}");
    }
}

#[test]
fn walls_are_open_where_the_settings_say_so_and_the_session_tells() {
    for open_fronts in [true, false] {
        let mut scene = room("path", 2);
        scene.render.open_fronts = open_fronts;
        let session = Session::of_scene(scene, &Options::default()).unwrap();
        let told = session.warnings().iter().any(|warning| warning.message.contains("half of the light"));
        assert_eq!(told, open_fronts);
        assert_eq!(mean(&session.render(&()).unwrap().rendered.film) > 0.0, open_fronts);
    }
}

#[test]
fn walls_that_face_outward_or_have_two_sides_block_light() {
    for (single_sided, reverse_orientation) in [(true, false), (false, true), (false, false)] {
        let mut scene = room("path", 1);
        for shape in &mut scene.shapes {
            (shape.single_sided, shape.reverse_orientation) = (single_sided, reverse_orientation);
        }
        // A box inside of the box, seen from between them, is in the dark.
        let mut inner = scene.shapes[0].clone();
        inner.world_from_object = DMat4::from_scale(DVec3::splat(0.5));
        scene.shapes.push(inner);
        let look = Look { lookfrom: DVec3::new(0.0, 0.1, 1.6), lookat: DVec3::ZERO, up: DVec3::Y };
        scene.camera.as_mut().unwrap().set_look(look, DVec3::ZERO);
        let found = mean(&Compiled::new(scene).film());
        assert!(found == 0.0, "{single_sided} {reverse_orientation}: {found}");
    }
}

#[test]
fn a_camera_that_would_see_only_backs_sees_both_sides() {
    let sheet = |reverse_orientation: bool| {
        let mut scene = scene(
            r#"
            [camera]
            lookfrom = [0, 0, 5]
            lookat = [0, 0, 0]
            [image]
            width = 8
            height = 8
            [render]
            integrator = "path"
            samples = 4
            [[quad]]
            corner = [-1, -1, 0]
            edge_u = [2, 0, 0]
            edge_v = [0, 2, 0]
            [[light]]
            type = "distant"
            direction = [0, 0, -1]
            illuminance = 3
            "#,
        );
        scene.shapes[0].single_sided = true;
        scene.shapes[0].reverse_orientation = reverse_orientation;
        Session::of_scene(scene, &Options::default()).unwrap()
    };
    let [front, back] = [sheet(false), sheet(true)];
    let pictures = [&front, &back].map(|session| session.render(&()).unwrap().developed.picture);
    assert!(pictures[0].pixels[27][1] > 0.1);
    assert_eq!(pictures[0], pictures[1]);
    let told = |session: &Session| {
        session.warnings().iter().any(|warning| warning.message.contains("shown from both sides"))
    };
    assert!(!told(&front) && told(&back));
}

#[test]
fn back_faces_are_black_where_the_material_says_so() {
    let sheet = |back: &str, kind: &str, from: f64| {
        let scene = scene(&format!(
            r#"
            [camera]
            lookfrom = [0, 0, {from}]
            lookat = [0, 0, 0]
            [image]
            width = 8
            height = 8
            [render]
            integrator = "path"
            samples = 16
            [materials.sheet]
            type = {kind}
            {back}
            [[quad]]
            corner = [-9, -9, 0]
            edge_u = [18, 0, 0]
            edge_v = [0, 18, 0]
            material = "sheet"
            [[sphere]]
            center = [0, 0, 50]
            radius = 30
            material = "sheet"
            [[light]]
            type = "environment"
            color = 1
            "#
        ));
        mean(&Compiled::new(scene).film())
    };
    for kind in ["'diffuse'", "'conductor'\nmetal = 'gold'", "'plastic'"] {
        let [front, back] = [3.0, -3.0].map(|from| sheet("", kind, from));
        assert!(front > 0.1 && back > 0.1, "{kind}: {front} {back}");
        assert_eq!(sheet("back_face = \"black\"", kind, 3.0), front, "{kind}");
        assert_eq!(sheet("back_face = \"black\"", kind, -3.0), 0.0, "{kind}");
    }
}
